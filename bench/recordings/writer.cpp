#include "bench/recordings/layout.h"
#include "bench/recordings/recording.h"

#include <algorithm>
#include <cerrno>
#include <fstream>

namespace winnow::bench {
namespace {

constexpr std::size_t kMaxCount = std::numeric_limits<std::int32_t>::max();

void put_text(std::span<std::byte> header, std::size_t at, const std::string& text) {
  std::memcpy(header.data() + at, text.data(), std::min(text.size(), kTextSize - 1));
}

void put_count(std::span<std::byte> header, std::size_t at, std::size_t count) {
  const auto value = static_cast<std::int32_t>(count);
  std::memcpy(header.data() + at, &value, sizeof value);
}

}  // namespace

void write_recording(const std::string& path, FrameSource& source, const std::string& object_type,
                     std::size_t steps) {
  const std::size_t objects = source.boxes().size();
  if (objects != source.objects()) {
    throw RecordingError(path + ": the format takes the same objects in every frame");
  }
  if (objects > kMaxCount || steps > kMaxCount) {
    throw RecordingError(path + ": the format takes at most 2^31-1 objects and frames");
  }
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  if (!file) throw RecordingError(path + ": cannot be written: " + std::strerror(errno));

  std::array<std::byte, kHeaderSize> header{};
  put_text(header, 0, source.name());
  put_text(header, kTextSize, object_type);
  put_count(header, kObjectsAt, objects);
  put_count(header, kStepsAt, steps);
  pack(source.world(), header.data() + kWorldAt);
  file.write(reinterpret_cast<const char*>(header.data()), kHeaderSize);

  std::vector<std::byte> frame(objects * kBoxSize);
  for (std::size_t f = 0; f <= steps && file; ++f) {
    if (f != 0 && !source.advance()) {
      throw RecordingError(path + ": the source ended after " + std::to_string(f) + " frames");
    }
    const std::span<const Aabb> boxes = source.boxes();
    for (std::size_t i = 0; i < objects; ++i) pack(boxes[i], frame.data() + i * kBoxSize);
    file.write(reinterpret_cast<const char*>(frame.data()),
               static_cast<std::streamsize>(frame.size()));
  }
  file.close();
  if (!file) throw RecordingError(path + ": could not be written to its end");
}

}  // namespace winnow::bench
