#pragma once

// From the features found by the float search to an answer in double. The distance between two
// points on the hulls is an upper bound; the separation of all vertices along the direction found
// is a lower bound; the difference of the two is the error. Called by hull_answers.wide.h.

#include "pipeline/kernels/hull/hull_measure.wide.h"
#include "pipeline/kernels/hull/hull_ties.wide.h"

namespace winnow::WINNOW_ISA_NAME::hull {

/// The distance of the cores (negative: depth) along `normal`, which points from the first to the
/// second, in the first's frame; `point` is on the first.
struct HullDistance {
  double distance;
  double error;
  double normal[3];
  double point[3];
  /// The touching features, for contacts. If null, the vertices of the closest simplex are used.
  const HullCandidate* winner;
  /// Storage for a winner that the float search has not found.
  HullCandidate found;
};

/// Weights of the point nearest to the origin, on a segment and on a triangle.
static inline void nearest_on_segment(const double (*w)[3], double* weight) {
  double e[3];
  for (int k = 0; k < 3; ++k) e[k] = w[1][k] - w[0][k];
  const double length = dot3(e, e);
  const double along = -dot3(e, w[0]);
  double t = length > 0.0 ? along / length : 0.0;
  t = t > 0.0 ? t : 0.0;
  t = t < 1.0 ? t : 1.0;
  weight[0] = 1.0 - t;
  weight[1] = t;
}

static inline double square_of_mix(const double (*w)[3], const double* weight,
                                   std::uint32_t count) {
  double square = 0.0;
  for (int k = 0; k < 3; ++k) {
    double x = 0.0;
    for (std::uint32_t i = 0; i < count; ++i) x += weight[i] * w[i][k];
    square += x * x;
  }
  return square;
}

static inline void nearest_on_triangle(const double (*w)[3], double* weight) {
  double e[3];
  double f[3];
  for (int k = 0; k < 3; ++k) {
    e[k] = w[1][k] - w[0][k];
    f[k] = w[2][k] - w[0][k];
  }
  const double n[3] = {e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2],
                       e[0] * f[1] - e[1] * f[0]};
  const double area = dot3(n, n);
  const double* p = w[0];
  // Weights of the second and the third corner, times the area.
  const double u = n[0] * (f[1] * p[2] - f[2] * p[1]) + n[1] * (f[2] * p[0] - f[0] * p[2]) +
                   n[2] * (f[0] * p[1] - f[1] * p[0]);
  const double v = -(n[0] * (e[1] * p[2] - e[2] * p[1]) + n[1] * (e[2] * p[0] - e[0] * p[2]) +
                     n[2] * (e[0] * p[1] - e[1] * p[0]));
  if (u >= 0.0 && v >= 0.0 && u + v <= area && area > 0.0) {
    weight[1] = u / area;
    weight[2] = v / area;
    weight[0] = 1.0 - weight[1] - weight[2];
    return;
  }
  double best = 0.0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const double side[2][3] = {{w[i][0], w[i][1], w[i][2]}, {w[j][0], w[j][1], w[j][2]}};
    double t[2];
    nearest_on_segment(side, t);
    const double square = square_of_mix(side, t, 2);
    if (i > 0 && !(square < best)) continue;
    best = square;
    weight[i] = t[0];
    weight[j] = t[1];
    weight[(i + 2) % 3] = 0.0;
  }
}

/// The distance of separate cores, from the search's simplex.
static inline void finish_apart(const HullPair& pair, HullDistance& answer) {
  double a[3][3];
  double w[3][3];
  for (std::uint32_t i = 0; i < pair.count; ++i) {
    double b[3];
    vertex_at(*pair.first, pair.vertices[i] & 0xFFFFU, a[i]);
    second_vertex_at(pair, pair.vertices[i] >> 16U, b);
    for (int k = 0; k < 3; ++k) w[i][k] = a[i][k] - b[k];
  }
  double weight[3] = {1.0, 0.0, 0.0};
  if (pair.count == 2) nearest_on_segment(w, weight);
  if (pair.count == 3) nearest_on_triangle(w, weight);
  double gap[3] = {};
  for (int k = 0; k < 3; ++k) {
    answer.point[k] = 0.0;
    for (std::uint32_t i = 0; i < pair.count; ++i) {
      gap[k] += weight[i] * w[i][k];
      answer.point[k] += weight[i] * a[i][k];
    }
  }
  const double length = __builtin_sqrt(dot3(gap, gap));
  const double inverse = 1.0 / length;
  for (int k = 0; k < 3; ++k) answer.normal[k] = -gap[k] * inverse;
  const double lower =
      lowest_of_second(pair, answer.normal) - height_of(*pair.first, answer.normal);
  const double doubt = length - lower;
  answer.distance = length;
  answer.error = (doubt > 0.0 ? doubt : 0.0) + kDoubleError * pair.size;
  answer.winner = nullptr;
  // The error would be NaN if the length is 0.
  if (!(length > 0.0)) answer.error = __builtin_inf();
}

