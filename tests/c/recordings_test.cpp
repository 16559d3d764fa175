// Recordings made in C, compared with those of a C++ program that makes the same calls.

#include "tests/c/handles_of_c.h"

#include <winnow/pipeline/recording.h>

#include <fstream>
#include <iterator>
#include <string>

namespace winnow::test {
namespace {

[[nodiscard]] std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Records a partition in C. Returns the path of the recording.
[[nodiscard]] std::string record_in_c() {
  std::string path = testing::TempDir() + "winnow_in_c.winnow";
  const OwnedRecorder recorder(winnow_recorder_create, path.c_str(),
                               static_cast<const winnow_memory*>(nullptr));
  winnow_partition_options options = WINNOW_PARTITION_OPTIONS;
  options.recorder = recorder;
  {
    const OwnedPartition partition(winnow_partition_create,
                                   winnow_structure_kind{WINNOW_LINEAR_BVH, 0.0F}, &options);
    const winnow_aabb boxes[2] = {{{0, 0, 0}, {1, 1, 1}}, {{0.5, 0.5, 0.5}, {2, 2, 2}}};
    const winnow_box_view view = winnow_boxes(boxes, 2);
    winnow_key keys[2];
    EXPECT_EQ(winnow_partition_insert(partition, &view, nullptr, keys), WINNOW_OK);
    const OwnedPairs pairs(winnow_pair_buffer_create, static_cast<const winnow_memory*>(nullptr));
    EXPECT_EQ(winnow_partition_self_pairs(partition, pairs, nullptr, nullptr), WINNOW_OK);
    EXPECT_EQ(winnow_recorder_end_frame(recorder), WINNOW_OK);
  }
  EXPECT_EQ(winnow_recorder_close(recorder), WINNOW_OK);
  EXPECT_EQ(winnow_recorder_status(recorder), WINNOW_OK);
  EXPECT_EQ(got<std::uint64_t>(winnow_recorder_bytes, recorder), bytes_of(path).size());
  EXPECT_EQ(got<std::uint64_t>(winnow_recorder_calls, recorder), recorder->calls());
  return path;
}

TEST(CInterface, recording_in_c_equals_that_in_cpp) {
  const std::string in_c = record_in_c();
  const std::string path = testing::TempDir() + "winnow_in_cpp.winnow";
  Recorder recorder(path.c_str());
  {
    Partition partition(linear_bvh(), {.recorder = &recorder});
    const Aabb boxes[2] = {{{0, 0, 0}, {1, 1, 1}}, {{0.5F, 0.5F, 0.5F}, {2, 2, 2}}};
    Key keys[2];
    EXPECT_EQ(partition.insert(boxes, {}, keys), Status::ok);
    PairBuffer pairs;
    EXPECT_EQ(partition.self_pairs(pairs), Status::ok);
    recorder.end_frame();
  }
  EXPECT_EQ(recorder.close(), Status::ok);
  EXPECT_GT(recorder.calls(), 4U);
  EXPECT_EQ(bytes_of(in_c), bytes_of(path));
}

TEST(CInterface, recorder_is_refused_without_a_file) {
  winnow_recorder* recorder = nullptr;
  EXPECT_EQ(winnow_recorder_create("/no/such/folder/x.winnow", nullptr, &recorder),
            WINNOW_INVALID_ARGUMENT);
  EXPECT_EQ(winnow_recorder_create(nullptr, nullptr, &recorder), WINNOW_INVALID_ARGUMENT);
  EXPECT_EQ(recorder, nullptr);
}

TEST(CInterface, scene_of_c_records_its_bodies) {
  const std::string path = testing::TempDir() + "winnow_scene_in_c.winnow";
  const OwnedRecorder recorder(winnow_recorder_create, path.c_str(),
                               static_cast<const winnow_memory*>(nullptr));
  const OwnedShapes shapes(winnow_shape_pool_create, static_cast<const winnow_memory*>(nullptr));
  winnow_scene_options options = WINNOW_SCENE_OPTIONS;
  options.recorder = recorder;
  const std::uint64_t before = recorder->calls();
  const OwnedScene scene(winnow_scene_create, shapes, &options);
  winnow_body_definition body = WINNOW_BODY_DEFINITION;
  winnow_shape ball{};
  ball.kind = WINNOW_SHAPE_SPHERE;
  ball.as.sphere.radius = 1.0;
  body.shape = got<winnow_shape_id>(winnow_shape_pool_add, shapes, &ball);
  winnow_key key;
  EXPECT_EQ(winnow_scene_add(scene, &body, 1, &key), WINNOW_OK);
  EXPECT_GE(recorder->calls(), before + 3) << "the scene, its shape and its body";
}

}  // namespace
}  // namespace winnow::test
