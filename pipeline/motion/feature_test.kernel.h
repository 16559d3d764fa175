#pragma once

#include "simd/kernels/kernels.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

/// Pairs of features that are tested at a time.
inline constexpr std::size_t kFeatureLanes = 8;

/// Between these neither cubes nor squares of numbers leave the range of double.
inline constexpr double kLeastScaled = 0x1p-200;
inline constexpr double kMostScaled = 0x1p200;
/// What products that underflow may lose.
inline constexpr double kLostByUnderflow = 1e-300;
/// Bounds the error of the coefficients of the volume that four points span, and of what is cut
/// from them, over the largest volume that their numbers could span: 60 roundings.
inline constexpr double kVolumeError = 0x1p-46;

/// The cheap tests that `first_impact` begins with, of eight pairs of features in columns: x, y, z
/// of points 0 to 3 at the start, then at the end. A bit is set for each pair that a coordinate
/// axis, or a volume that is never zero, does not tell apart, and for all whose numbers are bad or
/// want to be scaled.
struct FeatureTestKernels {
  std::uint32_t (*vertex_face)(const double* const* columns, std::size_t first, double separation);
  std::uint32_t (*edge_edge)(const double* const* columns, std::size_t first, double separation);
};

WINNOW_KERNELS(FeatureTestKernels, feature_test_kernels);

}  // namespace winnow
