#pragma once

#include <winnow/core/execution.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/continuous_collision.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/shape_pool.h>
#include "bench/common/random.h"
#include "bench/scenes/meshes.h"

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace winnow::bench {

/// Obstacles of the fast bodies.
enum class FastScene : std::uint8_t {
  funnel,  ///< a funnel of triangles; bodies move up to fifteen times their size in a step
  blade,   ///< a thin blade in a closed box that rotates by half a turn in a step
};

struct FastBodiesOptions {
  FastScene scene = FastScene::funnel;
  std::size_t bodies = 40;
  std::uint64_t seed = 1;
  double step = 1.0 / 60.0;
  double gravity = 10.0;
  /// If false, bodies move without collision detection, for comparison: `passed` then counts the
  /// bodies that passed through an obstacle.
  bool continuous = true;
  Execution execution = Execution::serial();
};

/// Spheres and boxes that move from impact to impact and collide with each other and with static or
/// rotating obstacles. All bodies move to the time of the first impact that ContinuousCollision
/// finds, the two bodies of this impact get an impulse, and the rest of the step is tested again.
/// The class uses only these impacts, never an overlap test. The bits of every body are the same on
/// any number of threads and any instruction set.
class FastBodies {
 public:
  /// Throws std::runtime_error if winnow rejects the scene.
  explicit FastBodies(const FastBodiesOptions& options);

  void step();

  [[nodiscard]] std::size_t bodies() const noexcept { return bodies_.size(); }
  [[nodiscard]] std::size_t steps() const noexcept { return steps_; }
  [[nodiscard]] std::size_t impacts() const noexcept { return impacts_; }
  /// Returns how often a centre passed through a triangle of the funnel or through the blade, found
  /// by brute force.
  [[nodiscard]] std::size_t passed() const noexcept { return passed_; }
  /// Returns the number of steps that were cut short because of too many impacts.
  [[nodiscard]] std::size_t cut_short() const noexcept { return cut_short_; }
  /// Returns the longest displacement of a body in a step without impacts, in its radii.
  [[nodiscard]] double fastest() const noexcept { return fastest_; }
  /// Returns a hash of the bits of positions, velocities and orientations.
  [[nodiscard]] std::uint64_t fingerprint() const noexcept;

 private:
  struct Body {
    Key key;
    Pose pose;
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    Eigen::Vector3d spin = Eigen::Vector3d::Zero();
    double radius = 0.0;
    /// Mass and inertia of a ball of this radius; 0 if the body is static or kinematic.
    double inverse_mass = 0.0;
    double inverse_inertia = 0.0;
  };

  void make_funnel_scene();
  void make_blade_scene();
  void fill(double reach, double low, double high, double speed);
  [[nodiscard]] Key add(ShapeId shape, const Pose& pose, BodyState state);
  void push(double seconds);
  /// Moves all bodies by a share of their motions.
  void advance(double share);
  void collide(const SceneImpact& impact);
  void put_back();
  [[nodiscard]] bool passes_funnel(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const;
  [[nodiscard]] bool passes_blade(const RigidMotion& body, const RigidMotion& blade,
                                  double share) const;

  FastBodiesOptions options_;
  ShapePool shapes_;
  CompositePool composites_;
  Scene scene_;
  ContinuousCollision ccd_;
  Triangles funnel_;
  Random random_;
  /// The blade is the last body.
  std::vector<Body> bodies_;
  std::vector<Key> keys_;
  std::vector<RigidMotion> motions_;
  std::vector<Pose> poses_;
  std::size_t steps_ = 0;
  std::size_t impacts_ = 0;
  std::size_t passed_ = 0;
  std::size_t cut_short_ = 0;
  double fastest_ = 0.0;
};

}  // namespace winnow::bench
