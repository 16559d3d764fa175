#pragma once

// A pair of convex polytopes, possibly rounded, as the hull kernels pass it from stage to stage,
// and the support function of a hull, sixteen vertices at a time.

#include "pipeline/kernels/fetch_ahead.wide.h"
#include "pipeline/kernels/single_vectors.wide.h"
#include "simd/lanes/vectors.h"

namespace winnow::WINNOW_ISA_NAME::hull {

/// Result of the float search about the cores.
enum class HullState : std::uint32_t {
  /// Farther apart than the caller needs.
  far,
  /// Closest features found, but not proven.
  apart,
  /// The overlap exceeds the errors of float.
  inside,
  /// Touching or overlapping, up to the errors of float.
  close,
};

/// "First" is body a of the pair, or body b if `swapped`: see comes_second.
struct HullPair {
  const HullShape* first;
  const HullShape* second;
  /// From the second's frame to the first's: x -> turn x + shift; stored by rows.
  double turn[9];
  double shift[3];
  /// From the first's frame to world axes; stored by rows.
  double frame[9];
  /// Position of the second minus position of the first, in world axes.
  double offset[3];
  /// An upper bound of every length that occurs: the distance of the hulls' origins, plus the
  /// reach_of each hull.
  double size;
  /// Sum of the roundings.
  double rounding;
  /// The search stops with state far if the cores are farther apart than this plus the rounding;
  /// infinite to never stop.
  double far;
  /// `turn` and `shift` in float. The `scaled_` numbers are multiplied by `scale`, a power of two
  /// that brings `size` into [1, 2).
  float turn_float[9];
  float scaled_turn[9];
  float scaled_shift[3];
  float scale;
  std::uint32_t index;
  bool swapped;
  // Outcome of the search.
  HullState state;
  /// `count` vertex pairs of the closest features: vertex of the first | vertex of the second <<
  /// 16.
  std::uint32_t count;
  std::uint32_t vertices[3];
  /// first - second at the closest points, scaled.
  float gap[3];
  /// State far: a lower bound of the distance of the cores, times the length of `gap`, scaled.
  float lower;
  /// Square of an upper bound of the penetration depth, scaled.
  float depth_squared;
  /// The latest support points of first - second, scaled.
  static constexpr std::uint32_t kTrail = 8;
  float trail[kTrail][3];
  std::uint32_t trail_length;
};

/// Beyond these sizes, products of four floats may not be normal numbers.
inline constexpr double kSmallestHull = 1e-8;
inline constexpr double kLargestHull = 1e8;
/// The search stores vertex numbers in 16 bits.
inline constexpr std::uint32_t kMaxHullVertices = 65535;

/// Bound of the rounding errors of lengths computed in double from a HullPair, relative to size:
/// some forty operations of half a unit each.
inline constexpr double kDoubleError = 40.0 * 0x1p-53;
/// As kDoubleError in float, including the error in the choice of the highest vertex: see
/// kLaneBits.
inline constexpr float kFloatError = 40.0F * 0x1p-24F;

/// Computes the rotation of a quaternion of any length; returns false if its squared length is
/// outside 1e-200 to 1e200.
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

/// True if the pair is computed with b first. The order does not depend on which body is called a,
/// so (a, b) and (b, a) are computed alike: if only one hull is solid, it is first; otherwise the
/// positions decide, then the addresses of the hulls, then the orientations.
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

/// The power of two that brings a size in float's range into [1, 2).
static inline float scale_of(double size) {
  const std::uint64_t exponent = __builtin_bit_cast(std::uint64_t, size) >> 52U;
  return static_cast<float>(__builtin_bit_cast(double, (2046U - exponent) << 52U));
}

/// Fills in the inputs of the search, with b first if `swapped`; returns false if poses or sizes
/// are out of range. `PointSecond`: the second is a point at its origin, so its orientation is not
/// read.
template <bool PointSecond = false>
static inline bool place_hulls(const HullShape& a, const HullShape& b, const Pose& pose_a,
                               const Pose& pose_b, bool swapped, HullPair& pair) {
  pair.swapped = swapped;
  const Pose& first = swapped ? pose_b : pose_a;
  const Pose& second = swapped ? pose_a : pose_b;
  pair.first = swapped ? &b : &a;
  pair.second = swapped ? &a : &b;
  double frame[9];
  double turn[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  if (!rotation_of(first.orientation, frame)) return false;
  if constexpr (!PointSecond) {
    double axes[9];
    if (!rotation_of(second.orientation, axes)) return false;
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) {
        turn[3 * i + k] =
            frame[i] * axes[k] + frame[3 + i] * axes[3 + k] + frame[6 + i] * axes[6 + k];
      }
    }
  }
  double offset[3];
  double shift[3];
  for (int i = 0; i < 3; ++i) offset[i] = second.position[i] - first.position[i];
  turn_back3(frame, offset, shift);
  pair.rounding = a.rounding + b.rounding;
  const double size = reach_of(a) + reach_of(b) + __builtin_fabs(shift[0]) +
                      __builtin_fabs(shift[1]) + __builtin_fabs(shift[2]);
  if (!(size > kSmallestHull && size < kLargestHull)) return false;
  if (!(pair.rounding < kLargestHull)) return false;
  const float scale = scale_of(size);
  pair.size = size;
  pair.scale = scale;
  for (int i = 0; i < 9; ++i) {
    const auto turn_float = static_cast<float>(turn[i]);
    pair.frame[i] = frame[i];
    pair.turn[i] = turn[i];
    pair.turn_float[i] = turn_float;
    pair.scaled_turn[i] = turn_float * scale;
  }
  for (int i = 0; i < 3; ++i) {
    pair.offset[i] = offset[i];
    pair.shift[i] = shift[i];
    pair.scaled_shift[i] = static_cast<float>(shift[i]) * scale;
  }
  return true;
}

