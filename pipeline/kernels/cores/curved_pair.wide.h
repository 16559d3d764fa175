#pragma once

// One pair of convex shapes in double: the curved kernels pass it from stage to stage, and single
// pairs are tested with it. Lengths are scaled by a power of two so that the largest is in [1, 2).

#include "pipeline/kernels/cores/core_lanes.wide.h"
#include "pipeline/kernels/cores/hull_core.wide.h"
#include "pipeline/kernels/kernels.h"
#include "pipeline/kernels/user_support.wide.h"

namespace winnow::WINNOW_ISA_NAME::curved {

/// The core of a shape in its own frame.
struct CoreDesc {
  ShapeKind kind;
  /// The same numbers as in CoreLanes.
  double number[hull::kCoreNumbers];
  /// Null unless the shape is a hull, and a user shape, respectively.
  const HullShape* hull;
  const SupportShape* own;
  double rounding;
  /// A point of the core.
  double center[3];
};

/// Result of the search for the closest points of the cores.
enum class CurvedState : std::uint32_t {
  /// Farther apart than `CurvedPair::far`.
  far,
  /// Apart; closest points found.
  apart,
  /// Certainly overlapping.
  inside,
  /// Touching, within the accuracy of double.
  close,
};

/// The first is body a of the pair, or body b if `swapped` is set. `offset` is in the caller's
/// units.
struct CurvedPair : hull::PairPlacement {
  CoreDesc first;
  CoreDesc second;
  /// The sum of the bounding radii of both cores about their origins and of |shift| (L1 norm),
  /// scaled: an upper bound of all lengths in the search.
  double size;
  double rounding;
  /// The search stops with state `far` if the distance of the cores (without roundings) exceeds
  /// this; in the caller's units. Infinite: never.
  double far;
  /// Factor by which lengths are multiplied, and its inverse.
  double scale;
  double unit;
  std::uint32_t index;
  bool swapped;
  // Outcome of the search.
  CurvedState state;
  /// Points of the Minkowski difference first - second, and the points of the first that belong to
  /// them: the simplex that spans the closest feature or, if the cores overlap, four points around
  /// the origin.
  std::uint32_t count;
  double difference[4][3];
  double on_first[4][3];
  /// The vector first - second at the closest points, its length, and a lower bound of the
  /// distance.
  double gap[3];
  double upper;
  double lower;
};

/// True if the pair has a user shape, of which only the support function is available.
static inline bool has_user_shape(const CurvedPair& pair) {
  return pair.second.kind == ShapeKind::support;
}

/// Bound of rounding errors of lengths, relative to size: some forty operations of half an ulp
/// each.
inline constexpr double kRoundingError = 40.0 * 0x1p-53;

/// If the size is in this range, its powers up to the fifth neither overflow nor underflow.
inline constexpr double kSmallest = 1e-60;
inline constexpr double kLargestSize = 1e60;

static inline double largest_of(double a, double b) {
  return a > b ? a : b;
}
static inline double least_of(double a, double b) {
  return a < b ? a : b;
}
static inline double dot2(const double* a, const double* b) {
  return a[0] * b[0] + a[1] * b[1];
}

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

/// Sets the core, without scaling, and returns an upper bound on the distance of its points from
/// its origin.
static inline double make_core(const ShapeTables& tables, ShapeId id, CoreDesc& form) {
  form.kind = id.kind();
  form.hull = nullptr;
  form.own = nullptr;
  for (double& x : form.number) x = 0.0;
  for (double& x : form.center) x = 0.0;
  const std::uint32_t i = id.index();
  switch (form.kind) {
    case ShapeKind::sphere:
      form.rounding = tables.spheres[i].radius;
      break;
    case ShapeKind::capsule:
      form.number[2] = tables.capsules[i].half_length;
      form.rounding = tables.capsules[i].radius;
      break;
    case ShapeKind::box:
      for (int k = 0; k < 3; ++k) form.number[k] = tables.boxes[i].half[k];
      form.rounding = tables.boxes[i].rounding;
      break;
    case ShapeKind::cylinder:
      form.number[0] = tables.cylinders[i].radius;
      form.number[2] = tables.cylinders[i].half_length;
      form.rounding = tables.cylinders[i].rounding;
      break;
    case ShapeKind::cone:
      form.number[0] = tables.cones[i].radius;
      form.number[2] = tables.cones[i].half_length;
      form.rounding = tables.cones[i].rounding;
      break;
    case ShapeKind::ellipsoid: {
      const double* r = tables.ellipsoids[i].radius;
      const double most = largest_of(largest_of(r[0], r[1]), r[2]);
      const double least = least_of(least_of(r[0], r[1]), r[2]);
      for (int k = 0; k < 3; ++k) form.number[k] = r[k];
      form.number[3] = most > 0.0 ? least * (least / most) : 0.0;
      form.rounding = tables.ellipsoids[i].rounding + form.number[3];
      break;
    }
    case ShapeKind::tapered_capsule: {
      const TaperedCapsuleShape& s = tables.tapered_capsules[i];
      const double more = __builtin_fabs(s.radius[1] - s.radius[0]);
      const double end = s.radius[1] > s.radius[0] ? s.half_length : -s.half_length;
      const bool is_ball = more >= 2.0 * s.half_length;
      form.number[0] = is_ball ? 0.0 : more;
      form.number[1] = end;
      form.number[2] = is_ball ? end : -end;
      form.center[2] = is_ball ? end : 0.0;
      form.rounding = (s.radius[1] > s.radius[0]) == is_ball ? s.radius[1] : s.radius[0];
      return form.number[0] + s.half_length;
    }
    case ShapeKind::triangle: {
      double most = 0.0;
      for (int v = 0; v < 3; ++v) {
        double reach = 0.0;
        for (int k = 0; k < 3; ++k) {
          const double x = tables.triangles[i].vertex[v][k];
          form.number[3 * v + k] = x;
          form.center[k] += x / 3.0;
          reach += __builtin_fabs(x);
        }
        most = largest_of(most, reach);
      }
      form.rounding = tables.triangles[i].rounding;
      return most;
    }
    case ShapeKind::support:
      form.own = &tables.supports[i];
      form.rounding = form.own->rounding;
      return form.own->radius;
    default:
      form.hull = &tables.hulls[i];
      form.rounding = form.hull->rounding;
      for (int k = 0; k < 3; ++k) form.center[k] = form.hull->center[k];
      return hull::reach_of(*form.hull);
  }
  return form.number[0] + form.number[1] + form.number[2];
}

/// True if b is the first. Two shapes of one kind are ordered by their positions, so that (a, b)
/// and (b, a) are computed alike.
static inline bool comes_second(const Pose& a, const Pose& b) {
  for (int i = 0; i < 3; ++i) {
    const double c = b.position[i] - a.position[i];
    if (c != 0.0) return c < 0.0;
  }
  return false;
}

/// Sets the input of the search. Returns false if poses or sizes are out of range.
static inline bool place_pair(const NarrowJob& job, BodyPair bodies, CurvedPair& pair) {
  const ShapeId ids[2] = {job.shapes[bodies.a], job.shapes[bodies.b]};
  const Pose& pose_a = job.poses[bodies.a];
  const Pose& pose_b = job.poses[bodies.b];
  pair.swapped = ids[0].kind() == ids[1].kind() && comes_second(pose_a, pose_b);
  double size = make_core(*job.tables, ids[pair.swapped ? 1 : 0], pair.first) +
                make_core(*job.tables, ids[pair.swapped ? 0 : 1], pair.second);
  if (!hull::place(pair.swapped ? pose_b : pose_a, pair.swapped ? pose_a : pose_b, pair)) {
    return false;
  }
  for (const double x : pair.shift) size += __builtin_fabs(x);
  const double rounding = pair.first.rounding + pair.second.rounding;
  if (!(size > kSmallest && size < kLargestSize)) return false;
  if (!(rounding < 1e6 * size)) return false;
  const double scale = hull::scale_of(size);
  pair.scale = scale;
  pair.unit = 1.0 / scale;
  pair.size = size * scale;
  pair.rounding = rounding * scale;
  for (double& x : pair.shift) x *= scale;
  for (CoreDesc* form : {&pair.first, &pair.second}) {
    for (double& x : form->number) x *= scale;
    for (double& x : form->center) x *= scale;
    form->rounding *= scale;
  }
  return true;
}

/// Writes the vertex of a hull that is farthest along d, times `scale`.
template <typename T>
static inline void hull_support(const HullShape& shape, const T* d, T scale, T* x) {
  const std::uint32_t vertex = hull::highest_vertex(shape, Vec3<T>{d[0], d[1], d[2]});
  const T* const* column = hull::columns_of(shape, T());
  for (int k = 0; k < 3; ++k) x[k] = column[k][vertex] * scale;
}

/// Support point of a core for which there is no lane code: a hull or a user shape.
template <typename T>
static inline void single_support(const CoreDesc& form, const T* d, T scale, T* x) {
  if (form.kind == ShapeKind::support) {
    user_support(*form.own, d, scale, x);
  } else {
    hull_support(*form.hull, d, scale, x);
  }
}

}  // namespace winnow::WINNOW_ISA_NAME::curved
