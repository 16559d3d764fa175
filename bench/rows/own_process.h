#pragma once

#include "bench/common/json.h"

#include <string>
#include <vector>

namespace winnow::bench {

/// Runs this tool once more with a subcommand and its options, in a process of its own, and gives
/// what it writes with --json. What it prints is dropped, but for errors. Throws std::runtime_error
/// if it cannot be run or wrote nothing, whatever its exit status.
[[nodiscard]] Json run_own(std::vector<std::string> arguments);

}  // namespace winnow::bench
