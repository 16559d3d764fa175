#pragma once

#include "bench/measure/race.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace winnow::bench {

/// Races partitions several times on the same frames and keeps each frame's minimum. Sums of few
/// frames, and the worst of many, are useless if one of them was disturbed.
[[nodiscard]] std::vector<Run> race_minima(
    const std::function<std::unique_ptr<FrameSource>()>& make_source,
    const std::vector<std::string>& partitions, std::size_t frames, int threads);

}  // namespace winnow::bench
