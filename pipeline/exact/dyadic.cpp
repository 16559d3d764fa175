// Dyadic: conversion, comparison, and the arithmetic of long numbers. Arithmetic of short numbers
// is inline in the header.

#include "pipeline/exact/dyadic.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

namespace winnow {
namespace {

__extension__ using Unsigned = unsigned __int128;

constexpr int kBits = 64;

/// Index of the digit that contains 2^exponent: exponent / 64, rounded down for negative exponents,
/// too.
[[nodiscard]] int place_of(int exponent) noexcept {
  return exponent >= 0 ? exponent / kBits : -((kBits - 1 - exponent) / kBits);
}

/// value * 2^exponent.
[[nodiscard]] double times_power(double value, int exponent) noexcept {
  constexpr int kBias = 1023;
  constexpr int kNear = 800;
  if (std::abs(exponent) > kNear) return std::ldexp(value, exponent);
  return value * std::bit_cast<double>(static_cast<std::uint64_t>(kBias + exponent) << 52U);
}

}  // namespace

Dyadic::Dyadic(double value) noexcept {
  const DoubleParts parts(value);
  if (parts.magnitude == 0) return;
  const int zeros = std::countr_zero(parts.magnitude);
  const auto odd = static_cast<std::int64_t>(parts.magnitude >> zeros);
  mantissa_ = value < 0.0 ? -odd : odd;
  exponent_ = parts.exponent + zeros;
}

Dyadic& Dyadic::operator=(const Dyadic& other) noexcept {
  if (this == &other) return *this;
  mantissa_ = other.mantissa_;
  exponent_ = other.exponent_;
  size_ = other.size_;
  negative_ = other.negative_;
  if (size_ != 0) std::copy_n(other.digit_, static_cast<std::size_t>(size_), digit_);
  return *this;
}

const Dyadic& Dyadic::with_digits(Dyadic& room) const noexcept {
  if (size_ != 0) return *this;
  const auto magnitude = static_cast<Unsigned>(mantissa_ < 0 ? -mantissa_ : mantissa_);
  room.negative_ = mantissa_ < 0;
  room.exponent_ = place_of(exponent_);
  const int shift = exponent_ - room.exponent_ * kBits;
  const Unsigned low = magnitude << shift;
  room.size_ = 3;
  room.digit_[0] = static_cast<std::uint64_t>(low);
  room.digit_[1] = static_cast<std::uint64_t>(low >> kBits);
  // The bits that the shift moves out of 128 bits.
  room.digit_[2] = shift == 0 ? 0 : static_cast<std::uint64_t>(magnitude >> (2 * kBits - shift));
  room.trim();
  return room;
}

void Dyadic::trim() noexcept {
  while (digit_[size_ - 1] == 0) --size_;
  int zeros = 0;
  while (digit_[zeros] == 0) ++zeros;
  if (zeros == 0) return;
  size_ -= zeros;
  exponent_ += zeros;
  for (int i = 0; i < size_; ++i) digit_[i] = digit_[i + zeros];
}

int Dyadic::compare_magnitudes(const Dyadic& a, const Dyadic& b) noexcept {
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
  if (sign_a == 0) return 0;
  if (a.is_short() && b.is_short()) {
    Dyadic::Wide x = a.mantissa_;
    Dyadic::Wide y = b.mantissa_;
    if (Dyadic::align(x, y, a.exponent_ - b.exponent_)) return (x > y ? 1 : 0) - (x < y ? 1 : 0);
  }
  Dyadic room_a;
  Dyadic room_b;
  return sign_a * Dyadic::compare_magnitudes(a.with_digits(room_a), b.with_digits(room_b));
}

void Dyadic::add_magnitudes(const Dyadic& a, const Dyadic& b, Dyadic& result) noexcept {
  const int low = std::min(a.exponent_, b.exponent_);
  const int high = std::max(a.top(), b.top());
  if (high - low + 1 > kDyadicDigits) return;
  std::uint64_t carry = 0;
  for (int place = low; place < high; ++place) {
    const Unsigned digit = static_cast<Unsigned>(a.digit_at(place)) + b.digit_at(place) + carry;
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
    const Unsigned digit = static_cast<Unsigned>(a.digit_at(place)) - b.digit_at(place) - borrow;
    result.digit_[place - low] = static_cast<std::uint64_t>(digit);
    borrow = static_cast<std::uint64_t>(digit >> kBits) & 1U;
  }
  result.exponent_ = low;
  result.size_ = high - low;
  result.trim();
}

Dyadic Dyadic::long_sum(const Dyadic& given_a, const Dyadic& given_b, bool subtract) noexcept {
  Dyadic result;
  if (given_b.sign() == 0) return given_a;
  if (given_a.sign() == 0) return subtract ? -given_b : given_b;
  Dyadic room_a;
  Dyadic room_b;
  const Dyadic& a = given_a.with_digits(room_a);
  const Dyadic& b = given_b.with_digits(room_b);
  const bool negative_b = b.negative_ != subtract;
  if (a.negative_ == negative_b) {
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

Dyadic Dyadic::long_product(const Dyadic& given_a, const Dyadic& given_b) noexcept {
  Dyadic result;
  if (given_a.sign() == 0 || given_b.sign() == 0) return result;
  Dyadic room_a;
  Dyadic room_b;
  const Dyadic& a = given_a.with_digits(room_a);
  const Dyadic& b = given_b.with_digits(room_b);
  const int size = a.size_ + b.size_;
  if (size > kDyadicDigits) return result;
  result.negative_ = a.negative_ != b.negative_;
  result.exponent_ = a.exponent_ + b.exponent_;
  result.size_ = size;
  std::fill_n(result.digit_, static_cast<std::size_t>(b.size_), 0U);
  for (int i = 0; i < a.size_; ++i) {
    std::uint64_t carry = 0;
    for (int k = 0; k < b.size_; ++k) {
      const Unsigned digit =
          static_cast<Unsigned>(a.digit_[i]) * b.digit_[k] + result.digit_[i + k] + carry;
      result.digit_[i + k] = static_cast<std::uint64_t>(digit);
      carry = static_cast<std::uint64_t>(digit >> kBits);
    }
    result.digit_[i + b.size_] = carry;
  }
  result.trim();
  return result;
}

int Dyadic::lowest_bit() const noexcept {
  return is_short() ? exponent_ : kBits * exponent_ + std::countr_zero(digit_[0]);
}

int Dyadic::highest_bit() const noexcept {
  if (!is_short()) return kBits * top() - 1 - std::countl_zero(digit_[size_ - 1]);
  const auto magnitude = static_cast<Unsigned>(mantissa_ < 0 ? -mantissa_ : mantissa_);
  const auto low = static_cast<std::uint64_t>(magnitude);
  const auto high = static_cast<std::uint64_t>(magnitude >> kBits);
  return exponent_ +
         (high != 0 ? 2 * kBits - 1 - std::countl_zero(high) : kBits - 1 - std::countl_zero(low));
}

double Dyadic::scaled(int exponent) const noexcept {
  if (is_word()) {
    return times_power(static_cast<double>(static_cast<std::int64_t>(mantissa_)),
                       exponent_ + exponent);
  }
  if (is_short()) return times_power(static_cast<double>(mantissa_), exponent_ + exponent);
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
