#pragma once

#include "tests/pipeline/pair_scenes.h"

namespace winnow::test {

/// Adds `count` pairs of the two kinds, every second one the pair before the other way round. Cores
/// are polygons, discs, segments and points, some solids; they lie in one plane, in parallel planes
/// or in one line, or are off by rounding or a little more, turned together in any way. Some are
/// rounded. Sizes are from 1e-12 to 1e12, those of a pair within 1:1000.
void add_flat_pairs(PairScene& scene, ShapeKind a, ShapeKind b, std::size_t count, Random& random);

}  // namespace winnow::test
