#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace winnow::bench {

/// What came of holding a page against the document that it should have been made from.
struct Trace {
  std::size_t cells = 0;           ///< looked at
  std::size_t points = 0;          ///< of plots
  std::size_t derived = 0;         ///< values of rows that were computed from other rows
  std::vector<std::string> wrong;  ///< what is not what the rows say, a sentence each
};

/// Derives anew what a report's page shows, by nothing but the attributes of its table cells
/// (data-row, data-value), the data of its plots, and the rows of results.json: it shares no code
/// with what writes the page. Every number in a table must be that of its row to within its last
/// digit, or a key of that row; x and y of every point those of its row; and every row that says
/// that it was derived must follow by its rule from the rows it names. `picked`: only so many cells
/// and points, picked at random; 0: all.
[[nodiscard]] Trace trace_page(const std::string& html, const nlohmann::json& document,
                               std::size_t picked = 0, std::uint64_t seed = 1);

}  // namespace winnow::bench
