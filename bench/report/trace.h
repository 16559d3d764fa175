#pragma once

#include "bench/common/json.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// What came of holding a page against the document that it should have been made from.
struct Trace {
  std::size_t cells = 0;           ///< of tables that say of which row they are
  std::size_t points = 0;          ///< of plots
  std::size_t derived = 0;         ///< values of rows that were computed from other rows
  std::vector<std::string> wrong;  ///< what is not what the rows say, a sentence each
};

/// Holds what a report's page shows, by nothing but the attributes of its table cells (data-row,
/// data-value) and the data of its plots, against the rows of results.json: every cell must show
/// the value that it names, or a key; x and y of every point must be those of its row; and every
/// value that says that it was derived must follow by its rule from the rows it names.
[[nodiscard]] Trace trace_page(const std::string& html, const Json& document);

/// What stands between the two from `at` on, which goes behind it; `at` is npos if there is no
/// more.
[[nodiscard]] std::string_view between(std::string_view text, std::string_view open,
                                       std::string_view close, std::size_t& at);

}  // namespace winnow::bench
