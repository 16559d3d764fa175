#pragma once

#include "bench/measure/race.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace winnow::bench {

/// Races partitions several times on the same frames and keeps each frame's minimum. Other work on
/// the machine may disturb a frame in one of these races, but seldom the same frame in all. A
/// single disturbed frame would falsify a sum of few frames, or the worst of many.
[[nodiscard]] std::vector<Run> race_minima(
    const std::function<std::unique_ptr<FrameSource>()>& make_source,
    const std::vector<std::string>& partitions, std::size_t frames, int threads);

}  // namespace winnow::bench
