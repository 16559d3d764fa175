#pragma once

// The kinds of cores in kernels, one struct for each: its numbers, its support point in lanes and
// one at a time, and its supporting feature. Called through with_core, the only branch by kind.
// For half-spaces and kinds without kernels, with_core calls the functions of hulls, which no
// kernel reaches. Features are numbered as in solver/manifold.cpp.

#include "pipeline/kernels/cores/core_lanes.wide.h"
#include "pipeline/kernels/cores/hull_core.wide.h"
#include "pipeline/kernels/pair_lanes.wide.h"
#include "pipeline/kernels/user_support.wide.h"
#include "pipeline/kinds/with_shape.h"
#include "pipeline/manifold/feature_rules.h"

namespace winnow::WINNOW_ISA_NAME::hull {

/// User shapes: no point is available without calling the support function.
inline constexpr float kNoInner = -1e30F;

/// If the component of a direction perpendicular to an axis is shorter, the direction counts as
/// parallel to the axis.
template <typename T>
inline constexpr T kMinAcross = sizeof(T) == sizeof(double) ? T(1e-150) : T(1e-30F);

/// Cosines of the angles of a rim's corners. The sine is the cosine a quarter turn earlier.
inline constexpr double kRimCosine[kRimCorners] = {
    1.0,  0.92387953251128674,  0.70710678118654757,  0.38268343236508978,
    0.0,  -0.38268343236508978, -0.70710678118654757, -0.92387953251128674,
    -1.0, -0.92387953251128674, -0.70710678118654757, -0.38268343236508978,
    0.0,  0.38268343236508978,  0.70710678118654757,  0.92387953251128674};
constexpr double rim_sine(std::uint32_t i) {
  return kRimCosine[(i + 3 * kRimCorners / 4) % kRimCorners];
}

template <typename T>
[[gnu::always_inline]] static inline Lanes<T> towards(const Lanes<T>& along, const Lanes<T>& half) {
  return select(along < Lanes<T>(T(0)), -half, half);
}
static inline double towards(double along, double half) {
  return along < 0.0 ? -half : half;
}

/// The side of a point along an axis, for feature numbers: 1 or -1 at the ends, else 0.
static inline int side_of(const CoreDesc& core, const double* at, int axis, double size) {
  const double near = core.number[axis] - 1e-9 * size;
  return at[axis] >= near ? 1 : (at[axis] <= -near ? -1 : 0);
}

/// Functions of a core by the struct of its shape. The members of each are:
///
///   kNumbers                        entries of `number` that the kind uses
///   kIsSingle                       the support points of lanes are computed one by one
///   kTouchesInPoint                 the supporting feature is a point
///   load<Side>(job, block, to)      loads a block, of which everything that is 0 is set; returns
///                                   the reach
///   make(tables, i, core)           loads shape i, likewise
///   support(n, d)                   support points of lanes with numbers n; unless kIsSingle
///   farthest(core, d, scale, x)     support point of one core
///   add_feature(core, d, at, patch) adds the supporting feature along d, which contains the point
///                                   `at`, to a CurvedPatch; unless kTouchesInPoint
///   point_feature(core, at, size)   feature number of a single contact point, as in the kernels of
///                                   round shapes
template <typename Shape>
struct KindCore;

struct PlainCore {
  static constexpr int kNumbers = 3;
  static constexpr bool kIsSingle = false;
  static constexpr bool kTouchesInPoint = false;
  static std::uint32_t point_feature(const CoreDesc&, const double*, double) { return 0; }
};

template <>
struct KindCore<SphereShape> : PlainCore {
  static constexpr int kNumbers = 0;
  static constexpr bool kTouchesInPoint = true;

