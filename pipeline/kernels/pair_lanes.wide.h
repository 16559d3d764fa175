#pragma once

// Loads the pairs of a job into SIMD lanes, one pair per lane: the loop over blocks of pairs,
// differences of positions, rotations, and the parameters of shapes in the order of their structs.

#include "pipeline/kernels/fetch_ahead.wide.h"
#include "simd/lanes/rows.h"
#include "simd/lanes/vectors.h"

namespace winnow::WINNOW_ISA_NAME {

/// As many pairs as Lanes<T> has lanes.
template <typename T>
struct PairBlock {
  /// One pair per lane. Lanes from `count` on repeat the job's last pair.
  const BodyPair* pairs;
  /// Index in the job of the pair in lane 0.
  std::uint32_t first;
  std::uint32_t count;

  [[nodiscard]] Mask16 lanes() const { return lanes_below(count); }
};

/// Calls body(block) for all pairs of the job. Prefetches only if the job has many bodies: the
/// loads of a block do not depend on the block before, so the processor overlaps the misses of
/// successive blocks in the nearer caches by itself.
template <typename T, typename Body>
[[gnu::always_inline]] inline void for_blocks(const NarrowJob& job, Body&& body) {
  constexpr std::uint32_t lanes = Lanes<T>::kCount;
  BodyPair tail[lanes];
  for (std::uint32_t first = 0; first < job.count; first += lanes) {
    PairBlock<T> block{job.pairs + first, first, lanes};
    if (job.count - first < lanes) {
      block.count = job.count - first;
      for (std::uint32_t i = 0; i < lanes; ++i) {
        tail[i] = block.pairs[i < block.count ? i : block.count - 1];
      }
      block.pairs = tail;
    }
    for (std::uint32_t i = 0; i < lanes && job.has_many_bodies; ++i) fetch_ahead(job, first + i);
    body(block);
  }
}

/// Returns the margin of each pair of a block.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> margins_of(const NarrowJob& job, const PairBlock<T>& block) {
  if (job.margins == nullptr) return Lanes<T>(static_cast<T>(job.margin));
  alignas(64) T each[Lanes<T>::kCount];
  for (int lane = 0; lane < Lanes<T>::kCount; ++lane) {
    each[lane] = static_cast<T>(job.margins[block.first + static_cast<std::uint32_t>(lane)]);
  }
  return Lanes<T>::load(each);
}

/// Views a plain struct of doubles as an array.
template <typename Plain>
[[gnu::always_inline]] inline const double* numbers(const Plain& plain) {
  static_assert(sizeof(Plain) % sizeof(double) == 0);
  return reinterpret_cast<const double*>(&plain);
}

/// Selects one body of a pair.
struct SideA {
  [[gnu::always_inline]] static std::uint32_t body(const BodyPair& pair) { return pair.a; }
};
struct SideB {
  [[gnu::always_inline]] static std::uint32_t body(const BodyPair& pair) { return pair.b; }
};

/// Loads rows of doubles and converts them to type T: `load(first_lane, out)` fills the eight lanes
/// from `first_lane` on.
template <typename T, int Count, typename Load>
[[gnu::always_inline]] inline void in_precision(Load&& load, Lanes<T> (&out)[Count]) {
  if constexpr (sizeof(T) == sizeof(double)) {
    load(0, out);
  } else {
    Doubles low[Count];
    Doubles high[Count];
    load(0, low);
    load(8, high);
    for (int k = 0; k < Count; ++k) out[k] = to_single(low[k], high[k]);
  }
}

/// Loads `Count` columns from one row of doubles per pair: row(lane) is the address of the row of
/// the pair in that lane.
template <int Count, typename T, typename Row>
[[gnu::always_inline]] inline void load_columns(Row&& row, Lanes<T> (&out)[Count]) {
  static_assert(1 <= Count && Count <= 4);
  if constexpr (Lanes<T>::kCount == 1) {
    const double* const only = row(0);
    for (int k = 0; k < Count; ++k) out[k] = Lanes<T>(only[k]);
  } else {
    in_precision<T>(
        [&](int from, Doubles(&rows)[Count]) {
          const auto row_from = [&](int lane) { return row(from + lane); };
          if constexpr (Count == 1) {
            rows[0] = load_rows1(row_from);
          } else if constexpr (Count == 2) {
            load_rows2(row_from, rows);
          } else if constexpr (Count == 3) {
            Doubles two[2];
            load_rows2(row_from, two);
            rows[0] = two[0];
            rows[1] = two[1];
            rows[2] = load_rows1([&](int lane) { return row(from + lane) + 2; });
          } else {
            load_rows4(row_from, rows);
          }
        },
        out);
  }
}

