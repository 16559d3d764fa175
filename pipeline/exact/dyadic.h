#pragma once

// Arbitrary-precision binary numbers for exact predicates. exact_vector.h builds vectors and
// rotations from them; exact_gjk.cpp, exact_overlap.cpp and exact_hull.cpp compute with these.

#include <bit>
#include <cstdint>

namespace winnow {

/// Number of 64-bit digits in a Dyadic. Callers must ensure by BitSpan and fits_dyadic
/// (exact_vector.h) that no result needs more: an operation whose result would not fit returns
/// zero, without a report, and never writes out of bounds.
inline constexpr int kDyadicDigits = 96;

/// The magnitude of a finite double, as magnitude * 2^exponent.
struct DoubleParts {
  explicit DoubleParts(double value) noexcept {
    constexpr int kFraction = 52;
    constexpr std::uint64_t kImplicit = std::uint64_t{1} << kFraction;
    const auto bits = std::bit_cast<std::uint64_t>(value);
    const int field = static_cast<int>(bits >> kFraction & 0x7FFU);
    magnitude = (bits & (kImplicit - 1)) | (field != 0 ? kImplicit : 0);
    exponent = (field != 0 ? field : 1) - 1075;
  }
  std::uint64_t magnitude;
  int exponent;
};

/// A number m * 2^e with integers m and e: exact sums, differences and products of doubles, without
/// rounding, overflow or underflow.
///
/// Short numbers, with a mantissa of at most 125 bits, store m and e. Coordinates that are small
/// integers times a power of two, and products of two factors, stay short. Long numbers have digits
/// of 64 bits with exponents that are multiples of 64, so that sums need no shifts; zero digits at
/// both ends are dropped.
///
/// (Expansions, as in Shewchuk 1997, would suffice for well scaled input. But a quaternion of a
/// half turn from a library has components of 6e-17, and products of a dozen of them leave the
/// range of double.)
class Dyadic {
 public:
  Dyadic() noexcept {}  // NOLINT: digits beyond size_ are never read
  /// From a finite double.
  Dyadic(double value) noexcept;  // NOLINT(google-explicit-constructor)
  Dyadic(const Dyadic& other) noexcept { *this = other; }
  Dyadic& operator=(const Dyadic& other) noexcept;
  [[nodiscard]] static Dyadic power_of_two(int exponent) noexcept { return {1, exponent}; }

  friend Dyadic operator+(const Dyadic& a, const Dyadic& b) noexcept { return sum(a, b, false); }
  friend Dyadic operator-(const Dyadic& a, const Dyadic& b) noexcept { return sum(a, b, true); }
  friend Dyadic operator*(const Dyadic& a, const Dyadic& b) noexcept {
    if (!a.is_word() || !b.is_word()) return long_product(a, b);
    return {a.mantissa_ * static_cast<std::int64_t>(b.mantissa_), a.exponent_ + b.exponent_};
  }
  friend Dyadic operator-(const Dyadic& a) noexcept {
    Dyadic result(a);
    result.negate();
    return result;
  }

  /// -1, 0 or 1.
  [[nodiscard]] int sign() const noexcept {
    if (size_ != 0) return negative_ ? -1 : 1;
    return (mantissa_ > 0 ? 1 : 0) - (mantissa_ < 0 ? 1 : 0);
  }
  /// Sign of a - b.
  friend int compare(const Dyadic& a, const Dyadic& b) noexcept;

  /// Exponents of the lowest and the highest bit that is set; not defined for zero.
  [[nodiscard]] int lowest_bit() const noexcept;
  [[nodiscard]] int highest_bit() const noexcept;

  /// Returns the number times 2^exponent as a double. The relative error is at most 2^-51 if the
  /// result is in range.
  [[nodiscard]] double scaled(int exponent) const noexcept;

  /// Upper bound on the square root of a number >= 0: its square exceeds the number by a factor of
  /// at most 1 + 2^-50. Exact if the root has at most 50 bits.
  friend Dyadic root_above(const Dyadic& square) noexcept;

 private:
  __extension__ using Wide = __int128;

  /// Makes a short number.
  Dyadic(Wide mantissa, int exponent) noexcept : mantissa_(mantissa), exponent_(exponent) {}

