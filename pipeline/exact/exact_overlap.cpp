// Exact overlap test of two shapes: chooses a method by kind (aligned_overlap, half-spaces, exact
// GJK, separating planes). Called by solver/solver.cpp.

#include "pipeline/exact/exact_overlap.h"

#include "pipeline/exact/aligned_overlap.h"
#include "pipeline/exact/core_difference.h"
#include "pipeline/exact/exact_gjk.h"
#include "pipeline/kinds/kinds.h"

#include <algorithm>
#include <cmath>

namespace winnow {
namespace {

/// Sign of rest - p sqrt(square_p) - q sqrt(square_q), with p and q >= 0, computed by squaring
/// twice.
[[nodiscard]] int sign_less_roots(const Dyadic& rest, const Dyadic& p, const Dyadic& square_p,
                                  const Dyadic& q, const Dyadic& square_q) noexcept {
  if (rest.sign() < 0) return -1;
  const Dyadic first = p * p * square_p;
  const Dyadic second = q * q * square_q;
  const Dyadic left = rest * rest - first - second;
  if (left.sign() < 0) return -1;
  return compare(left * left, Dyadic(4.0) * first * second);
}

[[nodiscard]] int normal_bits(const HalfSpaceShape& half_space) noexcept {
  BitSpan span;
  span.include(1.0);  // it is added to terms without the normal
  for (const double x : half_space.normal) span.include(x);
  return span.bits();
}

/// A half-space against the rounded core of any other shape. A stored normal is a unit vector only
/// up to rounding: its length, and a disc's radius projected on it, are roots, which are compared
/// by squaring.
[[nodiscard]] ExactVerdict half_space_verdict(const HalfSpaceShape& half_space,
                                              const Pose& half_space_pose, const CoreVertices& core,
                                              const Pose& core_pose) noexcept {
  const ExactVector between =
      exact_vector(core_pose.position) - exact_vector(half_space_pose.position);
  BitSpan lengths;
  for (const Dyadic& x : between.x) lengths.include(x);
  core.include_lengths(lengths);
  lengths.include(half_space.offset);
  constexpr int kSums = 6;
  if (!fits_dyadic(4, rotation_bits(half_space_pose) + rotation_bits(core_pose) +
                          normal_bits(half_space) + lengths.bits() + kSums)) {
    return ExactVerdict::undecided;
  }

  // All terms are multiplied by the squared lengths of both quaternions.
  const Dyadic core_square = square_length(core_pose.orientation);
  const Dyadic scale = core_square * square_length(half_space_pose.orientation);
  const ExactVector normal =
      scaled_rotation(half_space_pose.orientation) * exact_vector(half_space.normal);
  const ExactVector local = transposed_times(scaled_rotation(core_pose.orientation), normal);
  const Dyadic center = dot(normal, between) * core_square - scale * half_space.offset;
  const Dyadic square = dot(local, local);
  if (!core.has_discs) {
    Dyadic height;
    farthest_vertex(core, -local, height);
    return verdict_of(sign_less_roots(center - height, core.rounding, square, 0.0, 0.0));
  }
  const Dyadic across = local.x[0] * local.x[0] + local.x[1] * local.x[1];
  int sign = 1;
  for (const CoreDisc& disc : core.disc) {
    sign = std::min(sign, sign_less_roots(center + local.x[2] * disc.z, core.rounding, square,
                                          disc.radius, across));
  }
  return verdict_of(sign);
}

/// Two half-spaces always overlap unless their normals are opposite.
[[nodiscard]] ExactVerdict half_spaces_verdict(const HalfSpaceShape& a, const Pose& pose_a,
                                               const HalfSpaceShape& b,
                                               const Pose& pose_b) noexcept {
  const ExactVector between = exact_vector(pose_b.position) - exact_vector(pose_a.position);
  BitSpan lengths;
  for (const Dyadic& x : between.x) lengths.include(x);
  lengths.include(a.offset);
  lengths.include(b.offset);
  const int directions =
      rotation_bits(pose_a) + rotation_bits(pose_b) + normal_bits(a) + normal_bits(b);
  if (!fits_dyadic(2, directions + lengths.bits())) return ExactVerdict::undecided;
  const ExactVector normal_a = scaled_rotation(pose_a.orientation) * exact_vector(a.normal);
  const ExactVector normal_b = scaled_rotation(pose_b.orientation) * exact_vector(b.normal);
  const bool opposite = is_zero(cross(normal_a, normal_b)) && dot(normal_a, normal_b).sign() < 0;
  if (!opposite) return ExactVerdict::overlapping;
  // The second offset is multiplied by the ratio of the normals' lengths. For opposite normals this
  // is a ratio of dot products.
  const Dyadic along = dot(normal_b, normal_b);
  const Dyadic reach = dot(normal_a, between) - square_length(pose_a.orientation) * a.offset;
  const Dyadic other = square_length(pose_b.orientation) * b.offset;
  return verdict_of(compare(reach * along + dot(normal_a, normal_b) * other, 0.0));
}

/// The initial search direction. Any direction is valid, so small digits are dropped; +x if `axis`
/// is zero or not finite.
[[nodiscard]] ExactVector first_direction(const double axis[3]) noexcept {
  const double largest = std::max({std::fabs(axis[0]), std::fabs(axis[1]), std::fabs(axis[2])});
  const double sum = axis[0] + axis[1] + axis[2];
  if (!(largest > 0.0) || !std::isfinite(largest) || std::isnan(sum)) {
    return {{1.0, 0.0, 0.0}};
  }
  int exponent = 0;
  std::frexp(largest, &exponent);
  ExactVector direction;
  for (int k = 0; k < 3; ++k) {
    constexpr int kDigits = 40;
    direction.x[k] = std::nearbyint(std::ldexp(axis[k], kDigits - exponent));
  }
  return direction;
}

[[nodiscard]] ExactVerdict half_space_pair(const HalfSpaceShape& shape, const Pose& pose,
                                           const ShapeCore& other,
                                           const Pose& other_pose) noexcept {
  CoreVertices core;
  if (core_vertices(other, core)) return half_space_verdict(shape, pose, core, other_pose);
  if (other.kind != ShapeKind::half_space) return ExactVerdict::undecided;
  return half_spaces_verdict(shape, pose, *other.half_space, other_pose);
}

/// The minimum, over the directions passed to `test_axis` and their opposites, of the height of the
/// Minkowski difference of two rounded cores. A negative minimum proves that the shapes are
/// disjoint.
class MinHeight {
 public:
  /// `direction` is not zero; it is tested first.
  MinHeight(const CoreDifference& difference, const Dyadic& rounding,
            const ExactVector& direction) noexcept
      : difference_(difference), rounding_(rounding), least_(height_along(direction)) {
    test_direction(-direction);
  }

