#pragma once

// How deep two hulls overlap along the directions that the float search found, over all vertices,
// in the precision of the answer.

#include "pipeline/kernels/hull/hull_depth.wide.h"
#include "pipeline/kernels/hull/hull_features.wide.h"

namespace winnow::WINNOW_ISA_NAME::hull {

template <typename T>
inline constexpr T kRounding = static_cast<T>(kDoubleError);
template <>
inline constexpr float kRounding<float> = kFloatError;

/// Where the second stands, in the precision of the answer.
template <typename T>
struct HullPlace {
  T turn[9];
  T shift[3];

  explicit HullPlace(const HullPair& pair) {
    for (int i = 0; i < 9; ++i) turn[i] = static_cast<T>(pair.turn[i]);
    for (int i = 0; i < 3; ++i) shift[i] = static_cast<T>(pair.shift[i]);
  }
  [[gnu::always_inline]] void of_second(const HullShape& hull, std::uint32_t vertex, T* x) const {
    T local[3];
    vertex_at(hull, vertex, local);
    turn3(turn, local, x);
    for (int k = 0; k < 3; ++k) x[k] += shift[k];
  }
  /// The smallest product of a vertex of the second and `direction`.
  T lowest_of_second(const HullShape& hull, const T* direction) const {
    T local[3];
    turn_back3(turn, direction, local);
    for (T& x : local) x = -x;
    return dot3(direction, shift) - height_of(hull, local);
  }
  static T dot3(const T* a, const T* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
};

template <typename T>
static inline T root(T x) {
  return static_cast<T>(__builtin_sqrt(static_cast<double>(x)));
}

/// Depth along a unit direction from the first to the second, over all vertices.
template <typename T>
static inline T depth_along(const HullPair& pair, const HullPlace<T>& place, const T* normal) {
  return height_of(*pair.first, normal) - place.lowest_of_second(*pair.second, normal);
}

/// The directions between which an arc runs, in the first's frame and of any length.
template <typename T>
static inline void arc_ends(const HullPair& pair, const HullArc& arc, T (*end)[3]) {
  const double* n = pair.first->faces[arc.face[0]].normal;
  const double* m = pair.first->faces[arc.face[1]].normal;
  for (int i = 0; i < 2; ++i) {
    for (int k = 0; k < 3; ++k) {
      end[i][k] = static_cast<T>(arc.s[i]) * static_cast<T>(n[k]) +
                  static_cast<T>(arc.t[i]) * static_cast<T>(m[k]);
    }
  }
}

/// The depth of one candidate: an upper bound of the smallest in `depth` and its direction, and in
/// `lower` a lower bound for all directions that the candidate stands for.
template <typename T>
class HullMeasure {
 public:
  HullMeasure(const HullPair& pair, const HullPlace<T>& place) : pair_(pair), place_(place) {}

  T depth;
  T lower;
  T normal[3];

  void face(const HullCandidate& c) {
    if (c.kind == HullCandidate::Kind::first_face) {
      for (int k = 0; k < 3; ++k) normal[k] = static_cast<T>(pair_.first->faces[c.face].normal[k]);
    } else {
      T n[3];
      for (int k = 0; k < 3; ++k) n[k] = static_cast<T>(pair_.second->faces[c.face].normal[k]);
      turn3(place_.turn, n, normal);
      for (T& x : normal) x = -x;
    }
    depth = depth_along(pair_, place_, normal);
    lower = depth;
  }

  /// As HullDepth::cut bounds an arc.
  void arc(const HullArc& arc) {
    T end[2][3];
    T mine[3];
    vertex_at(*pair_.first, pair_.first->edges[arc.edge].vertex[0], mine);
    T w[2][3];
    arc_ends(pair_, arc, end);
    for (int i = 0; i < 2; ++i) {
      T theirs[3];
      place_.of_second(*pair_.second, arc.vertex[i], theirs);
      for (int k = 0; k < 3; ++k) w[i][k] = mine[k] - theirs[k];
    }
    crossing(end, w);
    // The ends of a whole arc are candidates themselves.
    if (!arc.is_whole()) bound_ends(end, w);
  }

  /// Of the arc between two directions and two points of the difference: the direction in which
  /// they are as high, or, if one of them is the higher at both ends, the end where that is lower.
  void crossing(const T (*end)[3], const T (*w)[3]) {
    const T here[2] = {dot(end[0], w[0]), dot(end[0], w[1])};
    const T there[2] = {dot(end[1], w[0]), dot(end[1], w[1])};
    const T q = here[0] - here[1];
    const T p = there[1] - there[0];
    const bool crosses = (p > T(0) && q > T(0)) || (p < T(0) && q < T(0));
    const int top = q > T(0) || p < T(0) ? 0 : 1;
    T weight[2] = {p < T(0) ? -p : p, q < T(0) ? -q : q};
    if (!crosses) {
      const bool at_start = here[top] < there[top];
      weight[0] = at_start ? T(1) : T(0);
      weight[1] = at_start ? T(0) : T(1);
    }
    for (int k = 0; k < 3; ++k) normal[k] = weight[0] * end[0][k] + weight[1] * end[1][k];
    const T scale = T(1) / root(dot(normal, normal));
    for (T& x : normal) x *= scale;
    depth = depth_along(pair_, place_, normal);
    const T heights[2] = {dot(normal, w[0]), dot(normal, w[1])};
    const int low = heights[0] < heights[1] ? 0 : 1;
    lower = heights[crosses ? low : top];
  }

  /// Where both points rise along an arc it is an end that bounds the higher of them.
  void bound_ends(const T (*end)[3], const T (*w)[3]) {
    for (int i = 0; i < 2; ++i) {
      const T heights[2] = {dot(end[i], w[0]), dot(end[i], w[1])};
      const T height =
          (heights[0] > heights[1] ? heights[0] : heights[1]) / root(dot(end[i], end[i]));
      lower = height < lower ? height : lower;
    }
  }

 private:
  static T dot(const T* a, const T* b) { return HullPlace<T>::dot3(a, b); }
  const HullPair& pair_;
  const HullPlace<T>& place_;
};

}  // namespace winnow::WINNOW_ISA_NAME::hull
