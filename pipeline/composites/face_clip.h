#pragma once

#include "pipeline/narrow/narrow_job.h"
#include "pipeline/shapes/frame.h"

#include <cstdint>

namespace winnow::mid {

/// A triangle of a mesh and another shape, which overlap.
struct FacePair {
  const ShapeTables& tables;
  ShapeId a;
  const Pose& pose_a;
  ShapeId b;
  const Pose& pose_b;
  /// The mesh's triangle is b.
  bool second;
};

/// Contacts along the normal of the triangle's face.
struct FaceContacts {
  ContactPoint points[kManifoldPoints];
  std::uint32_t count = 0;
  /// Of the first point, the deepest; and what rounding may have done to it.
  double depth = 0.0;
  double noise = 0.0;
};

/// Clips the feature of the other shape that lies farthest along `normal` (the face's, from a to b)
/// against the triangle. The depth is at least `least`. False if the feature is not over the
/// triangle, where its depth would be made up, or if it is deeper than `most`.
[[nodiscard]] bool clip_to_face(const FacePair& pair, const Vec& normal, double margin,
                                double least, double most, FaceContacts& out) noexcept;

}  // namespace winnow::mid