  template <typename Side>
  [[gnu::always_inline]] static Floats load(const NarrowJob& job, const PairBlock<float>& block,
                                            LoadedCores& to) {
    to.rounding = load_sphere<Side>(job, block);
    return Floats(0.0F);
  }
  static double make(const ShapeTables& tables, std::uint32_t i, CoreDesc& core) {
    core.rounding = tables.spheres[i].radius;
    return 0.0;
  }
  template <typename T>
  [[gnu::always_inline]] static Vec3<T> support(const Lanes<T>*, const Vec3<T>&) {
    const Lanes<T> zero(T(0));
    return {zero, zero, zero};
  }
  static void farthest(const CoreDesc&, const double*, double, double* x) {
    for (int k = 0; k < 3; ++k) x[k] = 0.0;
  }
};

template <>
struct KindCore<CapsuleShape> : PlainCore {
  template <typename Side>
  [[gnu::always_inline]] static Floats load(const NarrowJob& job, const PairBlock<float>& block,
                                            LoadedCores& to) {
    const CapsuleLanes<float> capsule = load_capsule<Side>(job, block);
    to.core.number[2] = capsule.half_length;
    to.rounding = capsule.radius;
    return capsule.half_length;
  }
  static double make(const ShapeTables& tables, std::uint32_t i, CoreDesc& core) {
    core.number[2] = tables.capsules[i].half_length;
    core.rounding = tables.capsules[i].radius;
    return core.number[2];
  }
  template <typename T>
  [[gnu::always_inline]] static Vec3<T> support(const Lanes<T>* n, const Vec3<T>& d) {
    const Lanes<T> zero(T(0));
    return {zero, zero, towards(d.z, n[2])};
  }
  static void farthest(const CoreDesc& core, const double* d, double, double* x) {
    x[0] = 0.0;
    x[1] = 0.0;
    x[2] = towards(d[2], core.number[2]);
  }
  template <typename Patch>
  static void add_feature(const CoreDesc& core, const double*, const double*, Patch& patch) {
    const double half = core.number[2];
    patch.add({0.0, 0.0, -half}, 0, 0);
    if (half > 0.0) patch.add({0.0, 0.0, half}, 1, 0);
  }
  static std::uint32_t point_feature(const CoreDesc& core, const double* at, double size) {
    const int side = side_of(core, at, 2, size);
    return side == 0 ? 0 : (side > 0 ? 1 : 2);
  }
};

template <>
struct KindCore<BoxShape> : PlainCore {
  /// Corners of the faces, counter-clockwise seen from outside. Bit i of a corner's number is set
  /// on the positive side of axis i. Face 2 i + 1 is the positive face of axis i.
  static constexpr std::uint32_t kFace[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                                {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};

  /// Returns the edge between two corners. Edges 4 i to 4 i + 3 are parallel to axis i.
  static constexpr std::uint32_t edge_between(std::uint32_t p, std::uint32_t q) {
    const std::uint32_t along = p ^ q;
    const std::uint32_t low = p & q;
    if (along == 1) return low >> 1U;
    if (along == 2) return 4 + (low & 1U) + (low >> 2U << 1U);
    return 8 + low;
  }

  template <typename Side>
  [[gnu::always_inline]] static Floats load(const NarrowJob& job, const PairBlock<float>& block,
                                            LoadedCores& to) {
    const BoxLanes<float> box = load_box<Side>(job, block);
    Floats* n = to.core.number;
    n[0] = box.half.x;
    n[1] = box.half.y;
    n[2] = box.half.z;
    to.rounding = box.rounding;
    to.inner = min(min(n[0], n[1]), n[2]);
    return n[0] + n[1] + n[2];
  }
  static double make(const ShapeTables& tables, std::uint32_t i, CoreDesc& core) {
    double* n = core.number;
    for (int k = 0; k < 3; ++k) n[k] = tables.boxes[i].half[k];
    core.rounding = tables.boxes[i].rounding;
    return n[0] + n[1] + n[2];
  }
  template <typename T>
  [[gnu::always_inline]] static Vec3<T> support(const Lanes<T>* n, const Vec3<T>& d) {
    return {towards(d.x, n[0]), towards(d.y, n[1]), towards(d.z, n[2])};
  }
  static void farthest(const CoreDesc& core, const double* d, double, double* x) {
    for (int k = 0; k < 3; ++k) x[k] = towards(d[k], core.number[k]);
  }
  template <typename Patch>
  static void add_feature(const CoreDesc& core, const double* d, const double*, Patch& patch) {
    std::uint32_t axis = 0;
    for (std::uint32_t k = 1; k < 3; ++k) {
      if (__builtin_fabs(d[k]) > __builtin_fabs(d[axis])) axis = k;
    }
    const std::uint32_t face = 2 * axis + (d[axis] > 0.0 ? 1U : 0U);
    const double* h = core.number;
    patch.set_feature(face);
    for (int i = 0; i < 4; ++i) {
      const std::uint32_t corner = kFace[face][i];
      const std::uint32_t next = kFace[face][(i + 1) % 4];
      patch.add({(corner & 1U) != 0 ? h[0] : -h[0], (corner & 2U) != 0 ? h[1] : -h[1],
                 (corner & 4U) != 0 ? h[2] : -h[2]},
                corner, edge_between(corner, next));
    }
  }
  static std::uint32_t point_feature(const CoreDesc& core, const double* at, double size) {
    const auto side = [&](int axis) { return side_of(core, at, axis, size); };
    return static_cast<std::uint32_t>(13 + side(0) + 3 * side(1) + 9 * side(2));
  }
};

template <>
struct KindCore<TriangleShape> : PlainCore {
  static constexpr int kNumbers = kCoreNumbers;

