#pragma once

#include "bench/scenes/frame_source.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {

struct SceneInfo {
  std::string_view name;
  std::string_view what;  ///< one line
};

/// The built-in scenes; the six that every figure is given for come first.
[[nodiscard]] std::span<const SceneInfo> scene_infos() noexcept;

/// How many of them, from the front, every figure is given for.
inline constexpr std::size_t kMainScenes = 6;

[[nodiscard]] std::vector<std::string> scene_names();
/// Of those that every figure is given for.
[[nodiscard]] std::vector<std::string> main_scenes();
[[nodiscard]] bool is_built_in(const std::string& name);

/// A built-in scene of so many objects in the end, in its first frame; it goes on for ever. The
/// same name, number and seed give the same bits on every machine. Null if there is no such name.
/// `objects` >= 1.
[[nodiscard]] std::unique_ptr<FrameSource> make_scene(std::string_view name, std::size_t objects,
                                                      std::uint64_t seed);
/// The same, or ArgumentError with the names there are.
[[nodiscard]] std::unique_ptr<FrameSource> scene_or_error(const std::string& name,
                                                          std::size_t objects, std::uint64_t seed);

}  // namespace winnow::bench
