#pragma once

#include "recordings/recording.h"
#include "scenes/frame_source.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace winnow::bench {

/// What a subcommand shows: a built-in scene by name, or a recording. A file goes before a scene of
/// the same name.
struct Target {
  std::string name;
  std::optional<std::size_t> objects;  ///< of a scene; unset: 10,000
  std::optional<std::uint64_t> seed;   ///< of a scene; unset: 1

  /// Reads the recording, if it is one. Throws ArgumentError or RecordingError.
  void open();
  /// From the first frame on, any number of times. Call `open` first; it must outlive the source.
  [[nodiscard]] std::unique_ptr<FrameSource> source() const;
  /// Null unless it is a recording.
  [[nodiscard]] const Recording* recording() const { return recording_ ? &*recording_ : nullptr; }

 private:
  std::optional<Recording> recording_;
};

/// Each of them, opened.
[[nodiscard]] std::vector<Target> open_targets(const std::vector<std::string>& names);

}  // namespace winnow::bench
