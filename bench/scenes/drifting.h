#pragma once

#include "bench/scenes/frame_source.h"

#include <cstddef>
#include <cstdint>
#include <memory>

namespace winnow::bench {

// Scenes whose bodies move in straight lines (in make_brownian: by random steps) and are reflected
// at the walls.

std::unique_ptr<FrameSource> make_uniform(std::size_t objects, std::uint64_t seed);
std::unique_ptr<FrameSource> make_sleepy(std::size_t objects, std::uint64_t seed);
std::unique_ptr<FrameSource> make_mixed(std::size_t objects, std::uint64_t seed);
std::unique_ptr<FrameSource> make_mixed_1000(std::size_t objects, std::uint64_t seed);
std::unique_ptr<FrameSource> make_clustered(std::size_t objects, std::uint64_t seed);
std::unique_ptr<FrameSource> make_wall(std::size_t objects, std::uint64_t seed);
std::unique_ptr<FrameSource> make_brownian(std::size_t objects, std::uint64_t seed);

}  // namespace winnow::bench