/// Position of b minus position of a, subtracted in double.
template <typename T>
[[gnu::always_inline]] inline Vec3<T> load_offset(const NarrowJob& job, const PairBlock<T>& block) {
  const auto position_of = [&](std::uint32_t body) { return numbers(job.poses[body]); };
  if constexpr (Lanes<T>::kCount == 1) {
    const double* const a = position_of(block.pairs[0].a);
    const double* const b = position_of(block.pairs[0].b);
    return {Lanes<T>(b[0] - a[0]), Lanes<T>(b[1] - a[1]), Lanes<T>(b[2] - a[2])};
  } else {
    Lanes<T> d[4];
    in_precision<T>(
        [&](int from, Doubles(&out)[4]) {
          load_differences4([&](int lane) { return position_of(block.pairs[from + lane].b); },
                            [&](int lane) { return position_of(block.pairs[from + lane].a); }, out);
        },
        d);
    return {d[0], d[1], d[2]};
  }
}

/// A quaternion q of any length, and the factor 2 / |q|^2 of the products of its components in a
/// rotation matrix. The factor is NaN if q is not finite, or if |q|^2 is outside 1e-250 to 1e250
/// (in float, 1e-25 to 1e25).
template <typename T>
struct ScaledQuaternion {
  Lanes<T> w;
  Vec3<T> v;
  Lanes<T> scale;
};

template <typename Side, typename T>
[[gnu::always_inline]] inline ScaledQuaternion<T> load_turn(const NarrowJob& job,
                                                            const PairBlock<T>& block) {
  constexpr T limit = sizeof(T) == sizeof(double) ? T(1e250) : T(1e25F);
  Lanes<T> q[4];
  load_columns(
      [&](int lane) { return job.poses[Side::body(block.pairs[lane])].orientation.data(); }, q);
  const Lanes<T> norm = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  const LaneMask<T> usable = (norm > Lanes<T>(T(1) / limit)) & (norm < Lanes<T>(limit));
  const Lanes<T> scale = select(usable, Lanes<T>(T(2)) / norm, Lanes<T>(T(__builtin_nan(""))));
  return {q[0], {q[1], q[2], q[3]}, scale};
}

/// The local z axis in world axes.
template <typename T>
[[gnu::always_inline]] inline Vec3<T> axis_z(const ScaledQuaternion<T>& q) {
  return {(q.v.x * q.v.z + q.w * q.v.y) * q.scale, (q.v.y * q.v.z - q.w * q.v.x) * q.scale,
          Lanes<T>(T(1)) - (q.v.x * q.v.x + q.v.y * q.v.y) * q.scale};
}

/// A rotation given by the images of the local axes.
template <typename T>
struct Rotation {
  Vec3<T> x;
  Vec3<T> y;
  Vec3<T> z;

  /// Rotates from the body's axes to the world's.
  [[gnu::always_inline]] Vec3<T> to_world(const Vec3<T>& v) const {
    return x * v.x + y * v.y + z * v.z;
  }
  [[gnu::always_inline]] Vec3<T> to_local(const Vec3<T>& v) const {
    return {dot(x, v), dot(y, v), dot(z, v)};
  }
};

template <typename T>
[[gnu::always_inline]] inline Rotation<T> rotation(const ScaledQuaternion<T>& q) {
  const Lanes<T> one(T(1));
  const Vec3<T> v = q.v * q.scale;
  const Lanes<T> xx = v.x * q.v.x;
  const Lanes<T> yy = v.y * q.v.y;
  const Lanes<T> zz = v.z * q.v.z;
  const Lanes<T> xy = v.x * q.v.y;
  const Lanes<T> xz = v.x * q.v.z;
  const Lanes<T> yz = v.y * q.v.z;
  const Vec3<T> w = v * q.w;
  return {{one - (yy + zz), xy + w.z, xz - w.y},
          {xy - w.z, one - (xx + zz), yz + w.x},
          {xz + w.y, yz - w.x, one - (xx + yy)}};
}

