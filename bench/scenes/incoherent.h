#pragma once

#include "bench/scenes/frame_source.h"

#include <cstddef>
#include <cstdint>
#include <memory>

namespace winnow::bench {

// Scenes with little or no temporal coherence.

std::unique_ptr<FrameSource> make_teleport(std::size_t objects, std::uint64_t seed);
std::unique_ptr<FrameSource> make_teleport_mixed(std::size_t objects, std::uint64_t seed);
std::unique_ptr<FrameSource> make_respawn(std::size_t objects, std::uint64_t seed);
std::unique_ptr<FrameSource> make_shear(std::size_t objects, std::uint64_t seed);
std::unique_ptr<FrameSource> make_jumps(std::size_t objects, std::uint64_t seed);

}  // namespace winnow::bench
