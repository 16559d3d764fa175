#pragma once

// A pair of convex polytopes, possibly rounded, as the hull kernels pass it from stage to stage.

#include "pipeline/narrow/narrow_job.h"
#include "simd/lanes/vectors.h"

namespace winnow::WINNOW_ISA_NAME {

/// What the float search found out about the cores.
enum class HullState : std::uint32_t {
  /// Farther apart than anyone asks.
  far,
  /// Closest features found; not proven.
  apart,
  /// Overlap beyond float's doubt.
  inside,
  /// Touching or overlapping, as far as float can tell.
  close,
};

/// "First" is body a of the pair, or body b where `swapped`: see comes_second.
struct HullPair {
  const HullShape* first;
  const HullShape* second;
  /// From the second's frame to the first's: x -> turn x + shift; rows.
  double turn[9];
  double shift[3];
  /// From the first's frame to the world's axes; rows.
  double frame[9];
  /// Position of the second less that of the first, in the world's axes.
  double offset[3];
  /// An upper bound of every length that occurs: both hulls' reach from their origins and the
  /// distance of these.
  double size;
  /// Sum of the roundings.
  double rounding;
  /// The same for float, where lengths are multiplied by `scale`, a power of two that brings `size`
  /// into [1, 2).
  float turn_float[9];
  float scaled_turn[9];
  float scaled_shift[3];
  float scale;
  std::uint32_t index;
  bool swapped;
  // Outcome of the search.
  HullState state;
  /// Vertices of the closest features: `count` times that of the first, | that of the second << 16.
  std::uint32_t count;
  std::uint32_t vertices[3];
  /// first - second where they are closest, scaled.
  float gap[3];
  /// A lower bound of the distance of the cores, scaled; of state far.
  float lower;
  /// Square of an upper bound of the penetration depth, scaled.
  float depth_squared;
  /// The latest supports, points of first - second, scaled.
  static constexpr std::uint32_t kTrail = 8;
  float trail[kTrail][3];
  std::uint32_t trail_length;
};

/// Sizes beyond these leave the range in which products of four floats are normal numbers.
inline constexpr double kSmallestHull = 1e-8;
inline constexpr double kLargestHull = 1e8;
/// Vertex numbers of the search have 16 bits.
inline constexpr std::uint32_t kMostHullVertices = 65535;

/// A bound of the rounding errors in lengths that are computed in double from a HullPair, over
/// size: some forty operations of half a unit each.
inline constexpr double kDoubleError = 40.0 * 0x1p-53;
/// The same in float, over size, with the doubt about which vertex is the highest: see kLaneBits.
inline constexpr float kFloatError = 40.0F * 0x1p-24F;

static inline double dot3(const double* a, const double* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
static inline float dot3(const float* a, const float* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
static inline void cross3(const double* a, const double* b, double* r) {
  r[0] = a[1] * b[2] - a[2] * b[1];
  r[1] = a[2] * b[0] - a[0] * b[2];
  r[2] = a[0] * b[1] - a[1] * b[0];
}
/// r = M x and r = M^T x, M by rows.
template <typename T>
static inline void turn3(const T* m, const T* x, T* r) {
  for (int i = 0; i < 3; ++i) r[i] = m[3 * i] * x[0] + m[3 * i + 1] * x[1] + m[3 * i + 2] * x[2];
}
template <typename T>
static inline void turn_back3(const T* m, const T* x, T* r) {
  for (int i = 0; i < 3; ++i) r[i] = m[i] * x[0] + m[3 + i] * x[1] + m[6 + i] * x[2];
}

/// The rotation of a quaternion of any length; false if its square leaves double's range.
static inline bool rotation_of(const double* q, double* m) {
  const double length = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  if (!(length > 1e-200 && length < 1e200)) return false;
  const double s = 2.0 / length;
  const double x = q[1] * s;
  const double y = q[2] * s;
  const double z = q[3] * s;
  const double wx = q[0] * x;
  const double wy = q[0] * y;
  const double wz = q[0] * z;
  const double xx = q[1] * x;
  const double xy = q[1] * y;
  const double xz = q[1] * z;
  const double yy = q[2] * y;
  const double yz = q[2] * z;
  const double zz = q[3] * z;
  m[0] = 1.0 - (yy + zz);
  m[1] = xy - wz;
  m[2] = xz + wy;
  m[3] = xy + wz;
  m[4] = 1.0 - (xx + zz);
  m[5] = yz - wx;
  m[6] = xz - wy;
  m[7] = yz + wx;
  m[8] = 1.0 - (xx + yy);
  return true;
}

static inline double reach_of(const HullShape& hull) {
  return __builtin_fabs(hull.center[0]) + __builtin_fabs(hull.center[1]) +
         __builtin_fabs(hull.center[2]) + hull.radius;
}

/// Whether the pair is answered with b first, so that (a, b) and (b, a) are computed alike: solids
/// come first, then the sign of the difference of positions decides, then what else differs.
static inline bool comes_second(const HullShape& a, const HullShape& b, const Pose& pose_a,
                                const Pose& pose_b) {
  if ((a.dimension == 3) != (b.dimension == 3)) return b.dimension == 3;
  for (int i = 0; i < 3; ++i) {
    const double c = pose_b.position[i] - pose_a.position[i];
    if (c != 0.0) return c < 0.0;
  }
  if (&a != &b) return &b < &a;
  for (int i = 0; i < 4; ++i) {
    const double d = pose_b.orientation[i] - pose_a.orientation[i];
    if (d != 0.0) return d < 0.0;
  }
  return false;
}

/// The largest power of two that is not above 1 / size, for a size in float's range.
static inline float scale_of(double size) {
  const std::uint64_t exponent = __builtin_bit_cast(std::uint64_t, size) >> 52U;
  return static_cast<float>(__builtin_bit_cast(double, (2046U - exponent) << 52U));
}

/// Fills what the search needs, b first where `swapped`; false if poses or sizes are out of range.
static inline bool place_hulls(const HullShape& a, const HullShape& b, const Pose& pose_a,
                               const Pose& pose_b, bool swapped, HullPair& pair) {
  pair.swapped = swapped;
  const Pose& first = pair.swapped ? pose_b : pose_a;
  const Pose& second = pair.swapped ? pose_a : pose_b;
  pair.first = pair.swapped ? &b : &a;
  pair.second = pair.swapped ? &a : &b;
  double axes[9];
  if (!rotation_of(first.orientation, pair.frame) || !rotation_of(second.orientation, axes)) {
    return false;
  }
  for (int i = 0; i < 3; ++i) pair.offset[i] = second.position[i] - first.position[i];
  turn_back3(pair.frame, pair.offset, pair.shift);
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      pair.turn[3 * i + k] = pair.frame[i] * axes[k] + pair.frame[3 + i] * axes[3 + k] +
                             pair.frame[6 + i] * axes[6 + k];
    }
  }
  pair.rounding = a.rounding + b.rounding;
  pair.size = reach_of(a) + reach_of(b) + __builtin_fabs(pair.shift[0]) +
              __builtin_fabs(pair.shift[1]) + __builtin_fabs(pair.shift[2]);
  if (!(pair.size > kSmallestHull && pair.size < kLargestHull)) return false;
  if (!(pair.rounding < kLargestHull)) return false;
  pair.scale = scale_of(pair.size);
  for (int i = 0; i < 9; ++i) pair.turn_float[i] = static_cast<float>(pair.turn[i]);
  for (int i = 0; i < 9; ++i) pair.scaled_turn[i] = pair.turn_float[i] * pair.scale;
  for (int i = 0; i < 3; ++i) pair.scaled_shift[i] = static_cast<float>(pair.shift[i]) * pair.scale;
  return true;
}

}  // namespace winnow::WINNOW_ISA_NAME