template <typename Side, typename T>
[[gnu::always_inline]] inline std::uint32_t shape_index(const NarrowJob& job,
                                                        const PairBlock<T>& block, int lane) {
  return job.shapes[Side::body(block.pairs[lane])].index();
}

template <typename T>
struct CapsuleLanes {
  Lanes<T> radius;
  Lanes<T> half_length;
};

template <typename T>
struct BoxLanes {
  Vec3<T> half;
  Lanes<T> rounding;
};

/// Cylinders and cones, which have the same parameters.
template <typename T>
struct RevolvedLanes {
  Lanes<T> radius;
  Lanes<T> half_length;
  Lanes<T> rounding;
};

/// In the triangle's own frame.
template <typename T>
struct TriangleLanes {
  Vec3<T> vertex[3];
  Lanes<T> rounding;
};

/// normal . x <= offset in the half-space's own frame.
template <typename T>
struct HalfSpaceLanes {
  Vec3<T> normal;
  Lanes<T> offset;
};

/// Loads the parameters of the pairs' shapes, `Count` doubles each, from `table`.
template <typename Side, int Count, typename T, typename Shape>
[[gnu::always_inline]] inline void load_shapes(const NarrowJob& job, const PairBlock<T>& block,
                                               const Shape* table, Lanes<T> (&out)[Count]) {
  static_assert(sizeof(Shape) == Count * sizeof(double));
  load_columns([&](int lane) { return numbers(table[shape_index<Side>(job, block, lane)]); }, out);
}

template <typename Side, typename T>
[[gnu::always_inline]] inline Lanes<T> load_sphere(const NarrowJob& job,
                                                   const PairBlock<T>& block) {
  Lanes<T> r[1];
  load_shapes<Side>(job, block, job.tables->spheres, r);
  return r[0];
}

template <typename Side, typename T>
[[gnu::always_inline]] inline CapsuleLanes<T> load_capsule(const NarrowJob& job,
                                                           const PairBlock<T>& block) {
  Lanes<T> r[2];
  load_shapes<Side>(job, block, job.tables->capsules, r);
  return {r[0], r[1]};
}

template <typename Side, typename T>
[[gnu::always_inline]] inline BoxLanes<T> load_box(const NarrowJob& job,
                                                   const PairBlock<T>& block) {
  Lanes<T> r[4];
  load_shapes<Side>(job, block, job.tables->boxes, r);
  return {{r[0], r[1], r[2]}, r[3]};
}

template <typename Side, typename T>
[[gnu::always_inline]] inline HalfSpaceLanes<T> load_half_space(const NarrowJob& job,
                                                                const PairBlock<T>& block) {
  Lanes<T> r[4];
  load_shapes<Side>(job, block, job.tables->half_spaces, r);
  return {{r[0], r[1], r[2]}, r[3]};
}

template <typename Side, typename T, typename Shape>
[[gnu::always_inline]] inline RevolvedLanes<T> load_revolved(const NarrowJob& job,
                                                             const PairBlock<T>& block,
                                                             const Shape* table) {
  Lanes<T> r[3];
  load_shapes<Side>(job, block, table, r);
  return {r[0], r[1], r[2]};
}

template <typename Side, typename T>
[[gnu::always_inline]] inline TriangleLanes<T> load_triangle(const NarrowJob& job,
                                                             const PairBlock<T>& block) {
  const auto row = [&](int lane) {
    return numbers(job.tables->triangles[shape_index<Side>(job, block, lane)]);
  };
  Lanes<T> r[2][4];
  Lanes<T> last[2];
  for (int part = 0; part < 2; ++part) {
    load_columns([&](int lane) { return row(lane) + 4 * part; }, r[part]);
  }
  load_columns([&](int lane) { return row(lane) + 8; }, last);
  return {{{r[0][0], r[0][1], r[0][2]}, {r[0][3], r[1][0], r[1][1]}, {r[1][2], r[1][3], last[0]}},
          last[1]};
}

}  // namespace winnow::WINNOW_ISA_NAME
