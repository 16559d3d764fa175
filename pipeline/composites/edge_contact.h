#pragma once

#include <winnow/pipeline/shapes.h>
#include "pipeline/shapes/frame.h"

#include <cstdint>

namespace winnow::mid {

/// What a contact with a triangle is.
enum class EdgeContact : std::uint8_t {
  /// With the face, or with an edge or corner that the surface really has.
  real,
  /// With the face, but the normal is off by more than rounding of unit vectors.
  nearly_face,
  /// With an edge or corner that neighbours continue.
  inner,
};

/// Bits of PrimitivePairs::active_edges of a triangle without inner edges.
inline constexpr std::uint8_t kAllActive = 63;

/// `active`: see PrimitivePairs::active_edges. `away`: unit, from the triangle to the other shape.
/// `face` is set to the triangle's unit normal on the side of `away`. Triangles without a normal
/// have real contacts only.
[[nodiscard]] EdgeContact classify(const TriangleShape& triangle, std::uint8_t active,
                                   const Vec& away, Vec& face) noexcept;

}  // namespace winnow::mid
