#pragma once

// Names of the parts of a box.

#include "pipeline/kernels/round/segments.wide.h"

namespace winnow::WINNOW_ISA_NAME {

/// -1, 0, 1 for numbers below, at and above zero.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> sign(const Lanes<T>& v) {
  const Lanes<T> zero(T(0));
  return select(v > zero, Lanes<T>(T(1)), select(v < zero, Lanes<T>(T(-1)), zero));
}

/// What the closest point of a box is called, by the signs of the direction towards the box: the
/// digits of a number to the base of three.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> box_feature(const Vec3<T>& towards) {
  const Lanes<T> three(T(3));
  return Lanes<T>(T(13)) - (sign(towards.x) + three * (sign(towards.y) + three * sign(towards.z)));
}

}  // namespace winnow::WINNOW_ISA_NAME
