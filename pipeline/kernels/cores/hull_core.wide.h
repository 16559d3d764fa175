#pragma once

// A hull as a core: its support function, sixteen vertices at a time, for one pair or one pair per
// lane; and its feature at a supporting vertex along a direction: a face or an edge that is within
// 14 degrees of perpendicular to the direction (feature_rules.h), or else the vertex. The limit is
// wide because bodies rock over their faces and edges.

#include <winnow/core/pose.h>
#include <winnow/pipeline/shapes.h>
#include "core/numbers/rotation.h"
#include "pipeline/kernels/single_vectors.wide.h"
#include "pipeline/manifold/feature_rules.h"
#include "simd/lanes/rows.h"
#include "simd/lanes/scalar_lane.h"
#include "simd/lanes/vectors.h"

namespace winnow::WINNOW_ISA_NAME::hull {

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
  // Products that are both added and subtracted: see `opaque`.
  const double wx = opaque(q[0] * x);
  const double wy = opaque(q[0] * y);
  const double wz = opaque(q[0] * z);
  const double xx = q[1] * x;
  const double xy = opaque(q[1] * y);
  const double xz = opaque(q[1] * z);
  const double yy = q[2] * y;
  const double yz = opaque(q[2] * z);
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

/// Two placed shapes, the second in the frame of the first.
struct PairPlacement {
  /// From the second's frame to the first's: x -> turn x + shift; stored by rows.
  double turn[9];
  double shift[3];
  /// From the first's frame to world axes; stored by rows.
  double frame[9];
  /// Position of the second minus position of the first, in world axes.
  double offset[3];
};

/// Returns false if an orientation is out of range. `PointSecond`: the second is a point at its
/// origin, so its orientation is not read.
template <bool PointSecond = false>
static inline bool place(const Pose& first, const Pose& second, PairPlacement& pair) {
  double axes[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  if (!rotation_of(first.orientation.data(), pair.frame)) return false;
  if constexpr (PointSecond) {
    for (int i = 0; i < 9; ++i) pair.turn[i] = axes[i];
  } else {
    if (!rotation_of(second.orientation.data(), axes)) return false;
    const double* const frame = pair.frame;
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) {
        pair.turn[3 * i + k] =
            frame[i] * axes[k] + frame[3 + i] * axes[3 + k] + frame[6 + i] * axes[6 + k];
      }
    }
  }
  for (int i = 0; i < 3; ++i) pair.offset[i] = second.position[i] - first.position[i];
  turn_back3(pair.frame, pair.offset, pair.shift);
  return true;
}

/// The power of two that brings a normal number into [1, 2).
static inline double scale_of(double size) {
  const std::uint64_t exponent = __builtin_bit_cast(std::uint64_t, size) >> 52U;
  return __builtin_bit_cast(double, (2046U - exponent) << 52U);
}

static inline double reach_of(const HullShape& hull) {
  return __builtin_fabs(hull.center[0]) + __builtin_fabs(hull.center[1]) +
         __builtin_fabs(hull.center[2]) + hull.radius;
}

