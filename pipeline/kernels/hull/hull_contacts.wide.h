#pragma once

// The features of two hulls that meet along a normal, as patches for contact_patch.

#include "pipeline/kernels/hull/hull_finish.wide.h"
#include "pipeline/manifold/contact_patch.h"

namespace winnow::WINNOW_ISA_NAME {

/// The supporting feature of one hull, in the axes of the world.
class HullPatch {
 public:
  /// `first`: of the first hull, else of the second. `normal` points from the first to the second.
  HullPatch(const HullPair& pair, bool first)
      : pair_(pair), hull_(first ? *pair.first : *pair.second), first_(first) {}

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

  void edge(std::uint32_t v, std::uint32_t w) {
    std::uint32_t index = 0;
    while (index + 1 < hull_.edge_count && !joins(hull_.edges[index], v, w)) ++index;
    count_ = 0;
    add(v < w ? v : w, index);
    add(v < w ? w : v, index);
    feature_ = hull_.face_count + index;
  }

  /// The face, edge or vertex that lies farthest along the normal: features within some degrees
  /// of perpendicular to it count as lying across it, since bodies rock over them.
  void across(const double* normal) {
    double d[3];
    if (first_) {
      for (int k = 0; k < 3; ++k) d[k] = normal[k];
    } else {
      turn_back3(pair_.turn, normal, d);
      for (double& x : d) x = -x;
    }
    const float direction[3] = {static_cast<float>(d[0]), static_cast<float>(d[1]),
                                static_cast<float>(d[2])};
    const std::uint32_t vertex = farthest_vertex(hull_, direction);
    float x[3];
    vertex_at(hull_, vertex, x);
    const std::uint32_t face_index = face_across(direction, x);
    if (face_index != kNone) return face(face_index);
    const std::uint32_t other = neighbour_across(direction, vertex, x);
    if (other != kNone) return edge(vertex, other);
    count_ = 0;
    add(vertex, 0);
    feature_ = hull_.face_count + hull_.edge_count + vertex;
  }

  [[nodiscard]] Patch patch() const {
    return {vertex_, vertex_feature_, edge_feature_, count_, feature_, hull_.rounding};
  }

 private:
  static constexpr std::uint32_t kRoom = 32;
  static constexpr std::uint32_t kNone = ~0U;
  /// Cosine and sine of about 14 degrees, as in the solver.
  static constexpr float kAligned = 0.97F;
  static constexpr float kTilted = 0.25F;

  static bool joins(const HullEdge& e, std::uint32_t v, std::uint32_t w) {
    return (e.vertex[0] == v && e.vertex[1] == w) || (e.vertex[0] == w && e.vertex[1] == v);
  }

  /// The face most along the direction of those at the vertex at x.
  [[nodiscard]] std::uint32_t face_across(const float* direction, const float* x) const {
    const float* const* plane = hull_.plane_float;
    const Floats slack(kFloatError * static_cast<float>(pair_.size));
    std::uint32_t best = kNone;
    float most = kAligned;
    for (std::uint32_t row = 0; row < hull_.face_count; row += 16) {
      const Vec3<float> n{Floats::load(plane[0] + row), Floats::load(plane[1] + row),
                          Floats::load(plane[2] + row)};
      const Floats cosine = dot(n, Vec3<float>{direction[0], direction[1], direction[2]});
      const Floats below = Floats::load(plane[3] + row) - dot(n, Vec3<float>{x[0], x[1], x[2]});
      Mask16 hit = bits((cosine > Floats(most)) & (below <= slack));
      const std::uint32_t left = hull_.face_count - row;
      if (left < 16) hit &= lanes_below(left);
      if (hit == 0) continue;
      alignas(64) float value[16];
      cosine.store(value);
      for (; hit != 0; hit &= hit - 1) {
        const unsigned lane = winnow::WINNOW_ISA_NAME::first(hit);
        if (!(value[lane] > most)) continue;
        most = value[lane];
        best = row + lane;
      }
    }
    return best;
  }

  /// The neighbour of a vertex that lies least below it.
  [[nodiscard]] std::uint32_t neighbour_across(const float* direction, std::uint32_t vertex,
                                               const float* x) const {
    std::uint32_t best = kNone;
    float least = kTilted * kTilted;
    if (hull_.dimension == 0) return best;
    for (std::uint32_t i = hull_.neighbour_first[vertex]; i < hull_.neighbour_first[vertex + 1];
         ++i) {
      float y[3];
      vertex_at(hull_, hull_.neighbour[i], y);
      for (int k = 0; k < 3; ++k) y[k] -= x[k];
      const float drop = dot3(direction, y);
      const float slope = drop * drop / dot3(y, y);
      if (!(slope < least)) continue;
      least = slope;
      best = hull_.neighbour[i];
    }
    return best;
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
  std::uint32_t count_ = 0;
  std::uint32_t feature_ = 0;
  double vertex_[kRoom][3];
  std::uint32_t vertex_feature_[kRoom];
  std::uint32_t edge_feature_[kRoom];
};

/// Writes the contacts of a pair: `normal` in the first's frame and, `world`, from body a to body b
/// in the axes of the world. Returns their number.
static inline std::uint32_t write_contacts(const HullPair& pair, const double* normal,
                                           const double* world, const HullCandidate* winner,
                                           double margin, ContactWriter& writer) {
  using Kind = HullCandidate::Kind;
  HullPatch first(pair, true);
  HullPatch second(pair, false);
  if (winner != nullptr && winner->kind == Kind::arc) {
    const HullEdge& edge = pair.first->edges[winner->arc.edge];
    first.edge(edge.vertex[0], edge.vertex[1]);
    second.edge(winner->arc.vertex[0], winner->arc.vertex[1]);
  } else {
    if (winner != nullptr && winner->kind == Kind::first_face) {
      first.face(winner->face);
    } else {
      first.across(normal);
    }
    if (winner != nullptr && winner->kind == Kind::second_face) {
      second.face(winner->face);
    } else {
      second.across(normal);
    }
  }
  ContactPoint points[kManifoldPoints];
  const std::uint32_t count =
      contact_patch(pair.swapped ? second.patch() : first.patch(),
                    pair.swapped ? first.patch() : second.patch(), world, margin, points);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t to = writer.size + i;
    for (int k = 0; k < 3; ++k) writer.position[k][to] = points[i].position[k];
    writer.depth[to] = points[i].depth;
    writer.feature[to] = points[i].feature;
  }
  writer.size += count;
  return count;
}

}  // namespace winnow::WINNOW_ISA_NAME
