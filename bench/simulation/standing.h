#pragma once

#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/shape_pool.h>
#include "bench/simulation/contact_solver.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace winnow::bench {

/// Something that stands if its contacts are good.
enum class StandingScene : std::uint8_t { stack, hull_stack, card_house, wheel, arch };
inline constexpr StandingScene kStandingScenes[] = {StandingScene::stack, StandingScene::hull_stack,
                                                    StandingScene::card_house, StandingScene::wheel,
                                                    StandingScene::arch};
[[nodiscard]] std::string name_of(StandingScene scene);

struct StandingOptions {
  bool contact_reduction = false;
  double margin = 0.02;
  /// Of a frame, in which contacts are found once.
  double seconds = 1.0 / 60.0;
  SolverOptions solver{};
  Execution execution = Execution::serial();
};

/// A structure of bodies whose edges are about 1, which nothing touches but a floor and gravity.
class Standing {
 public:
  Standing(StandingScene scene, const StandingOptions& options);

  void step();

  [[nodiscard]] double time() const noexcept { return time_; }
  [[nodiscard]] std::size_t bodies() const noexcept { return bodies_.size(); }
  [[nodiscard]] const Contacts& contacts() const noexcept { return contacts_; }
  [[nodiscard]] std::size_t islands() const noexcept { return islands_.size(); }
  [[nodiscard]] std::size_t colours() const noexcept { return colours_.size(); }
  /// How far the body is that went farthest from where it stood at the begin, or at `mark`; and by
  /// how much one has turned most, as an angle.
  [[nodiscard]] double drift() const;
  [[nodiscard]] double tilt() const;
  void mark();
  /// Deepest penetration of the last frame.
  [[nodiscard]] double deepest() const;
  /// Share of points in the last frame that were there in the one before.
  [[nodiscard]] double kept_points() const;
  /// Of all bodies' bits.
  [[nodiscard]] std::uint64_t fingerprint() const;

 private:
  void add(ShapeId shape, const RigidBody& body);
  /// A box or hull of density 1, its inertia that of a box.
  void add_solid(ShapeId shape, const Eigen::Vector3d& edges, const Eigen::Vector3d& position,
                 double turn_about_y);
  void add_floor();
  void build_stack(bool hulls);
  void build_card_house();
  void build_wheel();
  void build_arch();

  ShapePool shapes_;
  CompositePool composites_;
  Scene scene_;
  Contacts contacts_;
  ContactGroups islands_;
  ContactGroups colours_;
  ContactSolver solver_;
  StandingOptions options_;
  std::vector<Key> keys_;
  std::vector<RigidBody> bodies_;
  std::vector<RigidBody> marked_;
  double time_ = 0.0;
};

}  // namespace winnow::bench