/// The four low bits of a float are replaced by its lane's number, so that a maximum also names its
/// lane. The chosen vertex may thus be lower than the highest by 16 units in the last place.
inline constexpr std::uint32_t kLaneBits = 15;

[[gnu::always_inline]] static inline Floats with_lane_number(const Floats& value) {
#define WINNOW_LANE_NUMBER(i) __builtin_bit_cast(float, std::uint32_t{i})
  alignas(64) static constexpr float kNumbers[kLanes] = {
      WINNOW_LANE_NUMBER(0),  WINNOW_LANE_NUMBER(1),  WINNOW_LANE_NUMBER(2),
      WINNOW_LANE_NUMBER(3),  WINNOW_LANE_NUMBER(4),  WINNOW_LANE_NUMBER(5),
      WINNOW_LANE_NUMBER(6),  WINNOW_LANE_NUMBER(7),  WINNOW_LANE_NUMBER(8),
      WINNOW_LANE_NUMBER(9),  WINNOW_LANE_NUMBER(10), WINNOW_LANE_NUMBER(11),
      WINNOW_LANE_NUMBER(12), WINNOW_LANE_NUMBER(13), WINNOW_LANE_NUMBER(14),
      WINNOW_LANE_NUMBER(15)};
#undef WINNOW_LANE_NUMBER
  const Floats numbers = Floats::load(kNumbers);
  const Floats keep(__builtin_bit_cast(float, ~kLaneBits));
  return (value & keep) | numbers;
}

[[gnu::always_inline]] static inline Floats along(const float* const* vertex, std::uint32_t row,
                                                  const Vec3<float>& d) {
  return Floats::load(vertex[0] + row) * d.x + Floats::load(vertex[1] + row) * d.y +
         Floats::load(vertex[2] + row) * d.z;
}