  template <typename Side>
  [[gnu::always_inline]] static Floats load(const NarrowJob& job, const PairBlock<float>& block,
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
    return max(max(norm_l1(v[0]), norm_l1(v[1])), norm_l1(v[2]));
  }
  static double make(const ShapeTables& tables, std::uint32_t i, CoreDesc& core) {
    const TriangleShape& triangle = tables.triangles[i];
    double most = 0.0;
    for (int v = 0; v < 3; ++v) {
      double reach = 0.0;
      for (int k = 0; k < 3; ++k) {
        const double x = triangle.vertex[v][k];
        core.number[3 * v + k] = x;
        core.center[k] += x / 3.0;
        reach += __builtin_fabs(x);
      }
      most = largest_of(most, reach);
    }
    core.rounding = triangle.rounding;
    return most;
  }
  template <typename T>
  [[gnu::always_inline]] static Vec3<T> support(const Lanes<T>* n, const Vec3<T>& d) {
    const Vec3<T> v[3] = {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}, {n[6], n[7], n[8]}};
    const Lanes<T> h[3] = {dot(v[0], d), dot(v[1], d), dot(v[2], d)};
    const LaneMask<T> second = h[1] > h[0];
    const LaneMask<T> third = h[2] > max(h[0], h[1]);
    return select(third, v[2], select(second, v[1], v[0]));
  }
  static void farthest(const CoreDesc& core, const double* d, double, double* x) {
    const double* n = core.number;
    const double h[3] = {dot3(n, d), dot3(n + 3, d), dot3(n + 6, d)};
    const int best = h[1] > h[0] ? 1 : 0;
    const int vertex = h[2] > h[best] ? 2 : best;
    for (int k = 0; k < 3; ++k) x[k] = n[3 * vertex + k];
  }
  template <typename Patch>
  static void add_feature(const CoreDesc& core, const double*, const double*, Patch& patch) {
    for (std::uint32_t i = 0; i < 3; ++i) {
      const double* v = core.number + 3 * i;
      patch.add({v[0], v[1], v[2]}, i, i);
    }
  }
};

/// The point of a rim at height z in the direction of d; the center of the rim if d is along the
/// axis.
template <typename T>
[[gnu::always_inline]] static inline Vec3<T> rim_point(const Lanes<T>& radius, const Vec3<T>& d,
                                                       const Lanes<T>& across, const Lanes<T>& z) {
  const Lanes<T> over = radius / max(across, Lanes<T>(kMinAcross<T>));
  return {d.x * over, d.y * over, z};
}

/// A cylinder, or a cone, which has only the lower cap.
template <typename Shape>
struct RevolvedCore : PlainCore {
  static constexpr bool kIsCone = __is_same(Shape, ConeShape);

