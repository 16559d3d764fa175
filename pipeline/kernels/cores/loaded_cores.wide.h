#pragma once

// Loads the shapes of a block of pairs as cores in float lanes. For hulls and user shapes only
// their bounds are loaded, not their points. Used by overlap_test.wide.h.

#include "pipeline/kernels/cores/core_lanes.wide.h"
#include "pipeline/kernels/cores/hull_core.wide.h"
#include "pipeline/kernels/pair_lanes.wide.h"

namespace winnow::WINNOW_ISA_NAME::hull {

struct LoadedCores {
  CoreLanes<float> core;
  Floats rounding;
  /// Upper bound of the distance of the core's points from its origin.
  Floats reach;
  /// A central point of the core, and the radius of a ball around it that is inside the core;
  /// negative if no point of the core is available.
  Vec3<float> center;
  Floats inner;
};

/// User shapes: no point is available without calling the support function.
inline constexpr float kNoInner = -1e30F;

/// Loads floats from the shapes of a block, lane by lane: numbers_of(shape index, out) writes the
/// numbers of one shape.
template <typename Side, int Count, typename NumbersOf>
[[gnu::always_inline]] static inline void stage_numbers(const NarrowJob& job,
                                                        const PairBlock<float>& block,
                                                        NumbersOf&& numbers_of,
                                                        Floats (&out)[Count]) {
  alignas(64) float column[Count][Floats::kCount];
  // A single pair is loaded only once.
  const int lanes = block.count == 1 ? 1 : Floats::kCount;
  for (int lane = 0; lane < lanes; ++lane) {
    double number[Count];
    numbers_of(shape_index<Side>(job, block, lane), number);
    for (int k = 0; k < Count; ++k) column[k][lane] = static_cast<float>(number[k]);
  }
  for (int k = 0; k < Count; ++k) {
    out[k] = lanes == 1 ? Floats(column[k][0]) : Floats::load(column[k]);
  }
}

template <typename Side>
[[gnu::noinline]] static void load_hulls(const NarrowJob& job, const PairBlock<float>& block,
                                         LoadedCores& to) {
  Floats r[6];
  stage_numbers<Side>(
      job, block,
      [&](std::uint32_t i, double* out) {
        const HullShape& hull = job.tables->hulls[i];
        for (int k = 0; k < 3; ++k) out[k] = hull.center[k];
        out[3] = hull.rounding;
        out[4] = reach_of(hull);
        out[5] = hull.inner_radius;
      },
      r);
  to.center = {r[0], r[1], r[2]};
  to.rounding = r[3];
  to.reach = r[4];
  to.inner = r[5];
}

template <typename Side>
[[gnu::noinline]] static void load_user_shapes(const NarrowJob& job, const PairBlock<float>& block,
                                               LoadedCores& to) {
  Floats r[2];
  stage_numbers<Side>(
      job, block,
      [&](std::uint32_t i, double* out) {
        out[0] = job.tables->supports[i].rounding;
        out[1] = job.tables->supports[i].radius;
      },
      r);
  to.rounding = r[0];
  to.reach = r[1];
  to.inner = Floats(kNoInner);
}

template <typename Side>
[[gnu::always_inline]] static inline void load_boxes(const NarrowJob& job,
                                                     const PairBlock<float>& block,
                                                     LoadedCores& to) {
  const BoxLanes<float> box = load_box<Side>(job, block);
  Floats* n = to.core.number;
  n[0] = box.half.x;
  n[1] = box.half.y;
  n[2] = box.half.z;
  to.rounding = box.rounding;
  to.inner = min(min(n[0], n[1]), n[2]);
}

template <typename Side>
[[gnu::always_inline]] static inline void load_capsules(const NarrowJob& job,
                                                        const PairBlock<float>& block,
                                                        LoadedCores& to) {
  const CapsuleLanes<float> capsule = load_capsule<Side>(job, block);
  to.core.number[2] = capsule.half_length;
  to.rounding = capsule.radius;
}

template <typename Side, typename Shape>
[[gnu::always_inline]] static inline void load_revolved_cores(const NarrowJob& job,
                                                              const PairBlock<float>& block,
                                                              const Shape* table, LoadedCores& to) {
  const RevolvedLanes<float> revolved = load_revolved<Side>(job, block, table);
  Floats* n = to.core.number;
  n[0] = revolved.radius;
  n[2] = revolved.half_length;
  to.rounding = revolved.rounding;
  to.inner = min(n[0], n[2]);
  if constexpr (__is_same(Shape, ConeShape)) {
    // The distance of the side from the middle of the axis.
    const Floats height = n[2] + n[2];
    const Floats slant = sqrt(n[0] * n[0] + height * height);
    to.inner = n[0] * (n[2] / max(slant, Floats(kMinAcross<float>)));
  }
}

template <typename Side>
[[gnu::always_inline]] static inline void load_ellipsoids(const NarrowJob& job,
                                                          const PairBlock<float>& block,
                                                          LoadedCores& to) {
  Floats r[4];
  load_shapes<Side>(job, block, job.tables->ellipsoids, r);
  const Floats most = max(max(r[0], r[1]), r[2]);
  const Floats least = min(min(r[0], r[1]), r[2]);
  const Floats zero(0.0F);
  const Floats off = select(most > zero, least * (least / most), zero);
  for (int k = 0; k < 3; ++k) to.core.number[k] = r[k];
  to.core.number[3] = off;
  to.rounding = r[3] + off;
  to.inner = least - off;
}

template <typename Side>
[[gnu::always_inline]] static inline void load_tapers(const NarrowJob& job,
                                                      const PairBlock<float>& block,
                                                      LoadedCores& to) {
  Floats r[3];
  load_shapes<Side>(job, block, job.tables->tapered_capsules, r);
  const Floats zero(0.0F);
  const Floats more = abs(r[1] - r[0]);
  const LaneMask<float> is_ball = more >= r[2] + r[2];
  Floats* n = to.core.number;
  n[0] = select(is_ball, zero, more);
  n[1] = select(r[1] > r[0], r[2], -r[2]);
  n[2] = select(is_ball, n[1], -n[1]);
  to.rounding = select(is_ball, max(r[0], r[1]), min(r[0], r[1]));
  to.center = {zero, zero, select(is_ball, n[1], zero)};
  to.reach = n[0] + r[2];
}

template <typename Side>
[[gnu::always_inline]] static inline void load_triangles(const NarrowJob& job,
                                                         const PairBlock<float>& block,
                                                         LoadedCores& to) {
  const TriangleLanes<float> triangle = load_triangle<Side>(job, block);
  const Vec3<float>* v = triangle.vertex;
  for (int i = 0; i < 3; ++i) {
    to.core.number[3 * i] = v[i].x;
    to.core.number[3 * i + 1] = v[i].y;
    to.core.number[3 * i + 2] = v[i].z;
  }
  to.rounding = triangle.rounding;
  to.center = (v[0] + v[1] + v[2]) * Floats(1.0F / 3.0F);
  to.reach = max(max(norm_l1(v[0]), norm_l1(v[1])), norm_l1(v[2]));
}

/// All shapes are of one kind.
template <typename Side>
[[gnu::noinline]] static void load_cores(const NarrowJob& job, const PairBlock<float>& block,
                                         ShapeKind kind, LoadedCores& to) {
  const Floats zero(0.0F);
  Floats* n = to.core.number;
  for (int i = 0; i < kCoreNumbers; ++i) n[i] = zero;
  to.core.kind = kind;
  to.center = {zero, zero, zero};
  to.inner = zero;
  switch (kind) {
    case ShapeKind::sphere:
      to.rounding = load_sphere<Side>(job, block);
      break;
    case ShapeKind::capsule:
      load_capsules<Side>(job, block, to);
      break;
    case ShapeKind::box:
      load_boxes<Side>(job, block, to);
      break;
    case ShapeKind::cylinder:
      load_revolved_cores<Side>(job, block, job.tables->cylinders, to);
      break;
    case ShapeKind::cone:
      load_revolved_cores<Side>(job, block, job.tables->cones, to);
      break;
    case ShapeKind::ellipsoid:
      load_ellipsoids<Side>(job, block, to);
      break;
    case ShapeKind::tapered_capsule:
      return load_tapers<Side>(job, block, to);
    case ShapeKind::triangle:
      return load_triangles<Side>(job, block, to);
    case ShapeKind::support:
      return load_user_shapes<Side>(job, block, to);
    default:
      return load_hulls<Side>(job, block, to);
  }
  to.reach = n[0] + n[1] + n[2];
}

}  // namespace winnow::WINNOW_ISA_NAME::hull
