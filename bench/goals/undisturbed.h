#pragma once

#include "bench/measure/race.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace winnow::bench {

/// Races partitions on the same frames a few times over and keeps each frame's least time: sums of
/// few frames, and the worst of many, say nothing if one of them was disturbed.
[[nodiscard]] std::vector<Run> undisturbed(
    const std::function<std::unique_ptr<FrameSource>()>& make_source,
    const std::vector<std::string>& partitions, std::size_t frames, int threads);

}  // namespace winnow::bench
