#pragma once

#include <winnow/core/export.h>
#include <winnow/core/vec3.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace winnow {

// A host may round in any direction and flush denormal numbers (FTZ, DAZ). Inside the library the
// environment is the default one; what headers compute in the host's has to be outward there, too.

namespace detail {

inline constexpr std::uint32_t kSign = 0x80000000U;
inline constexpr std::uint32_t kExponent = 0x7F800000U;

/// The lesser of two numbers. If the host takes denormal ones for 0 as it compares, a minimum is 0,
/// and integers in the order of floats tell.
[[nodiscard]] constexpr float lesser(float a, float b) noexcept {
  const float found = b < a ? b : a;
  if (found != 0.0F) [[likely]]
    return found;
  const auto x = std::bit_cast<std::int32_t>(a);
  const auto y = std::bit_cast<std::int32_t>(b);
  const std::int32_t both_negative = (x & y) >> 31;
  return (y ^ both_negative) < (x ^ both_negative) ? b : a;
}

/// `round_up` of a number between those of the smallest normal floats, in integers: nothing
/// flushes these.
[[nodiscard]] constexpr float round_up_tiny(double value) noexcept {
  constexpr std::uint64_t kOne = std::uint64_t{1} << 52U;
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const std::uint64_t exponent = bits >> 52U & 0x7FFU;
  const std::uint64_t mantissa = (bits & (kOne - 1)) | (exponent == 0 ? 0 : kOne);
  // In units of 2^-149, the smallest float. All of a smaller number is shifted out.
  const std::uint64_t shift = exponent < 863 ? 63 : 1023 + 52 - 149 - exponent;
  const std::uint64_t whole = mantissa >> shift;
  const bool is_negative = bits >> 63U != 0;
  const std::uint64_t units = whole + (!is_negative && whole << shift != mantissa ? 1 : 0);
  return std::bit_cast<float>(static_cast<std::uint32_t>(units) | (is_negative ? kSign : 0));
}

}  // namespace detail

/// The number itself: a conversion would make 0 of a denormal one if the host flushes these.
[[nodiscard]] constexpr double to_double(float value) noexcept {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  if ((bits & detail::kExponent) != 0) [[likely]]
    return static_cast<double>(value);
  const double size =
      static_cast<double>(static_cast<std::int32_t>(bits & ~detail::kSign)) * 0x1p-149;
  return (bits & detail::kSign) != 0 ? -size : size;
}

/// The float after a finite or -infinite `value`, going up. By its bits: cheaper than
/// std::nextafter.
[[nodiscard]] constexpr float next_up(float value) noexcept {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  // One more in its bits, or one less of a negative one; 0 of either sign comes before the
  // smallest.
  const std::uint32_t next = bits + 1U - 2U * (bits >> 31U);
  return std::bit_cast<float>((bits & 0x7FFFFFFFU) == 0 ? 1U : next);
}

/// Smallest float that is >= `value`. NaN stays NaN; above the float range gives +infinity.
[[nodiscard]] constexpr float round_up(double value) noexcept {
  const float nearest = static_cast<float>(value);
  const auto bits = std::bit_cast<std::uint32_t>(nearest);
  if ((bits & detail::kExponent) == 0) [[unlikely]]
    return detail::round_up_tiny(value);
  // Of a mask: which of the two it is cannot be foreseen, and a branch would cost more.
  const std::uint32_t up = static_cast<double>(nearest) < value ? ~0U : 0U;
  const std::uint32_t above = (bits & detail::kSign) != 0 ? bits - 1U : bits + 1U;
  return std::bit_cast<float>(bits ^ ((bits ^ above) & up));
}

/// Largest float that is <= `value`. NaN stays NaN; below the float range gives -infinity.
[[nodiscard]] constexpr float round_down(double value) noexcept {
  return -round_up(-value);
}

/// The float nearest to `value`, but at most the largest: what is finite stays so. NaN stays NaN.
[[nodiscard]] constexpr float finite_float(double value) noexcept {
  constexpr auto kMost = static_cast<double>(std::numeric_limits<float>::max());
  return static_cast<float>(value < -kMost ? -kMost : (kMost < value ? kMost : value));
}

/// Largest double that is <= the exact a + b, for finite sums. If the host flushes denormal
/// numbers, for numbers of at least 2^-959, as all floats and products of two are, and for 0.
[[nodiscard]] inline double add_down(double a, double b) noexcept {
  const bool swapped = std::abs(a) < std::abs(b);
  const double greater = swapped ? b : a;
  const double smaller = swapped ? a : b;
  const double sum = greater + smaller;
  // What the sum has of the smaller one is a double, whichever way the sum was rounded (Boldo,
  // Graillat and Muller, "On the robustness of the 2Sum and Fast2Sum algorithms", ACM TOMS 44(1),
  // 2017). A sum of 0 has no error.
  const bool above = smaller < sum - greater;
  // One less in its bits, or one more of a negative sum; without a branch, as above.
  const auto bits = std::bit_cast<std::int64_t>(sum);
  return std::bit_cast<double>(bits - (above ? (bits >> 63) | 1 : 0));
}

/// Smallest double that is >= the exact a + b, for finite sums.
[[nodiscard]] inline double add_up(double a, double b) noexcept {
  return -add_down(-a, -b);
}

/// Component-wise `round_down`.
[[nodiscard]] inline Vec3f round_down(const Vec3d& v) noexcept {
  return {round_down(v.x()), round_down(v.y()), round_down(v.z())};
}

/// Component-wise `round_up`.
[[nodiscard]] inline Vec3f round_up(const Vec3d& v) noexcept {
  return {round_up(v.x()), round_up(v.y()), round_up(v.z())};
}

}  // namespace winnow
