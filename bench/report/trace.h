#pragma once

#include "bench/common/json.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// Result of checking a page against the document that it was made from.
struct Trace {
  std::size_t cells = 0;           ///< checked cells of tables that name their row
  std::size_t points = 0;          ///< checked points of plots
  std::size_t derived = 0;         ///< values that were computed from other rows
  std::vector<std::string> wrong;  ///< one sentence for each difference
};

/// Checks a report's page against the rows of results.json. Uses only the attributes of table cells
/// (data-row, data-value) and the data of plots: every cell must show the value that it names, or a
/// key; x and y of every point must equal its row's; and every derived value must follow by its
/// rule from the rows that it names.
[[nodiscard]] Trace trace_page(const std::string& html, const Json& document);

/// Returns the text between `open` and `close` from `at` on, and moves `at` behind it; `at` becomes
/// npos if there is no further match.
[[nodiscard]] std::string_view between(std::string_view text, std::string_view open,
                                       std::string_view close, std::size_t& at);

}  // namespace winnow::bench
