#pragma once

#include "bench/recordings/recording.h"
#include "bench/scenes/frame_source.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace winnow::bench {

/// A built-in scene or a recording, with the name that rows use and the argument that commands use.
struct NamedScene {
  std::string name;
  std::string argument{};  ///< a command's argument: the scene's name or the file's path
  std::shared_ptr<const Recording> recording{};

  [[nodiscard]] bool is_recording() const noexcept { return recording != nullptr; }
  /// Returns the number of objects; a recording has a fixed number.
  [[nodiscard]] std::size_t objects(std::size_t requested) const;
  /// Returns the scene from its first frame. Throws ArgumentError if there is no such scene.
  [[nodiscard]] std::unique_ptr<FrameSource> source(std::size_t objects, std::uint64_t seed) const;
  /// Returns the command options of the scene: " --scene ...", and size and seed of a built-in one.
  [[nodiscard]] std::string words(std::size_t objects, std::uint64_t seed) const;
};

/// Returns the scenes and recordings without duplicates. Their names are distinct: if a recording's
/// name is taken, its file name is appended. Throws ArgumentError or RecordingError.
[[nodiscard]] std::vector<NamedScene> named_scenes(const std::vector<std::string>& arguments);

/// Quotes a word for a shell if necessary.
[[nodiscard]] std::string shell_word(const std::string& word);

/// Returns a command that installs the other libraries first.
[[nodiscard]] std::string with_peers(const std::string& command);

}  // namespace winnow::bench
