#pragma once

// Continuous collision detection of pairs of moving shapes. ContinuousCollision
// (continuous_collision.h) finds such pairs in a scene. The implementation is in motion/.

#include <winnow/core/column.h>
#include <winnow/core/execution.h>
#include <winnow/core/export.h>
#include <winnow/core/footprint.h>
#include <winnow/core/large_pages.h>
#include <winnow/core/status.h>
#include <winnow/pipeline/contact_types.h>
#include <winnow/pipeline/rigid_motion.h>
#include <winnow/pipeline/shape_pool.h>

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

/// Internal types.
namespace impact {
struct Impact;
}  // namespace impact
class SubShapeQuery;

class CompositePool;

/// Moving bodies: body i has shape shapes[i] and moves by motions[i].
struct MovingBodies {
  std::span<const ShapeId> shapes;       ///< one per body
  std::span<const RigidMotion> motions;  ///< one per body
};

/// Options of `time_of_impact`.
struct ImpactOptions {
  /// Largest gap at the time of impact, relative to the size of the smaller shape. The size is the
  /// greatest distance of a point from the centre; if it is 0, the size of the other shape is used;
  /// for composite shapes, the sizes of the parts that touch. In (0, 1]. The gap is never smaller
  /// than double precision resolves: about 1e-13 of the sizes, of the path between the positions
  /// and of the arcs of rotation; for cylinders and cones against much larger shapes, about 1e-8 of
  /// the larger size.
  double tolerance = 1e-6;
  /// How work is run in parallel; results do not depend on it.
  Execution execution = Execution::serial();
  /// Pool of meshes, height fields and compounds; null if there are none.
  const CompositePool* composites = nullptr;
};

/// Results of `time_of_impact`, in columns: one element per pair, in the order of the input. The
/// caller keeps the object from call to call.
class WINNOW_API ImpactResult {
 public:
  /// Creates an empty result. Every allocation comes from `memory`, which must outlive the object;
  /// there are none before the first use.
  explicit ImpactResult(std::pmr::memory_resource* memory = default_memory()) noexcept;

  /// Returns the number of pairs.
  [[nodiscard]] std::size_t size() const noexcept { return time_.size(); }
  /// Returns the status of pair i: `ok`; `invalid_key` if a shape does not exist; `unsupported` for
  /// a composite shape without a pool of them; `invalid_pose` for an invalid motion. If it is not
  /// `ok`, the other columns contain zeros.
  [[nodiscard]] Status status(std::size_t i) const noexcept { return status_[i]; }
  /// Returns the status of all pairs.
  [[nodiscard]] std::span<const Status> status() const noexcept {
    return {status_.data(), status_.size()};
  }
  /// True if the shapes of pair i touch. False is certain: they are apart at all times.
  [[nodiscard]] bool hits(std::size_t i) const noexcept { return hit_[i] != 0; }
  /// Returns for all pairs whether they touch; nonzero if they do.
  [[nodiscard]] std::span<const std::uint8_t> hit() const noexcept {
    return {hit_.data(), hit_.size()};
  }
  /// Returns the times of impact, in [0, 1]; 1 if the shapes do not touch. At every earlier time
  /// they are apart.
  [[nodiscard]] std::span<const double> time() const noexcept { return span(time_); }
  /// Returns the distances at these times, within the tolerance; 0 if the shapes do not touch. For
  /// shapes that share a point at the start (time 0): minus the penetration depth.
  [[nodiscard]] std::span<const double> gap() const noexcept { return span(gap_); }
  /// Returns the error bounds: the true distance at that time is within gap +- error_bound.
  [[nodiscard]] std::span<const double> error_bound() const noexcept { return span(error_bound_); }
  /// Returns the unit normals from a to b at these times, in world axes; 0 if the shapes do not
  /// touch.
  [[nodiscard]] std::span<const double> normal(int axis) const noexcept {
    return span(normal_[axis]);
  }
  /// Returns the contact points of a, relative to the position of body a at that time, in world
  /// axes. The point of b is point + gap * normal.
  [[nodiscard]] std::span<const double> point(int axis) const noexcept {
    return span(point_[axis]);
  }

