#pragma once

// From boxes and triangles in the axes of the world to patches: one pair at a time, in double.
// Kernel files call this, so nothing here is inline.

#include "pipeline/manifold/contact_patch.h"

#include <cstdint>

namespace winnow {

/// A box where it stands, relative to the position of body a.
struct BoxFrame {
  /// Unit vectors.
  double axis[3][3];
  double half[3];
  double center[3];
  double rounding;
};

/// A triangle where it stands, likewise.
struct TriangleFrame {
  double vertex[3][3];
  double rounding;
};

/// Up to four vertices with their numbers.
struct FlatPatch {
  double vertex[4][3];
  std::uint32_t vertex_feature[4];
  std::uint32_t edge_feature[4];
  std::uint32_t count;
  std::uint32_t feature;
  double rounding;
};

/// The face of a box that looks along `normal`. Vertices are numbered by the bits x > 0, y > 0,
/// z > 0, edges by 4 x their axis and the bits of the others, faces by 2 x their axis and the sign.
[[nodiscard]] FlatPatch box_patch(const BoxFrame& box, const double normal[3]) noexcept;
/// The triangle: vertices 0 to 2, edge i from vertex i to the next, face 0.
[[nodiscard]] FlatPatch triangle_patch(const TriangleFrame& triangle) noexcept;

/// contact_patch of two of them.
std::uint32_t flat_contacts(const FlatPatch& a, const FlatPatch& b, const double normal[3],
                            double margin, ContactPoint* out) noexcept;

/// The point of a where two patches meet deepest along the normal.
void deepest_point(const FlatPatch& a, const FlatPatch& b, const double normal[3],
                   double point[3]) noexcept;

}  // namespace winnow
