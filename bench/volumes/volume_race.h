#pragma once

#include "engine/sample.h"
#include "volumes/solids.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {

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

/// The row with the least sum.
[[nodiscard]] const VolumeRow& best_of(const std::vector<VolumeRow>& rows);

}  // namespace winnow::bench
