#include "pipeline/exact/dyadic.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace winnow {
namespace {

__extension__ using Wide = unsigned __int128;

constexpr int kBits = 64;

/// The digit that counts 2^exponent: rounded down, also below zero.
[[nodiscard]] int place_of(int exponent) noexcept {
  return exponent >= 0 ? exponent / kBits : -((kBits - 1 - exponent) / kBits);
}

}  // namespace

Dyadic::Dyadic(double value) noexcept {
  constexpr int kFraction = 52;
  constexpr std::uint64_t kImplicit = std::uint64_t{1} << kFraction;
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const int field = static_cast<int>(bits >> kFraction & 0x7FFU);
  std::uint64_t mantissa = bits & (kImplicit - 1);
  if (field != 0) mantissa |= kImplicit;
  if (mantissa == 0) return;
  const int exponent = std::max(field, 1) - 1075;
  exponent_ = place_of(exponent);
  const Wide shifted = static_cast<Wide>(mantissa) << (exponent - exponent_ * kBits);
  negative_ = bits >> 63U != 0;
  size_ = 2;
  digit_[0] = static_cast<std::uint64_t>(shifted);
  digit_[1] = static_cast<std::uint64_t>(shifted >> kBits);
  trim();
}

Dyadic Dyadic::power_of_two(int exponent) noexcept {
  Dyadic result;
  result.exponent_ = place_of(exponent);
  result.size_ = 1;
  result.digit_[0] = std::uint64_t{1} << (exponent - result.exponent_ * kBits);
  return result;
}

Dyadic& Dyadic::operator=(const Dyadic& other) noexcept {
  if (this == &other) return *this;
  exponent_ = other.exponent_;
  size_ = other.size_;
  negative_ = other.negative_;
  std::copy_n(other.digit_, static_cast<std::size_t>(size_), digit_);
  return *this;
}

void Dyadic::trim() noexcept {
  while (size_ > 0 && digit_[size_ - 1] == 0) --size_;
  int zeros = 0;
  while (zeros < size_ && digit_[zeros] == 0) ++zeros;
  if (zeros == 0) return;
  size_ -= zeros;
  exponent_ += zeros;
  for (int i = 0; i < size_; ++i) digit_[i] = digit_[i + zeros];
}

int Dyadic::compare_magnitudes(const Dyadic& a, const Dyadic& b) noexcept {
  if (a.size_ == 0 || b.size_ == 0) return (a.size_ != 0) - (b.size_ != 0);
  if (a.top() != b.top()) return a.top() < b.top() ? -1 : 1;
  for (int place = a.top() - 1; place >= std::min(a.exponent_, b.exponent_); --place) {
    const std::uint64_t x = a.digit_at(place);
    const std::uint64_t y = b.digit_at(place);
    if (x != y) return x < y ? -1 : 1;
  }
  return 0;
}

int compare(const Dyadic& a, const Dyadic& b) noexcept {
  const int sign_a = a.sign();
  const int sign_b = b.sign();
  if (sign_a != sign_b) return sign_a < sign_b ? -1 : 1;
  return sign_a * Dyadic::compare_magnitudes(a, b);
}

void Dyadic::add_magnitudes(const Dyadic& a, const Dyadic& b, Dyadic& result) noexcept {
  const int low = std::min(a.exponent_, b.exponent_);
  const int high = std::max(a.top(), b.top());
  if (high - low + 1 > kDyadicDigits) return;
  std::uint64_t carry = 0;
  for (int place = low; place < high; ++place) {
    const Wide digit = static_cast<Wide>(a.digit_at(place)) + b.digit_at(place) + carry;
    result.digit_[place - low] = static_cast<std::uint64_t>(digit);
    carry = static_cast<std::uint64_t>(digit >> kBits);
  }
  result.exponent_ = low;
  result.size_ = high - low + 1;
  result.digit_[high - low] = carry;
  result.trim();
}