  template <typename Side>
  [[gnu::always_inline]] static Floats load(const NarrowJob& job, const PairBlock<float>& block,
                                            LoadedCores& to) {
    const RevolvedLanes<float> revolved =
        load_revolved<Side>(job, block, KindOf<Shape>::in(*job.tables));
    Floats* n = to.core.number;
    n[0] = revolved.radius;
    n[2] = revolved.half_length;
    to.rounding = revolved.rounding;
    to.inner = min(n[0], n[2]);
    if constexpr (kIsCone) {
      // The distance of the side from the middle of the axis.
      const Floats height = n[2] + n[2];
      const Floats slant = sqrt(n[0] * n[0] + height * height);
      to.inner = n[0] * (n[2] / max(slant, Floats(kMinAcross<float>)));
    }
    return n[0] + n[2];
  }
  static double make(const ShapeTables& tables, std::uint32_t i, CoreDesc& core) {
    const Shape& shape = KindOf<Shape>::in(tables)[i];
    core.number[0] = shape.radius;
    core.number[2] = shape.half_length;
    core.rounding = shape.rounding;
    return core.number[0] + core.number[2];
  }
  template <typename T>
  [[gnu::always_inline]] static Vec3<T> support(const Lanes<T>* n, const Vec3<T>& d) {
    const Lanes<T> across = sqrt(d.x * d.x + d.y * d.y);
    if constexpr (kIsCone) {
      const Lanes<T> zero(T(0));
      const Lanes<T> tip = n[2] * d.z;
      const LaneMask<T> on_tip = tip >= n[0] * across - tip;
      const Vec3<T> rim = rim_point(n[0], d, across, -n[2]);
      return select(on_tip, Vec3<T>{zero, zero, n[2]}, rim);
    } else {
      return rim_point(n[0], d, across, towards(d.z, n[2]));
    }
  }
  static void farthest(const CoreDesc& core, const double* d, double, double* x) {
    const double* n = core.number;
    const double across = __builtin_sqrt(d[0] * d[0] + d[1] * d[1]);
    const double tip = n[2] * d[2];
    const bool on_tip = kIsCone && tip >= n[0] * across - tip;
    const double over = on_tip ? 0.0 : n[0] / largest_of(across, kMinAcross<double>);
    x[0] = d[0] * over;
    x[1] = d[1] * over;
    x[2] = kIsCone ? (on_tip ? n[2] : -n[2]) : towards(d[2], n[2]);
  }
  template <typename Patch>
  static void add_feature(const CoreDesc& core, const double* d, const double*, Patch& patch) {
    const double r = core.number[0];
    const double h = core.number[2];
    const double across = __builtin_sqrt(d[0] * d[0] + d[1] * d[1]);
    const bool has_side = across > kAlongAxis;
    const double out[2] = {has_side ? d[0] / across : 1.0, has_side ? d[1] / across : 0.0};
    const bool on_tip = kIsCone && h * d[2] >= r * across - h * d[2];
    const double over_cap = kIsCone ? -d[2] : __builtin_fabs(d[2]);
    if (over_cap > kCapCosine && r > 0.0) return add_cap(r, d[2] > 0.0 ? h : -h, patch);
    const double top = kIsCone ? 0.0 : r;
    patch.set_feature(kSideLine);
    patch.add({out[0] * top, out[1] * top, h}, kSideLine, kSideLine);
    if (on_tip && !has_side) return;
    patch.add({out[0] * r, out[1] * r, -h}, kSideLine + 1, kSideLine);
  }
  template <typename Patch>
  static void add_cap(double radius, double z, Patch& patch) {
    const std::uint32_t feature = z > 0.0 ? 0 : kRimCorners;
    patch.set_feature(feature);
    for (std::uint32_t i = 0; i < kRimCorners; ++i) {
      patch.add({radius * kRimCosine[i], radius * rim_sine(i), z}, feature + i, feature + i);
    }
  }
};

template <>
struct KindCore<CylinderShape> : RevolvedCore<CylinderShape> {};
template <>
struct KindCore<ConeShape> : RevolvedCore<ConeShape> {};

/// An ellipsoid without its least radius of curvature, which is added to the rounding.
template <>
struct KindCore<EllipsoidShape> : PlainCore {
  static constexpr int kNumbers = 4;
  static constexpr bool kTouchesInPoint = true;

