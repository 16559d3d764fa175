#pragma once

#include "bench/scenes/frame_source.h"

#include <cstddef>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// Milliseconds of frames, by the host that runs the tasks. A frame updates the boxes that moved
/// and finds all pairs.
struct HostRace {
  std::vector<double> arena_ms{};  ///< oneTBB
  std::vector<double> pool_ms{};   ///< a simple thread pool, see ThreadPool
};

/// Races two partitions of one kind on frames of a scene, with `threads` threads each. The first
/// frames, which build, are not counted. Throws std::runtime_error if the pairs differ.
[[nodiscard]] HostRace race_hosts(FrameSource& source, std::string_view partition, int threads,
                                  std::size_t frames);

}  // namespace winnow::bench