  /// Returns the triangle or child of a that touches b, the same one in each run. kWholeShape for a
  /// convex shape, or if the shapes do not touch.
  [[nodiscard]] std::span<const std::uint32_t> part_a() const noexcept {
    return {part_a_.data(), part_a_.size()};
  }
  /// Returns the triangle or child of b.
  [[nodiscard]] std::span<const std::uint32_t> part_b() const noexcept {
    return {part_b_.data(), part_b_.size()};
  }

  /// Returns the bytes of all columns under `results`: exactly what is allocated from the resource.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  friend WINNOW_API Status time_of_impact(const ShapePool& shapes, const MovingBodies& bodies,
                                          std::span<const BodyPair> pairs,
                                          const ImpactOptions& options, ImpactResult& result);
  [[nodiscard]] bool resize(std::size_t count) noexcept;
  void find_range(const SubShapeQuery& parts, const MovingBodies& bodies,
                  std::span<const BodyPair> pairs, const ImpactOptions& options, std::size_t first,
                  std::size_t end);
  void write(std::size_t i, const impact::Impact& impact, std::uint32_t part_a,
             std::uint32_t part_b) noexcept;
  [[nodiscard]] static std::span<const double> span(const Column<double>& c) noexcept {
    return {c.data(), c.size()};
  }

  Column<Status> status_;
  Column<std::uint8_t> hit_;
  Column<double> time_;
  Column<double> gap_;
  Column<double> error_bound_;
  Column<double> normal_[3];
  Column<double> point_[3];
  Column<std::uint32_t> part_a_;
  Column<std::uint32_t> part_b_;
};

/// Finds the time at which the shapes of each pair first touch. The time is never late: at every
/// earlier time the shapes are apart, which is proved by separating planes, rounding included. It
/// is early by no more than the time to close a gap of the tolerance. Shapes that share a point at
/// the start touch at time 0. Shapes that pass each other within the tolerance, or leave that range
/// and come back into it, may or may not be reported as touching. Shapes that stay within the
/// tolerance while they slide, rest or separate are not reported.
///
/// The method is conservative advancement (Mirtich, "Impulse-based dynamic simulation of rigid body
/// systems", 1996) along the normal of the closest points. Along a fixed direction, the coordinate
/// of a point of a rotating body is a cosine in time; between two times it leaves its chord by at
/// most a term quadratic in the angle. Two closest-point computations thus prove that the shapes
/// are apart in between, with an error of second order, so that few steps suffice. A composite
/// shape is traversed in its own frame with the moving box of the other shape, rotation included,
/// in order of time; parts after the first impact found are skipped. If the shapes share a point at
/// the start, the gap is the gap of the deepest pair of parts.
///
/// `invalid_argument` for an invalid tolerance or a pair with a body index out of range,
/// `size_mismatch` for spans of different lengths, `out_of_memory`: then `result` is empty. Errors
/// of a single pair are in its status.
///
/// A pair usually takes about three closest-point computations, seven for fast rotations; up to
/// |turn| / sqrt(tolerance) if the shapes rotate fast around each other without touching. If
/// neither shape rotates, the computations are steps of one closest-point search (van den Bergen,
/// "Ray casting against general convex objects with application to continuous collision detection",
/// 2004): about six, up to fifteen for smooth shapes. For smooth shapes, some steps guess the
/// normal by the secant method. Pairs are sorted by kind, 256 at a time, and computed in double,
/// eight of the same kinds at once; pairs of half-spaces, and pairs at the limit of double
/// precision, are computed one by one. The result of a pair does not depend on other pairs. A pair
/// with a composite shape takes this for each pair of parts whose boxes overlap on the path, and
/// about one traversal for each half radian of relative rotation during which the moving box
/// overlaps more than 8 parts.
WINNOW_API Status time_of_impact(const ShapePool& shapes, const MovingBodies& bodies,
                                 std::span<const BodyPair> pairs, const ImpactOptions& options,
                                 ImpactResult& result);

}  // namespace winnow