  template <typename Side>
  [[gnu::always_inline]] static Floats load(const NarrowJob& job, const PairBlock<float>& block,
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
    return r[0] + r[1] + r[2];
  }
  static double make(const ShapeTables& tables, std::uint32_t i, CoreDesc& core) {
    const double* r = tables.ellipsoids[i].radius.data();
    const double most = largest_of(largest_of(r[0], r[1]), r[2]);
    const double least = least_of(least_of(r[0], r[1]), r[2]);
    for (int k = 0; k < 3; ++k) core.number[k] = r[k];
    core.number[3] = most > 0.0 ? least * (least / most) : 0.0;
    core.rounding = tables.ellipsoids[i].rounding + core.number[3];
    return r[0] + r[1] + r[2];
  }
  /// Values are relative to the largest product, so that no relevant square underflows.
  template <typename T>
  [[gnu::always_inline]] static Vec3<T> support(const Lanes<T>* n, const Vec3<T>& d) {
    const Vec3<T> stretched{n[0] * d.x, n[1] * d.y, n[2] * d.z};
    const Lanes<T> most = max(max(abs(stretched.x), abs(stretched.y)), abs(stretched.z));
    const Vec3<T> share = stretched * (Lanes<T>(T(1)) / max(most, Lanes<T>(kMinAcross<T>)));
    const Lanes<T> over = Lanes<T>(T(1)) / max(sqrt(dot(share, share)), Lanes<T>(T(1)));
    const Lanes<T> off = n[3] / max(sqrt(dot(d, d)), Lanes<T>(kMinAcross<T>));
    return {n[0] * share.x * over - off * d.x, n[1] * share.y * over - off * d.y,
            n[2] * share.z * over - off * d.z};
  }
  static void farthest(const CoreDesc& core, const double* d, double, double* x) {
    const double* n = core.number;
    const double stretched[3] = {n[0] * d[0], n[1] * d[1], n[2] * d[2]};
    const double length = __builtin_sqrt(dot3(stretched, stretched));
    const double over = 1.0 / largest_of(length, kMinAcross<double>);
    const double off = n[3] / __builtin_sqrt(dot3(d, d));
    for (int k = 0; k < 3; ++k) x[k] = n[k] * (stretched[k] * over) - off * d[k];
  }
};

/// A ball and a point, the tip. If one ball of the shape contains the other: the point at the
/// centre of the larger one.
template <>
struct KindCore<TaperedCapsuleShape> : PlainCore {
  template <typename Side>
  [[gnu::always_inline]] static Floats load(const NarrowJob& job, const PairBlock<float>& block,
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
    return n[0] + r[2];
  }
  static double make(const ShapeTables& tables, std::uint32_t i, CoreDesc& core) {
    const TaperedCapsuleShape& s = tables.tapered_capsules[i];
    const double more = __builtin_fabs(s.radius[1] - s.radius[0]);
    const double end = s.radius[1] > s.radius[0] ? s.half_length : -s.half_length;
    const bool is_ball = more >= 2.0 * s.half_length;
    core.number[0] = is_ball ? 0.0 : more;
    core.number[1] = end;
    core.number[2] = is_ball ? end : -end;
    core.center[2] = is_ball ? end : 0.0;
    core.rounding = (s.radius[1] > s.radius[0]) == is_ball ? s.radius[1] : s.radius[0];
    return core.number[0] + s.half_length;
  }
  template <typename T>
  [[gnu::always_inline]] static Vec3<T> support(const Lanes<T>* n, const Vec3<T>& d) {
    const Lanes<T> zero(T(0));
    const Lanes<T> length = sqrt(dot(d, d));
    const LaneMask<T> on_tip = (n[2] - n[1]) * d.z >= n[0] * length;
    const Lanes<T> over = n[0] / max(length, Lanes<T>(kMinAcross<T>));
    return select(on_tip, Vec3<T>{zero, zero, n[2]},
                  Vec3<T>{d.x * over, d.y * over, n[1] + d.z * over});
  }
  static void farthest(const CoreDesc& core, const double* d, double, double* x) {
    const double* n = core.number;
    const double length = __builtin_sqrt(dot3(d, d));
    const bool on_tip = (n[2] - n[1]) * d[2] >= n[0] * length;
    const double over = on_tip ? 0.0 : n[0] / largest_of(length, kMinAcross<double>);
    x[0] = d[0] * over;
    x[1] = d[1] * over;
    x[2] = on_tip ? n[2] : n[1] + d[2] * over;
  }
  /// The line between the balls. A ball inside the other one is not part of it.
  template <typename Patch>
  static void add_feature(const CoreDesc& core, const double* d, const double*, Patch& patch) {
    const double more = core.number[0];
    const double ball = core.number[1];
    const double tip = core.number[2];
    patch.add({more * d[0], more * d[1], ball + more * d[2]}, ball < 0.0 ? 1 : 0, 0);
    if (tip != ball) patch.add({0.0, 0.0, tip}, tip < 0.0 ? 1 : 0, 0);
  }
};

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

template <>
struct KindCore<HullShape> : PlainCore {
  static constexpr int kNumbers = 0;
  static constexpr bool kIsSingle = true;

