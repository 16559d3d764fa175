#pragma once

// The numbers of the shapes of a block's pairs, in the order in which the structs hold them.

#include "pipeline/kernels/gather.wide.h"

namespace winnow::WINNOW_ISA_NAME {

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

template <typename Side, typename T>
[[gnu::always_inline]] inline Lanes<T> load_sphere(const NarrowJob& job,
                                                   const PairBlock<T>& block) {
  Lanes<T> r[1];
  in_precision<T>(
      [&](int from, Doubles(&out)[1]) {
        out[0] = load_rows1([&](int lane) {
          return &job.tables.spheres[shape_index<Side>(job, block, from + lane)].radius;
        });
      },
      r);
  return r[0];
}

template <typename Side, typename T>
[[gnu::always_inline]] inline CapsuleLanes<T> load_capsule(const NarrowJob& job,
                                                           const PairBlock<T>& block) {
  Lanes<T> r[2];
  in_precision<T>(
      [&](int from, Doubles(&out)[2]) {
        load_rows2(
            [&](int lane) {
              return numbers(job.tables.capsules[shape_index<Side>(job, block, from + lane)]);
            },
            out);
      },
      r);
  return {r[0], r[1]};
}

template <typename Side, typename T>
[[gnu::always_inline]] inline BoxLanes<T> load_box(const NarrowJob& job,
                                                   const PairBlock<T>& block) {
  Lanes<T> r[4];
  in_precision<T>(
      [&](int from, Doubles(&out)[4]) {
        load_rows4(
            [&](int lane) {
              return numbers(job.tables.boxes[shape_index<Side>(job, block, from + lane)]);
            },
            out);
      },
      r);
  return {{r[0], r[1], r[2]}, r[3]};
}

template <typename Side, typename T>
[[gnu::always_inline]] inline TriangleLanes<T> load_triangle(const NarrowJob& job,
                                                             const PairBlock<T>& block) {
  const auto row = [&](int lane) {
    return numbers(job.tables.triangles[shape_index<Side>(job, block, lane)]);
  };
  Lanes<T> r[10];
  in_precision<T>(
      [&](int from, Doubles(&out)[10]) {
        Doubles quad[4];
        for (int part = 0; part < 2; ++part) {
          load_rows4([&](int lane) { return row(from + lane) + 4 * part; }, quad);
          for (int k = 0; k < 4; ++k) out[4 * part + k] = quad[k];
        }
        Doubles two[2];
        load_rows2([&](int lane) { return row(from + lane) + 8; }, two);
        out[8] = two[0];
        out[9] = two[1];
      },
      r);
  return {{{r[0], r[1], r[2]}, {r[3], r[4], r[5]}, {r[6], r[7], r[8]}}, r[9]};
}

template <typename Side, typename T>
[[gnu::always_inline]] inline HalfSpaceLanes<T> load_half_space(const NarrowJob& job,
                                                                const PairBlock<T>& block) {
  Lanes<T> r[4];
  in_precision<T>(
      [&](int from, Doubles(&out)[4]) {
        load_rows4(
            [&](int lane) {
              return numbers(job.tables.half_spaces[shape_index<Side>(job, block, from + lane)]);
            },
            out);
      },
      r);
  return {{r[0], r[1], r[2]}, r[3]};
}

}  // namespace winnow::WINNOW_ISA_NAME
