#pragma once

// Completes the search of hull_depth.wide.h in double for nearly parallel hulls. Called by
// hull_finish.wide.h.

#include "pipeline/kernels/hull/hull_measure.wide.h"

namespace winnow::WINNOW_ISA_NAME::hull {

/// Searches arcs that float cannot resolve. If hulls are nearly parallel, several vertices of the
/// second are equally far along a face normal of the first, up to the errors of float, and the
/// float search may have found the same vertex at both ends of an arc along which the vertex
/// changes. This class distinguishes them in double, on all arcs around the face.
class HullTies {
 public:
  /// `best` is the smallest depth found, `lower` a lower bound of the depth.
  HullTies(const HullPair& pair, double best, double lower)
      : pair_(pair), measure_(pair), best_(best), lower_(lower) {}

  /// Searches around a face of the first, along whose normal the depth is `depth`; returns false if
  /// there is more to search than there is room for.
  bool around(std::uint32_t face, double depth) {
    const HullFace& f = pair_.first->faces[face];
    return !has_ties(f.normal, f.offset - depth) || follow_all(face, f.offset - depth);
  }

  /// Searches an arc again on which a third vertex is nearer than the two that were found.
  bool along_arc(const HullArc& arc) {
    measure_.arc(arc);
    const double high = height_of(*pair_.first, measure_.normal);
    if (!has_ties(measure_.normal, high - measure_.depth)) return false;
    double ends[2][3];
    arc_ends(pair_, arc, ends);
    vertex_at(*pair_.first, pair_.first->edges[arc.edge].vertex[0], mine_);
    return follow(arc.edge, ends[0], ends[1]);
  }

  void bound(double depth) { lower_ = depth < lower_ ? depth : lower_; }

  [[nodiscard]] double best() const { return best_; }
  [[nodiscard]] double lower() const { return lower_; }
  [[nodiscard]] bool found() const { return found_; }
  [[nodiscard]] const HullCandidate& winner() const { return winner_; }
  [[nodiscard]] const double* normal() const { return normal_; }

 private:
  static constexpr int kMaxParts = 16;

  /// Part of an arc between two directions, and the supporting vertices of the second there.
  struct ArcPart {
    double end[2][3];
    std::uint32_t vertex[2];
  };

  /// `least`: the height of the second's lowest vertices along the face's normal.
  [[gnu::noinline]] bool follow_all(std::uint32_t face, double least) {
    const HullShape& hull = *pair_.first;
    const double* normal = hull.faces[face].normal;
    double local[3];
    against(normal, local);
    double tied[3];
    const double height = dot3(normal, pair_.shift) - least;
    middle_from(*pair_.second, local, height - kDoubleError * pair_.size, tied);
    double middle[3];
    turn3(pair_.turn, tied, middle);
    for (int k = 0; k < 3; ++k) middle[k] += pair_.shift[k];
    for (std::uint32_t i = 0; i < hull.faces[face].count; ++i) {
      const std::uint32_t edge = hull.loop_edge[hull.faces[face].first + i];
      const std::uint32_t* sides = hull.edges[edge].face;
      const std::uint32_t other = sides[0] == face ? sides[1] : sides[0];
      vertex_at(hull, hull.edges[edge].vertex[0], mine_);
      if (is_deep(middle, normal, hull.faces[other].normal)) continue;
      if (!follow(edge, normal, hull.faces[other].normal)) return false;
    }
    return true;
  }

  /// True if several vertices are within float's errors of the lowest, whose height is `least`.
  [[nodiscard]] bool has_ties(const double* normal, double least) const {
    const double doubt = 4.0 * static_cast<double>(kFloatError) * pair_.size;
    double local[3];
    against(normal, local);
    std::uint32_t vertex = 0;
    const double height = dot3(normal, pair_.shift) - least;
    return !sole_vertex_from(*pair_.second, local, height - doubt, vertex);
  }

  /// The vertex of the second that is farthest against a direction.
  [[nodiscard]] std::uint32_t nearest(const double* direction) const {
    double local[3];
    against(direction, local);
    return highest_vertex<double>(*pair_.second, {local[0], local[1], local[2]});
  }

  /// The opposite direction, in the second's frame.
  void against(const double* direction, double* local) const {
    turn_back3(pair_.turn, direction, local);
    for (int k = 0; k < 3; ++k) local[k] = -local[k];
  }

  bool follow(std::uint32_t edge, const double* from, const double* to) {
    const std::uint32_t last = nearest(to);
    double theirs[3];
    second_vertex_at(pair_, last, theirs);
    if (is_deep(theirs, from, to)) return true;
    const double* ends[2] = {from, to};
    ArcPart stack[kMaxParts];
    for (int i = 0; i < 2; ++i) {
      for (int k = 0; k < 3; ++k) stack[0].end[i][k] = ends[i][k];
    }
    stack[0].vertex[0] = nearest(from);
    stack[0].vertex[1] = last;
    int height = 1;
    for (int tested = 0; height > 0; ++tested) {
      if (tested == kMaxParts || height + 1 >= kMaxParts) return false;
      const ArcPart part = stack[--height];
      bound_part(edge, part, stack, height);
    }
    return true;
  }

  /// Bounds an arc by one point of the second if at both ends that point is at least as deep as the
  /// best: its height is concave in between.
  bool is_deep(const double* point, const double* from, const double* to) {
    double w[3];
    for (int k = 0; k < 3; ++k) w[k] = mine_[k] - point[k];
    const double here = dot3(from, w) / __builtin_sqrt(dot3(from, from));
    const double there = dot3(to, w) / __builtin_sqrt(dot3(to, to));
    const double height = (here < there ? here : there) + kDoubleError * pair_.size;
    if (!(height >= best_)) return false;
    bound(height);
    return true;
  }

  /// Bounds a part of an arc, or pushes its halves on the stack if a third vertex is nearer.
  void bound_part(std::uint32_t edge, const ArcPart& part, ArcPart* stack, int& height) {
    double w[2][3];
    for (int i = 0; i < 2; ++i) {
      double theirs[3];
      second_vertex_at(pair_, part.vertex[i], theirs);
      for (int k = 0; k < 3; ++k) w[i][k] = mine_[k] - theirs[k];
    }
    const double rounding = kDoubleError * pair_.size;
    // With a single vertex, the height is lowest at an end.
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
    ArcPart halves[2] = {part, part};
    for (int k = 0; k < 3; ++k) halves[0].end[1][k] = halves[1].end[0][k] = normal[k];
    halves[0].vertex[1] = third;
    halves[1].vertex[0] = third;
    stack[height++] = halves[0];
    stack[height++] = halves[1];
  }

  void keep(std::uint32_t edge, const ArcPart& part) {
    found_ = true;
    best_ = measure_.depth;
    for (int k = 0; k < 3; ++k) normal_[k] = measure_.normal[k];
    winner_.kind = HullCandidate::Kind::arc;
    winner_.arc.edge = edge;
    winner_.arc.vertex[0] = part.vertex[0];
    winner_.arc.vertex[1] = part.vertex[1];
  }

  const HullPair& pair_;
  HullMeasure measure_;
  double best_;
  double lower_;
  bool found_ = false;
  double normal_[3];
  HullCandidate winner_ = {};
  /// A vertex of the first on the edge of the arc.
  double mine_[3];
};

}  // namespace winnow::WINNOW_ISA_NAME::hull
