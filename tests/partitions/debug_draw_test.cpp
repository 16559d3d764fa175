// Debug drawing of a partition: every object once, a structure that encloses all objects, and
// nothing that was not requested.

#include <winnow/core/debug_draw.h>
#include <winnow/core/eigen.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/support/answers.h"
#include "tests/support/counting_memory.h"
#include "tests/support/hostile_scenes.h"
#include "tests/support/motion.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

constexpr DebugDrawOptions kObjectsOnly{.structure = false};
constexpr DebugDrawOptions kStructureOnly{.objects = false};

bool contains(const Aabb& outer, const Aabb& inner) {
  return (as_eigen(outer.min).array() <= as_eigen(inner.min).array()).all() &&
         (as_eigen(outer.max).array() >= as_eigen(inner.max).array()).all();
}

/// Records all draw calls.
class Sketch final : public DebugDraw {
 public:
  struct Box {
    Aabb box;
    Colour colour;
    bool operator==(const Box&) const = default;
  };
  struct Line {
    Vec3f from;
    Vec3f to;
    Colour colour;
    bool operator==(const Line&) const = default;
  };
  struct Text {
    std::string text;
    Colour colour;
    bool operator==(const Text&) const = default;
  };

  void box(const Aabb& box, Colour colour) override { boxes.push_back({box, colour}); }
  void line(const Vec3f& from, const Vec3f& to, Colour colour) override {
    lines.push_back({from, to, colour});
  }
  void sphere(const Sphere& sphere, Colour) override { spheres.push_back(sphere); }
  void text(const Vec3f&, std::string_view text, Colour colour) override {
    texts.push_back({std::string(text), colour});
  }

  [[nodiscard]] std::vector<Aabb> boxes_in(Colour colour) const {
    std::vector<Aabb> result;
    for (const Box& b : boxes) {
      if (b.colour == colour) result.push_back(b.box);
    }
    return result;
  }
  [[nodiscard]] bool is_empty() const {
    return boxes.empty() && lines.empty() && spheres.empty() && texts.empty();
  }

  std::vector<Box> boxes;
  std::vector<Line> lines;
  std::vector<Sphere> spheres;
  std::vector<Text> texts;
};

class DebugDrawing : public Conformance {
 protected:
  [[nodiscard]] Sketch draw(World& world, const DebugDrawOptions& options = {}) {
    Sketch sketch;
    EXPECT_EQ(world.threads().run([&] { return world.partition().debug_draw(sketch, options); }),
              Status::ok);
    return sketch;
  }

  [[nodiscard]] bool is_flat() const {
    return config().partition == "NSquared" || config().partition == "BoundsNSquared";
  }
  [[nodiscard]] bool has_cells() const {
    return config().partition == "FlatGrid" || config().partition == "SweepAndPrune";
  }

  // Returns the boxes that enclose objects directly: contents of cells and leaves of the tree.
  [[nodiscard]] std::vector<Aabb> holders(const Sketch& sketch, const Statistics& statistics) {
    std::vector<Aabb> result = sketch.boxes_in(kContentsColour);
    if (statistics.depth == 0) return result;
    const std::vector<Aabb> leaves = sketch.boxes_in(node_colour(statistics.depth - 1));
    result.insert(result.end(), leaves.begin(), leaves.end());
    return result;
  }

  void expect_true_picture(World& world) {
    const Sketch objects = draw(world, kObjectsOnly);
    EXPECT_TRUE(objects.lines.empty() && objects.texts.empty() && objects.spheres.empty());
    ASSERT_EQ(objects.boxes.size(), world.entries().size());
    auto drawn = objects.boxes.begin();
    for (const auto& [id, entry] : world.entries()) {
      Aabb box = expect_ok(world.partition().bounds(entry.key));
      ASSERT_EQ(drawn->box, box) << "object " << id;
      ASSERT_EQ(drawn->colour, kObjectColour);
      ++drawn;
    }
    const Sketch structure = draw(world, kStructureOnly);
    EXPECT_TRUE(structure.boxes_in(kObjectColour).empty());
    if (config().partition == "AutoPartition" && structure.is_empty())
      return;  // a flat structure was chosen
    if (is_flat()) {
      EXPECT_TRUE(structure.is_empty());
      return;
    }
    const std::vector<Aabb> held = holders(structure, world.partition().statistics());
    for (const Sketch::Box& object : objects.boxes) {
      ASSERT_TRUE(std::any_of(held.begin(), held.end(),
                              [&](const Aabb& holder) { return contains(holder, object.box); }));
    }
  }
};

