#pragma once

// From the features that the float search found to an answer in double (tier robust) or float (tier
// fast): the distance between points that lie on the hulls is an upper bound, the separation of all
// vertices along the direction found a lower one, and their difference the error.
//
// The features of two hulls that meet along a normal, as patches for contact_patch.

#include "pipeline/kernels/hull/hull_depth.wide.h"
#include "pipeline/kernels/hull/hull_features.wide.h"
#include "pipeline/manifold/contact_patch.h"

namespace winnow::WINNOW_ISA_NAME::hull {

/// Distance of the cores (negative: depth) along `normal`, from the first to the second, in the
/// first's frame; `point` is on the first.
template <typename T>
struct HullDistance {
  T distance;
  T error;
  T normal[3];
  T point[3];
  /// Features that touch, for contacts: vertices of the closest simplex are used where this is not
  /// set.
  const HullCandidate* winner;
  /// Room for one that the float search has not found.
  HullCandidate found;
};

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

/// Weights of the point nearest to the origin on the segment w0, w1; on the triangle.
template <typename T>
static inline void nearest_on_segment(const T (*w)[3], T* weight) {
  T e[3];
  for (int k = 0; k < 3; ++k) e[k] = w[1][k] - w[0][k];
  const T length = HullPlace<T>::dot3(e, e);
  const T along = -HullPlace<T>::dot3(e, w[0]);
  T t = length > T(0) ? along / length : T(0);
  t = t > T(0) ? t : T(0);
  t = t < T(1) ? t : T(1);
  weight[0] = T(1) - t;
  weight[1] = t;
}

template <typename T>
static inline T square_of_mix(const T (*w)[3], const T* weight, std::uint32_t count) {
  T square = T(0);
  for (int k = 0; k < 3; ++k) {
    T x = T(0);
    for (std::uint32_t i = 0; i < count; ++i) x += weight[i] * w[i][k];
    square += x * x;
  }
  return square;
}

template <typename T>
static inline void nearest_on_triangle(const T (*w)[3], T* weight) {
  T e[3];
  T f[3];
  for (int k = 0; k < 3; ++k) {
    e[k] = w[1][k] - w[0][k];
    f[k] = w[2][k] - w[0][k];
  }
  const T n[3] = {e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]};
  const T area = HullPlace<T>::dot3(n, n);
  const T* p = w[0];
  // Of the second and the third corner, times the area.
  const T u = n[0] * (f[1] * p[2] - f[2] * p[1]) + n[1] * (f[2] * p[0] - f[0] * p[2]) +
              n[2] * (f[0] * p[1] - f[1] * p[0]);
  const T v = -(n[0] * (e[1] * p[2] - e[2] * p[1]) + n[1] * (e[2] * p[0] - e[0] * p[2]) +
                n[2] * (e[0] * p[1] - e[1] * p[0]));
  if (u >= T(0) && v >= T(0) && u + v <= area && area > T(0)) {
    weight[1] = u / area;
    weight[2] = v / area;
    weight[0] = T(1) - weight[1] - weight[2];
    return;
  }
  T best = T(0);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const T side[2][3] = {{w[i][0], w[i][1], w[i][2]}, {w[j][0], w[j][1], w[j][2]}};
    T t[2];
    nearest_on_segment(side, t);
    const T square = square_of_mix(side, t, 2);
    if (i > 0 && !(square < best)) continue;
    best = square;
    weight[i] = t[0];
    weight[j] = t[1];
    weight[(i + 2) % 3] = T(0);
  }
}

