#pragma once

// Contacts of two hulls: finds their supporting features along a normal, and passes them as patches
// to contact_patch.

#include "pipeline/kernels/hull/hull_depth.wide.h"
#include "pipeline/kernels/hull/hull_features.wide.h"
#include "pipeline/manifold/contact_patch.h"

namespace winnow::WINNOW_ISA_NAME::hull {

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
      const double cosine = dot3(hull_.faces[side].normal, outward_);
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
      const bool better =
          dot3(hull_.faces[i].normal, outward_) > dot3(hull_.faces[best].normal, outward_);
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
