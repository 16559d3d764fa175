#pragma once

#include "simd/kernels/kernels.h"

#include <cstddef>
#include <cstdint>

namespace winnow {

/// Pairs of features tested at once.
inline constexpr std::size_t kFeatureLanes = 8;

/// Squares and cubes of numbers between these stay in the range of double.
inline constexpr double kMinScaled = 0x1p-200;
inline constexpr double kMaxScaled = 0x1p200;
/// Bound on the loss by underflow of products.
inline constexpr double kLostByUnderflow = 1e-300;
/// Error bound of the Bernstein coefficients of the volume that the features span, and of values
/// interpolated from the coefficients, relative to the largest volume that numbers of these
/// magnitudes could span. It covers 60 roundings.
inline constexpr double kVolumeError = 0x1p-46;

/// The cheap tests that `first_impact` begins with, for eight pairs of features in columns: x, y, z
/// of points 0 to 3 at the start, then at the end. Returns a bit for each pair that is not
/// separated by a coordinate axis or by a volume that is never zero, and for each pair whose
/// numbers are not finite or need scaling.
struct FeatureTestKernels {
  std::uint32_t (*vertex_face)(const double* const* columns, std::size_t first, double separation);
  std::uint32_t (*edge_edge)(const double* const* columns, std::size_t first, double separation);
};

WINNOW_KERNELS(FeatureTestKernels, feature_test_kernels);

}  // namespace winnow
