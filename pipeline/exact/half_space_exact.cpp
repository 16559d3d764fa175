#include "pipeline/exact/half_space_exact.h"
#include "pipeline/exact/bit_span.h"

#include <algorithm>

namespace winnow {
namespace {

[[nodiscard]] ExactVerdict verdict_of(int sign) noexcept {
  return sign > 0   ? ExactVerdict::separated
         : sign < 0 ? ExactVerdict::overlapping
                    : ExactVerdict::touching;
}

/// Sign of rest - p sqrt(square_p) - q sqrt(square_q), p and q >= 0: squared twice.
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
  span.include(1.0);  // it is added to terms without it
  for (const double x : half_space.normal) span.include(x);
  return span.bits();
}

}  // namespace

ExactVerdict half_space_verdict(const HalfSpaceShape& half_space, const Pose& half_space_pose,
                                const CoreVertices& core, const Pose& core_pose) noexcept {
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

  // All terms are times the squares of both quaternions' lengths.
  const Dyadic core_square = square_length(core_pose.orientation);
  const Dyadic scale = core_square * square_length(half_space_pose.orientation);
  const ExactVector normal =
      scaled_rotation(half_space_pose.orientation) * exact_vector(half_space.normal);
  const ExactVector local = transposed_times(scaled_rotation(core_pose.orientation), normal);
  const Dyadic center = dot(normal, between) * core_square - scale * half_space.offset;
  const Dyadic square = dot(local, local);
  if (!core.has_discs) {
    Dyadic height;
    farthest_vertex(core, -local, kNoVertex, height);
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

ExactVerdict half_spaces_verdict(const HalfSpaceShape& a, const Pose& pose_a,
                                 const HalfSpaceShape& b, const Pose& pose_b) noexcept {
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
  // The ratio of the normals' lengths, by which the second offset counts, is that of two products.
  const Dyadic along = dot(normal_b, normal_b);
  const Dyadic reach = dot(normal_a, between) - square_length(pose_a.orientation) * a.offset;
  const Dyadic other = square_length(pose_b.orientation) * b.offset;
  return verdict_of(compare(reach * along + dot(normal_a, normal_b) * other, 0.0));
}

}  // namespace winnow
