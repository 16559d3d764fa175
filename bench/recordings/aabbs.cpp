// Reads .aabbs recordings, which it checks against their header, plays and writes them. Recordings
// of programs are passed to program_reader.cpp. Commands of the bench tool call read_recording().

#include "bench/recordings/file_bytes.h"
#include "bench/recordings/recording.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <limits>
#include <new>
#include <string_view>

namespace winnow::bench {
namespace {

static_assert(std::endian::native == std::endian::little && std::numeric_limits<float>::is_iec559,
              "recordings are read and written as they lie in memory");

struct FileBox {
  float min[4];
  float max[4];

  [[nodiscard]] Aabb box() const noexcept {
    return {{min[0], min[1], min[2]}, {max[0], max[1], max[2]}};
  }
};

struct Header {
  char scene[128];
  char object_type[128];
  std::int32_t objects;
  std::int32_t steps;
  std::int32_t unused[2];
  FileBox world;
};
static_assert(sizeof(FileBox) == 32 && sizeof(Header) == 304);

FileBox to_file(const Aabb& box) noexcept {
  return {{box.min.x(), box.min.y(), box.min.z(), 0.0F},
          {box.max.x(), box.max.y(), box.max.z(), 0.0F}};
}

/// Returns the size in bytes of a file with this many frames. Both counts have 31 bits, so 64 bits
/// hold the number of boxes; their bytes may exceed them, but no such file exists.
std::uint64_t file_size(std::uint64_t objects, std::uint64_t frames) {
  constexpr std::uint64_t kMaxBoxes = (~std::uint64_t{0} - sizeof(Header)) / sizeof(FileBox);
  return sizeof(Header) + std::min(frames * objects, kMaxBoxes) * sizeof(FileBox);
}

class Reader {
 public:
  Reader(const std::string& path, std::span<const std::byte> bytes) : path_(path), bytes_(bytes) {}

  Recording read() {
    read_header();
    const auto objects = static_cast<std::size_t>(header_.objects);
    const auto steps = static_cast<std::size_t>(header_.steps);
    const std::uint64_t sizes[2] = {file_size(objects, steps), file_size(objects, steps + 1)};
    const std::uint64_t* const size = std::find(sizes, sizes + 2, bytes_.size());
    if (size == sizes + 2) {
      fail(bytes_.size(), "N = " + std::to_string(objects) + ", F = " + std::to_string(steps) +
                              " require " + std::to_string(sizes[0]) + " or " +
                              std::to_string(sizes[1]) + " bytes, and the file has " +
                              std::to_string(bytes_.size()));
    }
    const std::size_t frames = size == sizes ? steps : steps + 1;
    if (frames == 0) fail(sizeof(Header), "the file holds no frame");
    for (std::size_t frame = 0; frame < frames; ++frame) read_frame(frame);
    return std::move(recording_);
  }

 private:
  [[noreturn]] void fail(std::uint64_t at, const std::string& what) const {
    throw RecordingError(path_ + ": byte " + std::to_string(at) + ": " + what);
  }

  void read_header() {
    if (bytes_.size() < sizeof header_) {
      fail(bytes_.size(), "the file ends inside its header of " + std::to_string(sizeof header_) +
                              " bytes; is this an .aabbs file?");
    }
    std::memcpy(&header_, bytes_.data(), sizeof header_);
    recording_.scene = text(header_.scene, 0, "scene name");
    recording_.object_type = text(header_.object_type, sizeof header_.scene, "object type");
    if (header_.objects <= 0 || header_.steps < 0) {
      fail(offsetof(Header, objects), "N = " + std::to_string(header_.objects) + ", F = " +
                                          std::to_string(header_.steps) + " are no counts");
    }
    recording_.world = header_.world.box();
    if (!recording_.world.is_valid()) {
      fail(offsetof(Header, world), "the world box is inverted or has a NaN");
    }
  }

