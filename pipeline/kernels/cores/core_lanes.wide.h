#pragma once

// Cores of shapes, one per lane, and their support functions.

#include <winnow/pipeline/shapes.h>
#include "simd/lanes/vectors.h"

namespace winnow::WINNOW_ISA_NAME::hull {

inline constexpr int kCoreNumbers = 9;

/// Cores of one kind in their own frames, one per lane.
template <typename T>
struct CoreLanes {
  /// Box: half extents. Capsule, cylinder, cone: radius of the core, 0, half length. Triangle:
  /// three vertices. Ellipsoid: its radii, and the least radius of curvature, which is removed from
  /// the core and added to the rounding. Tapered capsule: the difference of the radii, z of the
  /// larger ball, z of the smaller ball; if the larger ball contains the smaller: 0, and twice z of
  /// the larger ball. Hulls and user shapes have no numbers.
  Lanes<T> number[kCoreNumbers];
  ShapeKind kind;
};

/// The number of entries of `number` that a kind uses.
constexpr int core_numbers(ShapeKind kind) {
  switch (kind) {
    case ShapeKind::sphere:
    case ShapeKind::hull:
    case ShapeKind::support:
      return 0;
    case ShapeKind::triangle:
      return kCoreNumbers;
    case ShapeKind::ellipsoid:
      return 4;
    default:
      return 3;
  }
}

/// If the component of a direction perpendicular to an axis is shorter, the direction counts as
/// parallel to the axis.
template <typename T>
inline constexpr T kMinAcross = sizeof(T) == sizeof(double) ? T(1e-150) : T(1e-30F);

/// The point of a rim at height z in the direction of d; the center of the rim if d is along the
/// axis.
template <typename T>
[[gnu::always_inline]] static inline Vec3<T> rim_point(const Lanes<T>& radius, const Vec3<T>& d,
                                                       const Lanes<T>& across, const Lanes<T>& z) {
  const Lanes<T> over = radius / max(across, Lanes<T>(kMinAcross<T>));
  return {d.x * over, d.y * over, z};
}

/// Support point of an ellipsoid, with n as in CoreLanes::number. Values are relative to the
/// largest product, so that no relevant square underflows.
template <typename T>
[[gnu::always_inline]] static inline Vec3<T> ellipsoid_point(const Lanes<T>* n, const Vec3<T>& d) {
  const Vec3<T> stretched{n[0] * d.x, n[1] * d.y, n[2] * d.z};
  const Lanes<T> most = max(max(abs(stretched.x), abs(stretched.y)), abs(stretched.z));
  const Vec3<T> share = stretched * (Lanes<T>(T(1)) / max(most, Lanes<T>(kMinAcross<T>)));
  const Lanes<T> over = Lanes<T>(T(1)) / max(sqrt(dot(share, share)), Lanes<T>(T(1)));
  const Lanes<T> off = n[3] / max(sqrt(dot(d, d)), Lanes<T>(kMinAcross<T>));
  return {n[0] * share.x * over - off * d.x, n[1] * share.y * over - off * d.y,
          n[2] * share.z * over - off * d.z};
}

/// Support point of a tapered capsule, with n as in CoreLanes::number.
template <typename T>
[[gnu::always_inline]] static inline Vec3<T> taper_point(const Lanes<T>* n, const Vec3<T>& d) {
  const Lanes<T> zero(T(0));
  const Lanes<T> length = sqrt(dot(d, d));
  const LaneMask<T> on_tip = (n[2] - n[1]) * d.z >= n[0] * length;
  const Lanes<T> over = n[0] / max(length, Lanes<T>(kMinAcross<T>));
  return select(on_tip, Vec3<T>{zero, zero, n[2]},
                Vec3<T>{d.x * over, d.y * over, n[1] + d.z * over});
}

/// Returns the support point of a core along d, in its frame; `one_by_one` computes it for hulls
/// and user shapes.
template <typename T, typename OneByOne>
[[gnu::always_inline]] static inline Vec3<T> support(const CoreLanes<T>& core, const Vec3<T>& d,
                                                     OneByOne&& one_by_one) {
  const Lanes<T> zero(T(0));
  const Lanes<T>* n = core.number;
  const auto towards = [&](const Lanes<T>& x, const Lanes<T>& h) {
    return select(x < zero, -h, h);
  };
  switch (core.kind) {
    case ShapeKind::sphere:
      return {zero, zero, zero};
    case ShapeKind::capsule:
      return {zero, zero, towards(d.z, n[2])};
    case ShapeKind::box:
      return {towards(d.x, n[0]), towards(d.y, n[1]), towards(d.z, n[2])};
    case ShapeKind::triangle: {
      const Vec3<T> v[3] = {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}, {n[6], n[7], n[8]}};
      const Lanes<T> h[3] = {dot(v[0], d), dot(v[1], d), dot(v[2], d)};
      const LaneMask<T> second = h[1] > h[0];
      const LaneMask<T> third = h[2] > max(h[0], h[1]);
      return select(third, v[2], select(second, v[1], v[0]));
    }
    case ShapeKind::cylinder:
      return rim_point(n[0], d, sqrt(d.x * d.x + d.y * d.y), towards(d.z, n[2]));
    case ShapeKind::cone: {
      const Lanes<T> across = sqrt(d.x * d.x + d.y * d.y);
      const Lanes<T> tip = n[2] * d.z;
      const LaneMask<T> on_tip = tip >= n[0] * across - tip;
      const Vec3<T> rim = rim_point(n[0], d, across, -n[2]);
      return select(on_tip, Vec3<T>{zero, zero, n[2]}, rim);
    }
    case ShapeKind::ellipsoid:
      return ellipsoid_point(n, d);
    case ShapeKind::tapered_capsule:
      return taper_point(n, d);
    default:
      return one_by_one(d);
  }
}

/// Applies a rotation, or its inverse; one matrix per lane.
template <typename T>
[[gnu::always_inline]] static inline Vec3<T> turned(const Lanes<T>* m, const Vec3<T>& v) {
  return {m[0] * v.x + m[1] * v.y + m[2] * v.z, m[3] * v.x + m[4] * v.y + m[5] * v.z,
          m[6] * v.x + m[7] * v.y + m[8] * v.z};
}
template <typename T>
[[gnu::always_inline]] static inline Vec3<T> turned_back(const Lanes<T>* m, const Vec3<T>& v) {
  return {m[0] * v.x + m[3] * v.y + m[6] * v.z, m[1] * v.x + m[4] * v.y + m[7] * v.z,
          m[2] * v.x + m[5] * v.y + m[8] * v.z};
}

}  // namespace winnow::WINNOW_ISA_NAME::hull