  [[nodiscard]] bool is_short() const noexcept { return size_ == 0; }
  /// True for short numbers whose mantissa fits 63 bits, so that products of two of them are short.
  [[nodiscard]] bool is_word() const noexcept {
    constexpr int kMaxBits = 62;
    return is_short() && mantissa_ >> kMaxBits == mantissa_ >> 127U;
  }
  /// True if `mantissa` fits a short number.
  [[nodiscard]] static bool fits(Wide mantissa) noexcept {
    constexpr int kMaxBits = 125;
    return mantissa >> kMaxBits == mantissa >> 127U;
  }
  /// Brings two short numbers to a common exponent; returns false if one then no longer fits.
  [[nodiscard]] static bool align(Wide& a, Wide& b, int shift) noexcept {
    constexpr int kMaxShift = 125;
    Wide& larger = shift >= 0 ? a : b;
    const int up = shift >= 0 ? shift : -shift;
    if (up == 0) return true;
    if (up >= kMaxShift) return false;
    const Wide shifted = larger << up;
    if (!fits(shifted) || shifted >> up != larger) return false;
    larger = shifted;
    return true;
  }
  [[nodiscard]] static Dyadic sum(const Dyadic& a, const Dyadic& b, bool subtract) noexcept {
    if (!a.is_short() || !b.is_short()) return long_sum(a, b, subtract);
    if (b.mantissa_ == 0) return a;
    const Wide added = subtract ? -b.mantissa_ : b.mantissa_;
    if (a.mantissa_ == 0) return {added, b.exponent_};
    Wide x = a.mantissa_;
    Wide y = added;
    if (!align(x, y, a.exponent_ - b.exponent_) || !fits(x + y)) return long_sum(a, b, subtract);
    return without_zeros(x + y, a.exponent_ < b.exponent_ ? a.exponent_ : b.exponent_);
  }
  /// Makes the short number with an odd (or zero) mantissa.
  [[nodiscard]] static Dyadic without_zeros(Wide mantissa, int exponent) noexcept {
    while ((mantissa & 1) == 0 && mantissa != 0) {
      const auto low = static_cast<std::uint64_t>(mantissa);
      const int zeros = low != 0 ? std::countr_zero(low) : 64;
      mantissa >>= zeros;
      exponent += zeros;
    }
    return {mantissa, exponent};
  }

  void negate() noexcept {
    mantissa_ = -mantissa_;
    negative_ = !negative_;
  }

  [[nodiscard]] static Dyadic long_product(const Dyadic& a, const Dyadic& b) noexcept;
  [[nodiscard]] static Dyadic long_sum(const Dyadic& a, const Dyadic& b, bool subtract) noexcept;
  /// Returns this number if it has digits, else its conversion to digits in `room`. Not for zero.
  [[nodiscard]] const Dyadic& with_digits(Dyadic& room) const noexcept;
  /// Sign of |a| - |b|, for numbers with digits.
  static int compare_magnitudes(const Dyadic& a, const Dyadic& b) noexcept;
  static void add_magnitudes(const Dyadic& a, const Dyadic& b, Dyadic& result) noexcept;
  /// Requires |a| > |b|.
  static void subtract_magnitudes(const Dyadic& a, const Dyadic& b, Dyadic& result) noexcept;
  [[nodiscard]] int top() const noexcept { return exponent_ + size_; }
  [[nodiscard]] std::uint64_t digit_at(int place) const noexcept {
    const int i = place - exponent_;
    return i >= 0 && i < size_ ? digit_[i] : 0;
  }
  /// Drops zero digits at both ends; requires a nonzero digit.
  void trim() noexcept;

  Wide mantissa_ = 0;          // short numbers: mantissa_ * 2^exponent_, odd or zero
  std::int32_t exponent_ = 0;  // long numbers: digit_[i] has weight 2^(64 * (exponent_ + i))
  std::int32_t size_ = 0;      // number of digits; 0 for short numbers, including zero
  bool negative_ = false;      // sign of long numbers
  std::uint64_t digit_[kDyadicDigits];
};

}  // namespace winnow
