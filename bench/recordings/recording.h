#pragma once

#include "bench/scenes/frame_source.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace winnow::bench {

// Recordings in Broadmark's format (.aabbs), little-endian:
//   byte   0  char[128]  scene name, printable, zero-filled
//   byte 128  char[128]  object type, likewise
//   byte 256  int32      N, objects
//   byte 260  int32      F, steps
//   byte 264  int32[2]   not used, written as 0
//   byte 272  box        the world
//   byte 304  box[N]     the first frame, then F more; files with F frames in all exist too
// A box is 8 floats: min x y z and one not used, max x y z and one not used.
//
// Or what a program recorded of itself (winnow::Recorder; pipeline/CONTRACT.md has the format).

/// What is wrong with a file, and where.
class RecordingError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Recording {
  std::string scene;
  std::string object_type;
  Aabb world;
  /// Each as large as the one before or larger: that of a program grows with the objects that it
  /// has at a time. A row whose object is gone is a point beside the world until another gets it.
  std::vector<std::vector<Aabb>> frames;

  /// How a program's recording was played.
  struct Program {
    std::uint64_t calls = 0;
    std::uint64_t questions = 0;
    std::uint64_t differences = 0;  ///< questions that were not answered as recorded
    bool is_whole = false;          ///< the recording was closed
  };
  std::optional<Program> program;

  /// Of the last frame.
  [[nodiscard]] std::size_t objects() const noexcept {
    return frames.empty() ? 0 : frames.back().size();
  }
};

/// Reads a whole .aabbs file, or what a program recorded; either may be an .xz if built with
/// liblzma. Throws RecordingError.
[[nodiscard]] Recording read_recording(const std::string& path);

/// What a program recorded, as frames of boxes: its calls are played twice. Throws RecordingError.
[[nodiscard]] Recording read_program(const std::string& path, std::span<const std::byte> bytes);

/// A point at which two bodies of a scene touch.
struct RecordedContact {
  Vec3f at;      ///< halfway between the surfaces
  Vec3f normal;  ///< unit, from one body to the other
};

/// The contacts that a program was last told of by the end of each frame of `read_recording`, with
/// bodies where they stand there: of a scene asked at level manifold. No frames of an .aabbs file.
/// Throws RecordingError.
[[nodiscard]] std::vector<std::vector<RecordedContact>> read_contacts(const std::string& path);

/// The same of what a program recorded.
[[nodiscard]] std::vector<std::vector<RecordedContact>> read_program_contacts(
    const std::string& path, std::span<const std::byte> bytes);

/// The .aabbs and .winnow files of a folder, .xz or not, by name; none if the folder is not there.
[[nodiscard]] std::vector<std::string> recordings_in(const std::string& folder);

/// Writes the source's current frame and `steps` more. Throws RecordingError.
void write_recording(const std::string& path, FrameSource& source, const std::string& object_type,
                     std::size_t steps);

/// A recording that is shown from its first frame on. It must outlive the source.
[[nodiscard]] std::unique_ptr<FrameSource> play(const Recording& recording);

}  // namespace winnow::bench
