#pragma once

#include "bench/scenes/frame_source.h"

#include <cstddef>
#include <cstdint>
#include <memory>

namespace winnow::bench {

/// Returns a scene that starts with a thousandth of the objects and grows by the same factor in
/// each frame until all are present.
std::unique_ptr<FrameSource> make_growth(std::size_t objects, std::uint64_t seed);

}  // namespace winnow::bench
