#pragma once

#include "bench/rows/results.h"

#include <string>

namespace winnow::bench {

/// bench/RESULTS.md: the tables of a report that are worth reading, in Markdown.
[[nodiscard]] std::string results_markdown(const Results& results);

/// A text with the times of every partition and library on every scene, at the largest size,
/// between
/// "<!-- figures -->" and "<!-- end -->"; as it is if it has no such place. Throws ArgumentError if
/// the place has no end.
[[nodiscard]] std::string with_figures(const std::string& text, const Results& results);

}  // namespace winnow::bench