  [[nodiscard]] std::string text(std::span<const char> field, std::size_t at,
                                 const char* what) const {
    const std::size_t length = std::string_view(field.data(), field.size()).find('\0');
    for (std::size_t i = 0; i < field.size(); ++i) {
      const bool is_text = i < length && std::isprint(static_cast<unsigned char>(field[i])) != 0;
      if (is_text || (i >= length && field[i] == '\0')) continue;
      fail(at + i, std::string("the ") + what + " is not printable text; is this an .aabbs file?");
    }
    return {field.data(), std::min(length, field.size())};
  }

  void read_frame(std::size_t frame) {
    std::vector<Aabb>& boxes = recording_.frames.emplace_back();
    const auto objects = static_cast<std::size_t>(header_.objects);
    for (std::size_t i = 0; i < objects; ++i) {
      const std::size_t at = sizeof(Header) + (frame * objects + i) * sizeof(FileBox);
      FileBox box;
      std::memcpy(&box, bytes_.data() + at, sizeof box);
      if (!boxes.emplace_back(box.box()).is_valid()) {
        fail(at, "box " + std::to_string(i) + " of frame " + std::to_string(frame) +
                     " is inverted or has a NaN");
      }
    }
  }

  const std::string& path_;
  std::span<const std::byte> bytes_;
  Header header_{};
  Recording recording_;
};

bool is_program(std::span<const std::byte> bytes) {
  constexpr std::string_view kMagic = "WINNOWRC";
  return bytes.size() >= kMagic.size() &&
         std::memcmp(bytes.data(), kMagic.data(), kMagic.size()) == 0;
}

class Player final : public FrameSource {
 public:
  explicit Player(const Recording& recording) : recording_(recording) {}

  [[nodiscard]] std::string name() const override { return recording_.scene; }
  [[nodiscard]] Aabb world() const override { return recording_.world; }
  [[nodiscard]] std::span<const Aabb> boxes() const override { return recording_.frames[frame_]; }

  [[nodiscard]] std::size_t objects() const override { return recording_.objects(); }

  bool advance() override {
    if (frame_ + 1 >= recording_.frames.size()) return false;
    ++frame_;
    return true;
  }

 private:
  const Recording& recording_;
  std::size_t frame_ = 0;
};

template <typename T>
void write(std::ofstream& file, const T& value) {
  file.write(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

Recording read_recording(const std::string& path) {
  try {
    const std::vector<std::byte> bytes = read_bytes(path);
    return is_program(bytes) ? read_program(path, bytes) : Reader(path, bytes).read();
  } catch (const std::bad_alloc&) {
    throw RecordingError(path + ": does not fit into memory");
  }
}

std::unique_ptr<FrameSource> play(const Recording& recording) {
  return std::make_unique<Player>(recording);
}

void write_recording(const std::string& path, FrameSource& source, const std::string& object_type,
                     std::size_t steps) {
  constexpr std::size_t kMaxCount = std::numeric_limits<std::int32_t>::max();
  const std::size_t objects = source.boxes().size();
  if (objects != source.objects()) {
    throw RecordingError(path + ": the format takes the same objects in every frame");
  }
  if (objects > kMaxCount || steps > kMaxCount) {
    throw RecordingError(path + ": the format takes at most 2^31-1 objects and frames");
  }
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  if (!file) throw RecordingError(path + ": cannot be written: " + std::strerror(errno));

  Header header{};
  source.name().copy(header.scene, sizeof header.scene - 1);
  object_type.copy(header.object_type, sizeof header.object_type - 1);
  header.objects = static_cast<std::int32_t>(objects);
  header.steps = static_cast<std::int32_t>(steps);
  header.world = to_file(source.world());
  write(file, header);
  for (std::size_t f = 0; f <= steps && file; ++f) {
    if (f != 0 && !source.advance()) {
      throw RecordingError(path + ": the source ended after " + std::to_string(f) + " frames");
    }
    for (const Aabb& box : source.boxes()) write(file, to_file(box));
  }
  file.close();
  if (!file) throw RecordingError(path + ": could not be written to its end");
}

}  // namespace winnow::bench