TEST_P(DebugDrawing, every_object_is_drawn_once_inside_the_structure) {
  for (const auto* scenes :
       {&random_scenes(), &degenerate_scenes(), &infinite_scenes(), &extreme_float_scenes()}) {
    for (const Scene& scene : *scenes) {
      if (scene.boxes.size() > 2000) continue;
      SCOPED_TRACE(scene.name);
      World world(config());
      world.insert(scene.boxes);
      ASSERT_NO_FATAL_FAILURE(expect_true_picture(world));
    }
  }
}

TEST_P(DebugDrawing, drawing_follows_moved_and_removed_objects) {
  World world(config());
  std::vector<Aabb> boxes = uniform_boxes(700);
  std::vector<Key> keys = world.insert(boxes);
  Random random(21);
  for (const Motion motion : kMotions) {
    SCOPED_TRACE(to_string(motion));
    move(motion, boxes, random);
    world.update(keys, boxes);
    ASSERT_NO_FATAL_FAILURE(expect_true_picture(world));
    world.remove(std::span(keys).last(60));
    keys.resize(keys.size() - 60);
    boxes.resize(keys.size());
    ASSERT_NO_FATAL_FAILURE(expect_true_picture(world));
  }
}

TEST_P(DebugDrawing, each_object_has_a_cell_in_even_scenes) {
  if (!has_cells()) return;
  World world(config());
  const std::vector<Aabb> boxes = uniform_boxes(1500);
  world.insert(boxes);
  const Sketch sketch = draw(world, kStructureOnly);
  ASSERT_EQ(world.partition().statistics().irregular, 0U);
  const std::vector<Aabb> cells = sketch.boxes_in(kCellColour);
  EXPECT_GT(cells.size(), 4U);
  EXPECT_EQ(cells.size(), sketch.boxes_in(kContentsColour).size());
  for (const Aabb& box : boxes) {
    // Because of rounding, a point at the edge of a cell may be in the neighbouring cell.
    const Aabb corner{as_eigen(box.min).array() - 1e-4F, as_eigen(box.min).array() + 1e-4F};
    ASSERT_TRUE(std::any_of(cells.begin(), cells.end(),
                            [&](const Aabb& cell) { return cell.overlaps(corner); }));
  }
}

TEST_P(DebugDrawing, drawn_axis_is_the_swept_or_fastest) {
  for (const int axis : {0, 1, 2}) {
    World world(config());
    world.insert(wall_boxes(700, axis));
    const Sketch sketch = draw(world, kStructureOnly);
    if (!has_cells()) {
      EXPECT_TRUE(sketch.lines.empty() && sketch.texts.empty());
      continue;
    }
    ASSERT_EQ(sketch.texts.size(), 1U);
    ASSERT_FALSE(sketch.lines.empty());
    const std::string& text = sketch.texts[0].text;
    EXPECT_NE(text[0], "xyz"[axis]) << "an axis that does not separate objects";
    EXPECT_NE(text.find(config().partition == "FlatGrid" ? "fastest" : "swept"), std::string::npos);
    // The arrow points along the axis that the text names.
    const Vec3f along = sketch.lines[0].to - sketch.lines[0].from;
    for (int other = 0; other < 3; ++other) {
      EXPECT_EQ(along[other] != 0.0F, "xyz"[other] == text[0]);
    }
  }
}

TEST_P(DebugDrawing, node_levels_are_nested_and_as_requested) {
  World world(config());
  world.insert(clustered_boxes(5000));
  const Sketch all = draw(world, kStructureOnly);
  const std::size_t levels = world.partition().statistics().depth;
  if (config().partition.ends_with("Bvh")) {
    EXPECT_EQ(levels, 3U);
  }
  for (std::size_t depth = 0; depth <= levels; ++depth) {
    DebugDrawOptions options = kStructureOnly;
    options.max_depth = static_cast<int>(depth);
    const Sketch some = draw(world, options);
    for (std::size_t d = 0; d < levels; ++d) {
      const std::vector<Aabb> nodes = some.boxes_in(node_colour(d));
      EXPECT_EQ(nodes, d < depth ? all.boxes_in(node_colour(d)) : std::vector<Aabb>{});
      if (d == 0 || d >= depth) continue;
      const std::vector<Aabb> parents = some.boxes_in(node_colour(d - 1));
      for (const Aabb& node : nodes) {
        ASSERT_TRUE(std::any_of(parents.begin(), parents.end(),
                                [&](const Aabb& parent) { return contains(parent, node); }));
      }
    }
    EXPECT_EQ(some.boxes_in(kCellColour), all.boxes_in(kCellColour));
  }
}

