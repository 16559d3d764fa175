#pragma once

#include "bench/rows/results.h"

#include <string>

namespace winnow::bench {

/// bench/RESULTS.md: what the layout shows of a report in results, in Markdown.
[[nodiscard]] std::string results_markdown(const Results& results);

/// A text with the layout's "readme" between "<!-- figures -->" and "<!-- end -->"; as it is if it
/// has no such place. Throws ArgumentError if the place has no end, or there are no frames to show.
[[nodiscard]] std::string with_figures(const std::string& text, const Results& results);

/// What the layout shows of a report on a terminal, what is missing, and problems.
void print_summary(const Results& results);

}  // namespace winnow::bench
