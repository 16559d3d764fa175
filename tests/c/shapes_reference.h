#pragma once

#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/shape_pool.h>

#include <array>

namespace winnow::test {

/// The shapes that shapes.c creates.
[[nodiscard]] std::array<ShapeId, 12> make_convex(ShapePool& pool);
[[nodiscard]] std::array<ShapeId, 4> make_composite(CompositePool& pool,
                                                    const std::array<ShapeId, 12>& convex);
[[nodiscard]] Pose pose_in(std::size_t i, std::size_t frame);

}  // namespace winnow::test
