#pragma once

#include "tests/pipeline/pair_scenes.h"

namespace winnow::test {

/// Adds `count` pairs of the two kinds. Every second pair repeats the one before with its bodies
/// swapped. Cores are polygons, discs, segments and points, and some solids. They are coplanar, in
/// parallel planes or collinear, exactly or up to rounding or a little more, in a random common
/// frame. Some are rounded. Sizes are from 1e-12 to 1e12, within 1:1000 in a pair.
void add_flat_pairs(PairScene& scene, ShapeKind a, ShapeKind b, std::size_t count, Random& random);

}  // namespace winnow::test
