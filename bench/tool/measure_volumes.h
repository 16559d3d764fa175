#pragma once

#include "recordings/recording.h"
#include "volumes/solids.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// What volumes are put around, and how fast it moves.
struct VolumeSetting {
  std::string what;   ///< "rotated cubes"
  double step = 0.1;  ///< how far an object goes in a frame, in its mean edges
  Solids solids{};
  std::span<const std::vector<Aabb>> recorded{};  ///< frames to follow, if there are any

  /// How many frames can be timed.
  [[nodiscard]] std::size_t frames(std::size_t wanted) const noexcept {
    return recorded.size() < 2 ? wanted : std::min(wanted, recorded.size() - 1);
  }
};

struct VolumeSettingOptions {
  std::string scene = "uniform";
  const Recording* recording = nullptr;  ///< instead of the scene
  std::size_t objects = 10'000;          ///< unless they are a recording's
  std::uint64_t seed = 1;
};

/// "scene", and objects that are turned: "cubes", "rods", "slow".
[[nodiscard]] std::span<const std::string_view> volume_setting_names() noexcept;

/// Partitions that take volumes from the caller.
[[nodiscard]] std::span<const std::string_view> volume_partitions() noexcept;

/// One of the settings. Objects of a recording go as they do in it; `step` is how far on average.
/// Throws ArgumentError for an unknown scene.
[[nodiscard]] VolumeSetting make_volume_setting(std::string_view name,
                                                const VolumeSettingOptions& options);

/// Timed frames that give steady medians in a second or two.
[[nodiscard]] std::size_t volume_frames(std::size_t objects) noexcept;

}  // namespace winnow::bench
