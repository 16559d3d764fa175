#pragma once

#include "pipeline/manifold/contact_patch.h"
#include "pipeline/solver/core.h"
#include "pipeline/solver/problem.h"
#include "pipeline/solver/solver.h"

#include <array>
#include <cstdint>

namespace winnow::solver {

/// A feature of a core with its numbers, in units of the problem: what contact_patch takes.
class SupportingPatch {
 public:
  /// No patch has more vertices.
  static constexpr std::uint32_t kRoom = kPatchRoom;

  /// The feature that lies farthest along `outward`: a box's face, a triangle, a segment, a hull's
  /// face, edge or vertex, a cylinder's or cone's cap as a polygon of 16 or a line of its side, the
  /// line between a tapered capsule's balls, what is farthest along eight directions around of a
  /// support function.
  /// Features some degrees off count as well, since bodies rock over them; all of them hold the
  /// supporting point. Corners of boxes are numbered by the bits x > 0, y > 0, z > 0, edges by
  /// 4 x their axis and the bits of the others, faces by 2 x their axis and the sign. Caps begin
  /// at +x and go round.
  SupportingPatch(const Core& core, const Vec& outward) noexcept;

  /// A square on the face of a half-space around the foot of `middle`, to `reach` on all sides.
  static SupportingPatch of_half_space(const Core& core, const Vec& middle, double reach) noexcept;

  [[nodiscard]] Patch view() const noexcept {
    return {vertex_, vertex_feature_.data(), edge_feature_.data(), count_, feature_, rounding_};
  }

 private:
  SupportingPatch() noexcept = default;
  void add(const Vec& v, std::uint32_t vertex_feature, std::uint32_t edge_feature) noexcept;
  void add_face(const Core& core, std::uint32_t face) noexcept;
  void add_edge(const Core& core, std::uint32_t edge, std::uint32_t feature) noexcept;
  void add_hull(const Core& core, const Vec& outward) noexcept;
  void add_cap(const Core& core, double z) noexcept;
  void add_round(const Core& core, const Vec& outward) noexcept;
  void add_taper(const Core& core, const Vec& outward) noexcept;
  void add_samples(const Core& core, const Vec& outward) noexcept;

  double vertex_[kRoom][3];
  std::array<std::uint32_t, kRoom> vertex_feature_;
  std::array<std::uint32_t, kRoom> edge_feature_;
  std::uint32_t count_ = 0;
  std::uint32_t feature_ = 0;
  double rounding_ = 0.0;
};

/// Fills in the contacts of an answer whose normal is known: the supporting features of both cores
/// along it, met by contact_patch. `point`: on the surface of a; `distance`: both in units of the
/// problem. At least one point, and the deepest one is as deep as the distance says.
void make_manifold(const Problem& problem, const Vec& point, double distance, double margin,
                   PairAnswer& answer) noexcept;

/// All corners of what the supporting features along `normal` share, of which a manifold has four
/// at most; in units of the problem. Room for kSharedCorners.
std::uint32_t shared_corners(const Problem& problem, const Vec& normal, double margin,
                             ContactPoint* out) noexcept;

}  // namespace winnow::solver
