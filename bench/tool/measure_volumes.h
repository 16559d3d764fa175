#pragma once

#include "recordings/recording.h"
#include "volumes/solids.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace winnow::bench {

/// What volumes are put around, and how fast it moves.
struct VolumeSetting {
  std::string what;   ///< "rotated cubes"
  double step = 0.1;  ///< how far an object goes in a frame, in its mean edges
  Solids solids{};
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

/// One of the settings. Objects of a recording's first frame go as far as they do in it on average,
/// but in any direction. Throws ArgumentError for an unknown scene.
[[nodiscard]] VolumeSetting make_volume_setting(std::string_view name,
                                                const VolumeSettingOptions& options);

/// Timed frames that give steady medians in a second or two.
[[nodiscard]] std::size_t volume_frames(std::size_t objects) noexcept;

}  // namespace winnow::bench
