#pragma once

#include "bench/scenes/frame_source.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {

struct SceneInfo {
  std::string_view name;
  std::string_view what;  ///< one line
};

/// Returns the built-in scenes. The first six are used by every benchmark.
[[nodiscard]] std::vector<SceneInfo> scene_infos();

/// Number of scenes, from the front, that every benchmark uses.
inline constexpr std::size_t kMainScenes = 6;

[[nodiscard]] std::vector<std::string> scene_names();
/// Returns the names of the first kMainScenes scenes.
[[nodiscard]] std::vector<std::string> main_scenes();
[[nodiscard]] bool is_built_in(const std::string& name);

/// Returns a built-in scene with finally `objects` objects, in its first frame; it never ends.
/// Equal names, numbers and seeds give equal bits on every machine. Returns null if there is no
/// such name. `objects` >= 1.
[[nodiscard]] std::unique_ptr<FrameSource> make_scene(std::string_view name, std::size_t objects,
                                                      std::uint64_t seed);
/// As above, but throws ArgumentError with a list of the names instead of returning null.
[[nodiscard]] std::unique_ptr<FrameSource> scene_or_error(const std::string& name,
                                                          std::size_t objects, std::uint64_t seed);

}  // namespace winnow::bench
