// Calls of the process-wide hooks. A separate program, since the hooks would also see the calls of
// other tests.

#include <gtest/gtest.h>
#include <winnow/core/hooks.h>
#include <winnow/winnow.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/answers.h"
#include "tests/support/scenes.h"

namespace winnow::test {
namespace {

std::vector<WorkStage> under_way;
std::vector<WorkStage> begun;
bool is_nested = true;
std::vector<std::string> log_lines;

void note_stage(WorkStage stage, bool begins) {
  if (begins) {
    under_way.push_back(stage);
    begun.push_back(stage);
  } else {
    is_nested = is_nested && !under_way.empty() && under_way.back() == stage;
    if (!under_way.empty()) under_way.pop_back();
  }
}

void note_entry(const LogEntry& entry) {
  const bool is_choice = entry.kind == LogEntry::Kind::choice;
  log_lines.push_back(std::string(is_choice ? "choice " : "refusal ") + std::string(entry.what) +
                      (is_choice ? " after " + std::string(entry.before) : "") + ": " +
                      std::string(entry.reason));
}

struct Hooks : testing::Test {
  Hooks() {
    under_way.clear();
    begun.clear();
    log_lines.clear();
    is_nested = true;
    set_stage_hook(note_stage);
    set_log_hook(note_entry);
  }
  ~Hooks() override {
    set_stage_hook(nullptr);
    set_log_hook(nullptr);
  }
};

TEST_F(Hooks, scene_stages_are_ordered_and_nested) {
  ShapePool shapes;
  CompositePool composites(shapes);
  ShapeId ball;
  ShapeId terrain;
  ball = expect_ok(shapes.add(SphereShape{0.5}));
  const std::vector<Vec3d> points{{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}};
  const std::vector<std::uint32_t> corners{0, 1, 2};
  terrain = expect_ok(composites.add_mesh(std::span(points), std::span(corners)));
  Scene scene(shapes, {.composites = &composites});
  Key key = expect_ok(scene.add({.shape = terrain, .state = BodyState::fixed}));
  key = expect_ok(scene.add({.shape = ball, .pose = Pose::at(0, 0, 0.4)}));
  key = expect_ok(scene.add({.shape = ball, .pose = Pose::at(0.7, 0, 0.4)}));
  Contacts contacts;
  ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);

  EXPECT_EQ(contacts.size(), 3U);
  EXPECT_TRUE(is_nested && under_way.empty());
  // The balls are solved before the triangle is found. Partitions refresh and build on the first
  // query of pairs.
  std::vector<WorkStage> shape_stages;
  for (const WorkStage stage : begun) {
    if (stage >= WorkStage::mid_phase) shape_stages.push_back(stage);
  }
  EXPECT_EQ(shape_stages, (std::vector<WorkStage>{WorkStage::narrow_phase, WorkStage::mid_phase,
                                                  WorkStage::narrow_phase, WorkStage::contacts}));
  for (const WorkStage stage : {WorkStage::refresh, WorkStage::build, WorkStage::pairs}) {
    EXPECT_NE(std::ranges::find(begun, stage), begun.end()) << to_string(stage);
  }
}

TEST_F(Hooks, removed_hooks_are_not_called) {
  EXPECT_EQ(set_stage_hook(nullptr), &note_stage);
  EXPECT_EQ(set_log_hook(nullptr), &note_entry);
  Partition partition(linear_bvh());
  PairBuffer pairs;
  EXPECT_EQ(partition.remove(Key{}), Status::invalid_key);
  EXPECT_EQ(partition.self_pairs(pairs), Status::ok);
  EXPECT_TRUE(begun.empty());
  EXPECT_TRUE(log_lines.empty());
}

TEST_F(Hooks, automatic_choice_is_logged) {
  const auto boxes = uniform_boxes(500);
  std::vector<Key> keys(boxes.size());
  Partition partition(automatic());
  const std::string_view before = partition.choice().structure.name();
  ASSERT_EQ(partition.insert(std::span(boxes).first(20), {}, std::span(keys).first(20)),
            Status::ok);
  PairBuffer pairs;
  ASSERT_EQ(partition.self_pairs(pairs), Status::ok);
  const StructureChoice choice = partition.choice();
  ASSERT_NE(choice.structure.name(), before);
  EXPECT_EQ(log_lines,
            std::vector<std::string>{"choice " + std::string(choice.structure.name()) + " after " +
                                     std::string(before) + ": " + std::string(choice.reason)});
}

TEST_F(Hooks, refused_calls_are_logged_with_reason) {
  Partition partition(linear_bvh());
  Key key;
  expect_error(partition.insert(Aabb{}, 0), Status::invalid_bounds);
  EXPECT_EQ(partition.remove(Key{}), Status::invalid_key);
  ShapePool shapes;
  Scene scene(shapes);
  expect_error(scene.add({}), Status::invalid_key);
  EXPECT_EQ(scene.move(Key{}, Pose{}), Status::invalid_key);
  EXPECT_EQ(log_lines, (std::vector<std::string>{"refusal Partition::insert: invalid_bounds",
                                                 "refusal Partition::remove: invalid_key",
                                                 "refusal Scene::add: invalid_key",
                                                 "refusal Scene::move: invalid_key"}));
}

TEST_F(Hooks, all_stages_have_names) {
  for (std::size_t i = 0; i < kWorkStages; ++i) {
    EXPECT_STRNE(to_string(static_cast<WorkStage>(i)), "unknown");
  }
  EXPECT_STREQ(to_string(static_cast<WorkStage>(kWorkStages)), "unknown");
}

}  // namespace
}  // namespace winnow::test
