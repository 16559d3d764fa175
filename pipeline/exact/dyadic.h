#pragma once

#include <cstdint>

namespace winnow {

/// A number m * 2^e with integers m and e: what sums, differences and products of doubles are,
/// without rounding, overflow or underflow. Digits of 64 bits, whose exponents are multiples of 64,
/// so that sums need no shifts; zeros at both ends are dropped, so that small integers take one.
///
/// (Sums of doubles, as by Shewchuk 1997, would do for well scaled input; but a quaternion of a
/// half turn from a library has components of 6e-17, and products of a dozen of them leave the
/// range of double.)
///
/// Room for kDyadicDigits; who computes makes sure by `lowest_bit` and `highest_bit` of the input
/// that no result needs more (an operation that would leaves zero, never memory out of bounds).
inline constexpr int kDyadicDigits = 96;

class Dyadic {
 public:
  Dyadic() noexcept {}  // NOLINT: digits beyond size_ are never read
  /// Of a finite double.
  Dyadic(double value) noexcept;  // NOLINT(google-explicit-constructor)
  Dyadic(const Dyadic& other) noexcept { *this = other; }
  Dyadic& operator=(const Dyadic& other) noexcept;
  [[nodiscard]] static Dyadic power_of_two(int exponent) noexcept;

  friend Dyadic operator+(const Dyadic& a, const Dyadic& b) noexcept { return sum(a, b, false); }
  friend Dyadic operator-(const Dyadic& a, const Dyadic& b) noexcept { return sum(a, b, true); }
  friend Dyadic operator*(const Dyadic& a, const Dyadic& b) noexcept;
  friend Dyadic operator-(const Dyadic& a) noexcept;

  /// -1, 0 or 1.
  [[nodiscard]] int sign() const noexcept { return size_ == 0 ? 0 : negative_ ? -1 : 1; }
  /// Sign of a - b.
  friend int compare(const Dyadic& a, const Dyadic& b) noexcept;

  /// Exponents of the lowest and the highest bit that is set; not for zero.
  [[nodiscard]] int lowest_bit() const noexcept;
  [[nodiscard]] int highest_bit() const noexcept;

  /// The number times 2^exponent as a double, to 2^-51 of itself as long as that is in range.
  [[nodiscard]] double scaled(int exponent) const noexcept;

  /// A number whose square is at least a number >= 0 and at most 2^-50 of it larger; the root
  /// itself if that has 50 bits.
  friend Dyadic root_above(const Dyadic& square) noexcept;

 private:
  /// Sign of |a| - |b|.
  static int compare_magnitudes(const Dyadic& a, const Dyadic& b) noexcept;
  static Dyadic sum(const Dyadic& a, const Dyadic& b, bool subtract) noexcept;
  static void add_magnitudes(const Dyadic& a, const Dyadic& b, Dyadic& result) noexcept;
  /// |a| > |b|.
  static void subtract_magnitudes(const Dyadic& a, const Dyadic& b, Dyadic& result) noexcept;
  [[nodiscard]] int top() const noexcept { return exponent_ + size_; }
  [[nodiscard]] std::uint64_t digit_at(int place) const noexcept {
    const int i = place - exponent_;
    return i >= 0 && i < size_ ? digit_[i] : 0;
  }
  void trim() noexcept;

  std::int32_t exponent_ = 0;  // digit_[i] counts 2^(64 * (exponent_ + i))
  std::int32_t size_ = 0;
  bool negative_ = false;
  std::uint64_t digit_[kDyadicDigits];
};

}  // namespace winnow
