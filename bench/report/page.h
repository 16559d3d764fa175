#pragma once

#include "bench/report/layout.h"

#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// HTML of parts, and the plots that it contains placeholders for.
struct PageParts {
  std::string html{};
  std::vector<Plot> plots{};
};

/// Returns a section of the layout, empty if there is nothing to show.
[[nodiscard]] PageParts section_parts(const Results& results, const Json& section);

/// Returns facts about a run as a table.
[[nodiscard]] std::string facts_table(const std::string& head, const Json& facts);

/// Returns the layout's section of this id. Throws std::out_of_range if there is none.
[[nodiscard]] const Json& section_of(std::string_view id);

/// Writes the whole page: the recommendation, a line about the run and what is missing, and every
/// section, all folded but the first. A plot is drawn when its section is opened; the address
/// suffix "#all" opens all sections. Throws ArgumentError if the file cannot be written.
void write_report_page(const std::string& path, const Results& results);

}  // namespace winnow::bench
