// Partitions and scenes with a recorder: each successful call is recorded once, also of objects
// that are moved and by several threads, and calls that a recording cannot contain end it.

#include <gtest/gtest.h>

#include <thread>
#include <utility>
#include <vector>

#include "tests/recording/programs.h"
#include "tests/support/answers.h"

namespace winnow::test {
namespace {

const std::vector<Aabb> kRow = [] {
  std::vector<Aabb> boxes;
  for (int i = 0; i < 40; ++i) {
    const auto x = static_cast<float>(i);
    boxes.push_back({{x, 0, 0}, {x + 1.5F, 1, 1}});
  }
  return boxes;
}();

/// A recorded partition with the boxes of kRow.
struct RecordedBoxes {
  explicit RecordedBoxes(Recorder& recorder) : partition(linear_bvh(), {.recorder = &recorder}) {
    EXPECT_EQ(partition.insert(kRow, {}, keys), Status::ok);
  }

  Partition partition;
  std::vector<Key> keys = std::vector<Key>(kRow.size());
};

void expect_replayed(const Bytes8& bytes, std::uint64_t calls) {
  RecordingPlayer player(bytes);
  EXPECT_EQ(player.play_all(), Status::ok);
  EXPECT_TRUE(player.is_whole());
  EXPECT_EQ(player.counts().calls, calls);
  EXPECT_EQ(player.counts().differences, 0U);
}

TEST(RecordedCalls, moved_partition_stays_recorded) {
  Bytes8 bytes;
  Recorder recorder(kept_in(bytes));
  {
    RecordedBoxes boxes(recorder);  // two calls
    Partition moved(std::move(boxes.partition));
    PairBuffer pairs;
    EXPECT_EQ(moved.self_pairs(pairs), Status::ok);  // one call
    EXPECT_EQ(pairs.size(), kRow.size() - 1);
    EXPECT_EQ(boxes.partition.refresh(), Status::invalid_argument);
    Partition other(linear_bvh());
    other = std::move(moved);
    expect_ok(moved.insert(kRow[0]));
    EXPECT_EQ(other.remove(boxes.keys[0]), Status::ok);  // one call
    EXPECT_EQ(other.self_pairs(pairs), Status::ok);      // one call
    EXPECT_EQ(pairs.size(), kRow.size() - 2);
  }  // one call
  ASSERT_EQ(recorder.close(), Status::ok);
  expect_replayed(bytes, 6);
}

TEST(RecordedCalls, calls_of_partitions_are_recorded_once) {
  Bytes8 bytes;
  Recorder recorder(kept_in(bytes));
  RecordedBoxes boxes(recorder);
  Partition& partition = boxes.partition;
  std::uint64_t before = recorder.calls();
  const auto expect_recorded = [&](std::uint64_t calls) {
    EXPECT_EQ(recorder.calls(), before + calls);
    before = recorder.calls();
  };
  const Key key = expect_ok(partition.insert(kRow[0], 5));
  expect_recorded(1);
  EXPECT_EQ(partition.update(key, kRow[1]), Status::ok);
  expect_recorded(1);
  EXPECT_EQ(partition.set_filter(key, {.layers = 2}), Status::ok);
  expect_recorded(1);
  expect_ok(partition.closest(Ray{{0, 0.5F, 0.5F}, {1, 0, 0}}));
  expect_recorded(1);
  PairEvents events;
  EXPECT_EQ(partition.self_pairs(events), Status::ok);
  expect_recorded(1);
  EXPECT_EQ(partition.remove(key), Status::ok);
  expect_recorded(1);
  EXPECT_EQ(partition.remove(key), Status::invalid_key);
  EXPECT_EQ(partition.reserve(100), Status::ok);
  expect_ok(partition.bounds(boxes.keys[0]));
  expect_recorded(0);
}

TEST(RecordedCalls, calls_of_scenes_are_recorded_once) {
  Bytes8 bytes;
  Recorder recorder(kept_in(bytes));
  ShapePool shapes;
  const ShapeId ball = expect_ok(shapes.add(SphereShape{0.5}));
  std::uint64_t before = recorder.calls();
  const auto expect_recorded = [&](std::uint64_t calls) {
    EXPECT_EQ(recorder.calls(), before + calls);
    before = recorder.calls();
  };
  {
    Scene scene(shapes, {.recorder = &recorder});
    expect_recorded(1);
    const Key key = expect_ok(scene.add({.shape = ball}));
    expect_recorded(2);  // also the shape
    expect_ok(scene.add({.shape = ball, .pose = Pose::at(0.5, 0, 0)}));
    expect_recorded(1);
    EXPECT_EQ(scene.move(key, Pose::at(0.1, 0, 0)), Status::ok);
    expect_recorded(1);
    EXPECT_EQ(scene.set_offsets(key, {}), Status::ok);  // as it was
    EXPECT_EQ(scene.set_layer(key, 0), Status::ok);
    EXPECT_EQ(scene.set_layers_collide(1, 2, true), Status::ok);
    expect_recorded(3);
    Sensors sensors(scene);
    expect_ok(sensors.add({.shape = ball}));
    EXPECT_EQ(sensors.sense(), Status::ok);
    EXPECT_EQ(sensors.sensed().size(), 2U);
    expect_recorded(3);
    ContinuousCollision ccd(scene);
    const Pose end[] = {Pose::at(2, 0, 0)};
    EXPECT_EQ(ccd.find_impacts({&key, 1}, end), Status::ok);
    expect_recorded(1);
    SceneQueries queries(scene);
    expect_ok(queries.closest(ShapeRay{{-3, 0, 0}, {1, 0, 0}}));
    expect_recorded(1);
    EXPECT_EQ(scene.remove(key), Status::ok);
    EXPECT_EQ(scene.remove(key), Status::invalid_key);
    expect_error(queries.distance(key, key), Status::invalid_key);
    expect_recorded(1);
  }
  expect_recorded(2);  // the end of the sensors, and of the scene
  ASSERT_EQ(recorder.close(), Status::ok);
  expect_replayed(bytes, before);
}

TEST(RecordedCalls, partition_queries_of_several_threads_are_replayed) {
  Bytes8 bytes;
  Recorder recorder(kept_in(bytes));
  {
    RecordedBoxes boxes(recorder);
    std::vector<PairBuffer> pairs(4);
    for (int frame = 0; frame < 5; ++frame) {
      EXPECT_EQ(boxes.partition.update(boxes.keys[3], kRow[20]), Status::ok);
      EXPECT_EQ(boxes.partition.refresh(), Status::ok);
      std::vector<std::thread> threads;
      for (PairBuffer& own : pairs) {
        threads.emplace_back([&] {
          HitBuffer hits;
          for (int i = 0; i < 10; ++i) {
            EXPECT_EQ(boxes.partition.self_pairs(own), Status::ok);
            expect_ok(boxes.partition.closest(Ray{{0, 0.5F, 0.5F}, {1, 0, 0}}));
            EXPECT_EQ(boxes.partition.nearest(kRow[7], 3, 9.0F, hits), Status::ok);
          }
        });
      }
      for (std::thread& thread : threads) thread.join();
    }
  }
  ASSERT_EQ(recorder.close(), Status::ok);
  expect_replayed(bytes, 2 + 5 * (2 + 4 * 30) + 1);
}

TEST(RecordedCalls, loading_a_partition_ends_the_recording) {
  Bytes8 bytes;
  Recorder recorder(kept_in(bytes));
  RecordedBoxes boxes(recorder);
  Column<std::byte> saved(std::pmr::get_default_resource());
  ASSERT_EQ(boxes.partition.save(saved), Status::ok);
  EXPECT_EQ(boxes.partition.load({}), Status::invalid_argument);
  EXPECT_EQ(recorder.status(), Status::ok);
  EXPECT_EQ(boxes.partition.load({saved.data(), saved.size()}), Status::ok);
  EXPECT_TRUE(boxes.partition.contains(boxes.keys[0]));
  EXPECT_EQ(recorder.status(), Status::unsupported);
}

TEST(RecordedCalls, pairs_without_common_recorder_end_the_recordings) {
  enum class Recorded { first, second, by_two };
  for (const Recorded recorded : {Recorded::first, Recorded::second, Recorded::by_two}) {
    Bytes8 bytes;
    Bytes8 more;
    Recorder recorder(kept_in(bytes));
    Recorder another(kept_in(more));
    RecordedBoxes boxes(recorder);
    RecordedBoxes of_another(another);
    Partition plain(linear_bvh());
    PairBuffer pairs;
    EXPECT_EQ(boxes.partition.pairs_with(boxes.partition, pairs), Status::ok);
    EXPECT_EQ(recorder.status(), Status::ok);
    EXPECT_EQ(recorded == Recorded::first ? boxes.partition.pairs_with(plain, pairs)
              : recorded == Recorded::second
                  ? plain.pairs_with(boxes.partition, pairs)
                  : boxes.partition.pairs_with(of_another.partition, pairs),
              Status::ok);
    EXPECT_EQ(pairs.empty(), recorded != Recorded::by_two);
    EXPECT_EQ(recorder.status(), Status::unsupported);
    EXPECT_EQ(another.status(), recorded == Recorded::by_two ? Status::unsupported : Status::ok);
  }
}

}  // namespace
}  // namespace winnow::test
