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

/// Returns the names of the structures, which stand only if their contacts are good.
[[nodiscard]] std::vector<std::string> standing_names();

struct StandingOptions {
  bool part_manifolds = false;
  /// Duration of a frame; contacts are found once per frame.
  double seconds = 1.0 / 60.0;
  Execution execution = Execution::serial();
};

/// A structure of bodies with edges of about 1, subject only to a floor and gravity.
class Standing {
 public:
  /// `structure` is one of standing_names().
  Standing(const std::string& structure, const StandingOptions& options);

  void step();

  [[nodiscard]] double time() const noexcept { return time_; }
  [[nodiscard]] std::size_t bodies() const noexcept { return bodies_.size(); }
  [[nodiscard]] const Contacts& contacts() const noexcept { return contacts_; }
  [[nodiscard]] std::size_t islands() const noexcept { return islands_.size(); }
  [[nodiscard]] std::size_t colours() const noexcept { return colours_.size(); }
  /// `drift` returns the largest distance of a body from its position at the start or, if it was
  /// called, at `mark`; `tilt` the largest angle by which a body has rotated since then.
  [[nodiscard]] double drift() const;
  [[nodiscard]] double tilt() const;
  void mark();
  /// Returns the deepest penetration of the last frame.
  [[nodiscard]] double deepest() const;
  /// Returns the share of the last frame's contact points that existed in the frame before.
  [[nodiscard]] double kept_points() const;
  /// Returns a hash of all bodies' bits.
  [[nodiscard]] std::uint64_t fingerprint() const;

 private:
  void add(ShapeId shape, const RigidBody& body);
  /// Adds a box or hull of density 1 with the inertia of a box.
  void add_solid(ShapeId shape, const Eigen::Vector3d& edges, const Eigen::Vector3d& position,
                 double turn_about_y);
  void add_floor();
  struct Structure {
    const char* name;
    void (Standing::*build)();
  };
  static const Structure kStructures[];
  friend std::vector<std::string> standing_names();
  void build_stack(ShapeId box);
  void build_box_stack();
  void build_hull_stack();
  void build_card_house();
  void build_wheel();
  void build_arch();

  ShapePool shapes_;
  CompositePool composites_;
  Scene scene_;
  Contacts contacts_;
  ContactGroups islands_;
  ContactGroups colours_;
  std::unique_ptr<ContactSolver> solver_ = make_contact_solver();
  StandingOptions options_;
  std::vector<Key> keys_;
  std::vector<RigidBody> bodies_;
  std::vector<RigidBody> marked_;
  double time_ = 0.0;
};

}  // namespace winnow::bench
