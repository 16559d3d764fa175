#pragma once

#include <winnow/core/cast.h>

#include <span>
#include <vector>

#include "tests/support/random.h"

namespace winnow::test {

/// A ray made to be hard for one box: along a face, an edge or through a corner, an ulp off, from
/// within, with zero components of either sign, of extreme lengths, and with ranges that end at
/// the very entry. Always valid.
[[nodiscard]] Ray hostile_ray(const Aabb& box, Random& random);

/// The same of the other casts: what moves has the size of the box, or none, or touches it.
[[nodiscard]] Cast hostile_cast(const Aabb& box, Random& random);

/// Rays of common kinds through the scene.
[[nodiscard]] std::vector<Ray> plain_rays(std::span<const Aabb> boxes, std::size_t count,
                                          Random& random);

}  // namespace winnow::test