  template <typename Side>
  [[gnu::noinline]] static Floats load(const NarrowJob& job, const PairBlock<float>& block,
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
    to.inner = r[5];
    return r[4];
  }
  static double make(const ShapeTables& tables, std::uint32_t i, CoreDesc& core) {
    core.hull = &tables.hulls[i];
    core.rounding = core.hull->rounding;
    for (int k = 0; k < 3; ++k) core.center[k] = core.hull->center[k];
    return reach_of(*core.hull);
  }
  template <typename T>
  static void farthest(const CoreDesc& core, const T* d, T scale, T* x) {
    const std::uint32_t vertex = highest_vertex(*core.hull, Vec3<T>{d[0], d[1], d[2]});
    const T* const* column = columns_of(*core.hull, T());
    for (int k = 0; k < 3; ++k) x[k] = column[k][vertex] * scale;
  }
  template <typename Patch>
  static void add_vertex(const HullShape& shape, std::uint32_t vertex, std::uint32_t edge_feature,
                         Patch& patch) {
    const double* const* v = shape.vertex;
    const double scale = patch.scale();
    patch.add({v[0][vertex] * scale, v[1][vertex] * scale, v[2][vertex] * scale}, vertex,
              edge_feature);
  }
  /// Only faces that contain the point `at` can be the feature: if `at` is on an edge, these are
  /// the two faces beside the edge, not the other faces at its ends.
  template <typename Patch>
  static void add_feature(const CoreDesc& core, const double* d, const double* at, Patch& patch) {
    const HullShape& shape = *core.hull;
    const double unit = patch.unit();
    const float direction[3] = {static_cast<float>(d[0]), static_cast<float>(d[1]),
                                static_cast<float>(d[2])};
    const float touched[3] = {static_cast<float>(at[0] * unit), static_cast<float>(at[1] * unit),
                              static_cast<float>(at[2] * unit)};
    const float doubt = kFloatError * static_cast<float>(patch.size() * unit);
    const std::uint32_t face = face_across(shape, d, touched, doubt);
    if (face != kNoFeature) {
      const HullFace& f = shape.faces[face];
      // If the polygon has too many corners, take every second (third, ...) one.
      const std::uint32_t stride = (f.count + kPatchRoom - 1) / kPatchRoom;
      for (std::uint32_t i = 0; i < f.count; i += stride) {
        add_vertex(shape, shape.loop[f.first + i], shape.loop_edge[f.first + i], patch);
      }
      return patch.set_feature(face);
    }
    const std::uint32_t vertex = farthest_vertex(shape, direction);
    float x[3];
    vertex_at(shape, vertex, x);
    const std::uint32_t other = neighbour_across(shape, direction, vertex, x);
    if (other == kNoFeature) {
      add_vertex(shape, vertex, 0, patch);
      return patch.set_feature(shape.face_count + shape.edge_count + vertex);
    }
    const std::uint32_t low = vertex < other ? vertex : other;
    const std::uint32_t high = vertex < other ? other : vertex;
    const std::uint32_t edge = edge_between(shape, low, high);
    add_vertex(shape, low, edge, patch);
    add_vertex(shape, high, edge, patch);
    patch.set_feature(shape.face_count + edge);
  }
  static std::uint32_t edge_between(const HullShape& shape, std::uint32_t low, std::uint32_t high) {
    std::uint32_t edge = 0;
    const auto joins = [&](const HullEdge& e) {
      return (e.vertex[0] == low && e.vertex[1] == high) ||
             (e.vertex[0] == high && e.vertex[1] == low);
    };
    while (edge + 1 < shape.edge_count && !joins(shape.edges[edge])) ++edge;
    return edge;
  }
};

/// Two unit vectors perpendicular to the unit vector d and to each other, stable while d jitters:
/// see kAxisCosine.
static inline void directions_across(const double* d, double (*across)[3]) {
  int axis = 0;
  while (axis < 2 && !(__builtin_fabs(d[axis]) <= kAxisCosine)) ++axis;
  double u[3];
  for (int k = 0; k < 3; ++k) u[k] = (k == axis ? 1.0 : 0.0) - d[axis] * d[k];
  const double length = __builtin_sqrt(dot3(u, u));
  for (double& x : u) x /= length;
  double v[3];
  cross3(d, u, v);
  for (int k = 0; k < 3; ++k) across[0][k] = kOffAxes[0] * u[k] + kOffAxes[1] * v[k];
  cross3(d, across[0], across[1]);
}

template <>
struct KindCore<SupportShape> : PlainCore {
  static constexpr int kNumbers = 0;
  static constexpr bool kIsSingle = true;

