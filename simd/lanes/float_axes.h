#pragma once

// One three-dimensional vector in four floats of a 128-bit register, on any instruction set. It is
// for single vectors, for which a wider register would only add latency.

#include <cstdint>

namespace winnow::WINNOW_ISA_NAME {

/// Lanes 0 to 2 are x, y and z; operators work lane by lane.
using FloatAxes = float __attribute__((vector_size(16)));
using FloatAxesBits = std::int32_t __attribute__((vector_size(16)));

[[gnu::always_inline]] inline FloatAxes float_axes(double x, double y, double z) {
  return FloatAxes{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z), 0.0F};
}
[[gnu::always_inline]] inline FloatAxes spread_axes(float value) {
  return FloatAxes{value, value, value, value};
}
/// Reads or writes four floats.
[[gnu::always_inline]] inline FloatAxes load_axes(const float* p) {
  FloatAxes v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}
[[gnu::always_inline]] inline void store_axes(FloatAxes v, float* p) {
  __builtin_memcpy(p, &v, sizeof v);
}
[[gnu::always_inline]] inline FloatAxesBits bits_of(FloatAxes v) {
  return reinterpret_cast<FloatAxesBits>(v);
}
[[gnu::always_inline]] inline FloatAxes from_bits(FloatAxesBits v) {
  return reinterpret_cast<FloatAxes>(v);
}
[[gnu::always_inline]] inline FloatAxes absolute(FloatAxes v) {
  return from_bits(bits_of(v) & ~bits_of(spread_axes(-0.0F)));
}
/// Returns `size` with the signs of `of`; the signs of `size` must be clear.
[[gnu::always_inline]] inline FloatAxes signed_as(FloatAxes size, FloatAxes of) {
  return from_bits(bits_of(size) | (bits_of(of) & bits_of(spread_axes(-0.0F))));
}
/// Lane-wise minimum; b if either is NaN.
[[gnu::always_inline]] inline FloatAxes lesser_axes(FloatAxes a, FloatAxes b) {
  const FloatAxesBits mask = a < b;
  return from_bits((mask & bits_of(a)) | (~mask & bits_of(b)));
}
/// Returns true if x, y and z are at most the limit.
[[gnu::always_inline]] inline bool are_all_below(FloatAxes v, float limit) {
  return v[0] <= limit && v[1] <= limit && v[2] <= limit;
}

}  // namespace winnow::WINNOW_ISA_NAME