TEST_P(DebugDrawing, labels_show_the_client_data) {
  World world(config());
  const std::vector<Aabb> boxes = uniform_boxes(3);
  const std::vector<ClientData> data{7, 0, ~ClientData{0}};
  world.insert(boxes, data);
  EXPECT_TRUE(draw(world, kObjectsOnly).texts.empty());
  const Sketch labels = draw(world, {.objects = false, .structure = false, .labels = true});
  EXPECT_TRUE(labels.boxes.empty() && labels.lines.empty());
  const std::vector<Sketch::Text> expected{
      {"7", kLabelColour}, {"0", kLabelColour}, {"18446744073709551615", kLabelColour}};
  EXPECT_EQ(labels.texts, expected);
}

TEST_P(DebugDrawing, empty_partition_draws_nothing) {
  World world(config());
  const DebugDrawOptions everything{.labels = true};
  EXPECT_TRUE(draw(world, everything).is_empty());
  world.insert(uniform_boxes(300));
  EXPECT_FALSE(draw(world, everything).is_empty());
  EXPECT_TRUE(draw(world, {.objects = false, .structure = false}).is_empty());
  world.clear();
  EXPECT_TRUE(draw(world, everything).is_empty());
}

TEST_P(DebugDrawing, negative_depth_is_refused) {
  World world(config());
  world.insert(uniform_boxes(100));
  Sketch sketch;
  EXPECT_EQ(world.partition().debug_draw(sketch, {.max_depth = -1}), Status::invalid_argument);
  EXPECT_TRUE(sketch.is_empty());
}

TEST_P(DebugDrawing, drawing_is_equal_on_all_isas_and_threads) {
  const std::vector<Aabb> boxes = mixed_boxes(1200);
  World world(config());
  world.insert(boxes);
  const Sketch here = draw(world);
  const IsaScope isa(available_isas().front());
  World plain({config().partition, available_isas().front(), 1});
  plain.insert(boxes);
  const Sketch there = draw(plain);
  EXPECT_EQ(here.boxes, there.boxes);
  EXPECT_EQ(here.lines, there.lines);
  EXPECT_EQ(here.texts, there.texts);
}

TEST_P(DebugDrawing, refused_memory_draws_nothing) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  CountingMemory memory;
  World world(config(), &memory);
  world.insert(mixed_boxes(700));
  for (std::size_t granted = 0; granted < 100; ++granted) {
    world.partition().release_memory();
    Sketch sketch;
    const std::size_t refusals = memory.refusals();
    memory.refuse_after(granted);
    const Status status =
        world.threads().run([&] { return world.partition().debug_draw(sketch, {}); });
    memory.grant_all();
    if (memory.refusals() == refusals) {
      EXPECT_EQ(status, Status::ok);
      EXPECT_FALSE(sketch.is_empty());
      return;
    }
    ASSERT_TRUE(status == Status::out_of_memory || status == Status::ok);
    EXPECT_EQ(sketch.is_empty(), status == Status::out_of_memory);
    ASSERT_NO_FATAL_FAILURE(expect_true_picture(world));
  }
  FAIL() << "the call never stopped requesting memory";
}

TEST_P(DebugDrawing, spheres_are_drawn_as_spheres_kdops_as_boxes) {
  if (config().partition != "BoundsNSquared") return;
  const std::vector<Aabb> boxes = uniform_boxes(40);
  std::vector<Key> keys(boxes.size());
  Partition spheres(bounds_n_squared(),
                    {.execution = config().execution(), .volume = Volume::sphere});
  ASSERT_EQ(spheres.insert(boxes, {}, keys), Status::ok);
  Sketch sketch;
  ASSERT_EQ(spheres.debug_draw(sketch), Status::ok);
  EXPECT_TRUE(sketch.boxes.empty());
  ASSERT_EQ(sketch.spheres.size(), boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const Sphere truth = Sphere::around(boxes[i]);
    EXPECT_EQ(sketch.spheres[i].center, truth.center);
    EXPECT_EQ(sketch.spheres[i].radius, truth.radius);
  }
  Partition kdops(bounds_n_squared(),
                  {.execution = config().execution(), .volume = Volume::kdop18});
  ASSERT_EQ(kdops.insert(boxes, {}, keys), Status::ok);
  sketch = {};
  ASSERT_EQ(kdops.debug_draw(sketch), Status::ok);
  EXPECT_EQ(sketch.boxes_in(kObjectColour), boxes);
}

INSTANTIATE_TEST_SUITE_P(All, DebugDrawing, testing::ValuesIn(all_configs()),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace winnow::test
