// Reads .aabbs recordings, which it checks against their header, and passes recordings of programs
// to program_reader.cpp. Commands of the bench tool call read_recording().

#include "bench/recordings/byte_source.h"
#include "bench/recordings/layout.h"
#include "bench/recordings/recording.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string_view>
#include <system_error>

namespace winnow::bench {
namespace {

/// Returns the size in bytes of a file with this many frames, or the largest number if that exceeds
/// 64 bits. Both counts have 31 bits, so their product does not overflow.
std::uint64_t file_size(std::uint64_t objects, std::uint64_t frames) {
  constexpr std::uint64_t kMaxSize = std::numeric_limits<std::uint64_t>::max();
  const std::uint64_t boxes = frames * objects;
  return boxes > (kMaxSize - kHeaderSize) / kBoxSize ? kMaxSize : kHeaderSize + boxes * kBoxSize;
}

class Reader {
 public:
  explicit Reader(const std::string& path) : path_(path), bytes_(open_bytes(path)) {}

  Recording read() {
    read_header();
    check_size();
    // A file has either `steps_` or `steps_ + 1` frames. If its size is not available in advance,
    // its end decides.
    for (std::uint64_t f = 0; f <= steps_; ++f) {
      std::vector<Aabb> boxes = read_frame(f);
      if (boxes.empty()) break;
      recording_.frames.push_back(std::move(boxes));
    }
    std::byte extra{};
    if (bytes_->read({&extra, 1}) != 0) {
      fail(offset_, "the data goes on after the last frame (" + shape() + ")");
    }
    if (recording_.frames.empty()) fail(offset_, "the file holds no frame (" + shape() + ")");
    return std::move(recording_);
  }

 private:
  [[noreturn]] void fail(std::uint64_t at, const std::string& what) const {
    throw RecordingError(path_ + ": byte " + std::to_string(at) + ": " + what);
  }

  [[nodiscard]] std::string shape() const {
    return "N = " + std::to_string(objects_) + ", F = " + std::to_string(steps_) + " require " +
           std::to_string(file_size(objects_, steps_)) + " or " +
           std::to_string(file_size(objects_, steps_ + 1)) + " bytes";
  }

  void read_header() {
    std::array<std::byte, kHeaderSize> header{};
    const std::size_t count = bytes_->read(header);
    if (count < kHeaderSize) {
      fail(count, "the file ends inside its header of " + std::to_string(kHeaderSize) + " bytes");
    }
    recording_.scene = text(header, 0, "scene name");
    recording_.object_type = text(header, kTextSize, "object type");
    objects_ = count_at(header, kObjectsAt, "number of objects N");
    steps_ = count_at(header, kStepsAt, "number of frames F");
    if (objects_ == 0) fail(kObjectsAt, "the number of objects N is 0");
    recording_.world = unpack(header.data() + kWorldAt);
    if (!recording_.world.is_valid()) fail(kWorldAt, "the world box is inverted or has a NaN");
    offset_ = kHeaderSize;
  }

  [[nodiscard]] std::string text(std::span<const std::byte> header, std::size_t at,
                                 const char* what) const {
    std::string result;
    bool ended = false;
    for (std::size_t i = 0; i < kTextSize; ++i) {
      const auto c = std::to_integer<unsigned char>(header[at + i]);
      if (c == 0) {
        ended = true;
      } else if (ended || std::isprint(c) == 0) {
        fail(at + i,
             std::string("the ") + what +
                 (ended ? " goes on after its end" : " has a character that is not printable") +
                 "; is this an .aabbs file?");
      } else {
        result += static_cast<char>(c);
      }
    }
    return result;
  }

  [[nodiscard]] std::uint64_t count_at(std::span<const std::byte> header, std::size_t at,
                                       const char* what) const {
    std::int32_t value = 0;
    std::memcpy(&value, header.data() + at, sizeof value);
    if (value < 0) fail(at, std::string("the ") + what + " is " + std::to_string(value));
    return static_cast<std::uint64_t>(value);
  }

  void check_size() const {
    const std::optional<std::uint64_t> size = bytes_->size();
    if (!size) return;
    if (*size != file_size(objects_, steps_) && *size != file_size(objects_, steps_ + 1)) {
      fail(*size, "the file has " + std::to_string(*size) + " bytes, but " + shape());
    }
  }

  /// Returns an empty vector at the end of the file.
  std::vector<Aabb> read_frame(std::uint64_t frame) {
    // Reads in portions, so that a wrong count in the header cannot allocate more than the file's
    // size.
    constexpr std::uint64_t kPortion = 4096;
    std::vector<std::byte> portion(kPortion * kBoxSize);
    std::vector<Aabb> boxes;
    while (boxes.size() < objects_) {
      const auto requested = static_cast<std::size_t>(
          std::min<std::uint64_t>(kPortion, objects_ - boxes.size()) * kBoxSize);
      const std::size_t count = bytes_->read({portion.data(), requested});
      if (count < requested) {
        const bool between = boxes.empty() && count == 0 && frame == steps_;
        if (between) return {};
        fail(offset_ + count,
             "the file ends inside frame " + std::to_string(frame) + " (" + shape() + ")");
      }
      for (std::size_t at = 0; at < requested; at += kBoxSize) {
        boxes.push_back(unpack(portion.data() + at));
        if (!boxes.back().is_valid()) {
          fail(offset_ + at, "box " + std::to_string(boxes.size() - 1) + " of frame " +
                                 std::to_string(frame) + " is inverted or has a NaN");
        }
      }
      offset_ += requested;
    }
    return boxes;
  }

  std::string path_;
  std::unique_ptr<ByteSource> bytes_;
  Recording recording_;
  std::uint64_t objects_ = 0;
  std::uint64_t steps_ = 0;
  std::uint64_t offset_ = 0;  // offset of the next byte to read
};

/// Checks plain files only, because bytes read from a pipe could not be read again.
bool is_program(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return false;
  constexpr std::string_view kMagic = "WINNOWRC";
  std::array<char, kMagic.size()> begin{};
  return open_bytes(path)->read(std::as_writable_bytes(std::span(begin))) == begin.size() &&
         std::string_view(begin.data(), begin.size()) == kMagic;
}

std::vector<std::byte> all_of(ByteSource& bytes) {
  constexpr std::size_t kAtATime = std::size_t{1} << 20U;
  std::vector<std::byte> all;
  for (std::size_t size = 0;; size = all.size()) {
    all.resize(size + kAtATime);
    const std::size_t count = bytes.read(std::span(all).subspan(size));
    all.resize(size + count);
    if (count < kAtATime) return all;
  }
}

}  // namespace

Recording read_recording(const std::string& path) {
  try {
    if (!is_program(path)) return Reader(path).read();
    return read_program(path, all_of(*open_bytes(path)));
  } catch (const std::bad_alloc&) {
    throw RecordingError(path + ": does not fit into memory");
  }
}

std::vector<std::vector<RecordedContact>> read_contacts(const std::string& path) {
  try {
    if (!is_program(path)) return {};
    return read_program_contacts(path, all_of(*open_bytes(path)));
  } catch (const std::bad_alloc&) {
    throw RecordingError(path + ": does not fit into memory");
  }
}

}  // namespace winnow::bench
