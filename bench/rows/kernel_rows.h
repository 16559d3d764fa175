#pragma once

#include "bench/rows/results.h"

#include <cstddef>
#include <string>

namespace winnow::bench {

/// Adds the kernels whose names contain the text, on every instruction set.
void add_kernels(Results& results, std::size_t rounds, const std::string& text = "");

}  // namespace winnow::bench
