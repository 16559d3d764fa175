// Sensors, continuous collision detection and hooks in C, compared with C++ calls on the same
// objects.

#include "tests/c/world_of_c.h"

#include <winnow/pipeline/continuous_collision.h>
#include <winnow/pipeline/sensors.h>

#include <array>
#include <string>
#include <vector>

namespace winnow::test {
namespace {

TEST(CInterface, sensors_return_arrays_of_cpp) {
  const SceneOfC world;
  CountedMemory counted;
  const winnow_memory memory = counted.functions();
  const OwnedSensors sensors(winnow_sensors_create, world.scene, &memory);
  winnow_sensor_definition goal = WINNOW_SENSOR_DEFINITION;
  goal.shape = world.shapes.convex[0];
  goal.pose = pose_of_c(12);
  goal.carrier = world.keys[12];
  goal.data = 77;
  const auto first = got<winnow_key>(winnow_sensors_add, sensors, &goal);
  const auto second = got<winnow_key>(winnow_sensors_add, sensors, &goal);
  const auto expect_sensed = [&] {
    EXPECT_EQ(winnow_sensors_sense(sensors), WINNOW_OK);
    EXPECT_TRUE(is_array_of(got_all<winnow_sensed_body>(winnow_sensors_sensed, sensors),
                            sensors->sensed()));
    EXPECT_TRUE(
        is_array_of(got_all<winnow_left_sensor>(winnow_sensors_left, sensors), sensors->left()));
  };
  expect_sensed();
  EXPECT_GT(sensors->sensed().size(), 0U);
  EXPECT_EQ(sensors->sensed()[0].sensor_data, 77U);
  goal.pose.position[2] = 40.0;
  EXPECT_EQ(winnow_sensors_move(sensors, first, &goal.pose), WINNOW_OK);
  goal.data = 78;
  EXPECT_EQ(winnow_sensors_set(sensors, second, &goal), WINNOW_OK);
  expect_sensed();
  EXPECT_GT(sensors->left().size(), 0U);
  EXPECT_EQ(winnow_sensors_remove(sensors, first), WINNOW_OK);
  EXPECT_FALSE(got<bool>(winnow_sensors_contains, sensors, first));
  EXPECT_EQ(got<std::size_t>(winnow_sensors_size, sensors), 1U);
  const auto stored = got<winnow_sensor_definition>(winnow_sensors_sensor, sensors, second);
  EXPECT_EQ(stored.data, 78U);
  EXPECT_TRUE(same(stored.pose, *c::as_cpp(&goal.pose)));
  EXPECT_TRUE(same(stored.carrier, world.key(12)));
  EXPECT_EQ(reserved_of(got<winnow_footprint>(winnow_sensors_footprint, sensors)),
            counted.outstanding);
}

TEST(CInterface, impacts_of_moving_bodies_equal_cpp) {
  const SceneOfC world;
  const OwnedImpacts ccd(winnow_continuous_collision_create, world.scene, nullptr);
  ContinuousCollision others(*world.scene);
  std::array<winnow_pose, 3> ends;
  const std::array<std::uint8_t, 3> bullets{0, 1, 0};
  for (std::size_t i = 0; i < ends.size(); ++i) {
    ends[i] = pose_of_c(8 + i);
    ends[i].position[1] += 3.0;
  }
  const winnow_pose_view view = winnow_poses(ends.data(), ends.size());
  winnow_continuous_options options = WINNOW_CONTINUOUS_OPTIONS;
  options.pairs = WINNOW_CONTINUOUS_BULLETS;
  options.bullets = bullets.data();
  options.leave_out_touching = 1;
  options.first_only = 1;
  const std::array<std::pair<const winnow_continuous_options*, ContinuousOptions>, 2> all{
      {{nullptr, {}},
       {&options,
        {.pairs = ContinuousPairs::bullets,
         .bullets = bullets,
         .touching = false,
         .first_only = true}}}};
  for (const auto& [of_c, of_cpp] : all) {
    EXPECT_EQ(winnow_continuous_collision_find_impacts(ccd, &world.keys[8], 3, &view, of_c),
              WINNOW_OK);
    EXPECT_EQ(others.find_impacts(c::as_cpp_span(&world.keys[8], 3),
                                  c::as_cpp_span(ends.data(), ends.size()), of_cpp),
              Status::ok);
    const auto impacts = got_all<winnow_scene_impact>(winnow_continuous_collision_impacts, ccd);
    ASSERT_EQ(impacts.size(), others.impacts().size());
    EXPECT_GT(impacts.size(), 0U);
    for (std::size_t i = 0; i < impacts.size(); ++i) {
      EXPECT_TRUE(have_same_bits(impacts[i], others.impacts()[i]));
    }
    EXPECT_TRUE(
        same_all(got_all<std::uint32_t>(winnow_continuous_collision_first, ccd), others.first()));
  }
  EXPECT_GT(got<winnow_footprint>(winnow_continuous_collision_footprint, ccd).results.reserved, 0U);
}

/// The calls of the hooks, in order.
std::vector<std::string> hook_calls;

void note_stage(winnow_work_stage stage, bool begins) {
  hook_calls.push_back(std::string(begins ? "begin " : "end ") + winnow_work_stage_name(stage));
}
void note_entry(const winnow_log_entry* entry) {
  hook_calls.push_back(std::string(entry->what.first, entry->what.count) + " " +
                       winnow_status_name(entry->status));
}

TEST(CInterface, hooks_receive_stages_and_refusals) {
  const SceneOfC world;
  hook_calls.clear();
  EXPECT_EQ(winnow_set_stage_hook(note_stage), nullptr);
  EXPECT_EQ(winnow_set_log_hook(note_entry), nullptr);
  world.collide();
  winnow_key none = WINNOW_NULL_KEY;
  EXPECT_EQ(winnow_scene_remove(world.scene, &none, 1), WINNOW_INVALID_KEY);
  EXPECT_EQ(winnow_set_stage_hook(nullptr), note_stage);
  EXPECT_EQ(winnow_set_log_hook(nullptr), note_entry);
  const std::vector<std::string> calls = hook_calls;
  world.collide();
  EXPECT_EQ(hook_calls, calls);
  const auto count = [&](const char* call) { return std::ranges::count(calls, call); };
  EXPECT_GT(count("begin narrow_phase"), 0);
  EXPECT_EQ(count("begin narrow_phase"), count("end narrow_phase"));
  EXPECT_EQ(calls.back(), "Scene::remove invalid_key");
  EXPECT_STREQ(winnow_work_stage_name(99), "unknown");
}

TEST(CInterface, pair_order_does_not_depend_on_threads) {
  std::vector<winnow_aabb> boxes(20000);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const float x = 0.25F * static_cast<float>(i);
    boxes[i] = {{x, 0, 0}, {x + 1.0F, 1, 1}};
  }
  const winnow_box_view view = winnow_boxes(boxes.data(), boxes.size());
  const auto pairs_on = [&](const winnow_execution& execution) {
    winnow_partition_options options = WINNOW_PARTITION_OPTIONS;
    options.execution = execution;
    const OwnedPartition partition(winnow_partition_create, winnow_structure_kind{}, &options);
    const OwnedPairs pairs(winnow_pair_buffer_create, nullptr);
    std::vector<winnow_key> keys(boxes.size());
    EXPECT_EQ(winnow_partition_insert(partition, &view, nullptr, keys.data()), WINNOW_OK);
    EXPECT_EQ(winnow_partition_self_pairs(partition, pairs, nullptr, nullptr), WINNOW_OK);
    return std::vector<Pair>(pairs->begin(), pairs->end());
  };
  const std::vector<Pair> serial = pairs_on({WINNOW_EXECUTION_SERIAL, {}});
  EXPECT_EQ(serial.size(), 20000U * 4 - 10);
  EXPECT_TRUE(pairs_on({WINNOW_EXECUTION_PARALLEL, {}}) == serial);
  for (const std::size_t count : {1U, 2U, 5U}) {
    winnow_threads* made = nullptr;
    const winnow_status status = winnow_threads_create(count, &made);
    winnow_threads_destroy(made);
    if (status == WINNOW_UNSUPPORTED) continue;
    const OwnedThreads threads(winnow_threads_create, count);
    EXPECT_TRUE(pairs_on(got<winnow_execution>(winnow_threads_execution, threads)) == serial);
  }
}

}  // namespace
}  // namespace winnow::test
