#pragma once

// The feature of a hull at its supporting vertex along a direction: a face or an edge that is
// within 14 degrees of perpendicular to the direction (contact_patch.h), or else the vertex. The
// limit is wide because bodies rock over their faces and edges.

#include "pipeline/kernels/hull/hull_pair.wide.h"
#include "pipeline/manifold/contact_patch.h"

namespace winnow::WINNOW_ISA_NAME::hull {

inline constexpr std::uint32_t kNoFeature = ~0U;

/// The edge between two vertices.
static inline std::uint32_t find_edge(const HullShape& hull, std::uint32_t v, std::uint32_t w) {
  for (std::uint32_t i = 0; i < hull.edge_count; ++i) {
    const std::uint32_t* ends = hull.edges[i].vertex;
    if ((ends[0] == v && ends[1] == w) || (ends[0] == w && ends[1] == v)) return i;
  }
  return kNoFeature;
}

/// Cosines that differ by at most this may be in the wrong order in float.
inline constexpr float kTiedCosines = 1e-6F;

/// `face_across` in double, for faces that are nearly coplanar.
static inline std::uint32_t tied_face_across(const HullShape& hull, const double* direction,
                                             const float* x, float doubt) {
  const float* const* plane = hull.plane_float;
  std::uint32_t best = kNoFeature;
  double most = kFaceCosine;
  for (std::uint32_t i = 0; i < hull.face_count; ++i) {
    const float n[3] = {plane[0][i], plane[1][i], plane[2][i]};
    const double cosine = dot3(hull.faces[i].normal, direction);
    if (!(cosine > most) || !(plane[3][i] - dot3(n, x) <= doubt)) continue;
    most = cosine;
    best = i;
  }
  return best;
}

/// Returns the face that is most along the direction, among the faces whose planes pass within
/// `doubt` of the vertex at x; kNoFeature if no cosine is above kFaceCosine.
static inline std::uint32_t face_across(const HullShape& hull, const double* direction,
                                        const float* x, float doubt) {
  const float* const* plane = hull.plane_float;
  const Vec3<float> along{static_cast<float>(direction[0]), static_cast<float>(direction[1]),
                          static_cast<float>(direction[2])};
  const Floats slack(doubt);
  std::uint32_t best = kNoFeature;
  auto most = static_cast<float>(kFaceCosine);
  float next = most;
  for (std::uint32_t row = 0; row < hull.face_count; row += kLanes) {
    const Vec3<float> n{Floats::load(plane[0] + row), Floats::load(plane[1] + row),
                        Floats::load(plane[2] + row)};
    const Floats cosine = dot(n, along);
    const Floats below = Floats::load(plane[3] + row) - dot(n, Vec3<float>{x[0], x[1], x[2]});
    Mask16 hit = bits((cosine > Floats(next)) & (below <= slack));
    const std::uint32_t left = hull.face_count - row;
    if (left < kLanes) hit &= lanes_below(left);
    if (hit == 0) continue;
    alignas(64) float value[kLanes];
    cosine.store(value);
    for (; hit != 0; hit &= hit - 1) {
      const unsigned lane = winnow::WINNOW_ISA_NAME::first(hit);
      if (!(value[lane] > most)) {
        next = value[lane] > next ? value[lane] : next;
        continue;
      }
      next = most;
      most = value[lane];
      best = row + lane;
    }
  }
  const bool is_tied = best != kNoFeature && most - next <= kTiedCosines;
  return is_tied ? tied_face_across(hull, direction, x, doubt) : best;
}

/// Returns the neighbour to which the edge from a vertex is closest to perpendicular to the
/// direction; kNoFeature if no edge is within kEdgeSine of it.
static inline std::uint32_t neighbour_across(const HullShape& hull, const float* direction,
                                             std::uint32_t vertex, const float* x) {
  std::uint32_t best = kNoFeature;
  auto least = static_cast<float>(kEdgeSine * kEdgeSine);
  if (hull.dimension == 0) return best;
  for (std::uint32_t i = hull.neighbour_first[vertex]; i < hull.neighbour_first[vertex + 1]; ++i) {
    float y[3];
    vertex_at(hull, hull.neighbour[i], y);
    for (int k = 0; k < 3; ++k) y[k] -= x[k];
    const float drop = dot3(direction, y);
    const float slope = drop * drop / dot3(y, y);
    if (!(slope < least)) continue;
    least = slope;
    best = hull.neighbour[i];
  }
  return best;
}

}  // namespace winnow::WINNOW_ISA_NAME::hull
