#pragma once

// Continuous collision detection: times at which moving shapes, or features of meshes, touch.
// ContinuousCollision (continuous_collision.h) finds moving pairs in a scene. The implementation is
// in motion/.

#include <winnow/core/execution.h>
#include <winnow/core/export.h>
#include <winnow/core/memory.h>
#include <winnow/core/status.h>
#include <winnow/core/vectors.h>
#include <winnow/pipeline/contact_types.h>
#include <winnow/pipeline/rigid_motion.h>
#include <winnow/pipeline/shape_pool.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory_resource>
#include <span>

namespace winnow {

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
  [[nodiscard]] std::span<const Status> status() const noexcept { return status_; }
  /// True if the shapes of pair i touch. False is certain: they are apart at all times.
  [[nodiscard]] bool hits(std::size_t i) const noexcept { return hit_[i] != 0; }
  /// Returns for all pairs whether they touch; nonzero if they do.
  [[nodiscard]] std::span<const std::uint8_t> hit() const noexcept { return hit_; }
  /// Returns the times of impact, in [0, 1]; 1 if the shapes do not touch. At every earlier time
  /// they are apart.
  [[nodiscard]] std::span<const double> time() const noexcept { return time_; }
  /// Returns the distances at these times, within the tolerance; 0 if the shapes do not touch. For
  /// shapes that share a point at the start (time 0): minus the penetration depth.
  [[nodiscard]] std::span<const double> gap() const noexcept { return gap_; }
  /// Returns the error bounds: the true distance at that time is within gap +- error_bound.
  [[nodiscard]] std::span<const double> error_bound() const noexcept { return error_bound_; }
  /// Returns the unit normals from a to b at these times, in world axes; 0 if the shapes do not
  /// touch.
  [[nodiscard]] std::span<const double> normal(int axis) const noexcept { return normal_[axis]; }
  /// Returns the contact points of a, relative to the position of body a at that time, in world
  /// axes. The point of b is point + gap * normal.
  [[nodiscard]] std::span<const double> point(int axis) const noexcept { return point_[axis]; }

  /// Returns the triangle or child of a that touches b, the same one in each run. kWholeShape for a
  /// convex shape, or if the shapes do not touch.
  [[nodiscard]] std::span<const std::uint32_t> part_a() const noexcept { return part_a_; }
  /// Returns the triangle or child of b.
  [[nodiscard]] std::span<const std::uint32_t> part_b() const noexcept { return part_b_; }

  /// Returns the bytes of all columns under `results`: exactly what is allocated from the resource.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  friend struct ImpactColumns;

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

/// Kinds of feature pairs of meshes, each given by four points.
enum class FeaturePair : std::uint8_t {
  vertex_face,  ///< point 0 and the triangle of points 1, 2 and 3
  edge_edge,    ///< the edge from point 0 to 1 and the edge from point 2 to 3
};

/// When features count as touching, and the limit of work.
struct FeatureImpactOptions {
  /// Distance at which features touch: finite, >= 0, in units of the points.
  double min_separation = 0.0;
  /// How early the returned time may be before the first touch, in (0, 1], apart from rounding.
  /// Features that stay apart, but come closer than the distance that they move in a time of
  /// `tolerance`, may be reported as touching.
  double tolerance = 0x1p-40;
  /// Largest number of time intervals to examine, at least 1. If they do not settle the result, an
  /// impact at the first unsettled time is returned: early, never late.
  std::uint32_t max_intervals = 2048;
};

/// Result for one pair of features.
struct FeatureImpact {
  bool hit = false;  ///< false: they do not touch in [0, 1]
  /// Time of the first touch, in [0, 1], never late; infinite if there is none.
  double time = std::numeric_limits<double>::infinity();
};

/// Finds the time at which two features first touch, while each of their points moves linearly from
/// `start` at time 0 to `end` at time 1. Degenerate features count as the segment or point that
/// they are. The result is certified: no touch is missed and no time is late, rounding included;
/// coordinates are taken as exact. A hit without a touch is possible only if the gap is at most
/// about 1e-14 of the size and motion of the features, or at most the distance that they move in a
/// time of `tolerance`, or if `max_intervals` is reached.
///
/// The differences of the points of the two features span a polygon whose corners move linearly;
/// the features touch when this polygon contains the origin. Two tests rule out time intervals. The
/// first test: the volume spanned by the points, a cubic polynomial in time, has no zero in the
/// interval (shown by the hull of its Bernstein coefficients, as in Bezier clipping: Sederberg and
/// Nishita, "Curve intersection using Bezier clipping", 1990). The second test: a fixed plane
/// separates the polygon from the origin at both ends of the interval. Because the corners move
/// linearly, the plane then separates them during the whole interval. Compare the three-dimensional
/// inclusion of Wang et al., "A large-scale benchmark and an inclusion-based algorithm for
/// continuous collision detection", 2021.
///
/// `invalid_bounds` if a coordinate is not finite or a difference of two overflows;
/// `invalid_argument` for options out of range.
[[nodiscard]] WINNOW_API Answer<FeatureImpact> feature_impact(
    FeaturePair kind, const std::array<Vec3d, 4>& start, const std::array<Vec3d, 4>& end,
    const FeatureImpactOptions& options = {}) noexcept;

/// Many pairs of features, in columns in the caller's memory: coordinate `axis` of point k of pair
/// i at the start is start[k][axis][i]. Nothing is copied, so the object must not outlive the
/// memory.
struct FeatureColumns {
  std::array<std::array<const double*, 3>, 4> start{};  ///< at time 0
  std::array<std::array<const double*, 3>, 4> end{};    ///< at time 1
  std::size_t count = 0;                                ///< number of pairs
};

/// As `feature_impact`, for many pairs: times[i] is the time of pair i, infinite if there is no
/// impact, NaN if its coordinates are invalid. Results equal single calls bit for bit, on any
/// instruction set; a cheap test that rules out most pairs runs on several at a time.
/// `size_mismatch` if `times` and the pairs differ in number; `invalid_argument` for invalid
/// options or missing columns.
[[nodiscard]] WINNOW_API Status feature_impacts(FeaturePair kind, const FeatureColumns& pairs,
                                                std::span<double> times,
                                                const FeatureImpactOptions& options = {}) noexcept;

}  // namespace winnow
