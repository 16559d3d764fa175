// HierarchicalGrid: tests of levels and cells beyond the conformance suite.

#include <winnow/core/eigen.h>
#include <winnow/partitions/partition.h>

#include <algorithm>
#include <set>

#include "tests/support/config.h"
#include "tests/support/counting_memory.h"
#include "tests/support/motion.h"
#include "tests/support/random.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

const Config kConfig{"HierarchicalGrid", active_isa(), 2};

Aabb box_at(const Vec3d& centre, double edge) {
  Aabb box;
  for (int axis = 0; axis < 3; ++axis) {
    box.min[axis] = static_cast<float>(centre[axis] - 0.5 * edge);
    box.max[axis] = static_cast<float>(centre[axis] + 0.5 * edge);
  }
  return box;
}

Vec3d point(Random& random, double side) {
  return {random.uniform(-side, side), random.uniform(-side, side), random.uniform(-side, side)};
}

// Returns boxes with edges over a range of `ratio`, each at a distance of a few edges from the
// origin: objects of every size overlap objects of every other size.
std::vector<Aabb> nested_boxes(std::size_t count, double ratio, Random& random) {
  std::vector<Aabb> boxes(count);
  for (Aabb& box : boxes) {
    const double edge = random.log_uniform(1.0, ratio);
    box = box_at(point(random, 4.0 * edge), edge);
  }
  return boxes;
}

std::size_t levels_of(World& world) {
  EXPECT_EQ(world.partition().refresh(), Status::ok);
  return world.partition().statistics().levels;
}

TEST(HierarchicalGrid, objects_of_one_size_have_one_level) {
  World world(kConfig);
  world.insert(uniform_boxes(3000));
  EXPECT_EQ(levels_of(world), 1U);
}

// Uses scenes with few grid lines, because their number of lines varies most from build to build.
TEST(HierarchicalGrid, repeated_frames_do_not_allocate) {
  for (std::uint64_t stream = 0; stream < 40; ++stream) {
    SCOPED_TRACE(stream);
    CountingMemory memory;
    World world({"HierarchicalGrid", active_isa(), 1}, &memory);
    Random random(stream);
    std::vector<std::vector<Aabb>> frames{mixed_boxes(800, stream)};
    while (frames.size() < 4) {
      frames.push_back(frames.back());
      move(Motion::much, frames.back(), random);
    }
    const std::vector<Key> keys = world.insert(frames[0]);
    PairBuffer buffer;
    const auto play = [&](std::size_t frame) {
      world.update(keys, frames[frame % frames.size()]);
      ASSERT_EQ(world.self_pairs(buffer), Status::ok);
    };
    for (std::size_t frame = 0; frame < 12; ++frame) play(frame);
    const std::size_t requests = memory.requests();
    for (std::size_t frame = 12; frame < 40; ++frame) play(frame);
    EXPECT_EQ(memory.requests(), requests);
  }
}

TEST(HierarchicalGrid, pairs_of_any_sizes_are_found_once) {
  Random random(61);
  for (const double ratio : {10.0, 1e3, 1e6, 1e12}) {
    SCOPED_TRACE(ratio);
    World world(kConfig);
    world.insert(nested_boxes(1500, ratio, random));
    EXPECT_TRUE(world.agrees());
    EXPECT_EQ(world.partition().statistics().irregular, 0U);
  }
}

TEST(HierarchicalGrid, very_different_sizes_get_their_own_levels) {
  Random random(62);
  std::vector<Aabb> boxes;
  for (const double edge : {1e-6, 1.0, 1e6}) {
    for (int i = 0; i < 800; ++i) boxes.push_back(box_at(point(random, 8.0 * edge), edge));
  }
  World world(kConfig);
  world.insert(boxes);
  EXPECT_EQ(levels_of(world), 3U);
  EXPECT_TRUE(world.agrees());
}

