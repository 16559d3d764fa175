#pragma once

// A scalar double with the interface of Lanes. A kernel template of doubles uses it to compute a
// single pair with the same operations, and so with the same bits, without filling registers.

#include "simd/lanes/lanes.h"

namespace winnow::WINNOW_ISA_NAME {

/// A scalar double, as the number type of Lanes.
struct ScalarLane {
  double value;

  ScalarLane() = default;
  // NOLINTNEXTLINE(google-explicit-constructor)
  [[gnu::always_inline]] constexpr ScalarLane(double v) : value(v) {}
  [[gnu::always_inline]] constexpr operator double() const { return value; }
};

template <>
inline constexpr int kPartsOf<ScalarLane> = 1;

/// The type of a lane in memory.
template <typename T>
struct RealOf {
  using Type = T;
};
template <>
struct RealOf<ScalarLane> {
  using Type = double;
};

/// Hides from the compiler how a number was computed. g++ 12 compiles wrongly when it puts such
/// numbers side by side in registers: it fuses a sum of products beside a difference of products
/// although contraction is off, and selects by the masks of other numbers.
[[gnu::always_inline]] inline double opaque(double v) {
#if defined(WINNOW_ISA_IS_neon64)
  asm("" : "+w"(v));
#else
  asm("" : "+x"(v));
#endif
  return v;
}

template <>
struct LaneMask<ScalarLane, 1> {
  bool part[1];

  [[gnu::always_inline]] friend LaneMask operator&(const LaneMask& a, const LaneMask& b) {
    return {{a.part[0] && b.part[0]}};
  }
  [[gnu::always_inline]] friend LaneMask operator|(const LaneMask& a, const LaneMask& b) {
    return {{a.part[0] || b.part[0]}};
  }
  [[gnu::always_inline]] friend LaneMask operator!(const LaneMask& a) { return {{!a.part[0]}}; }
};

template <>
struct Lanes<ScalarLane, 1> {
  using Mask = LaneMask<ScalarLane, 1>;
  static constexpr int kCount = 1;

  double part[1];

  Lanes() = default;
  [[gnu::always_inline]] Lanes(double v) : part{v} {}  // NOLINT(google-explicit-constructor)
  [[gnu::always_inline]] Lanes(ScalarLane v)
      : part{v.value} {}  // NOLINT(google-explicit-constructor)

  [[gnu::always_inline]] static Lanes load(const ScalarLane* p) { return Lanes(*p); }
  [[gnu::always_inline]] static Lanes load_unaligned(const ScalarLane* p) { return Lanes(*p); }
  [[gnu::always_inline]] void store(ScalarLane* p) const { p->value = part[0]; }
  [[gnu::always_inline]] void store_unaligned(ScalarLane* p) const { p->value = part[0]; }

#define WINNOW_SCALAR_OPERATOR(op)                                                  \
  [[gnu::always_inline]] friend Lanes operator op(const Lanes& a, const Lanes& b) { \
    return Lanes(opaque(a.part[0] op b.part[0]));                                   \
  }                                                                                 \
  [[gnu::always_inline]] Lanes& operator op##=(const Lanes& b) {                    \
    return *this = *this op b;                                                      \
  }
  WINNOW_SCALAR_OPERATOR(+)
  WINNOW_SCALAR_OPERATOR(-)
  WINNOW_SCALAR_OPERATOR(*)
  WINNOW_SCALAR_OPERATOR(/)
#undef WINNOW_SCALAR_OPERATOR
  [[gnu::always_inline]] friend Lanes operator-(const Lanes& a) {
    return Lanes(opaque(-0.0 - a.part[0]));
  }

#define WINNOW_SCALAR_COMPARE(op)                                                  \
  [[gnu::always_inline]] friend Mask operator op(const Lanes& a, const Lanes& b) { \
    return {{a.part[0] op b.part[0]}};                                             \
  }
  WINNOW_SCALAR_COMPARE(<)
  WINNOW_SCALAR_COMPARE(<=)
  WINNOW_SCALAR_COMPARE(>)
  WINNOW_SCALAR_COMPARE(>=)
  WINNOW_SCALAR_COMPARE(==)
#undef WINNOW_SCALAR_COMPARE

  [[gnu::always_inline]] friend Lanes select(const Mask& mask, const Lanes& a, const Lanes& b) {
    return Lanes(opaque(mask.part[0] ? a.part[0] : b.part[0]));
  }
  [[gnu::always_inline]] friend Lanes min(const Lanes& a, const Lanes& b) {
    return Lanes(opaque(a.part[0] < b.part[0] ? a.part[0] : b.part[0]));
  }
  [[gnu::always_inline]] friend Lanes max(const Lanes& a, const Lanes& b) {
    return Lanes(opaque(a.part[0] > b.part[0] ? a.part[0] : b.part[0]));
  }
  [[gnu::always_inline]] friend Lanes abs(const Lanes& a) {
    return Lanes(opaque(__builtin_fabs(a.part[0])));
  }
  [[gnu::always_inline]] friend Lanes sqrt(const Lanes& a) {
    return Lanes(opaque(__builtin_sqrt(a.part[0])));
  }
};

/// Branchless, because the sign is unpredictable. Returns 1 for -0.
[[gnu::always_inline]] inline Lanes<ScalarLane> sign_or_one(const Lanes<ScalarLane>& a) {
  return Lanes<ScalarLane>(opaque(__builtin_copysign(1.0, opaque(a.part[0] + 0.0))));
}

[[gnu::always_inline]] inline Mask16 bits(const LaneMask<ScalarLane, 1>& mask) {
  return mask.part[0] ? 1U : 0U;
}

}  // namespace winnow::WINNOW_ISA_NAME
