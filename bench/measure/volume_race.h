#pragma once

#include "bench/common/sample.h"
#include "bench/recordings/recording.h"
#include "bench/scenes/solids.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {

// Not raced: bounds of 16 bits, relative to the box of a group of 256 rows. They took half the
// memory and 10 to 15 % less time to test on AVX-512, with 0.02 to 0.04 % false positives, and
// making them anew in each frame costs a thirtieth of that: too little for a second form of every
// kernel.

/// One kind of volume around the objects of a scene, followed over some frames on one thread.
struct VolumeRow {
  std::string volume;
  std::size_t reported = 0;     ///< pairs, summed over the frames
  std::size_t overlapping = 0;  ///< of these, pairs of objects that overlap
  std::size_t missed = 0;       ///< pairs that overlap and were not reported; must be 0
  double bytes_per_object = 0.0;
  /// Of the pairs that overlap, summed over the frames, see PairSummary.
  std::uint64_t fingerprint = 0;
  // Milliseconds a frame.
  std::vector<double> make{};    ///< of the volumes, from the oriented boxes
  std::vector<double> broad{};   ///< update and pairs
  std::vector<double> narrow{};  ///< exact test of the reported pairs

  /// Share of the reported pairs that do not overlap.
  [[nodiscard]] double false_positives() const noexcept;
  /// Medians.
  [[nodiscard]] double make_ms() const { return median_of(make); }
  [[nodiscard]] double broad_ms() const { return median_of(broad); }
  [[nodiscard]] double narrow_ms() const { return median_of(narrow); }
  [[nodiscard]] double sum_ms() const { return make_ms() + broad_ms() + narrow_ms(); }
  // By frames, in milliseconds.
  [[nodiscard]] std::vector<double> found() const;     ///< from oriented boxes to reported pairs
  [[nodiscard]] std::vector<double> answered() const;  ///< to tested pairs
};

struct VolumeRaceOptions {
  std::string partition = "LinearBvh";
  std::size_t frames = 9;  ///< timed ones; one more comes before them
  double step = 0.1;       ///< how far an object goes in a frame, in mean edges
  /// Instead of that, the frames of a recording whose first one the solids are made of.
  std::span<const std::vector<Aabb>> recorded{};
};

/// All volumes, then margins of 5, 10, 20 and 50 % about boxes, in turns over the same frames.
/// Throws std::invalid_argument if the partition takes no volumes.
[[nodiscard]] std::vector<VolumeRow> race_volumes(Solids solids, const VolumeRaceOptions& options);

/// Nanoseconds that the exact test of a pair must cost for the row's volume to pay off against
/// boxes without a margin (the first row): what it costs more, by the pairs that it saves. 0 if it
/// saves none.
[[nodiscard]] double pays_from_ns(const VolumeRow& row, const VolumeRow& boxes);

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
