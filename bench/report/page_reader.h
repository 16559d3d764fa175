#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// A cell of a table on a report's page: its text, and the row and value that it says it shows.
struct TracedCell {
  std::string row;
  std::string value;
  std::string text;
};
using TracedRow = std::vector<TracedCell>;

/// Of all tables of a page but those of facts about the machine.
[[nodiscard]] std::vector<TracedRow> table_rows(std::string_view html);

/// The data of all plots of a page; empty if it has none.
[[nodiscard]] nlohmann::json plots_of(std::string_view html);

/// A figure as a text shows it.
struct ShownFigure {
  double value = 0.0;
  double half_digit = 0.0;  ///< half of its last digit
  std::string unit;         ///< what stands behind it
};

/// Reads 1,234  0.0571  12.5 %  -3.1e-16; false if the text does not begin with a number.
[[nodiscard]] bool read_figure(std::string text, ShownFigure& figure);

/// What stands between the two from `at` on, which goes behind it; `at` is npos if there is no
/// more.
[[nodiscard]] std::string_view between(std::string_view text, std::string_view open,
                                       std::string_view close, std::size_t& at);

}  // namespace winnow::bench
