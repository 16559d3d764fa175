#pragma once

#include <winnow/core/export.h>
#include <winnow/core/vec3.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace winnow {

// What rounds outward here does so in any direction of rounding that a host has set, and where it
// flushes denormal numbers.

/// The number itself: a conversion would make 0 of a denormal one where the host flushes these.
[[nodiscard]] constexpr double to_double(float value) noexcept {
  constexpr std::uint32_t kSign = 0x80000000U;
  constexpr std::uint32_t kExponent = 0x7F800000U;
  const auto bits = std::bit_cast<std::uint32_t>(value);
  if ((bits & kExponent) != 0) [[likely]]
    return static_cast<double>(value);
  const double size = static_cast<double>(static_cast<std::int32_t>(bits & ~kSign)) * 0x1p-149;
  return (bits & kSign) != 0 ? -size : size;
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

namespace detail {

/// `round_up` where nothing is flushed.
[[nodiscard]] constexpr float round_up_unflushed(double value) noexcept {
  const float nearest = static_cast<float>(value);
  // Of a mask: which of the two it is cannot be foreseen, and a branch would cost more.
  const std::uint32_t up = static_cast<double>(nearest) < value ? ~0U : 0U;
  const auto bits = std::bit_cast<std::uint32_t>(nearest);
  const auto above = std::bit_cast<std::uint32_t>(next_up(nearest));
  return std::bit_cast<float>(bits ^ ((bits ^ above) & up));
}

/// `add_down` where nothing is flushed. The rounding error of the sum is found exactly (Knuth,
/// TAOCP vol. 2, 4.2.2, theorem B); in other directions of rounding its sign is right.
[[nodiscard]] inline double add_down_unflushed(double a, double b) noexcept {
  const double sum = a + b;
  const double shadow = sum - a;
  const double error = (a - (sum - shadow)) + (b - shadow);
  // One less in its bits, or one more of a negative sum; without a branch, as above. A sum of 0 has
  // no error.
  const std::int64_t below = error < 0.0 ? 1 : 0;
  const auto bits = std::bit_cast<std::int64_t>(sum);
  return std::bit_cast<double>(bits - below * (2 * (bits >> 63) + 1));
}

/// The same with flushing switched off meanwhile.
[[nodiscard]] WINNOW_API float round_up_tiny(double value) noexcept;
[[nodiscard]] WINNOW_API double add_down_tiny(double a, double b) noexcept;

/// True if `value` is not 0, but less than 2^(exponent - 1023).
[[nodiscard]] constexpr bool is_tiny(double value, std::uint64_t exponent) noexcept {
  const std::uint64_t size = std::bit_cast<std::uint64_t>(value) & ~(std::uint64_t{1} << 63U);
  return size - 1 < (exponent << 52U) - 1;
}

}  // namespace detail

/// Smallest float that is >= `value`. NaN stays NaN; above the float range gives +infinity.
[[nodiscard]] constexpr float round_up(double value) noexcept {
  constexpr std::uint64_t kLeastNormalFloat = 1023 - 126;
  if (detail::is_tiny(value, kLeastNormalFloat)) [[unlikely]] {
    if (!std::is_constant_evaluated()) return detail::round_up_tiny(value);
  }
  return detail::round_up_unflushed(value);
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

/// Largest double that is <= the exact a + b, for finite sums.
[[nodiscard]] inline double add_down(double a, double b) noexcept {
  // A sum is flushed only if both are so small that it has no rounding error of its own.
  constexpr std::uint64_t kFarAboveDenormal = 64;
  if (detail::is_tiny(a, kFarAboveDenormal) || detail::is_tiny(b, kFarAboveDenormal)) [[unlikely]] {
    return detail::add_down_tiny(a, b);
  }
  return detail::add_down_unflushed(a, b);
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
