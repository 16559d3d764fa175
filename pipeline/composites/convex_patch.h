#pragma once

#include <winnow/pipeline/contact_types.h>
#include "pipeline/composites/surface_cones.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow::mid {

/// A locally convex patch of a touched surface, as one convex shape: a triangle and those around it
/// that overlap the other body in the same group, as far as they lie behind each other's planes.
class ConvexPatch {
 public:
  /// Grows the patch around a triangle of one side of a group. `outward`: the triangle's normal
  /// towards the other body. O(size of the group x size of the patch).
  void grow(const SurfaceCones& cones, const AnswerGroup& group, std::uint32_t start, bool second,
            const Vec& outward) noexcept;
  /// Adds a triangle. Returns false, and does not add it, unless the patch stays locally convex and
  /// has room.
  [[nodiscard]] bool add(std::uint32_t primitive, Facet facet) noexcept;
  /// Makes the patch empty.
  void clear() noexcept { count_ = 0; }

  /// The triangles, with normals outwards.
  [[nodiscard]] std::span<const Facet> facets() const noexcept { return {facet_, count_}; }
  [[nodiscard]] bool is_empty() const noexcept { return count_ == 0; }
  [[nodiscard]] bool contains(std::uint32_t primitive) const noexcept;
  /// Height of the highest corner along a direction.
  [[nodiscard]] double top(const Vec& direction) const noexcept;
  /// Returns whether the projection of a point to the plane of one of the triangles is in it.
  [[nodiscard]] bool is_under(const Vec& point) const noexcept;
  /// Length of the longest edge.
  [[nodiscard]] double size() const noexcept;
  /// The convex hull of the patch, in the frame of `pose`; refers to the patch.
  [[nodiscard]] SupportShape shape() const noexcept;
  [[nodiscard]] Pose pose() const noexcept;

 private:
  static constexpr std::size_t kMaxFacets = 64;

  [[nodiscard]] bool accepts(const Facet& facet) const noexcept;

  std::size_t count_ = 0;
  /// 1 if outward is the side from which the corners are counter-clockwise, else -1.
  double turn_ = 1.0;
  std::uint32_t primitive_[kMaxFacets];
  Facet facet_[kMaxFacets];
};

/// The least translation that parts two convex shapes, each of which may be a patch.
struct PatchSide {
  ShapeId shape;
  Pose pose;
  /// If not empty, replaces the shape.
  const ConvexPatch& patch;
};

/// Returns the distance and normal of two shapes at level distance.
[[nodiscard]] PairAnswer solve_patches(const ShapeTables& tables, const PatchSide& a,
                                       const PatchSide& b) noexcept;

}  // namespace winnow::mid
