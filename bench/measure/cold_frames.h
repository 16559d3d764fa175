#pragma once

#include <winnow/core/aabb.h>

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// Where a partition gets its memory: from ordinary pages that nobody has written to; from those
/// that its frame before has; or, as by default, from large pages that nobody has written to.
inline constexpr std::string_view kUntouched = "untouched";
inline constexpr std::string_view kTouched = "touched";
inline constexpr std::string_view kLargePages = "large pages";

/// Milliseconds of the parts of first frames, one entry per frame.
struct ColdFrames {
  std::string partition{};
  std::string_view memory{};
  std::vector<double> insert_ms{};
  std::vector<double> build_ms{};
  std::vector<double> pairs_ms{};
  std::vector<double> total_ms{};
  // Not on touched pages: a frame for which all memory was reserved, one for which it was touched
  // as well, and what the latter took before the frame.
  std::vector<double> reserved_ms{};
  std::vector<double> ready_ms{};
  std::vector<double> reserve_ms{};
  // What it takes to write to as many ordinary pages as the partition and its pairs hold.
  std::vector<double> pages_ms{};
};

struct ColdRace {
  std::vector<ColdFrames> frames;    ///< of each partition, in each of the memories
  std::vector<double> yardstick_ms;  ///< of frames of the same boxes; none without it
};

/// First frames of so many fresh partitions of these boxes: all boxes are inserted, the structure
/// is built and all pairs are found. Reserved is room for them and for as many pairs as they have.
/// All take turns, and frames of the yardstick, which always starts anew, among them if it is
/// wanted. Throws std::runtime_error if not all find the same pairs.
[[nodiscard]] ColdRace race_cold_frames(std::span<const Aabb> boxes,
                                        const std::vector<std::string>& partitions, int threads,
                                        std::size_t rounds = 7, bool yardstick = true);

}  // namespace winnow::bench