/// Searches around the candidates for minima that float may have missed. Returns false if the
/// minimum cannot be determined.
static inline bool finish_ties(const HullPair& pair, const HullDepth& found, const double* depth,
                               const double* least, double& best, double& lower,
                               HullDistance& answer) {
  HullTies ties(pair, best, __builtin_inf());
  const double reach = best + 4.0 * static_cast<double>(kFloatError) * pair.size;
  const double enough = best - kDoubleError * pair.size;
  for (std::uint32_t i = 0; i < found.count(); ++i) {
    const HullCandidate& c = found.candidate(i);
    if (c.kind == HullCandidate::Kind::arc && least[i] < enough) {
      if (!ties.along_arc(c.arc)) return false;
      continue;
    }
    ties.bound(least[i]);
    if (c.kind != HullCandidate::Kind::first_face || depth[i] > reach) continue;
    if (!ties.around(c.face, depth[i])) return false;
  }
  best = ties.best();
  lower = ties.lower();
  if (!ties.found()) return true;
  answer.found = ties.winner();
  answer.winner = &answer.found;
  for (int k = 0; k < 3; ++k) answer.normal[k] = ties.normal()[k];
  return true;
}

/// The depth of overlapping cores: the smallest depth of the candidates. The error is large if the
/// lower bound of some candidate is well below that.
static inline void finish_depth(const HullPair& pair, const HullDepth& found,
                                HullDistance& answer) {
  HullMeasure measure(pair);
  double best = __builtin_inf();
  double lower = best;
  double depth[HullDepth::kMaxCandidates];
  double least[HullDepth::kMaxCandidates];
  answer.winner = nullptr;
  for (std::uint32_t i = 0; i < found.count(); ++i) {
    const HullCandidate& c = found.candidate(i);
    if (c.kind == HullCandidate::Kind::arc) {
      measure.arc(c.arc);
    } else {
      measure.face(c);
    }
    depth[i] = measure.depth;
    least[i] = measure.lower;
    lower = measure.lower < lower ? measure.lower : lower;
    if (!(measure.depth < best)) continue;
    best = measure.depth;
    answer.winner = &c;
    for (int k = 0; k < 3; ++k) answer.normal[k] = measure.normal[k];
  }
  const bool sure =
      answer.winner != nullptr && finish_ties(pair, found, depth, least, best, lower, answer);
  const double doubt = best - lower;
  answer.distance = -best;
  answer.error = (doubt > 0.0 ? doubt : 0.0) + kDoubleError * pair.size;
  if (!sure) answer.error = __builtin_inf();
}

/// True if a point in a hull's own frame is in front of no face by more than `doubt`; false for
/// flat hulls.
static inline bool contains(const HullShape& hull, const double* x, double doubt) {
  for (std::uint32_t i = 0; i < hull.face_count; ++i) {
    const HullFace& face = hull.faces[i];
    if (!(dot3(face.normal, x) - face.offset <= doubt)) return false;
  }
  return hull.dimension == 3;
}