/// Computes sixteen heights along `direction` with their lanes' numbers in the low bits; the
/// largest of them is the height of the hull. If the hull has more than sixteen vertices, each
/// height is the largest of its lane, and `block` receives the first vertex of the block of sixteen
/// that it is from.
[[gnu::always_inline]] static inline void heights(const HullShape& hull, const float* direction,
                                                  float* height, float* block) {
  const Vec3<float> d{direction[0], direction[1], direction[2]};
  Floats best = with_lane_number(along(hull.vertex_float, 0, d));
  if (hull.vertex_count > kLanes) {
    Floats where(0.0F);
    for (std::uint32_t row = kLanes; row < hull.vertex_count; row += kLanes) {
      const Floats value = with_lane_number(along(hull.vertex_float, row, d));
      const LaneMask<float> higher = value > best;
      best = select(higher, value, best);
      where = select(higher, Floats(static_cast<float>(row)), where);
    }
    where.store(block);
  }
  best.store(height);
}

/// The lane of a maximum that is zero. A zero with a lane's number is a denormal number, which
/// arithmetic may flush to zero on this host; the stored heights still have the bits.
[[gnu::noinline]] static std::uint32_t lane_of_zero(const float* height) {
  const auto pattern = [&](std::uint32_t i) {
    return __builtin_bit_cast(std::uint32_t, height[i]);
  };
  // From the largest denormal number to the smallest: the order in which hosts that do not flush
  // them choose.
  for (std::uint32_t i = kLanes; i-- > 0;) {
    if (pattern(i) == i) return i;
  }
  for (std::uint32_t i = 0; i < kLanes; ++i) {
    if (pattern(i) == (1U << 31U | i)) return i;
  }
  return 0;
}

/// The vertex that the maximum of `heights` names.
[[gnu::always_inline]] static inline std::uint32_t vertex_of(const HullShape& hull, float highest,
                                                             const float* height,
                                                             const float* block) {
  std::uint32_t vertex = __builtin_bit_cast(std::uint32_t, highest) & kLaneBits;
  if (highest == 0.0F) vertex = lane_of_zero(height);
  if (hull.vertex_count > kLanes) vertex += static_cast<std::uint32_t>(block[vertex]);
  // The columns are padded with copies of vertex 0.
  return vertex < hull.vertex_count ? vertex : 0;
}

/// The supporting vertex along one direction.
[[gnu::always_inline]] static inline std::uint32_t farthest_vertex(const HullShape& hull,
                                                                   const float* direction) {
  alignas(64) float height[kLanes];
  alignas(64) float block[kLanes];
  heights(hull, direction, height, block);
  return vertex_of(hull, reduce_max(Floats::load(height)), height, block);
}

[[gnu::always_inline]] static inline Doubles along(const double* const* vertex, std::uint32_t row,
                                                   const Vec3<double>& d) {
  return Doubles::load(vertex[0] + row) * d.x + Doubles::load(vertex[1] + row) * d.y +
         Doubles::load(vertex[2] + row) * d.z;
}
[[gnu::always_inline]] static inline const double* const* columns_of(const HullShape& hull,
                                                                     double) {
  return hull.vertex;
}
[[gnu::always_inline]] static inline const float* const* columns_of(const HullShape& hull, float) {
  return hull.vertex_float;
}

template <typename T>
[[gnu::always_inline]] static inline T largest_lane(const Lanes<T>& v) {
  if constexpr (sizeof(T) == sizeof(float)) return reduce_max(v);
  constexpr std::uint32_t kWidth = Lanes<T>::kCount;
  alignas(64) T value[kWidth];
  v.store(value);
  for (std::uint32_t half = kWidth / 2; half > 0; half /= 2) {
    for (std::uint32_t i = 0; i < half; ++i) {
      value[i] = value[i] > value[i + half] ? value[i] : value[i + half];
    }
  }
  return value[0];
}

/// The first lane with the largest number; an unspecified lane if there are NaNs.
template <typename T>
[[gnu::always_inline]] static inline std::uint32_t lane_of_largest(const Lanes<T>& v) {
  constexpr Mask16 last = 1U << (Lanes<T>::kCount - 1);
  return first(static_cast<Mask16>(bits(v == Lanes<T>(largest_lane(v))) | last));
}

