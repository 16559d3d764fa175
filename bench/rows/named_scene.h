#pragma once

#include "bench/recordings/recording.h"
#include "bench/scenes/frame_source.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace winnow::bench {

/// A built-in scene, or a recording, as rows and the commands that measure them again name it.
struct NamedScene {
  std::string name;
  std::string argument{};  ///< how a command names it: the scene, or the file
  std::shared_ptr<const Recording> recording{};

  [[nodiscard]] bool is_recording() const noexcept { return recording != nullptr; }
  /// A recording has its own number, whatever is asked for.
  [[nodiscard]] std::size_t objects(std::size_t asked) const;
  /// From the first frame on. Throws ArgumentError if there is no such scene.
  [[nodiscard]] std::unique_ptr<FrameSource> source(std::size_t objects, std::uint64_t seed) const;
  /// How the options of commands name it: " --scene ...", and what else a built-in one needs.
  [[nodiscard]] std::string words(std::size_t objects, std::uint64_t seed) const;
};

/// Scenes and recordings, each once. Rows of two are told apart by their names: a recording whose
/// own is taken has its file's besides. Throws ArgumentError or RecordingError.
[[nodiscard]] std::vector<NamedScene> named_scenes(const std::vector<std::string>& arguments);

/// A word as a shell takes it for one.
[[nodiscard]] std::string shell_word(const std::string& word);

/// A command, by which other libraries are installed first.
[[nodiscard]] std::string with_peers(const std::string& command);

}  // namespace winnow::bench
