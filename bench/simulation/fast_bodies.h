#pragma once

#include <winnow/core/execution.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/scene_sweep.h>
#include <winnow/pipeline/shape_pool.h>
#include "bench/common/random.h"
#include "bench/scenes/meshes.h"

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace winnow::bench {

/// What fast bodies run into.
enum class FastScene : std::uint8_t {
  funnel,  ///< a funnel of triangles, in which they go by up to fifteen times their size in a step
  blade,   ///< a thin blade in a closed box, which turns by half a turn in a step
};

struct FastBodiesOptions {
  FastScene scene = FastScene::funnel;
  std::size_t bodies = 40;
  std::uint64_t seed = 1;
  double step = 1.0 / 60.0;
  double gravity = 10.0;
  /// False: bodies go their whole ways whatever they meet, to see what gets through then.
  bool swept = true;
  Execution execution = Execution::serial();
};

/// Spheres and boxes that meet each other and what stands or turns, from impact to impact: all go
/// on to the first one that a sweep finds, the two bodies get an impulse, and what is left of the
/// step is swept again. A client of winnow: it never looks whether bodies overlap. The bits of
/// every body are the same on any number of threads and any instruction set.
class FastBodies {
 public:
  /// Throws std::runtime_error if winnow refuses the scene.
  explicit FastBodies(const FastBodiesOptions& options);

  void step();

  [[nodiscard]] std::size_t bodies() const noexcept { return bodies_.size(); }
  [[nodiscard]] std::size_t steps() const noexcept { return steps_; }
  [[nodiscard]] std::size_t impacts() const noexcept { return impacts_; }
  /// Ways of centres through a triangle of the funnel or through the blade, found by looking at
  /// these alone.
  [[nodiscard]] std::size_t passed() const noexcept { return passed_; }
  /// Steps that were cut short, because impacts followed on each other without end.
  [[nodiscard]] std::size_t cut_short() const noexcept { return cut_short_; }
  /// The longest way of a body in a step without impacts, in its radii.
  [[nodiscard]] double fastest() const noexcept { return fastest_; }
  /// Of positions, velocities and orientations, bit by bit.
  [[nodiscard]] std::uint64_t fingerprint() const noexcept;

 private:
  struct Body {
    Key key;
    Pose pose;
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    Eigen::Vector3d spin = Eigen::Vector3d::Zero();
    double radius = 0.0;
    /// Of a ball of the radius; 0: nothing moves it.
    double inverse_mass = 0.0;
    double inverse_inertia = 0.0;
  };

  void make_funnel_scene();
  void make_blade_scene();
  void fill(double reach, double low, double high, double speed);
  [[nodiscard]] Key add(ShapeId shape, const Pose& pose, Motion motion);
  void push(double seconds);
  /// All of them go on for a share of some seconds.
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
  SceneSweep sweep_;
  Triangles funnel_;
  Random random_;
  /// The blade is the last one.
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