/// The supporting vertex along a direction. If several vertices are equally far, the lowest lane
/// wins, and in a lane the first vertex.
template <typename T>
static inline std::uint32_t highest_vertex(const HullShape& hull, const Vec3<T>& direction) {
  constexpr std::uint32_t kWidth = Lanes<T>::kCount;
  const T* const* vertex = columns_of(hull, T());
  Lanes<T> best = along(vertex, 0, direction);
  Lanes<T> where(T(0));
  for (std::uint32_t row = kWidth; row < hull.vertex_count; row += kWidth) {
    const Lanes<T> value = along(vertex, row, direction);
    const LaneMask<T> higher = value > best;
    best = select(higher, value, best);
    where = select(higher, Lanes<T>(static_cast<T>(row)), where);
  }
  alignas(64) T row[kWidth];
  where.store(row);
  const std::uint32_t lane = lane_of_largest(best);
  const std::uint32_t found = static_cast<std::uint32_t>(row[lane]) + lane;
  // The columns are padded with copies of vertex 0.
  return found < hull.vertex_count ? found : 0;
}

/// The largest dot product of a vertex with `direction`.
template <typename T>
static inline T height_of(const HullShape& hull, const T* direction) {
  constexpr std::uint32_t kWidth = Lanes<T>::kCount;
  const Vec3<T> d{direction[0], direction[1], direction[2]};
  const T* const* vertex = columns_of(hull, T());
  if (hull.vertex_count == 1) {
    return vertex[0][0] * direction[0] + vertex[1][0] * direction[1] + vertex[2][0] * direction[2];
  }
  Lanes<T> best = along(vertex, 0, d);
  for (std::uint32_t row = kWidth; row < hull.vertex_count; row += kWidth) {
    best = max(best, along(vertex, row, d));
  }
  return largest_lane(best);
}

/// Finds the first vertex whose height along `direction` is at least `limit`; returns false if
/// there is not exactly one.
template <typename T>
static inline bool sole_vertex_from(const HullShape& hull, const T* direction, T limit,
                                    std::uint32_t& vertex) {
  constexpr std::uint32_t kWidth = Lanes<T>::kCount;
  const Vec3<T> d{direction[0], direction[1], direction[2]};
  std::uint32_t found = 0;
  for (std::uint32_t row = 0; row < hull.vertex_count; row += kWidth) {
    Mask16 high = bits(along(columns_of(hull, T()), row, d) >= Lanes<T>(limit));
    const std::uint32_t left = hull.vertex_count - row;
    if (left < kWidth) high &= lanes_below(left);
    if (high == 0) continue;
    if (found == 0) vertex = row + first(high);
    found += winnow::WINNOW_ISA_NAME::count(high);
  }
  return found == 1;
}

/// Computes the mean of all vertices whose height along `direction` is at least `limit`; returns
/// their number.
template <typename T>
static inline std::uint32_t middle_from(const HullShape& hull, const T* direction, T limit,
                                        T* middle) {
  constexpr std::uint32_t kWidth = Lanes<T>::kCount;
  const Vec3<T> d{direction[0], direction[1], direction[2]};
  const T* const* vertex = columns_of(hull, T());
  std::uint32_t found = 0;
  for (int k = 0; k < 3; ++k) middle[k] = T(0);
  for (std::uint32_t row = 0; row < hull.vertex_count; row += kWidth) {
    Mask16 high = bits(along(vertex, row, d) >= Lanes<T>(limit));
    const std::uint32_t left = hull.vertex_count - row;
    if (left < kWidth) high &= lanes_below(left);
    found += winnow::WINNOW_ISA_NAME::count(high);
    for (; high != 0; high &= high - 1) {
      const std::uint32_t i = row + first(high);
      for (int k = 0; k < 3; ++k) middle[k] += vertex[k][i];
    }
  }
  if (found > 1) {
    for (int k = 0; k < 3; ++k) middle[k] /= static_cast<T>(found);
  }
  return found;
}

/// Vertex i in the hull's own frame.
template <typename T>
[[gnu::always_inline]] static inline void vertex_at(const HullShape& hull, std::uint32_t i, T* x) {
  const T* const* vertex = columns_of(hull, T());
  for (int k = 0; k < 3; ++k) x[k] = vertex[k][i];
}

}  // namespace winnow::WINNOW_ISA_NAME::hull
