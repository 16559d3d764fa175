#pragma once

#include "simd/lanes/lanes.h"

#include <cstddef>

namespace winnow::WINNOW_ISA_NAME {

inline constexpr float kMinExtent = 1e-30F;  // a shorter range counts as one position

/// The range of some numbers.
struct AxisExtent {
  float low;
  float high;

  /// Returns the range of `count` >= 1 numbers.
  static AxisExtent of(const float* x, std::size_t count) {
    constexpr std::size_t kStep = static_cast<std::size_t>(kLanes);
    if (count < kStep) {
      AxisExtent reach{x[0], x[0]};
      for (std::size_t i = 1; i < count; ++i) {
        reach.low = x[i] < reach.low ? x[i] : reach.low;
        reach.high = x[i] > reach.high ? x[i] : reach.high;
      }
      return reach;
    }
    Floats low = Floats::load_unaligned(x);
    Floats high = low;
    for (std::size_t i = kStep; i < count; i += kStep) {
      // The last step may read some numbers again.
      const Floats v = Floats::load_unaligned(x + (i + kStep <= count ? i : count - kStep));
      low = min(low, v);
      high = max(high, v);
    }
    return {reduce_min(low), reduce_max(high)};
  }
  // Half of the length, because the length of arbitrary floats could overflow.
  [[nodiscard]] float half() const { return 0.5F * high - 0.5F * low; }
};

}  // namespace winnow::WINNOW_ISA_NAME
