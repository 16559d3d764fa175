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
// The other format is a program's recording of its own calls (winnow::Recorder); see
// pipeline/FORMATS.md.

/// The message names the file and what is wrong with it.
class RecordingError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A point at which two bodies of a scene touch.
struct RecordedContact {
  Vec3f at;      ///< halfway between the surfaces
  Vec3f normal;  ///< unit, from one body to the other
};

struct Recording {
  std::string scene;
  std::string object_type;
  Aabb world;
  /// Sizes never decrease: in a program's recording, a frame has a row for each id used so far. A
  /// row whose id no object has in this frame is a point outside the bounds of all boxes.
  std::vector<std::vector<Aabb>> frames;
  /// For each frame of a program's recording, the contacts that the scene had computed last by the
  /// frame's end, at level manifold, at the bodies' poses of that time. Empty for an .aabbs file.
  std::vector<std::vector<RecordedContact>> contacts;

  /// Statistics of playing a program's recording.
  struct Program {
    std::uint64_t calls = 0;
    std::uint64_t questions = 0;
    std::uint64_t differences = 0;  ///< queries whose results differ from the recorded ones
    bool is_whole = false;          ///< the recording was closed
  };
  std::optional<Program> program;

  /// Returns the number of rows of the last frame.
  [[nodiscard]] std::size_t objects() const noexcept {
    return frames.empty() ? 0 : frames.back().size();
  }
};

/// Reads a whole .aabbs file or a program's recording; either may be compressed with xz if built
/// with liblzma. Throws RecordingError.
[[nodiscard]] Recording read_recording(const std::string& path);

/// Plays a program's recording twice and returns its frames. Throws RecordingError.
[[nodiscard]] Recording read_program(const std::string& path, std::span<const std::byte> bytes);

/// Writes the source's current frame and `steps` more. Throws RecordingError.
void write_recording(const std::string& path, FrameSource& source, const std::string& object_type,
                     std::size_t steps);

/// Returns a source that plays the recording from its first frame. The recording must outlive it.
[[nodiscard]] std::unique_ptr<FrameSource> play(const Recording& recording);

}  // namespace winnow::bench
