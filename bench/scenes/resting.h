#pragma once

#include "bench/scenes/frame_source.h"

#include <cstddef>
#include <cstdint>
#include <memory>

namespace winnow::bench {

// Scenes whose bodies rest on each other or come to rest.

std::unique_ptr<FrameSource> make_pile(std::size_t objects, std::uint64_t seed);
std::unique_ptr<FrameSource> make_free_fall(std::size_t objects, std::uint64_t seed);
std::unique_ptr<FrameSource> make_gravity(std::size_t objects, std::uint64_t seed);

}  // namespace winnow::bench
