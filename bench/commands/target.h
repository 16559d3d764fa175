#pragma once

#include "bench/rows/named_scene.h"

#include <CLI/CLI.hpp>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace winnow::bench {

/// Of a built-in scene, unless asked otherwise.
inline constexpr std::size_t kSceneObjects = 10'000;

/// What a command shows that takes one scene: a built-in one by name, or a recording.
struct Target {
  std::string name;
  std::optional<std::size_t> objects;  ///< of a built-in scene
  std::optional<std::uint64_t> seed;   ///< of a built-in scene; unset: 1

  /// The argument and its two options.
  void add_to(CLI::App& app);
  /// Throws ArgumentError or RecordingError.
  [[nodiscard]] NamedScene named() const;
  /// From the first frame on.
  [[nodiscard]] std::unique_ptr<FrameSource> source(const NamedScene& scene) const {
    return scene.source(objects.value_or(kSceneObjects), seed.value_or(1));
  }
};

}  // namespace winnow::bench
