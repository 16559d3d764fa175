#pragma once

#include "bench/rows/results.h"

#include <string>

namespace winnow::bench {

/// Returns bench/RESULTS.md: the parts that the layout shows in the target "results".
[[nodiscard]] std::string results_markdown(const Results& results);

/// Replaces the text between "<!-- figures -->" and "<!-- end -->" by the layout's "readme".
/// Returns the text unchanged if it has no such markers. Throws ArgumentError if the end marker is
/// missing or the results have no frames to show.
[[nodiscard]] std::string with_figures(const std::string& text, const Results& results);

/// Prints the tables that the layout shows in the target "terminal", then missing measurements,
/// warnings and problems.
void print_summary(const Results& results);

}  // namespace winnow::bench
