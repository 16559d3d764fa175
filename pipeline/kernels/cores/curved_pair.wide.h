#pragma once

// One pair of convex shapes in double, and support points of its Minkowski difference: the curved
// kernels pass it from stage to stage, and single pairs are tested with it. Lengths are scaled by a
// power of two so that the largest is in [1, 2).

#include "pipeline/kernels/cores/core_kinds.wide.h"
#include "pipeline/kernels/kernels.h"

namespace winnow::WINNOW_ISA_NAME::curved {

using hull::CoreDesc;
using hull::farthest;

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

static inline double dot2(const double* a, const double* b) {
  return a[0] * b[0] + a[1] * b[1];
}

/// True if the pair is computed with b first. Two shapes of one kind are ordered by their
/// positions, so that (a, b) and (b, a) are computed alike.
static inline bool computes_b_first(const Pose& a, const Pose& b) {
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
  pair.swapped = ids[0].kind() == ids[1].kind() && computes_b_first(pose_a, pose_b);
  double size = hull::make_core(*job.tables, ids[pair.swapped ? 1 : 0], pair.first) +
                hull::make_core(*job.tables, ids[pair.swapped ? 0 : 1], pair.second);
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

/// The support point w of first - second along n, and the point `mine` of the first in it.
static inline void difference_point(const CurvedPair& pair, const double* n, double* w,
                                    double* mine) {
  double back[3];
  double local[3];
  double theirs[3];
  farthest(pair.first, n, pair.scale, mine);
  turn_back3(pair.turn, n, back);
  for (double& x : back) x = -x;
  farthest(pair.second, back, pair.scale, local);
  turn3(pair.turn, local, theirs);
  for (int k = 0; k < 3; ++k) w[k] = mine[k] - (theirs[k] + pair.shift[k]);
}

}  // namespace winnow::WINNOW_ISA_NAME::curved
