#pragma once

#include "bench/scenes/frame_source.h"

#include <cstddef>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// Milliseconds of frames, by who runs the tasks: what moved is brought in, and all pairs are
/// found.
struct HostRace {
  std::vector<double> arena_ms{};  ///< oneTBB
  std::vector<double> pool_ms{};   ///< a plain pool of threads, see ThreadPool
};

/// Plays frames of a scene to two partitions of one kind on so many threads each, in turns, which
/// one is first changing with every frame; the first frames, which build, do not count. Throws
/// std::runtime_error if they report different pairs, or the same in another order.
[[nodiscard]] HostRace race_hosts(FrameSource& source, std::string_view partition, int threads,
                                  std::size_t frames);

}  // namespace winnow::bench
