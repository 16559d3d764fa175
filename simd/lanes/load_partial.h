#pragma once

#include "simd/lanes/lanes.h"

#include <cstddef>

namespace winnow::WINNOW_ISA_NAME {

/// Loads the first `left` of sixteen numbers; the other lanes are zero. Memory behind these numbers
/// is not read, because other threads may write to it.
template <typename T>
[[nodiscard]] Lanes<T> load_partial(const T* p, std::size_t left) {
  if (left >= static_cast<std::size_t>(kLanes)) return Lanes<T>::load_unaligned(p);
  alignas(64) T some[kLanes] = {};
  for (std::size_t i = 0; i < left; ++i) some[i] = p[i];
  return Lanes<T>::load(some);
}

}  // namespace winnow::WINNOW_ISA_NAME