/// Computes the point of the first's edge where two edges cross as seen along the normal. Returns
/// false if it is beyond an end of an edge, or if the edges are parallel.
static inline bool crossing_point(const HullPair& pair, HullDistance& answer) {
  const HullArc& arc = answer.winner->arc;
  const HullEdge& edge = pair.first->edges[arc.edge];
  double a[2][3];
  double b[2][3];
  for (int i = 0; i < 2; ++i) {
    vertex_at(*pair.first, edge.vertex[i], a[i]);
    second_vertex_at(pair, arc.vertex[i], b[i]);
  }
  double d[3];
  double e[3];
  double r[3];
  for (int k = 0; k < 3; ++k) {
    d[k] = a[1][k] - a[0][k];
    e[k] = b[1][k] - b[0][k];
    r[k] = b[0][k] - a[0][k];
  }
  // Perpendicular to the second edge and the normal.
  const double* n = answer.normal;
  const double across[3] = {e[1] * n[2] - e[2] * n[1], e[2] * n[0] - e[0] * n[2],
                            e[0] * n[1] - e[1] * n[0]};
  const double sine = dot3(across, d);
  const double t = dot3(across, r) / sine;
  for (int k = 0; k < 3; ++k) answer.point[k] = a[0][k] + t * d[k];
  // The parameter on the second edge, likewise.
  const double from_first[3] = {d[1] * n[2] - d[2] * n[1], d[2] * n[0] - d[0] * n[2],
                                d[0] * n[1] - d[1] * n[0]};
  const double u = dot3(from_first, r) / sine;
  return t >= 0.0 && t <= 1.0 && u >= 0.0 && u <= 1.0;
}

/// The touching point of two hulls along a normal, from the vertices that are farthest along it.
class HullTouch {
 public:
  HullTouch(const HullPair& pair, const HullDistance& answer)
      : pair_(pair), answer_(answer), rounding_(kDoubleError * pair.size) {}

  /// Computes the mean of the first's or the second's farthest vertices, as a point on the first in
  /// its frame; returns the number of these vertices.
  std::uint32_t find_middle(bool first, double* x) const {
    if (first) return middle_of(*pair_.first, answer_.normal, x);
    double direction[3];
    turn_back3(pair_.turn, answer_.normal, direction);
    for (double& d : direction) d = -d;
    double local[3];
    const std::uint32_t tied = middle_of(*pair_.second, direction, local);
    turn3(pair_.turn, local, x);
    for (int k = 0; k < 3; ++k) x[k] += pair_.shift[k] - answer_.distance * answer_.normal[k];
    return tied;
  }

  /// True if a point of the touching plane is on the first or the second.
  [[nodiscard]] bool is_on(bool first, const double* x) const {
    if (first) return contains(*pair_.first, x, rounding_);
    double across[3];
    for (int k = 0; k < 3; ++k) {
      across[k] = x[k] + answer_.distance * answer_.normal[k] - pair_.shift[k];
    }
    double local[3];
    turn_back3(pair_.turn, across, local);
    return contains(*pair_.second, local, rounding_);
  }

 private:
  std::uint32_t middle_of(const HullShape& hull, const double* direction, double* x) const {
    return middle_from(hull, direction, height_of(hull, direction) - 8.0 * rounding_, x);
  }

  const HullPair& pair_;
  const HullDistance& answer_;
  double rounding_;
};

/// Computes the point where edges cross or one vertex touches a face. If parallel features touch,
/// tries the middle of one of them; then the midpoint of both middles, which is on both features if
/// they overlap and each is symmetric about its middle; then the middle of the other. Returns false
/// if none of these points is on both hulls.
static inline bool touching_point(const HullPair& pair, HullDistance& answer) {
  using Kind = HullCandidate::Kind;
  const Kind kind = answer.winner->kind;
  if (kind == Kind::arc && crossing_point(pair, answer)) return true;
  const HullTouch touch(pair, answer);
  const bool first = kind == Kind::second_face;
  const std::uint32_t tied = touch.find_middle(first, answer.point);
  if ((kind != Kind::arc && tied == 1) || touch.is_on(!first, answer.point)) return true;
  double other[3];
  touch.find_middle(!first, other);
  for (int k = 0; k < 3; ++k) answer.point[k] = 0.5 * (answer.point[k] + other[k]);
  if (touch.is_on(true, answer.point) && touch.is_on(false, answer.point)) return true;
  for (int k = 0; k < 3; ++k) answer.point[k] = other[k];
  return touch.is_on(first, answer.point);
}

}  // namespace winnow::WINNOW_ISA_NAME::hull