void Dyadic::subtract_magnitudes(const Dyadic& a, const Dyadic& b, Dyadic& result) noexcept {
  const int low = std::min(a.exponent_, b.exponent_);
  const int high = a.top();
  if (high - low > kDyadicDigits) return;
  std::uint64_t borrow = 0;
  for (int place = low; place < high; ++place) {
    const Wide digit = static_cast<Wide>(a.digit_at(place)) - b.digit_at(place) - borrow;
    result.digit_[place - low] = static_cast<std::uint64_t>(digit);
    borrow = static_cast<std::uint64_t>(digit >> kBits) & 1U;
  }
  result.exponent_ = low;
  result.size_ = high - low;
  result.trim();
}

Dyadic Dyadic::sum(const Dyadic& a, const Dyadic& b, bool subtract) noexcept {
  if (b.size_ == 0) return a;
  const bool negative_b = b.negative_ != subtract;
  Dyadic result;
  if (a.size_ == 0) {
    result = b;
    result.negative_ = negative_b;
  } else if (a.negative_ == negative_b) {
    add_magnitudes(a, b, result);
    result.negative_ = negative_b;
  } else {
    const int order = compare_magnitudes(a, b);
    if (order > 0) subtract_magnitudes(a, b, result);
    if (order < 0) subtract_magnitudes(b, a, result);
    result.negative_ = order > 0 ? a.negative_ : negative_b;
  }
  return result;
}

Dyadic operator-(const Dyadic& a) noexcept {
  Dyadic result(a);
  result.negative_ = !a.negative_;
  return result;
}

Dyadic operator*(const Dyadic& a, const Dyadic& b) noexcept {
  Dyadic result;
  const int size = a.size_ + b.size_;
  if (a.size_ == 0 || b.size_ == 0 || size > kDyadicDigits) return result;
  result.negative_ = a.negative_ != b.negative_;
  result.exponent_ = a.exponent_ + b.exponent_;
  result.size_ = size;
  if (size == 2) {
    const Wide digits = static_cast<Wide>(a.digit_[0]) * b.digit_[0];
    result.digit_[0] = static_cast<std::uint64_t>(digits);
    result.digit_[1] = static_cast<std::uint64_t>(digits >> kBits);
    result.trim();
    return result;
  }
  std::fill_n(result.digit_, static_cast<std::size_t>(b.size_), 0U);
  for (int i = 0; i < a.size_; ++i) {
    std::uint64_t carry = 0;
    for (int k = 0; k < b.size_; ++k) {
      const Wide digit =
          static_cast<Wide>(a.digit_[i]) * b.digit_[k] + result.digit_[i + k] + carry;
      result.digit_[i + k] = static_cast<std::uint64_t>(digit);
      carry = static_cast<std::uint64_t>(digit >> kBits);
    }
    result.digit_[i + b.size_] = carry;
  }
  result.trim();
  return result;
}

int Dyadic::lowest_bit() const noexcept {
  return kBits * exponent_ + std::countr_zero(digit_[0]);
}

int Dyadic::highest_bit() const noexcept {
  return kBits * top() - 1 - std::countl_zero(digit_[size_ - 1]);
}

double Dyadic::scaled(int exponent) const noexcept {
  if (size_ == 0) return 0.0;
  double value = std::ldexp(static_cast<double>(digit_[size_ - 1]), kBits);
  if (size_ > 1) value += static_cast<double>(digit_[size_ - 2]);
  value = std::ldexp(value, kBits * (top() - 2) + exponent);
  return negative_ ? -value : value;
}

Dyadic root_above(const Dyadic& square) noexcept {
  if (square.sign() <= 0) return {};
  const int half = square.highest_bit() >> 1;
  const Dyadic unit = Dyadic::power_of_two(half);
  double root = std::sqrt(square.scaled(-2 * half));
  while (compare(unit * root * (unit * root), square) < 0) root = std::nextafter(root, 4.0);
  return unit * root;
}

}  // namespace winnow
