#pragma once

// Depth of two hulls along the directions that the float search found, over all vertices, in
// double.

#include "pipeline/kernels/hull/hull_depth.wide.h"
#include "pipeline/kernels/hull/hull_features.wide.h"

namespace winnow::WINNOW_ISA_NAME::hull {

/// Vertex i of the second in the first's frame.
[[gnu::always_inline]] static inline void second_vertex_at(const HullPair& pair, std::uint32_t i,
                                                           double* x) {
  double local[3];
  vertex_at(*pair.second, i, local);
  turn3(pair.turn, local, x);
  for (int k = 0; k < 3; ++k) x[k] += pair.shift[k];
}

/// The smallest dot product of a vertex of the second with `direction`.
static inline double lowest_of_second(const HullPair& pair, const double* direction) {
  double local[3];
  turn_back3(pair.turn, direction, local);
  for (double& x : local) x = -x;
  return dot3(direction, pair.shift) - height_of(*pair.second, local);
}

/// Depth along a unit direction from the first to the second, over all vertices.
static inline double depth_along(const HullPair& pair, const double* normal) {
  return height_of(*pair.first, normal) - lowest_of_second(pair, normal);
}

/// The directions at the ends of an arc, in the first's frame, not normalized.
static inline void arc_ends(const HullPair& pair, const HullArc& arc, double (*end)[3]) {
  const double* n = pair.first->faces[arc.face[0]].normal;
  const double* m = pair.first->faces[arc.face[1]].normal;
  for (int i = 0; i < 2; ++i) {
    for (int k = 0; k < 3; ++k) {
      end[i][k] = static_cast<double>(arc.s[i]) * n[k] + static_cast<double>(arc.t[i]) * m[k];
    }
  }
}

/// Measures a candidate: `depth` is an upper bound of the smallest depth, attained along `normal`;
/// `lower` is a lower bound for all directions that the candidate stands for.
class HullMeasure {
 public:
  explicit HullMeasure(const HullPair& pair) : pair_(pair) {}

  double depth;
  double lower;
  double normal[3];

  void face(const HullCandidate& c) {
    if (c.kind == HullCandidate::Kind::first_face) {
      for (int k = 0; k < 3; ++k) normal[k] = pair_.first->faces[c.face].normal[k];
    } else {
      double n[3];
      for (int k = 0; k < 3; ++k) n[k] = pair_.second->faces[c.face].normal[k];
      turn3(pair_.turn, n, normal);
      for (double& x : normal) x = -x;
    }
    depth = depth_along(pair_, normal);
    lower = depth;
  }

  /// Bounds an arc as HullDepth::cut does.
  void arc(const HullArc& arc) {
    double end[2][3];
    double mine[3];
    vertex_at(*pair_.first, pair_.first->edges[arc.edge].vertex[0], mine);
    double w[2][3];
    arc_ends(pair_, arc, end);
    for (int i = 0; i < 2; ++i) {
      double theirs[3];
      second_vertex_at(pair_, arc.vertex[i], theirs);
      for (int k = 0; k < 3; ++k) w[i][k] = mine[k] - theirs[k];
    }
    crossing(end, w);
    // The ends of a whole arc are candidates themselves.
    if (!arc.is_whole()) bound_ends(end, w);
  }

  /// For the arc between two directions and two points of the difference: measures the direction in
  /// which both points have the same height. If one point is higher at both ends, measures the end
  /// at which it is lower.
  void crossing(const double (*end)[3], const double (*w)[3]) {
    const double here[2] = {dot3(end[0], w[0]), dot3(end[0], w[1])};
    const double there[2] = {dot3(end[1], w[0]), dot3(end[1], w[1])};
    const double q = here[0] - here[1];
    const double p = there[1] - there[0];
    const bool crosses = (p > 0.0 && q > 0.0) || (p < 0.0 && q < 0.0);
    const int top = q > 0.0 || p < 0.0 ? 0 : 1;
    double weight[2] = {p < 0.0 ? -p : p, q < 0.0 ? -q : q};
    if (!crosses) {
      const bool at_start = here[top] < there[top];
      weight[0] = at_start ? 1.0 : 0.0;
      weight[1] = at_start ? 0.0 : 1.0;
    }
    for (int k = 0; k < 3; ++k) normal[k] = weight[0] * end[0][k] + weight[1] * end[1][k];
    const double scale = 1.0 / __builtin_sqrt(dot3(normal, normal));
    for (double& x : normal) x *= scale;
    depth = depth_along(pair_, normal);
    const double heights[2] = {dot3(normal, w[0]), dot3(normal, w[1])};
    const int low = heights[0] < heights[1] ? 0 : 1;
    lower = heights[crosses ? low : top];
  }

  /// If both points rise along an arc, the larger of their heights is smallest at an end: lowers
  /// the bound to the larger height at each end.
  void bound_ends(const double (*end)[3], const double (*w)[3]) {
    for (int i = 0; i < 2; ++i) {
      const double heights[2] = {dot3(end[i], w[0]), dot3(end[i], w[1])};
      const double height = (heights[0] > heights[1] ? heights[0] : heights[1]) /
                            __builtin_sqrt(dot3(end[i], end[i]));
      lower = height < lower ? height : lower;
    }
  }

 private:
  const HullPair& pair_;
};

}  // namespace winnow::WINNOW_ISA_NAME::hull