/// True if the pair is computed with b first. The order does not depend on which body is called a,
/// so (a, b) and (b, a) are computed alike: if only one hull is solid, it is first; otherwise the
/// positions decide, then the addresses of the hulls, then the orientations.
static inline bool computes_b_first(const HullShape& a, const HullShape& b, const Pose& pose_a,
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

template <typename T>
[[gnu::always_inline]] static inline Lanes<T> along(const T* const* vertex, std::uint32_t row,
                                                    const Vec3<T>& d) {
  return Lanes<T>::load(vertex[0] + row) * d.x + Lanes<T>::load(vertex[1] + row) * d.y +
         Lanes<T>::load(vertex[2] + row) * d.z;
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

/// The number of a vertex as the bit pattern of a lane.
constexpr float number_pattern(std::uint32_t number) {
  return __builtin_bit_cast(float, number);
}

/// One row per lane: the heights of the hull's sixteen vertices. If the hull has more, entry i is
/// the largest height of the vertices i, i + 16, ..., and `block` stores from which block of
/// sixteen it is.
struct VertexHeights {
  alignas(64) float height[kLanes * kLanes];
  alignas(64) float block[kLanes * kLanes];
};

/// Calls found(lane, vertex) for all `active` lanes with the vertex of hull[lane] that is farthest
/// along the lane's direction, in float and in the hull's own frame.
template <typename Found>
[[gnu::always_inline]] static inline void for_farthest_vertices(const HullShape* const* hull,
                                                                const Vec3<float>& direction,
                                                                Mask16 active, VertexHeights& rows,
                                                                Found&& found) {
  alignas(64) float along[3][kLanes];
  direction.x.store(along[0]);
  direction.y.store(along[1]);
  direction.z.store(along[2]);
  for (Mask16 rest = active; rest != 0; rest &= rest - 1) {
    const unsigned lane = first(rest);
    const float d[3] = {along[0][lane], along[1][lane], along[2][lane]};
    heights(*hull[lane], d, rows.height + lane * kLanes, rows.block + lane * kLanes);
  }
  alignas(64) float highest[kLanes];
  reduce_max_rows(rows.height).store_unaligned(highest);
  for (Mask16 rest = active; rest != 0; rest &= rest - 1) {
    const unsigned lane = first(rest);
    found(lane, vertex_of(*hull[lane], highest[lane], rows.height + lane * kLanes,
                          rows.block + lane * kLanes));
  }
}

/// The supporting vertices of the hulls in the lanes, and their numbers.
class FarthestVertices {
 public:
  void put(int lane, const HullShape& hull) { hull_[lane] = &hull; }

  void find(const Vec3<float>& direction, Mask16 active) {
    for_farthest_vertices(hull_, direction, active, rows_,
                          [&](unsigned lane, std::uint32_t vertex) {
                            number_[lane] = vertex;
                            for (int i = 0; i < 3; ++i) {
                              vertex_[i][lane] = hull_[lane]->vertex_float[i][vertex];
                            }
                          });
  }

  [[nodiscard]] Vec3<float> vertex() const {
    return {Floats::load(vertex_[0]), Floats::load(vertex_[1]), Floats::load(vertex_[2])};
  }
  /// The numbers times 2^shift.
  [[nodiscard]] Floats numbers(std::uint32_t shift) const {
    alignas(64) float pattern[kLanes];
    for (int lane = 0; lane < kLanes; ++lane)
      pattern[lane] = number_pattern(number_[lane] << shift);
    return Floats::load(pattern);
  }

 private:
  const HullShape* hull_[kLanes] = {};
  std::uint32_t number_[kLanes] = {};
  alignas(64) float vertex_[3][kLanes] = {};
  VertexHeights rows_;
};

inline constexpr std::uint32_t kNoFeature = ~0U;

/// The edge between two vertices.
static inline std::uint32_t find_edge(const HullShape& hull, std::uint32_t v, std::uint32_t w) {
  for (std::uint32_t i = 0; i < hull.edge_count; ++i) {
    const std::uint32_t* ends = hull.edges[i].vertex;
    if ((ends[0] == v && ends[1] == w) || (ends[0] == w && ends[1] == v)) return i;
  }
  return kNoFeature;
}

/// Cosines that differ by at most this may be in the wrong order in float.
inline constexpr float kTiedCosines = 1e-6F;

/// `face_across` in double, for faces that are nearly coplanar.
static inline std::uint32_t tied_face_across(const HullShape& hull, const double* direction,
                                             const float* x, float doubt) {
  const float* const* plane = hull.plane_float;
  std::uint32_t best = kNoFeature;
  double most = kFaceCosine;
  for (std::uint32_t i = 0; i < hull.face_count; ++i) {
    const float n[3] = {plane[0][i], plane[1][i], plane[2][i]};
    const double cosine = dot3(hull.faces[i].normal.data(), direction);
    if (!(cosine > most) || !(plane[3][i] - dot3(n, x) <= doubt)) continue;
    most = cosine;
    best = i;
  }
  return best;
}

/// Returns the face that is most along the direction, among the faces whose planes pass within
/// `doubt` of the vertex at x; kNoFeature if no cosine is above kFaceCosine.
static inline std::uint32_t face_across(const HullShape& hull, const double* direction,
                                        const float* x, float doubt) {
  const float* const* plane = hull.plane_float;
  const Vec3<float> along{static_cast<float>(direction[0]), static_cast<float>(direction[1]),
                          static_cast<float>(direction[2])};
  const Floats slack(doubt);
  std::uint32_t best = kNoFeature;
  auto most = static_cast<float>(kFaceCosine);
  float next = most;
  for (std::uint32_t row = 0; row < hull.face_count; row += kLanes) {
    const Vec3<float> n{Floats::load(plane[0] + row), Floats::load(plane[1] + row),
                        Floats::load(plane[2] + row)};
    const Floats cosine = dot(n, along);
    const Floats below = Floats::load(plane[3] + row) - dot(n, Vec3<float>{x[0], x[1], x[2]});
    Mask16 hit = bits((cosine > Floats(next)) & (below <= slack));
    const std::uint32_t left = hull.face_count - row;
    if (left < kLanes) hit &= lanes_below(left);
    if (hit == 0) continue;
    alignas(64) float value[kLanes];
    cosine.store(value);
    for (; hit != 0; hit &= hit - 1) {
      const unsigned lane = winnow::WINNOW_ISA_NAME::first(hit);
      if (!(value[lane] > most)) {
        next = value[lane] > next ? value[lane] : next;
        continue;
      }
      next = most;
      most = value[lane];
      best = row + lane;
    }
  }
  const bool is_tied = best != kNoFeature && most - next <= kTiedCosines;
  return is_tied ? tied_face_across(hull, direction, x, doubt) : best;
}

/// Returns the neighbour to which the edge from a vertex is closest to perpendicular to the
/// direction; kNoFeature if no edge is within kEdgeSine of it.
static inline std::uint32_t neighbour_across(const HullShape& hull, const float* direction,
                                             std::uint32_t vertex, const float* x) {
  std::uint32_t best = kNoFeature;
  auto least = static_cast<float>(kEdgeSine * kEdgeSine);
  if (hull.dimension == 0) return best;
  for (std::uint32_t i = hull.neighbour_first[vertex]; i < hull.neighbour_first[vertex + 1]; ++i) {
    float y[3];
    vertex_at(hull, hull.neighbour[i], y);
    for (int k = 0; k < 3; ++k) y[k] -= x[k];
    const float drop = dot3(direction, y);
    const float slope = drop * drop / dot3(y, y);
    if (!(slope < least)) continue;
    least = slope;
    best = hull.neighbour[i];
  }
  return best;
}

}  // namespace winnow::WINNOW_ISA_NAME::hull
