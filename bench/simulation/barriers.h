#pragma once

#include <winnow/core/execution.h>
#include <winnow/core/vectors.h>
#include "bench/common/interface.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>

namespace winnow::bench {

struct BarrierOptions {
  /// A funnel of triangles, in which spheres and boxes move up to fifteen times their size in a
  /// step; a thin blade in a closed box, which rotates by half a turn in a step; or a cloth that
  /// falls on a ball.
  std::string scene = "funnel";
  /// Number of bodies, or of vertices along an edge of the cloth; 0: 16 and 40.
  std::size_t size = 0;
  double step = 1.0 / 60.0;
  double gravity = 10.0;
  /// If false, everything moves without collision detection, for comparison.
  bool continuous = true;
  Execution execution = Execution::serial();
};

/// State of a barrier's simulation. NaN: not a figure of this scene.
struct BarrierFigures {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  std::size_t objects = 0;  ///< bodies, or triangles of the cloth
  std::size_t steps = 0;
  /// Impacts that cut steps: of bodies, or of features of the cloth with each other and the ball.
  std::size_t impacts = 0;
  /// Steps that ended early: bodies had too many impacts, or cuts of single vertices of the cloth
  /// did not end.
  std::size_t cut_short = 0;
  /// Found by brute force: how often the centre of a body passed through a triangle of the funnel
  /// or the blade; at present, the edges of the cloth that cross a face, and the faces that
  /// intersect the ball.
  std::size_t passed = 0;
  double fastest = kNone;  ///< longest displacement of a body in a step without impacts, in radii
  double strain = kNone;   ///< largest relative extension of a link of the cloth
  double lowest = kNone;   ///< height of the lowest vertex of the cloth
  /// Hash of the bits of all positions, and of orientations and velocities of bodies.
  std::uint64_t fingerprint = 0;
};

/// A simulation of fast motion in which nothing may pass through anything. It uses only winnow's
/// public interface. Its bits are the same on any number of threads and any instruction set.
class Barrier : public Interface {
 public:
  virtual void step() = 0;
  [[nodiscard]] virtual BarrierFigures figures() const = 0;
};

[[nodiscard]] std::unique_ptr<Barrier> make_fast_bodies(const BarrierOptions& options);
[[nodiscard]] std::unique_ptr<Barrier> make_cloth_drop(const BarrierOptions& options);

/// Throws std::runtime_error if winnow rejects the scene.
[[nodiscard]] inline std::unique_ptr<Barrier> make_barrier(const BarrierOptions& options) {
  return options.scene == "cloth" ? make_cloth_drop(options) : make_fast_bodies(options);
}

/// Returns whether the segment between two points crosses a triangle: its ends are on different
/// sides of the plane, and its line passes all edges on the same side.
[[nodiscard]] inline bool crosses(const Vec3d& from, const Vec3d& to, const Vec3d& a,
                                  const Vec3d& b, const Vec3d& c) {
  const auto volume = [](const Vec3d& p, const Vec3d& q, const Vec3d& r, const Vec3d& s) {
    return (q - p).cross(r - p).dot(s - p);
  };
  if ((volume(a, b, c, from) > 0.0) == (volume(a, b, c, to) > 0.0)) return false;
  const bool side = volume(from, to, a, b) > 0.0;
  return side == (volume(from, to, b, c) > 0.0) && side == (volume(from, to, c, a) > 0.0);
}

}  // namespace winnow::bench
