#pragma once

#include "bench/scenes/frame_source.h"

#include <cstddef>
#include <memory>
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

/// What is wrong with a file, and where.
class RecordingError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct Recording {
  std::string scene;
  std::string object_type;
  Aabb world;
  std::vector<std::vector<Aabb>> frames;  ///< all of the same size

  [[nodiscard]] std::size_t objects() const noexcept {
    return frames.empty() ? 0 : frames.front().size();
  }
};

/// Reads a whole .aabbs file, or an .aabbs.xz if built with liblzma. Throws RecordingError.
[[nodiscard]] Recording read_recording(const std::string& path);

/// The .aabbs and .aabbs.xz files of a folder by name; none if the folder is not there.
[[nodiscard]] std::vector<std::string> recordings_in(const std::string& folder);

/// Writes the source's current frame and `steps` more. Throws RecordingError.
void write_recording(const std::string& path, FrameSource& source, const std::string& object_type,
                     std::size_t steps);

/// A recording that is shown from its first frame on. It must outlive the source.
[[nodiscard]] std::unique_ptr<FrameSource> play(const Recording& recording);

}  // namespace winnow::bench