/// Cores that are apart, from the search's simplex.
template <typename T>
static inline void finish_apart(const HullPair& pair, const HullPlace<T>& place,
                                HullDistance<T>& answer) {
  T a[3][3];
  T w[3][3];
  for (std::uint32_t i = 0; i < pair.count; ++i) {
    T b[3];
    vertex_at(*pair.first, pair.vertices[i] & 0xFFFFU, a[i]);
    place.of_second(*pair.second, pair.vertices[i] >> 16U, b);
    for (int k = 0; k < 3; ++k) w[i][k] = a[i][k] - b[k];
  }
  T weight[3] = {T(1), T(0), T(0)};
  if (pair.count == 2) nearest_on_segment(w, weight);
  if (pair.count == 3) nearest_on_triangle(w, weight);
  T gap[3] = {};
  for (int k = 0; k < 3; ++k) {
    answer.point[k] = T(0);
    for (std::uint32_t i = 0; i < pair.count; ++i) {
      gap[k] += weight[i] * w[i][k];
      answer.point[k] += weight[i] * a[i][k];
    }
  }
  const T length = root(HullPlace<T>::dot3(gap, gap));
  const T inverse = T(1) / length;
  for (int k = 0; k < 3; ++k) answer.normal[k] = -gap[k] * inverse;
  const T lower =
      place.lowest_of_second(*pair.second, answer.normal) - height_of(*pair.first, answer.normal);
  const T doubt = length - lower;
  answer.distance = length;
  answer.error = (doubt > T(0) ? doubt : T(0)) + kRounding<T> * static_cast<T>(pair.size);
  answer.winner = nullptr;
  // Not a number if the length is 0.
  if (!(length > T(0))) answer.error = static_cast<T>(__builtin_inf());
}