  void test_axis(const ExactVector& direction) noexcept {
    if (is_zero(direction)) return;
    test_direction(direction);
    test_direction(-direction);
  }
  [[nodiscard]] int sign() const noexcept { return least_.sign(); }

 private:
  [[nodiscard]] Dyadic height_along(const ExactVector& direction) const noexcept {
    return difference_.height_bound(direction) +
           rounding_ * difference_.scale() * root_above(dot(direction, direction));
  }
  void test_direction(const ExactVector& direction) noexcept {
    const Dyadic height = height_along(direction);
    if (compare(height, least_) < 0) least_ = height;
  }

  const CoreDifference& difference_;
  const Dyadic& rounding_;
  Dyadic least_;
};

/// Separating-axis test (SAT) for pairs whose numbers span too wide a range for exact GJK. Tests
/// `direction`, the axes of both frames and their cross products. For boxes without rounding, flat
/// ones included, this is complete (Gottschalk, "Separating axis theorem", 1996); for other pairs
/// it can only prove that the shapes are disjoint.
[[nodiscard]] ExactVerdict verdict_by_planes(const CoreDifference& difference,
                                             const Dyadic& rounding, const ExactVector& direction,
                                             bool are_boxes) noexcept {
  if (!difference.heights_in_range()) return ExactVerdict::undecided;
  MinHeight least(difference, rounding, direction);
  for (int i = 0; i < 3; ++i) {
    least.test_axis(difference.axis_a(i));
    least.test_axis(difference.axis_b(i));
    for (int k = 0; k < 3; ++k) least.test_axis(cross(difference.axis_a(i), difference.axis_b(k)));
  }
  if (least.sign() < 0) return ExactVerdict::separated;
  if (!are_boxes || rounding.sign() != 0) return ExactVerdict::undecided;
  return verdict_of(-least.sign());
}

/// Cylinders and cones: the heights along `direction` bound the cores from outside, and polygons
/// inscribed in their discs from inside. Decided if the heights separate the shapes, if the
/// polygons overlap, or if both touch.
[[nodiscard]] ExactVerdict bounded_verdict(const CoreDifference& difference, const Dyadic& rounding,
                                           const ExactVector& direction) noexcept {
  const Dyadic length = root_above(dot(direction, direction));
  const Dyadic height = difference.height_bound(direction) + rounding * difference.scale() * length;
  if (height.sign() < 0) return ExactVerdict::separated;
  const ExactVerdict inscribed = locate_origin(difference, rounding, direction);
  if (inscribed == ExactVerdict::overlapping) return inscribed;
  const bool both = inscribed == ExactVerdict::touching && height.sign() == 0;
  return both ? ExactVerdict::touching : ExactVerdict::undecided;
}

}  // namespace

ExactVerdict exact_overlap(const ShapeTables& tables, ShapeId a, const Pose& pose_a, ShapeId b,
                           const Pose& pose_b, const double axis[3]) noexcept {
  const ShapeCore shape_a = core_of(tables, a);
  const ShapeCore shape_b = core_of(tables, b);
  const ExactVerdict aligned = aligned_overlap(shape_a, pose_a, shape_b, pose_b);
  if (aligned != ExactVerdict::undecided) return aligned;
  if (shape_a.kind == ShapeKind::half_space) {
    return half_space_pair(*shape_a.half_space, pose_a, shape_b, pose_b);
  }
  if (shape_b.kind == ShapeKind::half_space) {
    return half_space_pair(*shape_b.half_space, pose_b, shape_a, pose_a);
  }
  const bool are_boxes = shape_a.kind == ShapeKind::box && shape_b.kind == ShapeKind::box;
  CoreVertices core_a;
  CoreVertices core_b;
  if (!core_vertices(shape_a, core_a) || !core_vertices(shape_b, core_b)) {
    return ExactVerdict::undecided;
  }
  const CoreDifference difference(core_a, pose_a, core_b, pose_b);
  const ExactVector direction = first_direction(axis);
  const Dyadic rounding = Dyadic(core_a.rounding) + core_b.rounding;
  if (!difference.in_range()) {
    return verdict_by_planes(difference, rounding, direction, are_boxes);
  }
  if (core_a.has_discs || core_b.has_discs) {
    return bounded_verdict(difference, rounding, direction);
  }
  return locate_origin(difference, rounding, direction);
}

}  // namespace winnow
