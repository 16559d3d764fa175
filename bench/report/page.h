#pragma once

#include "bench/report/layout.h"

#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// HTML of parts, and the plots that have a place in it.
struct PageParts {
  std::string html{};
  std::vector<Plot> plots{};
};

/// A section of the layout, empty if there is nothing to show.
[[nodiscard]] PageParts section_parts(const Results& results, const Json& section);

/// Facts about a run as a table.
[[nodiscard]] std::string facts_table(const std::string& head, const Json& facts);

/// The section of the layout of this id. Throws std::out_of_range if there is none.
[[nodiscard]] const Json& section_of(std::string_view id);

/// The whole page: the recommendation, a line of what was measured where and what is missing, and
/// every section, folded but for the first. Plots are drawn when their section is opened; "#all"
/// behind the address opens all of them. Throws ArgumentError if it cannot be written.
void write_report_page(const std::string& path, const Results& results);

}  // namespace winnow::bench