/// Depth along a unit direction from the first to the second, over all vertices.
template <typename T>
static inline T depth_along(const HullPair& pair, const HullPlace<T>& place, const T* normal) {
  return height_of(*pair.first, normal) - place.lowest_of_second(*pair.second, normal);
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
    for (int i = 0; i < 2; ++i) {
      const double* n = pair_.first->faces[arc.face[0]].normal;
      const double* m = pair_.first->faces[arc.face[1]].normal;
      T theirs[3];
      place_.of_second(*pair_.second, arc.vertex[i], theirs);
      for (int k = 0; k < 3; ++k) {
        end[i][k] = static_cast<T>(arc.s[i]) * static_cast<T>(n[k]) +
                    static_cast<T>(arc.t[i]) * static_cast<T>(m[k]);
        w[i][k] = mine[k] - theirs[k];
      }
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

/// Arcs that float cannot follow: where hulls are nearly parallel, several vertices of the second
/// are as far along a face's normal of the first as float can tell, and the search may have taken
/// the same for both ends of an arc along which they change. Here the vertices that tie are told
/// apart in double, on all arcs around the face.
class HullTies {
 public:
  /// `best` and `lower`: the least depth known and the least that it can be.
  HullTies(const HullPair& pair, const HullPlace<double>& place, double best, double lower)
      : pair_(pair), measure_(pair, place), place_(place), best_(best), lower_(lower) {}

  /// Looks around a face of the first, along whose normal the depth is known; false if there is
  /// more to look at than there is room for.
  bool around(std::uint32_t face, double depth) {
    const HullFace& f = pair_.first->faces[face];
    if (!find_ties(f.normal, f.offset - depth)) return false;
    return count_ < 2 || follow_all(face);
  }

  /// Looks again at an arc on which a third vertex is nearer than the two that were found.
  bool along_arc(const HullArc& arc) {
    measure_.arc(arc);
    const double high = height_of(*pair_.first, measure_.normal);
    if (!find_ties(measure_.normal, high - measure_.depth) || count_ < 2) return false;
    const HullFace* faces = pair_.first->faces;
    double ends[2][3];
    for (int i = 0; i < 2; ++i) {
      for (int k = 0; k < 3; ++k) {
        ends[i][k] = static_cast<double>(arc.s[i]) * faces[arc.face[0]].normal[k] +
                     static_cast<double>(arc.t[i]) * faces[arc.face[1]].normal[k];
      }
    }
    return follow(arc.edge, ends[0], ends[1]);
  }

  void bound(double depth) { lower_ = depth < lower_ ? depth : lower_; }

  [[nodiscard]] double best() const { return best_; }
  [[nodiscard]] double lower() const { return lower_; }
  [[nodiscard]] bool found() const { return found_; }
  [[nodiscard]] const HullCandidate& winner() const { return winner_; }
  [[nodiscard]] const double* normal() const { return normal_; }

 private:
  static constexpr std::uint32_t kMostTies = 32;
  static constexpr int kMostParts = 16;

  /// Between two directions along which two vertices of the second are the nearest.
  struct Part {
    double end[2][3];
    std::uint32_t vertex[2];
  };

  [[gnu::noinline]] bool follow_all(std::uint32_t face) {
    const HullShape& hull = *pair_.first;
    for (std::uint32_t i = 0; i < hull.faces[face].count; ++i) {
      const std::uint32_t edge = hull.loop_edge[hull.faces[face].first + i];
      const std::uint32_t* sides = hull.edges[edge].face;
      const std::uint32_t other = sides[0] == face ? sides[1] : sides[0];
      if (!follow(edge, hull.faces[face].normal, hull.faces[other].normal)) return false;
    }
    return true;
  }

  /// Those of which float could not tell which is the lowest, `least` or a little higher.
  bool find_ties(const double* normal, double least) {
    constexpr std::uint32_t kWidth = Lanes<double>::kCount;
    const HullShape& second = *pair_.second;
    double local[3];
    turn_back3(place_.turn, normal, local);
    for (double& x : local) x = -x;
    const double doubt = 4.0 * static_cast<double>(kFloatError) * pair_.size;
    const Lanes<double> limit(dot3(normal, place_.shift) - least - doubt);
    const Vec3<double> d{local[0], local[1], local[2]};
    count_ = 0;
    for (std::uint32_t row = 0; row < second.vertex_count; row += kWidth) {
      Mask16 high = bits(along(second.vertex, row, d) >= limit);
      const std::uint32_t left = second.vertex_count - row;
      if (left < kWidth) high &= lanes_below(left);
      for (; high != 0; high &= high - 1) {
        if (count_ == kMostTies) return false;
        tied_[count_++] = row + winnow::WINNOW_ISA_NAME::first(high);
      }
    }
    return true;
  }

  /// Of the vertices that tie the one farthest against a direction.
  [[nodiscard]] std::uint32_t nearest(const double* direction) const {
    std::uint32_t best = tied_[0];
    double least = __builtin_inf();
    for (std::uint32_t i = 0; i < count_; ++i) {
      double x[3];
      place_.of_second(*pair_.second, tied_[i], x);
      const double height = dot3(direction, x);
      best = height < least ? tied_[i] : best;
      least = height < least ? height : least;
    }
    return best;
  }

  bool follow(std::uint32_t edge, const double* from, const double* to) {
    const double* ends[2] = {from, to};
    Part stack[kMostParts];
    for (int i = 0; i < 2; ++i) {
      for (int k = 0; k < 3; ++k) stack[0].end[i][k] = ends[i][k];
      stack[0].vertex[i] = nearest(ends[i]);
    }
    vertex_at(*pair_.first, pair_.first->edges[edge].vertex[0], mine_);
    int height = 1;
    for (int looked = 0; height > 0; ++looked) {
      if (looked == kMostParts || height + 1 >= kMostParts) return false;
      const Part part = stack[--height];
      look(edge, part, stack, height);
    }
    return true;
  }

  /// Bounds a part of an arc, or puts its halves on the stack where a third vertex is nearer.
  void look(std::uint32_t edge, const Part& part, Part* stack, int& height) {
    double w[2][3];
    for (int i = 0; i < 2; ++i) {
      double theirs[3];
      place_.of_second(*pair_.second, part.vertex[i], theirs);
      for (int k = 0; k < 3; ++k) w[i][k] = mine_[k] - theirs[k];
    }
    const double rounding = kDoubleError * pair_.size;
    // One vertex, whose height is least at an end.
    if (part.vertex[0] == part.vertex[1]) {
      for (const double(&end)[3] : part.end) {
        bound(dot3(end, w[0]) / __builtin_sqrt(dot3(end, end)) + rounding);
      }
      return;
    }
    measure_.crossing(part.end, w);
    measure_.bound_ends(part.end, w);
    if (measure_.lower + rounding >= best_) return;
    const double* normal = measure_.normal;
    std::uint32_t third = nearest(normal);
    if (measure_.depth < best_) keep(edge, part);
    if (measure_.depth - measure_.lower <= rounding || third == part.vertex[0] ||
        third == part.vertex[1]) {
      return bound(measure_.lower);
    }
    Part halves[2] = {part, part};
    for (int k = 0; k < 3; ++k) halves[0].end[1][k] = halves[1].end[0][k] = normal[k];
    halves[0].vertex[1] = third;
    halves[1].vertex[0] = third;
    stack[height++] = halves[0];
    stack[height++] = halves[1];
  }

  void keep(std::uint32_t edge, const Part& part) {
    found_ = true;
    best_ = measure_.depth;
    for (int k = 0; k < 3; ++k) normal_[k] = measure_.normal[k];
    winner_.kind = HullCandidate::Kind::arc;
    winner_.arc.edge = edge;
    winner_.arc.vertex[0] = part.vertex[0];
    winner_.arc.vertex[1] = part.vertex[1];
  }

  const HullPair& pair_;
  HullMeasure<double> measure_;
  const HullPlace<double>& place_;
  double best_;
  double lower_;
  bool found_ = false;
  double normal_[3];
  HullCandidate winner_ = {};
  /// The vertex of the first at whose edge an arc lies.
  double mine_[3];
  std::uint32_t count_ = 0;
  std::uint32_t tied_[kMostTies];
};

/// What candidates of the float search may have missed. False if that cannot be told.
static inline bool finish_ties(const HullPair& pair, const HullPlace<double>& place,
                               const HullDepth& found, const double* depth, const double* least,
                               double& best, double& lower, HullDistance<double>& answer) {
  HullTies ties(pair, place, best, __builtin_inf());
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

/// Cores that overlap: measures the candidates. The error is not small where a candidate that is
/// left out in double is not surely deeper.
template <typename T>
static inline void finish_depth(const HullPair& pair, const HullPlace<T>& place,
                                const HullDepth& found, HullDistance<T>& answer) {
  HullMeasure<T> measure(pair, place);
  T best = static_cast<T>(__builtin_inf());
  T lower = best;
  T depth[HullDepth::kMostCandidates];
  T least[HullDepth::kMostCandidates];
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
  bool sure = answer.winner != nullptr;
  if constexpr (sizeof(T) == sizeof(double)) {
    sure = sure && finish_ties(pair, place, found, depth, least, best, lower, answer);
  }
  const T doubt = best - lower;
  answer.distance = -best;
  answer.error = (doubt > T(0) ? doubt : T(0)) + kRounding<T> * static_cast<T>(pair.size);
  if (!sure) answer.error = static_cast<T>(__builtin_inf());
}

/// Where the second's vertex nearest to the first's inside touches, or the first's; false if the
/// touching features are parallel, so that one vertex does not tell.
template <typename T>
static inline bool touching_point(const HullPair& pair, const HullPlace<T>& place,
                                  HullDistance<T>& answer) {
  using Kind = HullCandidate::Kind;
  const HullCandidate& c = *answer.winner;
  if (c.kind == Kind::arc) {
    const HullEdge& edge = pair.first->edges[c.arc.edge];
    T a[2][3];
    T b[2][3];
    for (int i = 0; i < 2; ++i) {
      vertex_at(*pair.first, edge.vertex[i], a[i]);
      place.of_second(*pair.second, c.arc.vertex[i], b[i]);
    }
    T d[3];
    T e[3];
    T r[3];
    for (int k = 0; k < 3; ++k) {
      d[k] = a[1][k] - a[0][k];
      e[k] = b[1][k] - b[0][k];
      r[k] = b[0][k] - a[0][k];
    }
    // Across the second edge and the normal: where the edges cross as seen along the normal.
    const T* n = answer.normal;
    const T across[3] = {e[1] * n[2] - e[2] * n[1], e[2] * n[0] - e[0] * n[2],
                         e[0] * n[1] - e[1] * n[0]};
    const T sine = HullPlace<T>::dot3(across, d);
    const T t = HullPlace<T>::dot3(across, r) / sine;
    for (int k = 0; k < 3; ++k) answer.point[k] = a[0][k] + t * d[k];
    return t >= T(0) && t <= T(1);
  }
  const bool mine = c.kind == Kind::second_face;
  const HullShape& hull = mine ? *pair.first : *pair.second;
  T direction[3];
  if (mine) {
    for (int k = 0; k < 3; ++k) direction[k] = answer.normal[k];
  } else {
    turn_back3(place.turn, answer.normal, direction);
    for (T& x : direction) x = -x;
  }
  std::uint32_t vertex = 0;
  const T doubt = T(8) * kRounding<T> * static_cast<T>(pair.size);
  if (!sole_vertex(hull, direction, doubt, vertex)) return false;
  if (mine) {
    vertex_at(hull, vertex, answer.point);
  } else {
    place.of_second(hull, vertex, answer.point);
    for (int k = 0; k < 3; ++k) answer.point[k] -= answer.distance * answer.normal[k];
  }
  return true;
}

/// The supporting feature of one hull, in the axes of the world.
class HullPatch {
 public:
  /// `first`: of the first hull, else of the second. `normal`: from the first to the second, in the
  /// first's frame.
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
    // Of polygons with more corners than there is room for, every second (third, ...) is taken.
    const std::uint32_t stride = (f.count + kRoom - 1) / kRoom;
    count_ = 0;
    for (std::uint32_t i = 0; i < f.count; i += stride) {
      add(hull_.loop[f.first + i], hull_.loop_edge[f.first + i]);
    }
    feature_ = index;
  }

  /// An edge, or a face beside it that lies across the normal as well: what touches along the edge
  /// is about to touch there.
  void edge(std::uint32_t index) {
    std::uint32_t best = kNoFeature;
    double most = kFaceCosine;
    for (const std::uint32_t side : hull_.edges[index].face) {
      if (side >= hull_.face_count) continue;
      const double cosine = dot3(hull_.faces[side].normal, outward_);
      if (!(cosine > most)) continue;
      most = cosine;
      best = side;
    }
    if (best != kNoFeature) return face(best);
    edge_alone(index);
  }

  /// The same by its ends; what `across` finds if there is no such edge.
  void edge_between(std::uint32_t v, std::uint32_t w) {
    const std::uint32_t index = edge_of(v, w);
    if (index == kNoFeature) return across();
    edge(index);
  }

  /// The same by the supporting vertices of a simplex: the features that are closest.
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

  /// The face, edge or vertex that lies farthest along the normal: features within some degrees
  /// of perpendicular to it count as lying across it, since bodies rock over them.
  void across() {
    const float direction[3] = {static_cast<float>(outward_[0]), static_cast<float>(outward_[1]),
                                static_cast<float>(outward_[2])};
    across_at(farthest_vertex(hull_, direction));
  }

  /// The same for a vertex that lies farthest.
  void across_at(std::uint32_t vertex) {
    const float direction[3] = {static_cast<float>(outward_[0]), static_cast<float>(outward_[1]),
                                static_cast<float>(outward_[2])};
    float x[3];
    vertex_at(hull_, vertex, x);
    const float slack = kFloatError * static_cast<float>(pair_.size);
    const std::uint32_t face_index = face_across(hull_, direction, x, slack);
    if (face_index != kNoFeature) return face(face_index);
    const std::uint32_t other = neighbour_across(hull_, direction, vertex, x);
    if (other != kNoFeature) return edge_alone(edge_of(vertex, other));
    vertex_alone(vertex);
  }

  /// Of a simple shape all that there is: the face that looks along the normal however steeply, a
  /// segment, a point.
  void whole() {
    if (hull_.dimension == 0) return vertex_alone(0);
    if (hull_.dimension == 1) return edge_alone(0);
    std::uint32_t best = 0;
    for (std::uint32_t i = 1; i < hull_.face_count; ++i) {
      const bool better =
          dot3(hull_.faces[i].normal, outward_) > dot3(hull_.faces[best].normal, outward_);
      best = better ? i : best;
    }
    face(best);
  }

  [[nodiscard]] Patch patch() const {
    return {vertex_, vertex_feature_, edge_feature_, count_, feature_, hull_.rounding};
  }

 private:
  static constexpr std::uint32_t kRoom = 32;

  [[nodiscard]] std::uint32_t edge_of(std::uint32_t v, std::uint32_t w) const {
    for (std::uint32_t i = 0; i < hull_.edge_count; ++i) {
      const std::uint32_t* ends = hull_.edges[i].vertex;
      if ((ends[0] == v && ends[1] == w) || (ends[0] == w && ends[1] == v)) return i;
    }
    return kNoFeature;
  }

  void edge_alone(std::uint32_t index) {
    const std::uint32_t* ends = hull_.edges[index].vertex;
    count_ = 0;
    add(ends[0] < ends[1] ? ends[0] : ends[1], index);
    add(ends[0] < ends[1] ? ends[1] : ends[0], index);
    feature_ = hull_.face_count + index;
  }

  void vertex_alone(std::uint32_t vertex) {
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
    double* r = vertex_[count_];
    turn3(pair_.frame, x, r);
    if (pair_.swapped) {
      for (int k = 0; k < 3; ++k) r[k] -= pair_.offset[k];
    }
    vertex_feature_[count_] = vertex;
    edge_feature_[count_++] = edge_feature;
  }

  const HullPair& pair_;
  const HullShape& hull_;
  bool first_;
  /// In the hull's own frame.
  double outward_[3];
  std::uint32_t count_ = 0;
  std::uint32_t feature_ = 0;
  double vertex_[kRoom][3];
  std::uint32_t vertex_feature_[kRoom];
  std::uint32_t edge_feature_[kRoom];
};

/// The feature of one of the hulls in which they touch: that of the depth's winner, or, without
/// one, of the closest vertices.
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

/// What is asked of the contacts of a pair.
struct HullContacts {
  /// In the first's frame, and from body a to body b in the axes of the world.
  const double* normal;
  const double* world;
  double margin;
  /// The pair's, and how far the deepest contact may be from it.
  double distance;
  double doubt;
};

/// Writes the contacts of a pair and returns their number; 0 if the features do not meet where the
/// pair is deepest. `Simple`: the second is no hull but stands for a sphere, capsule, box or
/// triangle.
template <bool Simple>
static inline std::uint32_t write_contacts(const HullPair& pair, const HullContacts& ask,
                                           const HullCandidate* winner, ContactWriter& writer) {
  HullPatch first(pair, ask.normal, true);
  HullPatch second(pair, ask.normal, false);
  find_feature(pair, winner, true, first);
  if constexpr (Simple) {
    second.whole();
  } else {
    find_feature(pair, winner, false, second);
  }
  ContactPoint points[kManifoldPoints];
  const std::uint32_t count =
      contact_patch(pair.swapped ? second.patch() : first.patch(),
                    pair.swapped ? first.patch() : second.patch(), ask.world, ask.margin, points);
  const double miss = __builtin_fabs(static_cast<double>(points[0].depth) + ask.distance);
  if (count == 0 || !(miss <= ask.doubt)) return 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t to = writer.size + i;
    for (int k = 0; k < 3; ++k) writer.position[k][to] = points[i].position[k];
    writer.depth[to] = points[i].depth;
    writer.feature[to] = points[i].feature;
  }
  writer.size += count;
  return count;
}

}  // namespace winnow::WINNOW_ISA_NAME::hull
