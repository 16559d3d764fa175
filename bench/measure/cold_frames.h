#pragma once

#include <winnow/core/volumes.h>

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// Memory of a partition: ordinary pages not written before; ordinary pages that the previous frame
/// has written; large pages not written before, which are the default of the library.
inline constexpr std::string_view kUntouched = "untouched";
inline constexpr std::string_view kTouched = "touched";
inline constexpr std::string_view kLargePages = "large pages";

/// Milliseconds of first frames, one entry per frame.
struct ColdFrames {
  std::string partition{};
  std::string_view memory{};
  /// By name: the parts insert_ms, build_ms and pairs_ms, and their sum total_ms; pages_ms, the
  /// time of the first write to as many ordinary pages as the partition and its pairs occupy.
  /// Except for `kTouched` also total times of frames whose memory was reserved before
  /// (reserved_ms), or reserved and written to (ready_ms), which took reserve_ms.
  std::map<std::string, std::vector<double>> times{};
};

struct ColdRace {
  std::vector<ColdFrames> frames;    ///< each partition in each kind of memory
  std::vector<double> yardstick_ms;  ///< frames of the same boxes; empty without the yardstick
};

/// Times first frames of new partitions, `rounds` per partition and kind of memory: all boxes are
/// inserted, the structure is built and all pairs are found. Reserved frames have room for these
/// boxes and pairs. The partitions take turns. If `yardstick` is set, one yardstick repeats its
/// first frame, which allocates nothing after the first round. Throws std::runtime_error if the
/// pairs differ.
[[nodiscard]] ColdRace race_cold_frames(std::span<const Aabb> boxes,
                                        const std::vector<std::string>& partitions, int threads,
                                        std::size_t rounds = 7, bool yardstick = true);

}  // namespace winnow::bench
