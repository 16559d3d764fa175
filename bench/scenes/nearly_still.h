#pragma once

#include "bench/scenes/frame_source.h"

#include <cstddef>
#include <cstdint>
#include <memory>

namespace winnow::bench {

// Scenes in which almost nothing changes from frame to frame.

std::unique_ptr<FrameSource> make_few_movers(std::size_t objects, std::uint64_t seed);
std::unique_ptr<FrameSource> make_jitter(std::size_t objects, std::uint64_t seed);

}  // namespace winnow::bench
