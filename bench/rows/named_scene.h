#pragma once

#include <winnow/simd/isa.h>
#include "bench/recordings/recording.h"
#include "bench/scenes/frame_source.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <sstream>
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

/// Returns the command of bench/run that measures a row again.
template <typename... Parts>
[[nodiscard]] std::string command_text(const Parts&... parts) {
  std::ostringstream text;
  text << "bench/run ";
  (text << ... << parts);
  return text.str();
}
/// Returns " --threads 2 --isa avx2".
[[nodiscard]] std::string settings_text(int threads, Isa isa = active_isa());

}  // namespace winnow::bench
