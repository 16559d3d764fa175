#pragma once

#include "pipeline/composites/composites.h"

namespace winnow::mid {

/// Convex solids are hulls for everything but rays: contacts, depths, overlaps and casts then equal
/// those of the hull of the same vertices. A solid is convex if its faces, merged where they are
/// coplanar to kSolidTolerance of its size, are.

/// Makes the hull of a solid mesh, if it is convex and has none. `out_of_memory` changes nothing.
/// O(n log n).
[[nodiscard]] Status make_hull(Composites& all, ShapeId mesh) noexcept;

/// Makes the hulls of all convex solids, after a pool is loaded.
[[nodiscard]] Status make_hulls(Composites& all) noexcept;

}  // namespace winnow::mid
