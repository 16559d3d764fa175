#pragma once

#include <winnow/core/export.h>
#include <winnow/core/vec3.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace winnow {

// A host program may round in any direction and flush denormals (FTZ, DAZ). Library code switches
// to the default environment. Inline functions of headers run in the host's environment and must
// round outward there, too.

namespace detail {

inline constexpr std::uint32_t kSign = 0x80000000U;
inline constexpr std::uint32_t kExponent = 0x7F800000U;

/// Returns the smaller number. If the host treats denormals as 0 in comparisons, two numbers may
/// compare equal to 0; then their bits are compared as integers, which have the same order.
[[nodiscard]] constexpr float lesser(float a, float b) noexcept {
  const float found = b < a ? b : a;
  if (found != 0.0F) [[likely]]
    return found;
  const auto x = std::bit_cast<std::int32_t>(a);
  const auto y = std::bit_cast<std::int32_t>(b);
  const std::int32_t both_negative = (x & y) >> 31;
  return (y ^ both_negative) < (x ^ both_negative) ? b : a;
}

/// `round_up` for values below the smallest normal float in magnitude. Works in integers, which are
/// never flushed.
[[nodiscard]] constexpr float round_up_tiny(double value) noexcept {
  constexpr std::uint64_t kOne = std::uint64_t{1} << 52U;
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const std::uint64_t exponent = bits >> 52U & 0x7FFU;
  const std::uint64_t mantissa = (bits & (kOne - 1)) | (exponent == 0 ? 0 : kOne);
  // Converts to units of 2^-149, the smallest denormal float; smaller values shift to 0.
  const std::uint64_t shift = exponent < 863 ? 63 : 1023 + 52 - 149 - exponent;
  const std::uint64_t whole = mantissa >> shift;
  const bool is_negative = bits >> 63U != 0;
  const std::uint64_t units = whole + (!is_negative && whole << shift != mantissa ? 1 : 0);
  return std::bit_cast<float>(static_cast<std::uint32_t>(units) | (is_negative ? kSign : 0));
}

}  // namespace detail

/// Returns `value` as a double, exactly. A plain conversion would flush denormals if the host does.
[[nodiscard]] constexpr double to_double(float value) noexcept {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  if ((bits & detail::kExponent) != 0) [[likely]]
    return static_cast<double>(value);
  const double size =
      static_cast<double>(static_cast<std::int32_t>(bits & ~detail::kSign)) * 0x1p-149;
  return (bits & detail::kSign) != 0 ? -size : size;
}

/// Returns the next larger float after a finite or -infinite `value`. Works on the bits instead of
/// calling std::nextafter.
[[nodiscard]] constexpr float next_up(float value) noexcept {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  // Adds 1 to the bits, or subtracts 1 if negative. After 0 of either sign comes the smallest
  // denormal.
  const std::uint32_t next = bits + 1U - 2U * (bits >> 31U);
  return std::bit_cast<float>((bits & 0x7FFFFFFFU) == 0 ? 1U : next);
}

/// Returns the smallest float that is >= `value`. NaN stays NaN; above the float range the result
/// is +infinity.
[[nodiscard]] constexpr float round_up(double value) noexcept {
  const float nearest = static_cast<float>(value);
  const auto bits = std::bit_cast<std::uint32_t>(nearest);
  if ((bits & detail::kExponent) == 0) [[unlikely]]
    return detail::round_up_tiny(value);
  // Branchless: the direction is unpredictable.
  const std::uint32_t up = static_cast<double>(nearest) < value ? ~0U : 0U;
  const std::uint32_t above = (bits & detail::kSign) != 0 ? bits - 1U : bits + 1U;
  return std::bit_cast<float>(bits ^ ((bits ^ above) & up));
}

/// Returns the largest float that is <= `value`. NaN stays NaN; below the float range the result is
/// -infinity.
[[nodiscard]] constexpr float round_down(double value) noexcept {
  return -round_up(-value);
}

/// Returns the float nearest to `value`, clamped to the finite floats. NaN stays NaN.
[[nodiscard]] constexpr float finite_float(double value) noexcept {
  constexpr auto kMaxFloat = static_cast<double>(std::numeric_limits<float>::max());
  return static_cast<float>(value < -kMaxFloat ? -kMaxFloat
                                               : (kMaxFloat < value ? kMaxFloat : value));
}

/// Returns the largest double that is <= the exact a + b, if the sum is finite. If the host flushes
/// denormals, this holds for 0 and for numbers of at least 2^-959, which includes all floats and
/// products of two floats.
[[nodiscard]] inline double add_down(double a, double b) noexcept {
  const bool swapped = std::abs(a) < std::abs(b);
  const double greater = swapped ? b : a;
  const double smaller = swapped ? a : b;
  const double sum = greater + smaller;
  // The part of `smaller` that is in the sum is sum - greater, a double in every rounding direction
  // (Boldo, Graillat and Muller, "On the robustness of the 2Sum and Fast2Sum algorithms", ACM TOMS
  // 44(1), 2017). A sum of 0 has no error.
  const bool above = smaller < sum - greater;
  // Subtracts 1 from the bits, or adds 1 if the sum is negative; branchless, as in `round_up`.
  const auto bits = std::bit_cast<std::int64_t>(sum);
  return std::bit_cast<double>(bits - (above ? (bits >> 63) | 1 : 0));
}

/// Returns the smallest double that is >= the exact a + b, under the conditions of `add_down`.
[[nodiscard]] inline double add_up(double a, double b) noexcept {
  return -add_down(-a, -b);
}

/// Applies `round_down` to each coordinate.
[[nodiscard]] inline Vec3f round_down(const Vec3d& v) noexcept {
  return {round_down(v.x()), round_down(v.y()), round_down(v.z())};
}

/// Applies `round_up` to each coordinate.
[[nodiscard]] inline Vec3f round_up(const Vec3d& v) noexcept {
  return {round_up(v.x()), round_up(v.y()), round_up(v.z())};
}

}  // namespace winnow
