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

/// Results of one kind of volume around the objects of a scene, over some frames on one thread.
struct VolumeRow {
  std::string volume;
  std::size_t reported = 0;     ///< pairs, summed over the frames
  std::size_t overlapping = 0;  ///< reported pairs whose objects overlap
  std::size_t missed = 0;       ///< overlapping pairs that were not reported; must be 0
  double bytes_per_object = 0.0;
  /// Sum over the overlapping pairs of all frames, see PairSummary.
  std::uint64_t fingerprint = 0;
  // Milliseconds per frame.
  std::vector<double> make{};    ///< making the volumes from the oriented boxes
  std::vector<double> broad{};   ///< update and pairs
  std::vector<double> narrow{};  ///< exact test of the reported pairs

  /// Share of the reported pairs that do not overlap.
  [[nodiscard]] double false_positives() const noexcept;
  /// Medians.
  [[nodiscard]] double make_ms() const { return median_of(make); }
  [[nodiscard]] double broad_ms() const { return median_of(broad); }
  [[nodiscard]] double narrow_ms() const { return median_of(narrow); }
  [[nodiscard]] double sum_ms() const { return make_ms() + broad_ms() + narrow_ms(); }
  // By frame, in milliseconds.
  [[nodiscard]] std::vector<double> found() const;     ///< from oriented boxes to reported pairs
  [[nodiscard]] std::vector<double> answered() const;  ///< from oriented boxes to tested pairs
};

struct VolumeRaceOptions {
  std::string partition = "LinearBvh";
  std::size_t frames = 9;  ///< timed frames; one untimed frame precedes them
  double step = 0.1;       ///< movement of an object per frame, in mean edges
  /// If given, the frames of this recording are used instead; the solids were made of its first
  /// frame.
  std::span<const std::vector<Aabb>> recorded{};
};

/// Races all volumes, and boxes with fat margins of 5, 10, 20 and 50 % of their longest edges, in
/// turns over the same frames. Throws std::invalid_argument if the partition supports no volumes.
[[nodiscard]] std::vector<VolumeRow> race_volumes(Solids solids, const VolumeRaceOptions& options);

/// Returns the nanoseconds of an exact pair test from which on the row's volume is faster than
/// boxes without a margin (the first row): its additional cost divided by the number of pairs that
/// it saves. 0 if it saves none.
[[nodiscard]] double pays_from_ns(const VolumeRow& row, const VolumeRow& boxes);

/// The objects of a race, and their speed.
struct VolumeSetting {
  std::string what;   ///< "rotated cubes"
  double step = 0.1;  ///< movement of an object per frame, in mean edges
  Solids solids{};
  std::span<const std::vector<Aabb>> recorded{};  ///< frames to follow, if any

  /// Returns how many frames can be timed.
  [[nodiscard]] std::size_t frames(std::size_t requested) const noexcept {
    return recorded.size() < 2 ? requested : std::min(requested, recorded.size() - 1);
  }
};

struct VolumeSettingOptions {
  std::string scene = "uniform";
  const Recording* recording = nullptr;  ///< replaces the scene
  std::size_t objects = 10'000;          ///< ignored for a recording
  std::uint64_t seed = 1;
};

/// Returns "scene", and the names of rotated objects: "cubes", "rods", "slow".
[[nodiscard]] std::span<const std::string_view> volume_setting_names() noexcept;

/// Returns the partitions that take volumes from the caller.
[[nodiscard]] std::span<const std::string_view> volume_partitions() noexcept;

/// Makes one of the settings. Objects of a recording move as recorded; `step` is then their mean
/// movement. Throws ArgumentError for an unknown scene.
[[nodiscard]] VolumeSetting make_volume_setting(std::string_view name,
                                                const VolumeSettingOptions& options);

/// Returns a number of timed frames that gives stable medians in one or two seconds.
[[nodiscard]] std::size_t volume_frames(std::size_t objects) noexcept;

}  // namespace winnow::bench
