#pragma once

// Step 4 of the hull kernels (hull_answers.wide.h has the sequence): from the features found in
// float to results in double.
//
// finish_apart and finish_depth compute the distance. The distance between two points on the hulls
// is an upper bound; the separation of all vertices along the direction found is a lower bound; the
// difference of the two is the error. write_contacts finds the supporting features of both hulls
// along the normal, and passes them as patches to contact_patch.

#include "pipeline/kernels/hull/hull_depth.wide.h"
#include "pipeline/manifold/contact_patch.h"
#include "pipeline/manifold/feature_rules.h"

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
  double n[3];
  double across_e[3];
  double across_f[3];
  cross3(e, f, n);
  cross3(e, w[0], across_e);
  cross3(f, w[0], across_f);
  const double area = dot3(n, n);
  // Weights of the second and the third corner, times the area.
  const double u = dot3(n, across_f);
  const double v = -dot3(n, across_e);
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

/// The distance of separate cores, from the vertices of the search's last simplex. Float may have
/// ended at another feature than the closest: the bounds in double then differ, and the error shows
/// it.
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
  // The plane of the first's highest vertices and the plane of the second's lowest separate the
  // cores.
  const double between_planes =
      lowest_of_second(pair, answer.normal) - height_of(*pair.first, answer.normal);
  const double doubt = length - between_planes;
  answer.distance = length;
  answer.error = (doubt > 0.0 ? doubt : 0.0) + kDoubleError * pair.size;
  answer.winner = nullptr;
  // The error would be NaN if the length is 0.
  if (!(length > 0.0)) answer.error = __builtin_inf();
}

/// Searches around the candidates for minima that float may have missed. Returns false if the
/// minimum cannot be determined.
static inline bool finish_ties(const HullPair& pair, const HullDepth& found, const double* depth,
                               const double* least, double& best, double& lower_bound,
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
  lower_bound = ties.lower_bound();
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
  double lower_bound = best;
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
    least[i] = measure.lower_bound;
    lower_bound = measure.lower_bound < lower_bound ? measure.lower_bound : lower_bound;
    if (!(measure.depth < best)) continue;
    best = measure.depth;
    answer.winner = &c;
    for (int k = 0; k < 3; ++k) answer.normal[k] = measure.normal[k];
  }
  const bool sure =
      answer.winner != nullptr && finish_ties(pair, found, depth, least, best, lower_bound, answer);
  const double doubt = best - lower_bound;
  answer.distance = -best;
  answer.error = (doubt > 0.0 ? doubt : 0.0) + kDoubleError * pair.size;
  if (!sure) answer.error = __builtin_inf();
}

