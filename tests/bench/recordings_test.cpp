// Recordings of boxes: a written file reads back unchanged, and invalid files are refused.

#include "bench/recordings/recording.h"
#include "bench/scenes/scene.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

namespace winnow::bench {
namespace {

constexpr std::size_t kHeader = 304;
constexpr std::size_t kBox = 32;

class Recordings : public testing::Test {
 protected:
  Recordings() { std::filesystem::create_directories(folder_); }
  ~Recordings() override { std::filesystem::remove_all(folder_); }

  // Records a scene of 20 boxes and 3 steps, which makes 4 frames.
  std::vector<char> record(const std::string& scene = "uniform") {
    const auto source = make_scene(scene, 20, 7);
    write_recording(path_, *source, "box", 3);
    std::ifstream file(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  void write(const std::vector<char>& bytes) {
    std::ofstream file(path_, std::ios::binary | std::ios::trunc);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }

  template <typename T>
  static void put(std::vector<char>& bytes, std::size_t at, T value) {
    std::memcpy(bytes.data() + at, &value, sizeof value);
  }

  void expect_refused(const std::vector<char>& bytes, const char* why) {
    write(bytes);
    EXPECT_THROW((void)read_recording(path_), RecordingError) << why;
  }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() /
      ("winnow_" + std::to_string(reinterpret_cast<std::uintptr_t>(this)) + "_" +
       testing::UnitTest::GetInstance()->current_test_info()->name());
  std::string path_ = (folder_ / "scene.aabbs").string();
};

TEST_F(Recordings, written_recording_reads_back_frame_by_frame) {
  for (const SceneInfo& info : scene_infos()) {
    if (info.name == "growth") continue;  // the format stores the same objects in every frame
    record(std::string(info.name));
    const Recording recording = read_recording(path_);
    EXPECT_EQ(recording.scene, info.name);
    EXPECT_EQ(recording.object_type, "box");
    ASSERT_EQ(recording.frames.size(), 4U);
    const auto source = make_scene(info.name, 20, 7);
    const auto player = play(recording);
    for (std::size_t frame = 0; frame < 4; ++frame) {
      const std::vector<Aabb> boxes(source->boxes().begin(), source->boxes().end());
      EXPECT_EQ(recording.frames[frame], boxes) << info.name << ", frame " << frame;
      EXPECT_EQ(std::vector<Aabb>(player->boxes().begin(), player->boxes().end()), boxes);
      EXPECT_EQ(player->advance(), frame < 3);
      EXPECT_TRUE(source->advance());
    }
  }
}

TEST_F(Recordings, scene_that_grows_is_refused) {
  EXPECT_THROW(write_recording(path_, *make_scene("growth", 20, 7), "box", 3), RecordingError);
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(Recordings, recording_that_lacks_one_frame_is_read) {
  std::vector<char> bytes = record();
  put(bytes, 260, std::int32_t{4});  // 4 steps normally make 5 frames
  write(bytes);
  EXPECT_EQ(read_recording(path_).frames.size(), 4U);
}

TEST_F(Recordings, file_of_another_size_is_refused) {
  const std::vector<char> good = record();
  for (const std::size_t size : {std::size_t{0}, std::size_t{100}, kHeader - 1, kHeader,
                                 kHeader + 10, good.size() - kBox, good.size() - 1}) {
    expect_refused({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)}, "cut off");
  }
  std::vector<char> longer = good;
  longer.push_back(0);
  expect_refused(longer, "one byte more");
}

TEST_F(Recordings, file_with_a_false_header_is_refused) {
  const std::vector<char> good = record();
  for (const std::int32_t count : {0, -1, 19, 21, 0x7FFFFFFF, -0x7FFFFFFF}) {
    std::vector<char> bad = good;
    put(bad, 256, count);
    expect_refused(bad, "objects");
  }
  for (const std::int32_t steps : {-1, 0, 1, 5, 0x7FFFFFFF}) {
    std::vector<char> bad = good;
    put(bad, 260, steps);
    expect_refused(bad, "steps");
  }
  std::vector<char> bad = good;
  bad[3] = '\x01';
  expect_refused(bad, "a character that is not printable");
}

TEST_F(Recordings, file_with_a_bad_box_is_refused) {
  const std::vector<char> good = record();
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  for (const std::size_t at : {std::size_t{272}, kHeader, good.size() - kBox}) {
    std::vector<char> bad = good;
    put(bad, at, nan);
    expect_refused(bad, "NaN");
    put(bad, at, 1e30F);
    expect_refused(bad, "inverted");
  }
}

TEST_F(Recordings, missing_file_is_refused) {
  EXPECT_THROW((void)read_recording((folder_ / "none.aabbs").string()), RecordingError);
}

}  // namespace
}  // namespace winnow::bench
