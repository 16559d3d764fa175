#include "pipeline/motion/feature_test.kernel.h"
#include "simd/lanes/vectors.h"

namespace winnow {
namespace WINNOW_ISA_NAME {
namespace {

using FeatureVector = Vec3<double>;

/// The features of eight pairs at one end of their motion.
template <int Corners>
struct FeatureState {
  FeatureVector corner[Corners];
  FeatureVector edge[2];
};

/// Computes the differences in the order of the scalar code.
template <int Corners>
[[gnu::always_inline]] inline FeatureState<Corners> load_state(const double* const* columns,
                                                               std::size_t first) {
  FeatureVector p[4];
  for (int k = 0; k < 4; ++k) {
    p[k] = {Doubles::load_unaligned(columns[3 * k] + first),
            Doubles::load_unaligned(columns[3 * k + 1] + first),
            Doubles::load_unaligned(columns[3 * k + 2] + first)};
  }
  FeatureState<Corners> s;
  if constexpr (Corners == 3) {
    for (int k = 0; k < 3; ++k) s.corner[k] = p[0] - p[k + 1];
    s.edge[0] = p[2] - p[1];
    s.edge[1] = p[3] - p[1];
  } else {
    s.corner[0] = p[0] - p[2];
    s.corner[1] = p[1] - p[2];
    s.corner[2] = p[1] - p[3];
    s.corner[3] = p[0] - p[3];
    s.edge[0] = p[1] - p[0];
    s.edge[1] = p[3] - p[2];
  }
  return s;
}

[[gnu::always_inline]] inline FeatureVector larger(const FeatureVector& a, const FeatureVector& b) {
  return {max(abs(a.x), abs(b.x)), max(abs(a.y), abs(b.y)), max(abs(a.z), abs(b.z))};
}
[[gnu::always_inline]] inline Doubles largest(const FeatureVector& v) {
  return max(max(abs(v.x), abs(v.y)), abs(v.z));
}

/// Returns the lanes in which all corners, at the start and at the end, are farther than `least` on
/// one side of the origin along an axis.
template <int Corners, typename Coordinate>
[[gnu::always_inline]] inline LaneMask<double> apart_on(const FeatureState<Corners>& start,
                                                        const FeatureState<Corners>& end,
                                                        const Doubles& least,
                                                        Coordinate&& coordinate) {
  Doubles low = coordinate(start.corner[0]);
  Doubles high = low;
  for (int k = 0; k < Corners; ++k) {
    const Doubles a = coordinate(start.corner[k]);
    const Doubles b = coordinate(end.corner[k]);
    low = min(low, min(a, b));
    high = max(high, max(a, b));
  }
  return (low > least) | (-high > least);
}

/// Returns the lanes in which all Bernstein coefficients of the volume are beyond the band on one
/// side.
template <int Corners>
[[gnu::always_inline]] inline LaneMask<double> never_flat(const FeatureState<Corners>& start,
                                                          const FeatureState<Corners>& end,
                                                          double separation) {
  const FeatureVector first = cross(start.edge[0], start.edge[1]);
  const FeatureVector last = cross(end.edge[0], end.edge[1]);
  const FeatureVector mixed = cross(start.edge[0], end.edge[1]) + cross(end.edge[0], start.edge[1]);
  const FeatureVector& a = start.corner[0];
  const FeatureVector& b = end.corner[0];
  const Doubles volume[4] = {dot(a, first), (dot(b, first) + dot(a, mixed)) / Doubles(3.0),
                             (dot(a, last) + dot(b, mixed)) / Doubles(3.0), dot(b, last)};
  const FeatureVector m = larger(a, b);
  const FeatureVector e = larger(start.edge[0], end.edge[0]);
  const FeatureVector f = larger(start.edge[1], end.edge[1]);
  const Doubles most =
      m.x * (e.y * f.z + e.z * f.y) + m.y * (e.z * f.x + e.x * f.z) + m.z * (e.x * f.y + e.y * f.x);
  Doubles band = Doubles(kVolumeError) * most + Doubles(kLostByUnderflow);
  if (separation > 0.0) {
    const Doubles longest =
        max(max(sqrt(dot(first, first)), Doubles(0.5) * sqrt(dot(mixed, mixed))),
            sqrt(dot(last, last)));
    const Doubles sizes = Doubles(1e-150) + longest;
    band = (band + Doubles(separation) * sizes) * Doubles(1.0 + 0x1p-40);
  }
  LaneMask<double> above = volume[0] > band;
  LaneMask<double> below = -volume[0] > band;
  for (int k = 1; k < 4; ++k) {
    above = above & (volume[k] > band);
    below = below & (-volume[k] > band);
  }
  return above | below;
}

template <int Corners>
std::uint32_t may_touch(const double* const* columns, std::size_t first, double separation) {
  const FeatureState<Corners> start = load_state<Corners>(columns, first);
  const FeatureState<Corners> end = load_state<Corners>(columns + 12, first);
  Doubles size = Doubles(0.0);
  LaneMask<double> numbers = size == size;
  const auto measure = [&](const FeatureVector& v) {
    size = max(size, largest(v));
    // max ignores NaN, so test for it here.
    numbers = numbers & (norm_l1(v) <= Doubles(kLargest<double>));
  };
  for (int k = 0; k < Corners; ++k) {
    measure(start.corner[k]);
    measure(end.corner[k]);
  }
  for (int k = 0; k < 2; ++k) {
    measure(start.edge[k]);
    measure(end.edge[k]);
  }
  numbers = numbers & (size <= Doubles(kMaxScaled)) & (size >= Doubles(kMinScaled));
  const Doubles least = Doubles(separation * (1.0 + 0x1p-50));
  const LaneMask<double> apart =
      apart_on(start, end, least, [](const FeatureVector& v) { return v.x; }) |
      apart_on(start, end, least, [](const FeatureVector& v) { return v.y; }) |
      apart_on(start, end, least, [](const FeatureVector& v) { return v.z; }) |
      never_flat(start, end, separation);
  return ~bits(apart & numbers) & kAllLanes<double>;
}

}  // namespace
}  // namespace WINNOW_ISA_NAME

extern const FeatureTestKernels WINNOW_KERNEL_TABLE(feature_test_kernels) = {
    WINNOW_ISA_NAME::may_touch<3>, WINNOW_ISA_NAME::may_touch<4>};

}  // namespace winnow
