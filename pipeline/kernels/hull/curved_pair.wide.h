#pragma once

// A pair of convex shapes by itself, in double: as the curved kernels pass it from stage to stage,
// and as a pair alone is judged. Lengths are multiplied by a power of two that brings the largest
// into [1, 2).

#include "pipeline/kernels/hull/core_lanes.wide.h"
#include "pipeline/kernels/hull/hull_pair.wide.h"
#include "pipeline/kernels/own_support.wide.h"

namespace winnow::WINNOW_ISA_NAME::curved {

/// The core of a shape in its own frame.
struct Form {
  ShapeKind kind;
  /// As those of CoreLanes.
  double number[hull::kCoreNumbers];
  /// Of a hull, and of a program's own set.
  const HullShape* hull;
  const SupportShape* own;
  double rounding;
  /// A point of it.
  double center[3];
};

/// What the search found out about the cores.
enum class CurvedState : std::uint32_t {
  /// Farther apart than anyone asks.
  far,
  /// Closest points found.
  apart,
  /// Overlap beyond doubt.
  inside,
  /// Touching, as far as double can tell.
  close,
};

/// "First" is body a of the pair, or body b where `swapped`.
struct CurvedPair {
  Form first;
  Form second;
  /// From the second's frame to the first's: x -> turn x + shift; rows.
  double turn[9];
  double shift[3];
  /// From the first's frame to the world's axes; rows.
  double frame[9];
  /// Position of the second less that of the first, in the world's axes and the caller's lengths.
  double offset[3];
  /// An upper bound of every length that occurs.
  double size;
  double rounding;
  /// The search stops with state far beyond this, in the caller's lengths, roundings excluded;
  /// infinite: never.
  double far;
  /// What lengths were multiplied by, and its inverse.
  double scale;
  double unit;
  std::uint32_t index;
  bool swapped;
  // Outcome of the search.
  CurvedState state;
  /// Points of first - second, and the points of the first that are in them: those that span the
  /// closest feature, or where the cores overlap the four around the origin.
  std::uint32_t count;
  double difference[4][3];
  double on_first[4][3];
  /// first - second where they are closest, its length, and a lower bound of the distance.
  double gap[3];
  double upper;
  double lower;
};

/// Nothing is known of the surface of a program's own set but its points.
static inline bool has_own(const CurvedPair& pair) {
  return pair.second.kind == ShapeKind::support;
}

/// A bound of the rounding errors of lengths, over size: some forty operations of half a unit each.
inline constexpr double kRoundingError = 40.0 * 0x1p-53;

/// Sizes within these have powers that neither overflow nor vanish.
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

/// Unit, across d, which is unit, and each other, the same while d trembles: see kAxisCosine.
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

/// Fills the core, unscaled, and returns its reach from its origin.
static inline double describe(const ShapeTables& tables, ShapeId id, Form& form) {
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

/// Pairs of one kind are computed alike in either order: the sign of the difference of positions
/// decides.
static inline bool comes_second(const Pose& a, const Pose& b) {
  for (int i = 0; i < 3; ++i) {
    const double c = b.position[i] - a.position[i];
    if (c != 0.0) return c < 0.0;
  }
  return false;
}

/// Fills what the search needs; false if poses or sizes are out of range.
static inline bool place_pair(const NarrowJob& job, BodyPair bodies, CurvedPair& pair) {
  const ShapeId ids[2] = {job.shapes[bodies.a], job.shapes[bodies.b]};
  const Pose& pose_a = job.poses[bodies.a];
  const Pose& pose_b = job.poses[bodies.b];
  pair.swapped = ids[0].kind() == ids[1].kind() && comes_second(pose_a, pose_b);
  const Pose& first = pair.swapped ? pose_b : pose_a;
  const Pose& second = pair.swapped ? pose_a : pose_b;
  double size = describe(*job.tables, ids[pair.swapped ? 1 : 0], pair.first) +
                describe(*job.tables, ids[pair.swapped ? 0 : 1], pair.second);
  double frame[9];
  double axes[9];
  if (!hull::rotation_of(first.orientation, frame) ||
      !hull::rotation_of(second.orientation, axes)) {
    return false;
  }
  double offset[3];
  double shift[3];
  for (int i = 0; i < 3; ++i) offset[i] = second.position[i] - first.position[i];
  turn_back3(frame, offset, shift);
  for (const double x : shift) size += __builtin_fabs(x);
  const double rounding = pair.first.rounding + pair.second.rounding;
  if (!(size > kSmallest && size < kLargestSize)) return false;
  if (!(rounding < 1e6 * size)) return false;
  const std::uint64_t exponent = __builtin_bit_cast(std::uint64_t, size) >> 52U;
  const double scale = __builtin_bit_cast(double, (2046U - exponent) << 52U);
  pair.scale = scale;
  pair.unit = 1.0 / scale;
  pair.size = size * scale;
  pair.rounding = rounding * scale;
  for (int i = 0; i < 3; ++i) {
    pair.offset[i] = offset[i];
    pair.shift[i] = shift[i] * scale;
    for (int k = 0; k < 3; ++k) {
      pair.frame[3 * i + k] = frame[3 * i + k];
      pair.turn[3 * i + k] =
          frame[i] * axes[k] + frame[3 + i] * axes[3 + k] + frame[6 + i] * axes[6 + k];
    }
  }
  for (Form* form : {&pair.first, &pair.second}) {
    for (double& x : form->number) x *= scale;
    for (double& x : form->center) x *= scale;
    form->rounding *= scale;
  }
  return true;
}

/// The vertex of a hull that is farthest along d, times `scale`.
template <typename T>
static inline void hull_support(const HullShape& shape, const T* d, T scale, T* x) {
  const std::uint32_t vertex = hull::highest_vertex(shape, Vec3<T>{d[0], d[1], d[2]});
  const T* const* column = hull::columns_of(shape, T());
  for (int k = 0; k < 3; ++k) x[k] = column[k][vertex] * scale;
}

/// That of a core of which no lanes are made.
template <typename T>
static inline void single_support(const Form& form, const T* d, T scale, T* x) {
  if (form.kind == ShapeKind::support) {
    own_support(*form.own, d, scale, x);
  } else {
    hull_support(*form.hull, d, scale, x);
  }
}

}  // namespace winnow::WINNOW_ISA_NAME::curved
