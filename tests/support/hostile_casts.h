#pragma once

#include <winnow/core/rays.h>

#include <span>
#include <vector>

#include "tests/support/random.h"

namespace winnow::test {

/// Returns a ray that is hard for one box: along a face, an edge or through a corner, an ulp off,
/// from inside, with zero components of either sign, of extreme lengths, and with ranges that end
/// exactly at the entry. Always valid.
[[nodiscard]] Ray hostile_ray(const Aabb& box, Random& random);

/// As above, for the other casts: the moving volume has the size of the box or none, or touches it.
[[nodiscard]] Cast hostile_cast(const Aabb& box, Random& random);

/// Returns rays of common kinds through the scene.
[[nodiscard]] std::vector<Ray> plain_rays(std::span<const Aabb> boxes, std::size_t count,
                                          Random& random);

}  // namespace winnow::test
