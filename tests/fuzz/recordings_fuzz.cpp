// Untrusted recordings of boxes: each is either refused with an error, or read completely and equal
// after it is written and read again.

#include <cstring>
#include <fstream>

#include "bench/recordings/recording.h"
#include "tests/fuzz/target.h"

namespace winnow::test {
namespace {

using bench::Recording;

bool same_frames(const Recording& a, const Recording& b) {
  return a.scene == b.scene && a.frames == b.frames;
}

/// Returns a recording of `objects` unit boxes.
std::string file_of(std::int32_t objects, std::int32_t steps, std::int32_t frames) {
  std::string file(256, '\0');
  file.replace(0, 7, "uniform");
  file.replace(128, 4, "cube");
  const auto put = [&](auto value) {
    file.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (const std::int32_t count : {objects, steps, 0, 0}) put(count);
  for (std::int32_t box = 0; box < 1 + objects * frames; ++box) {
    for (int k = 0; k < 8; ++k) put(k % 4 == 3 ? 0.0F : static_cast<float>(box + (k > 3 ? 1 : 0)));
  }
  return file;
}

}  // namespace

void fuzz(std::span<const std::uint8_t> input) {
  const ScratchFile file(input, ".aabbs");
  Recording recording;
  try {
    recording = bench::read_recording(file.path());
  } catch (const bench::RecordingError& error) {
    WINNOW_REQUIRE(std::string(error.what()).find(file.path()) == 0);
    return;
  }
  WINNOW_REQUIRE(recording.objects() != 0 && recording.world.is_valid());
  for (const auto& frame : recording.frames) {
    WINNOW_REQUIRE(frame.size() == recording.objects());
    for (const Aabb& box : frame) WINNOW_REQUIRE(box.is_valid());
  }
  const ScratchFile copy({}, "_copy.aabbs");
  const auto source = bench::play(recording);
  bench::write_recording(copy.path(), *source, recording.object_type, recording.frames.size() - 1);
  WINNOW_REQUIRE(same_frames(recording, bench::read_recording(copy.path())));
}

std::vector<std::string> fuzz_seeds() {
  std::vector<std::string> seeds{"",
                                 file_of(1, 0, 1),
                                 file_of(3, 2, 3),
                                 file_of(3, 2, 2),
                                 file_of(17, 1, 2),
                                 file_of(2, 1000, 1)};
  const std::string whole = file_of(2, 1, 2);
  // Changes every 37th of the first 256 bytes, which are two texts, and each byte after them; also
  // truncates the file before each of these bytes.
  for (std::size_t i = 0; i < whole.size(); i += i < 256 ? 37 : 1) {
    for (const char other : {'\0', '\x7F', '\x80', '\xFF'}) {
      seeds.push_back(whole);
      seeds.back()[i] = other;
    }
    seeds.push_back(whole.substr(0, i));
  }
  seeds.push_back(whole + "x");
  // Inputs with the signature of compressed files.
  for (std::string seed : random_seeds(20, 200)) {
    seeds.push_back(std::string("\xFD"
                                "7zXZ\0",
                                6) +
                    std::move(seed));
  }
  return seeds;
}

}  // namespace winnow::test
