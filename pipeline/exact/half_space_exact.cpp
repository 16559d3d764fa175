#include <winnow/pipeline/exact/bit_span.h>
#include <winnow/pipeline/exact/half_space_exact.h>

#include <algorithm>

namespace winnow {
namespace {

[[nodiscard]] ExactVerdict verdict_of(int sign) noexcept {
  return sign > 0   ? ExactVerdict::separated
         : sign < 0 ? ExactVerdict::overlapping
                    : ExactVerdict::touching;
}

/// Sign of rest - radius * sqrt(square), radius >= 0.
[[nodiscard]] int sign_less_root(const Dyadic& rest, const Dyadic& radius,
                                 const Dyadic& square) noexcept {
  if (rest.sign() < 0) return -1;
  return compare(rest * rest, radius * radius * square);
}

[[nodiscard]] int normal_bits(const HalfSpaceShape& half_space) noexcept {
  BitSpan span;
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
  if (!fits_dyadic(2, rotation_bits(half_space_pose) + rotation_bits(core_pose) +
                          normal_bits(half_space) + 64 + lengths.bits() + kSums)) {
    return ExactVerdict::undecided;
  }

  // All terms are times the squares of both quaternions' lengths.
  const Dyadic core_square = square_length(core_pose.orientation);
  const Dyadic scale = core_square * square_length(half_space_pose.orientation);
  const ExactVector normal =
      scaled_rotation(half_space_pose.orientation) * exact_vector(half_space.normal);
  const ExactVector local = transposed_times(scaled_rotation(core_pose.orientation), normal);
  const Dyadic center =
      dot(normal, between) * core_square - scale * (Dyadic(half_space.offset) + core.rounding);
  if (!core.has_discs) {
    Dyadic height;
    farthest_vertex(core, -local, kNoVertex, height);
    return verdict_of(compare(center, height));
  }
  const Dyadic across = local.x[0] * local.x[0] + local.x[1] * local.x[1];
  int sign = 1;
  for (const CoreDisc& disc : core.disc) {
    sign = std::min(sign, sign_less_root(center + local.x[2] * disc.z, disc.radius, across));
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
  if (!fits_dyadic(1, directions + lengths.bits())) return ExactVerdict::undecided;
  const ExactVector normal_a = scaled_rotation(pose_a.orientation) * exact_vector(a.normal);
  const ExactVector normal_b = scaled_rotation(pose_b.orientation) * exact_vector(b.normal);
  const bool opposite = is_zero(cross(normal_a, normal_b)) && dot(normal_a, normal_b).sign() < 0;
  if (!opposite) return ExactVerdict::overlapping;
  const Dyadic square = square_length(pose_a.orientation);
  return verdict_of(
      compare(dot(normal_a, between), square * (Dyadic(a.offset) + Dyadic(b.offset))));
}

}  // namespace winnow
