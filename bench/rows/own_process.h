#pragma once

#include "bench/common/json.h"

#include <string>
#include <vector>

namespace winnow::bench {

/// Runs this tool in a second process with a subcommand, its options and --json, and returns what
/// it wrote, whatever its exit status. Its standard output is dropped, and an interrupt from the
/// terminal does not reach it. Throws std::runtime_error if it cannot start or wrote nothing.
[[nodiscard]] Json run_own(std::vector<std::string> arguments);

}  // namespace winnow::bench
