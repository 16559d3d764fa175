#pragma once

// Triangles in lanes, seen from a point or a segment.

#include "pipeline/kernels/round/segments.wide.h"

namespace winnow::WINNOW_ISA_NAME {

/// A triangle around the origin of the question: vertices, edge i from vertex i to the next one,
/// squares of the edges' lengths, and the normal e0 x e1 of any length.
template <typename T>
struct TriangleView {
  Vec3<T> vertex[3];
  Vec3<T> edge[3];
  Lanes<T> square[3];
  Vec3<T> normal;
  Lanes<T> normal_square;
};

/// `offset` is added to the vertices.
template <typename T>
[[gnu::always_inline]] inline TriangleView<T> view_triangle(const TriangleLanes<T>& triangle,
                                                            const Vec3<T>& offset) {
  TriangleView<T> r;
  for (int i = 0; i < 3; ++i) {
    r.vertex[i] = triangle.vertex[i] + offset;
    r.edge[i] = triangle.vertex[i == 2 ? 0 : i + 1] - triangle.vertex[i];
    r.square[i] = dot(r.edge[i], r.edge[i]);
  }
  r.normal = cross(r.edge[0], r.edge[1]);
  r.normal_square = dot(r.normal, r.normal);
  return r;
}

/// Where the normal is more than rounding.
template <typename T>
[[gnu::always_inline]] inline LaneMask<T> has_normal(const TriangleView<T>& b) {
  const Lanes<T> least(T(16) * kEpsilon<T> * kEpsilon<T>);
  return b.normal_square > b.square[0] * b.square[1] * least;
}

/// The largest coordinates of a vertex, summed.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> largest(const TriangleLanes<T>& triangle) {
  return max(taxicab(triangle.vertex[0]),
             max(taxicab(triangle.vertex[1]), taxicab(triangle.vertex[2])));
}

/// The best so far of directions along which two cores are apart.
template <typename T>
struct Gap {
  /// How far they are, negative if they overlap.
  Lanes<T> distance;
  /// Unit, from a to b.
  Vec3<T> normal;
};

/// Keeps the direction along which the cores are farther apart.
template <typename T>
[[gnu::always_inline]] inline void widen(Gap<T>& gap, const LaneMask<T>& valid,
                                         const Lanes<T>& distance, const Vec3<T>& normal) {
  const LaneMask<T> better = valid & (distance > gap.distance);
  gap.distance = select(better, distance, gap.distance);
  gap.normal = select(better, normal, gap.normal);
}

/// How far a triangle lies on one side of a segment's ends along a unit direction, the better of
/// the two ways. `reach` is that of the segment, whose middle is the origin.
template <typename T>
[[gnu::always_inline]] inline Gap<T> gap_along(const TriangleView<T>& b, const Vec3<T>& n,
                                               const Lanes<T>& reach) {
  const Lanes<T> x = dot(b.vertex[0], n);
  const Lanes<T> y = dot(b.vertex[1], n);
  const Lanes<T> z = dot(b.vertex[2], n);
  const Lanes<T> ahead = min(min(x, y), z) - reach;
  const Lanes<T> behind = -max(max(x, y), z) - reach;
  return {max(ahead, behind), select(ahead >= behind, n, -n)};
}

/// The nearest candidate so far for the closest points.
template <typename T>
struct Nearest {
  /// From a to b.
  Vec3<T> w;
  Lanes<T> square;
  /// Where on the segment of a.
  Lanes<T> s;
  /// Vertices of the triangle are 1, 2, 3, edges 4, 5, 6, the face is 7.
  Lanes<T> feature;
};

template <typename T>
[[gnu::always_inline]] inline void nearer(Nearest<T>& nearest, const LaneMask<T>& valid,
                                          const Vec3<T>& w, const Lanes<T>& s,
                                          const Lanes<T>& feature) {
  const Lanes<T> square = dot(w, w);
  const LaneMask<T> better = valid & (square < nearest.square);
  nearest.w = select(better, w, nearest.w);
  nearest.square = select(better, square, nearest.square);
  nearest.s = select(better, s, nearest.s);
  nearest.feature = select(better, feature, nearest.feature);
}

/// A candidate in the face for a point: the convex combination of the vertices at the foot of the
/// point, so that it lies on the triangle however thin that is.
template <typename T>
[[gnu::always_inline]] inline void nearer_in_face(Nearest<T>& nearest, const TriangleView<T>& b,
                                                  const Vec3<T>& point, const Lanes<T>& s) {
  const Lanes<T> zero(T(0));
  const Vec3<T> v[3] = {b.vertex[0] - point, b.vertex[1] - point, b.vertex[2] - point};
  const Lanes<T> weight[3] = {dot(cross(v[1], b.edge[1]), b.normal),
                              dot(cross(v[2], b.edge[2]), b.normal),
                              dot(cross(v[0], b.edge[0]), b.normal)};
  const Lanes<T> sum = weight[0] + weight[1] + weight[2];
  const LaneMask<T> over =
      (weight[0] >= zero) & (weight[1] >= zero) & (weight[2] >= zero) & (sum > zero);
  const Vec3<T> w =
      (v[0] * weight[0] + v[1] * weight[1] + v[2] * weight[2]) * (Lanes<T>(T(1)) / sum);
  nearer(nearest, over, w, s, Lanes<T>(T(7)));
}

/// What an edge's point at t is called.
template <typename T>
[[gnu::always_inline]] inline Lanes<T> edge_feature(const Lanes<T>& t, int edge) {
  const Lanes<T> zero(T(0));
  const Lanes<T> one(T(1));
  const Lanes<T> next(T(edge == 2 ? 1 : edge + 2));
  return select(t <= zero, Lanes<T>(T(edge + 1)), select(t >= one, next, Lanes<T>(T(edge + 4))));
}

}  // namespace winnow::WINNOW_ISA_NAME
