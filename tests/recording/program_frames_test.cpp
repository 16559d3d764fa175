// Frames of boxes that the tool makes from a program's recording.

#include "bench/recordings/recording.h"

#include <gtest/gtest.h>

#include <unistd.h>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/recording/programs.h"
#include "tests/support/answers.h"

namespace winnow::test {
namespace {

class ProgramFrames : public testing::Test {
 protected:
  ~ProgramFrames() override { std::filesystem::remove(path_); }

  const std::string path_ = (std::filesystem::temp_directory_path() /
                             ("winnow_frames_" + std::to_string(::getpid()) + ".winnow"))
                                .string();
};

TEST_F(ProgramFrames, frames_have_a_row_for_each_id) {
  const Aabb unit{{0, 0, 0}, {1, 1, 1}};
  const Aabb far{{5, 0, 0}, {6, 1, 1}};
  {
    Recorder recorder(path_.c_str());
    Partition partition(linear_bvh(), {.recorder = &recorder});
    Key keys[3];
    keys[0] = expect_ok(partition.insert(unit, 0));
    keys[1] = expect_ok(partition.insert(unit, 0));
    recorder.end_frame();
    EXPECT_EQ(partition.remove(keys[0]), Status::ok);
    recorder.end_frame();
    keys[0] = expect_ok(partition.insert(far, 0));
    keys[2] = expect_ok(partition.insert(far, 0));
    recorder.end_frame();
  }
  const bench::Recording recording = bench::read_recording(path_);
  ASSERT_EQ(recording.frames.size(), 3U);
  EXPECT_EQ(recording.objects(), 3U);
  EXPECT_TRUE((recording.frames[0] == std::vector<Aabb>{unit, unit}));
  const Aabb gone = recording.frames[1][0];
  EXPECT_TRUE(gone.is_valid() && gone.min == gone.max && !gone.overlaps(unit));
  EXPECT_TRUE(recording.world.overlaps(gone));
  EXPECT_TRUE((recording.frames[2] == std::vector<Aabb>{far, unit, far}));
  ASSERT_TRUE(recording.program);
  EXPECT_TRUE(recording.program->is_whole);
}

TEST_F(ProgramFrames, frames_follow_queries_without_end_frame) {
  {
    Recorder recorder(path_.c_str());
    Partition partition(linear_bvh(), {.recorder = &recorder});
    PairBuffer pairs;
    Key key;
    for (int frame = 0; frame < 4; ++frame) {
      key = expect_ok(partition.insert({{0, 0, 0}, {1, 1, 1}}, 0));
      EXPECT_EQ(partition.self_pairs(pairs), Status::ok);
    }
  }
  const bench::Recording recording = bench::read_recording(path_);
  ASSERT_EQ(recording.frames.size(), 4U);
  for (std::size_t f = 0; f < 4; ++f) EXPECT_EQ(recording.frames[f].size(), f + 1);
  EXPECT_EQ(recording.program->questions, 4U);
  EXPECT_EQ(recording.program->differences, 0U);
}

TEST_F(ProgramFrames, frames_of_scenes_are_boxes_of_bodies) {
  {
    Recorder recorder(path_.c_str());
    record_scene(recorder, 30, 5, {});
  }
  const bench::Recording recording = bench::read_recording(path_);
  EXPECT_EQ(recording.frames.size(), 5U);
  EXPECT_EQ(recording.objects(), 39U);
  EXPECT_EQ(recording.program->differences, 0U);
}

TEST_F(ProgramFrames, frames_have_contacts_at_the_bodies) {
  {
    Recorder recorder(path_.c_str());
    ShapePool shapes;
    const ShapeId box = shapes.add(BoxShape{{0.5, 0.5, 0.5}});
    Scene scene(shapes, {.recorder = &recorder});
    expect_ok(scene.add({.shape = box, .pose = Pose::at(10, 20, 30)}));
    expect_ok(scene.add({.shape = box, .pose = Pose::at(10, 20, 30.9)}));
    recorder.end_frame();
    Contacts contacts;
    EXPECT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
    recorder.end_frame();
    EXPECT_EQ(scene.collide(ContactLevel::boolean, contacts), Status::ok);
    recorder.end_frame();
  }
  const bench::Recording recording = bench::read_recording(path_);
  const auto& frames = recording.contacts;
  ASSERT_EQ(frames.size(), recording.frames.size());
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_TRUE(frames[0].empty() && frames[2].empty());
  ASSERT_EQ(frames[1].size(), 4U);
  for (const bench::RecordedContact& contact : frames[1]) {
    EXPECT_NEAR(std::abs(contact.at.x() - 10), 0.5, 1e-5);
    EXPECT_NEAR(std::abs(contact.at.y() - 20), 0.5, 1e-5);
    EXPECT_NEAR(contact.at.z(), 30.45, 1e-5);
    EXPECT_NEAR(std::abs(contact.normal.z()), 1.0, 1e-6);
  }
}

TEST_F(ProgramFrames, damaged_recording_is_refused) {
  {
    Recorder recorder(path_.c_str());
    record_scene(recorder, 30, 5, {});
  }
  std::fstream file(path_, std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(500);
  file.put('x').put('y').put('z');
  file.close();
  EXPECT_THROW((void)bench::read_recording(path_), bench::RecordingError);
}

}  // namespace
}  // namespace winnow::test
