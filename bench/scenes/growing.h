#pragma once

#include "bench/scenes/frame_source.h"

#include <cstddef>
#include <cstdint>
#include <memory>

namespace winnow::bench {

/// Begins with a thousandth of the objects, and grows by the same factor in each frame until all
/// are there.
std::unique_ptr<FrameSource> make_growth(std::size_t objects, std::uint64_t seed);

}  // namespace winnow::bench