  template <typename Side>
  [[gnu::noinline]] static Floats load(const NarrowJob& job, const PairBlock<float>& block,
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
    to.inner = Floats(kNoInner);
    return r[1];
  }
  static double make(const ShapeTables& tables, std::uint32_t i, CoreDesc& core) {
    core.own = &tables.supports[i];
    core.rounding = core.own->rounding;
    return core.own->radius;
  }
  template <typename T>
  static void farthest(const CoreDesc& core, const T* d, T scale, T* x) {
    user_support(*core.own, d, scale, x);
  }
  /// Uses directions that are slightly off, because bodies rock. The corners of a flat face stay
  /// far apart; the points of a round surface are close together, and the farthest of them is kept.
  template <typename Patch>
  static void add_feature(const CoreDesc& core, const double* d, const double*, Patch& patch) {
    constexpr std::uint32_t kSamples = 8;
    const double scale = patch.scale();
    double across[2][3];
    directions_across(d, across);
    const double apart = sample_tolerance(*core.own, across, scale);
    double kept[kSamples][3];
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < kSamples; ++i) {
      const double c = kSampleTilt * kRimCosine[2 * i];
      const double s = kSampleTilt * rim_sine(2 * i);
      double tilted[3];
      for (int k = 0; k < 3; ++k) tilted[k] = d[k] + across[0][k] * c + across[1][k] * s;
      double x[3];
      farthest(core, tilted, scale, x);
      std::uint32_t at = 0;
      while (at < count && !(distance_of(x, kept[at]) <= apart)) ++at;
      if (at < count && !(dot3(d, x) > dot3(d, kept[at]))) continue;
      for (int k = 0; k < 3; ++k) kept[at][k] = x[k];
      count = at < count ? count : count + 1;
    }
    if (count == 1) farthest(core, d, scale, kept[0]);
    count = keep_coplanar(kept, count);
    for (std::uint32_t i = 0; i < count; ++i) {
      patch.add({kept[i][0], kept[i][1], kept[i][2]}, i, i);
    }
  }
  /// Keeps the points that are in the plane of point 0, the point farthest from it, and the point
  /// with which these two span the largest triangle. Returns their number.
  static std::uint32_t keep_coplanar(double (*x)[3], std::uint32_t count) {
    if (count < 4) return count;
    std::uint32_t far = 1;
    for (std::uint32_t i = 2; i < count; ++i) {
      if (distance_of(x[i], x[0]) > distance_of(x[far], x[0])) far = i;
    }
    double normal[3] = {};
    for (std::uint32_t i = 1; i < count; ++i) {
      double e[3];
      double f[3];
      double n[3];
      for (int k = 0; k < 3; ++k) {
        e[k] = x[far][k] - x[0][k];
        f[k] = x[i][k] - x[0][k];
      }
      cross3(e, f, n);
      if (!(dot3(n, n) > dot3(normal, normal))) continue;
      for (int k = 0; k < 3; ++k) normal[k] = n[k];
    }
    const double level =
        kSampleLevel * distance_of(x[far], x[0]) * __builtin_sqrt(dot3(normal, normal));
    const double base = dot3(normal, x[0]);
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      if (__builtin_fabs(dot3(normal, x[i]) - base) > level) continue;
      for (int k = 0; k < 3; ++k) x[kept][k] = x[i][k];
      ++kept;
    }
    return kept;
  }
  static double distance_of(const double* x, const double* y) {
    const double d[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
    return __builtin_sqrt(dot3(d, d));
  }
};

