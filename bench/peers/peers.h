#pragma once

#include "peers/engine.h"

#include <memory>
#include <vector>

namespace winnow::bench {

/// One engine per other library found when this was built, in the order in which reports list
/// them, each with its best settings for at most `threads` threads.
[[nodiscard]] std::vector<std::unique_ptr<Engine>> make_peers(int threads);

}  // namespace winnow::bench
