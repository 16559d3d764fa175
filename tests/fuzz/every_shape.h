#pragma once

#include <winnow/winnow.h>

#include <cstdint>
#include <span>
#include <vector>

#include "tests/fuzz/bytes.h"
#include "tests/fuzz/target.h"

namespace winnow::test {

/// Shapes of every kind.
struct EveryShape {
  explicit EveryShape(Bytes& bytes);

  ShapePool pool;
  CompositePool composites{pool};
  std::vector<ShapeId> ids;
  /// The number of bounded convex shapes, which come first.
  std::size_t convex = 0;
};

inline EveryShape::EveryShape(Bytes& bytes) {
  const double r = 0.25 + bytes.extent() * 0.25;
  bool good = true;
  const auto take = [&](Status status, ShapeId id) {
    good = good && status == Status::ok;
    ids.push_back(id);
  };
  const auto add = [&](const auto& shape) {
    ShapeId id;
    const Status status = pool.add(shape).get(id);
    take(status, id);
  };
  add(SphereShape{r});
  add(CapsuleShape{0.25, r});
  add(BoxShape{{0.5, 0.25, r}, 0.0});
  add(CylinderShape{0.5, 0.25, 0.0});
  add(ConeShape{0.5, r, 0.125});
  add(TriangleShape{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0.25}}, 0.0});
  const std::vector<Vec3d> corners{{1, 0, 0},  {-1, 0, 0}, {0, r, 0},
                                   {0, -r, 0}, {0, 0, 1},  {0, 0, -1}};
  const std::vector<std::uint32_t> loops{0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4,
                                         2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
  const std::vector<std::uint32_t> sizes(8, 3);
  ShapeId id;
  take(pool.add_hull(corners, {loops, sizes}, 0.0).get(id), id);
  add(TaperedCapsuleShape{{0.5, 0.25}, r});
  convex = ids.size();
  add(HalfSpaceShape{{0, 0, 1}, 0.0});
  const CompoundChild children[] = {{ids[2], Pose::at(0.5, 0, 0)}, {ids[0], Pose::at(-0.5, 0, 0)}};
  take(composites.add_compound(children).get(id), id);
  const std::vector<Vec3f> points{{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0.5F}};
  const std::vector<std::uint32_t> triangles{0, 1, 2, 0, 2, 3};
  take(composites.add_mesh(std::span(points), std::span(triangles)).get(id), id);
  take(composites.add_scaled(ids.back(), {1.0, -0.5, 2.0}).get(id), id);
  std::vector<float> heights(9);
  for (float& height : heights) height = static_cast<float>(0.25 * bytes.extent());
  take(composites.add_height_field({heights, 3, 3, 0, {1.0, 1.0}}).get(id), id);
  const CompoundChild surfaces[] = {{ids.back(), Pose::at(-1, 0, 0.5)},
                                    {ids[1], Pose::at(0, 1, 0)},
                                    {ids[ids.size() - 2], Pose::at(0.5, 0, -0.5)}};
  take(composites.add_compound(surfaces).get(id), id);
  WINNOW_REQUIRE(good);
}

}  // namespace winnow::test