TEST(HierarchicalGrid, objects_of_all_sizes_at_one_point_pair) {
  Random random(63);
  std::vector<Aabb> boxes(700);
  for (Aabb& box : boxes) box = box_at(Vec3d{}, random.log_uniform(1e-6, 1e6));
  World world(kConfig);
  world.insert(boxes);
  PairBuffer pairs;
  ASSERT_EQ(world.self_pairs(pairs), Status::ok);
  EXPECT_EQ(pairs.size(), boxes.size() * (boxes.size() - 1) / 2);
}

TEST(HierarchicalGrid, memory_depends_on_objects_not_on_the_world) {
  const auto bytes_of = [](double world_side) {
    Random random(64);
    std::vector<Aabb> boxes;
    for (int cluster = 0; cluster < 50; ++cluster) {
      const Vec3d centre = point(random, world_side);
      for (int i = 0; i < 100; ++i) {
        boxes.push_back(box_at(centre + point(random, 4.0), random.log_uniform(0.01, 1.0)));
      }
    }
    World world(kConfig);
    world.insert(boxes);
    EXPECT_TRUE(world.agrees());
    EXPECT_LE(world.partition().statistics().cells, boxes.size());
    return world.partition().footprint().structure.reserved;
  };
  EXPECT_LE(bytes_of(1e6), 2 * bytes_of(10.0));
}

TEST(HierarchicalGrid, objects_that_grow_and_shrink_change_levels) {
  Random random(65);
  World world(kConfig);
  std::vector<Aabb> boxes = nested_boxes(900, 1e4, random);
  const std::vector<Key> keys = world.insert(boxes);
  PairBuffer pairs;
  ASSERT_TRUE(world.agrees(pairs));
  for (int frame = 0; frame < 6; ++frame) {
    // At first a few objects, then all.
    for (std::size_t i = 0; i < boxes.size(); i += frame < 4 ? 30 : 1) {
      const Vec3d centre = (0.5F * (boxes[i].min + boxes[i].max)).cast<double>();
      const double edge = static_cast<double>(boxes[i].max[0] - boxes[i].min[0]);
      boxes[i] = box_at(centre, edge * (random.chance(0.5) ? 30.0 : 1.0 / 30.0));
    }
    world.update(keys, boxes);
    ASSERT_TRUE(world.agrees(pairs)) << "frame " << frame;
  }
}

TEST(HierarchicalGrid, drift_within_cells_keeps_the_row_order) {
  World world(kConfig);
  std::vector<Aabb> boxes = uniform_boxes(2000);
  const std::vector<Key> keys = world.insert(boxes);
  ASSERT_TRUE(world.agrees());
  for (Aabb& box : boxes)
    box = {as_eigen(box.min).array() + 0.05F, as_eigen(box.max).array() + 0.05F};
  world.update(keys, boxes);
  ASSERT_TRUE(world.agrees());
  EXPECT_EQ(world.partition().statistics().builds, 1U);
  EXPECT_EQ(world.partition().statistics().irregular, 0U);
}

class CellColours final : public DebugDraw {
 public:
  void box(const Aabb&, Colour colour) override { seen.insert(pack(colour)); }
  void line(const Vec3f&, const Vec3f&, Colour) override {}
  void sphere(const Sphere&, Colour) override {}
  void text(const Vec3f&, std::string_view, Colour) override {}

  std::set<std::uint32_t> seen;

 private:
  static std::uint32_t pack(Colour c) { return c.r * 65536U + c.g * 256U + c.b; }
};

TEST(HierarchicalGrid, each_level_is_drawn_in_its_own_colour) {
  Random random(66);
  World world(kConfig);
  world.insert(nested_boxes(1500, 1e6, random));
  const std::size_t levels = levels_of(world);
  ASSERT_GT(levels, 1U);
  CellColours colours;
  ASSERT_EQ(world.partition().debug_draw(colours, {.objects = false}), Status::ok);
  EXPECT_EQ(colours.seen.size(), levels + 1);  // and one for the contents of cells
}

}  // namespace
}  // namespace winnow::test
