#pragma once

// Contact manifolds of the solver: computes the supporting features of two cores and passes them to
// manifold/contact_patch.h.

#include "pipeline/manifold/contact_patch.h"
#include "pipeline/manifold/feature_rules.h"
#include "pipeline/solver/core.h"
#include "pipeline/solver/problem.h"
#include "pipeline/solver/solver.h"

#include <array>
#include <cstdint>

namespace winnow::solver {

/// The supporting feature of a core with its feature numbers, in units of the problem.
class SupportingPatch {
 public:
  /// Maximal number of vertices.
  static constexpr std::uint32_t kRoom = kPatchRoom;

  /// Finds the feature farthest along `outward`: a face of a box, a triangle, a segment, a face,
  /// edge or vertex of a hull, a cap of a cylinder or cone as a polygon of 16 corners or a line of
  /// its side, the line between the balls of a tapered capsule, or, for a support function, the
  /// support points of eight directions around `outward`. Features may deviate from `outward` by
  /// the angles of feature_rules.h, because bodies rock over them; each contains the supporting
  /// point. Corners of boxes are numbered by the bits x > 0, y > 0, z > 0; edges by 4 x their axis
  /// plus the bits of the other axes; faces by 2 x their axis plus the sign. Caps begin at +x and
  /// are numbered around the rim.
  SupportingPatch(const Core& core, const Vec& outward) noexcept;

  /// A square on the face of a half-space around the projection of `middle`, `reach` to each side.
  static SupportingPatch of_half_space(const Core& core, const Vec& middle, double reach) noexcept;

  [[nodiscard]] SupportingFeature view() const noexcept {
    return {vertex_, vertex_feature_.data(), edge_feature_.data(), count_, feature_, rounding_};
  }

  // Called by the form of the core (core_forms.h).
  void add(const Vec& v, std::uint32_t vertex_feature, std::uint32_t edge_feature) noexcept;
  void set_feature(std::uint32_t feature) noexcept { feature_ = feature; }

 private:
  SupportingPatch() noexcept = default;

  double vertex_[kRoom][3];
  std::array<std::uint32_t, kRoom> vertex_feature_;
  std::array<std::uint32_t, kRoom> edge_feature_;
  std::uint32_t count_ = 0;
  std::uint32_t feature_ = 0;
  double rounding_ = 0.0;
};

/// Sets the contacts of an answer whose normal is already set: calls contact_patch for the
/// supporting features of both cores. `point` is on the surface of a; `point` and `distance` are in
/// units of the problem. Writes at least one point. The depth of the deepest point is -distance.
void make_manifold(const Problem& problem, const Vec& point, double distance, double margin,
                   PairAnswer& answer) noexcept;

/// Finds all corners of the intersection of the supporting features along `normal`; a manifold
/// keeps at most four of them. In units of the problem. `out` has room for kMaxIntersectionCorners.
std::uint32_t intersection_corners(const Problem& problem, const Vec& normal, double margin,
                                   ContactPoint* out) noexcept;

}  // namespace winnow::solver