/// Calls visit(KindCore<Shape>) for a kind, and returns its result.
template <typename Visit>
[[gnu::always_inline]] constexpr decltype(auto) with_core(ShapeKind kind, Visit&& visit) {
  return with_kind(
      kind, [&](auto of) __attribute__((always_inline))->decltype(auto) {
        using Shape = typename decltype(of)::Shape;
        if constexpr (requires { sizeof(KindCore<Shape>); }) {
          return visit(KindCore<Shape>{});
        } else {
          return visit(KindCore<HullShape>{});
        }
      });
}

/// The number of entries of `number` that a kind uses.
constexpr int core_numbers(ShapeKind kind) {
  return with_core(kind, [](auto core) { return decltype(core)::kNumbers; });
}
/// True for hulls and user shapes, the support points of which are computed one by one.
constexpr bool is_single(ShapeKind kind) {
  return with_core(kind, [](auto core) { return decltype(core)::kIsSingle; });
}

/// Returns the support point of a core along d, in its frame; `one_by_one` computes it for hulls
/// and user shapes.
template <typename T, typename OneByOne>
[[gnu::always_inline]] static inline Vec3<T> support(const CoreLanes<T>& core, const Vec3<T>& d,
                                                     OneByOne&& one_by_one) {
  return with_core(
      core.kind, [&](auto kind) __attribute__((always_inline))->Vec3<T> {
        if constexpr (decltype(kind)::kIsSingle) {
          return one_by_one(d);
        } else {
          return kind.support(core.number, d);
        }
      });
}

/// Loads the cores of a block; all shapes are of one kind.
template <typename Side>
[[gnu::noinline]] static void load_cores(const NarrowJob& job, const PairBlock<float>& block,
                                         ShapeKind kind, LoadedCores& to) {
  const Floats zero(0.0F);
  for (Floats& n : to.core.number) n = zero;
  to.core.kind = kind;
  to.center = {zero, zero, zero};
  to.inner = zero;
  to.reach = with_core(
      kind, [&](auto core) __attribute__((always_inline)) {
        return core.template load<Side>(job, block, to);
      });
}

/// Sets the core of one shape, without scaling, and returns an upper bound on the distance of its
/// points from its origin.
static inline double make_core(const ShapeTables& tables, ShapeId id, CoreDesc& core) {
  core.kind = id.kind();
  core.hull = nullptr;
  core.own = nullptr;
  for (double& x : core.number) x = 0.0;
  for (double& x : core.center) x = 0.0;
  return with_core(core.kind, [&](auto kind) { return kind.make(tables, id.index(), core); });
}

/// The support point of one core along d, in its frame.
static inline void farthest(const CoreDesc& core, const double* d, double scale, double* x) {
  with_core(core.kind, [&](auto kind) { kind.farthest(core, d, scale, x); });
}

/// Support point of a core for which is_single is true.
template <typename T>
static inline void single_support(const CoreDesc& core, const T* d, T scale, T* x) {
  if (core.own != nullptr) {
    KindCore<SupportShape>::farthest(core, d, scale, x);
  } else {
    KindCore<HullShape>::farthest(core, d, scale, x);
  }
}

}  // namespace winnow::WINNOW_ISA_NAME::hull