/// True if a point in a hull's own frame is in front of no face by more than `doubt`; false for
/// flat hulls.
static inline bool contains(const HullShape& hull, const double* x, double doubt) {
  for (std::uint32_t i = 0; i < hull.face_count; ++i) {
    const HullFace& face = hull.faces[i];
    if (!(dot3(face.normal.data(), x) - face.offset <= doubt)) return false;
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
  double across[3];
  cross3(e, answer.normal, across);
  const double sine = dot3(across, d);
  const double t = dot3(across, r) / sine;
  for (int k = 0; k < 3; ++k) answer.point[k] = a[0][k] + t * d[k];
  // The parameter on the second edge, likewise.
  double from_first[3];
  cross3(d, answer.normal, from_first);
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

/// Transforms from the frame of the first to world axes, relative to body a.
static inline void to_world(const HullPair& pair, const double* x, double* r) {
  turn3(pair.frame, x, r);
  if (!pair.swapped) return;
  for (int k = 0; k < 3; ++k) r[k] -= pair.offset[k];
}

/// The supporting feature of one hull, in world axes.
class HullPatch {
 public:
  /// `first` selects the hull. `normal` points from the first to the second, in the frame of the
  /// first.
  HullPatch(const HullPair& pair, const double* normal, bool first)
      : pair_(pair), hull_(first ? *pair.first : *pair.second), first_(first) {
    if (first_) {
      for (int k = 0; k < 3; ++k) outward_[k] = normal[k];
    } else {
      turn_back3(pair_.turn, normal, outward_);
      for (double& x : outward_) x = -x;
    }
  }

  void face(std::uint32_t index) {
    const HullFace& f = hull_.faces[index];
    // If the polygon has too many corners, take every second (third, ...) one.
    const std::uint32_t stride = (f.count + kRoom - 1) / kRoom;
    count_ = 0;
    for (std::uint32_t i = 0; i < f.count; i += stride) {
      add(hull_.loop[f.first + i], hull_.loop_edge[f.first + i]);
    }
    feature_ = index;
  }

  /// Sets an edge, or a face beside it that also supports: shapes that touch along the edge are
  /// about to touch along the face.
  void edge(std::uint32_t index) {
    std::uint32_t best = kNoFeature;
    double most = kFaceCosine;
    for (const std::uint32_t side : hull_.edges[index].face) {
      if (side >= hull_.face_count) continue;
      const double cosine = dot3(hull_.faces[side].normal.data(), outward_);
      if (!(cosine > most)) continue;
      most = cosine;
      best = side;
    }
    if (best != kNoFeature) return face(best);
    use_only_edge(index);
  }

  /// As above, with the edge given by its ends. Calls `across` if there is no such edge.
  void edge_between(std::uint32_t v, std::uint32_t w) {
    const std::uint32_t index = find_edge(hull_, v, w);
    if (index == kNoFeature) return across();
    edge(index);
  }

  /// As above, with the feature given by the vertices of a simplex: the closest features.
  void closest(const std::uint32_t* vertices, std::uint32_t count, std::uint32_t shift) {
    const std::uint32_t v = vertices[0] >> shift & 0xFFFFU;
    std::uint32_t w = v;
    for (std::uint32_t i = 1; i < count; ++i) {
      const std::uint32_t x = vertices[i] >> shift & 0xFFFFU;
      if (x == v || x == w) continue;
      if (w != v) return across();
      w = x;
    }
    if (w != v) return edge_between(v, w);
    across_at(v);
  }

  /// Sets the supporting face, edge or vertex along the normal. Faces and edges up to 14 degrees
  /// off count as supporting, because bodies rock over them.
  void across() {
    float direction[3];
    write_direction(direction);
    across_at(farthest_vertex(hull_, direction));
  }

  /// As above, if the farthest vertex is given.
  void across_at(std::uint32_t vertex) {
    float direction[3];
    write_direction(direction);
    float x[3];
    vertex_at(hull_, vertex, x);
    const float slack = kFloatError * static_cast<float>(pair_.size);
    const std::uint32_t face_index = face_across(hull_, outward_, x, slack);
    if (face_index != kNoFeature) return face(face_index);
    const std::uint32_t other = neighbour_across(hull_, direction, vertex, x);
    if (other != kNoFeature) return use_only_edge(find_edge(hull_, vertex, other));
    use_only_vertex(vertex);
  }

  /// Sets all of a simple shape: the face that faces the normal best at any angle, a segment, or a
  /// point.
  void whole() {
    if (hull_.dimension == 0) return use_only_vertex(0);
    if (hull_.dimension == 1) return use_only_edge(0);
    std::uint32_t best = 0;
    for (std::uint32_t i = 1; i < hull_.face_count; ++i) {
      const bool better = dot3(hull_.faces[i].normal.data(), outward_) >
                          dot3(hull_.faces[best].normal.data(), outward_);
      best = better ? i : best;
    }
    face(best);
  }

  [[nodiscard]] SupportingFeature view() const {
    return {vertex_, vertex_feature_, edge_feature_, count_, feature_, hull_.rounding};
  }

 private:
  static constexpr std::uint32_t kRoom = kPatchRoom;

  void write_direction(float* direction) const {
    for (int k = 0; k < 3; ++k) direction[k] = static_cast<float>(outward_[k]);
  }

  void use_only_edge(std::uint32_t index) {
    const std::uint32_t* ends = hull_.edges[index].vertex;
    count_ = 0;
    add(ends[0] < ends[1] ? ends[0] : ends[1], index);
    add(ends[0] < ends[1] ? ends[1] : ends[0], index);
    feature_ = hull_.face_count + index;
  }

  void use_only_vertex(std::uint32_t vertex) {
    count_ = 0;
    add(vertex, 0);
    feature_ = hull_.face_count + hull_.edge_count + vertex;
  }

  void add(std::uint32_t vertex, std::uint32_t edge_feature) {
    double x[3];
    vertex_at(hull_, vertex, x);
    if (!first_) {
      double y[3];
      turn3(pair_.turn, x, y);
      for (int k = 0; k < 3; ++k) x[k] = y[k] + pair_.shift[k];
    }
    to_world(pair_, x, vertex_[count_]);
    vertex_feature_[count_] = vertex;
    edge_feature_[count_++] = edge_feature;
  }

  const HullPair& pair_;
  const HullShape& hull_;
  bool first_;
  /// In the frame of the hull.
  double outward_[3];
  std::uint32_t count_ = 0;
  std::uint32_t feature_ = 0;
  double vertex_[kRoom][3];
  std::uint32_t vertex_feature_[kRoom];
  std::uint32_t edge_feature_[kRoom];
};

/// Finds the feature with which one of the hulls touches: the feature of the axis of least depth
/// (`winner`) or, if there is none, of the closest vertices.
static inline void find_feature(const HullPair& pair, const HullCandidate* winner, bool first,
                                HullPatch& patch) {
  using Kind = HullCandidate::Kind;
  if (winner == nullptr) return patch.closest(pair.vertices, pair.count, first ? 0 : 16);
  if (winner->kind == (first ? Kind::first_face : Kind::second_face)) {
    return patch.face(winner->face);
  }
  if (winner->kind != Kind::arc) return patch.across();
  if (first) return patch.edge(winner->arc.edge);
  patch.edge_between(winner->arc.vertex[0], winner->arc.vertex[1]);
}

/// Finds the features of both hulls. `Simple`: the second is not a general hull but represents a
/// sphere, capsule, box or triangle.
template <bool Simple>
static inline void find_features(const HullPair& pair, const HullCandidate* winner,
                                 HullPatch& first, HullPatch& second) {
  find_feature(pair, winner, true, first);
  if constexpr (Simple) {
    second.whole();
  } else {
    find_feature(pair, winner, false, second);
  }
}

/// Input for the contacts of a pair.
struct HullContacts {
  /// Contact normal: in the frame of the first, and from body a to body b in world axes.
  const double* normal;
  const double* world;
  double margin;
  /// Distance of the pair, and how far the depth of the deepest contact may be from it.
  double distance;
  double doubt;
};

/// Writes the contacts of a pair and returns their number; 0 if the features do not overlap at the
/// depth of the pair.
template <bool Simple>
static inline std::uint32_t write_contacts(const HullPair& pair, const HullContacts& input,
                                           const HullCandidate* winner, ContactWriter& writer) {
  HullPatch first(pair, input.normal, true);
  HullPatch second(pair, input.normal, false);
  find_features<Simple>(pair, winner, first, second);
  ContactPoint points[kManifoldPoints];
  const std::uint32_t count =
      contact_patch(pair.swapped ? second.view() : first.view(),
                    pair.swapped ? first.view() : second.view(), input.world, input.margin, points);
  if (count == 0) return 0;
  const double miss = __builtin_fabs(static_cast<double>(points[0].depth) + input.distance);
  if (!(miss <= input.doubt)) return 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t to = writer.size + i;
    for (int k = 0; k < 3; ++k) writer.position[k][to] = points[i].position[k];
    writer.depth[to] = points[i].depth;
    writer.feature[to] = points[i].feature;
  }
  writer.size += count;
  return count;
}

/// Computes the contact point of body a from the features, in world axes, if the vertices do not
/// determine it. Returns false if the features do not overlap at the depth of the pair, up to
/// `doubt`.
template <bool Simple>
static inline bool point_of_features(const HullPair& pair, const HullContacts& input,
                                     const HullCandidate* winner, double* point) {
  HullPatch first(pair, input.normal, true);
  HullPatch second(pair, input.normal, false);
  find_features<Simple>(pair, winner, first, second);
  const SupportingFeature a = pair.swapped ? second.view() : first.view();
  const SupportingFeature b = pair.swapped ? first.view() : second.view();
  const double depth = deepest_point(a, b, input.world, point) + a.rounding + b.rounding;
  for (int k = 0; k < 3; ++k) point[k] += a.rounding * input.world[k];
  return __builtin_fabs(depth + input.distance) <= input.doubt;
}

/// Returns the feature of the first that is closest to a point: the face of least depth, or the
/// feature that the closest vertices span.
static inline std::uint32_t feature_at_point(const HullPair& pair, const HullContacts& input,
                                             const HullCandidate* winner) {
  const auto id = [](FeatureKind kind, std::uint32_t number) {
    return static_cast<std::uint32_t>(kind) << kFeatureKindShift | number;
  };
  if (winner != nullptr) return id(FeatureKind::face, winner->face);
  const HullShape& hull = *pair.first;
  const std::uint32_t v = pair.vertices[0] & 0xFFFFU;
  if (pair.count == 2) {
    const std::uint32_t edge = find_edge(hull, v, pair.vertices[1] & 0xFFFFU);
    if (edge != kNoFeature) return id(FeatureKind::edge, edge);
  }
  if (pair.count > 1) {
    float x[3];
    vertex_at(hull, v, x);
    const float slack = kFloatError * static_cast<float>(pair.size);
    const std::uint32_t face = face_across(hull, input.normal, x, slack);
    if (face != kNoFeature) return id(FeatureKind::face, face);
  }
  return id(FeatureKind::vertex, v);
}

/// Writes the single contact of a second shape whose core is a point, halfway between the surfaces.
static inline void write_point_contact(const HullPair& pair, const HullContacts& input,
                                       const HullCandidate* winner, ContactWriter& writer) {
  double center[3];
  to_world(pair, pair.shift, center);
  // Moves the contact from the point towards the first shape. The normal points from body a to body
  // b, and the first shape is body a unless the pair is swapped.
  const double back = pair.second->rounding + 0.5 * input.distance;
  const double reach = pair.swapped ? back : -back;
  const std::uint32_t to = writer.size++;
  for (int k = 0; k < 3; ++k) {
    writer.position[k][to] = static_cast<float>(center[k] + reach * input.world[k]);
  }
  writer.depth[to] = static_cast<float>(-input.distance);
  const std::uint64_t feature = feature_at_point(pair, input, winner);
  writer.feature[to] = pair.swapped ? feature : feature << 32U;
}

}  // namespace winnow::WINNOW_ISA_NAME::hull
