#pragma once

#include "bench/goals/lab.h"

#include <string>
#include <vector>

namespace winnow::bench {

/// One line of the answer: what is asked, and what it measures now.
struct Goal {
  std::string topic{};
  std::string what{};
  std::string unit{};
  bool at_least = false;
  double asked = 0.0;
  double measured = 0.0;
  std::string detail{};  ///< which rows it is made of

  [[nodiscard]] bool holds() const noexcept {
    return at_least ? measured >= asked : measured <= asked;
  }
};

/// An ask is a predicate over rows:
///
///   "measure": {NAME: options} or a list of such, see measurements.h: who makes the rows
///   "value": FIGURE, "over": FIGURE: what is measured, and what it is divided by
///   "at_most" or "at_least": FIGURE: the bound
///   "by": [keys]: a goal for each combination of keys among the rows of the value
///   "worst_by": [keys]: of these the worst counts
///   "median_by": [keys]: of these the median
///   "optional": true: no goal where a figure has no row
///
/// A FIGURE is a number, or an object:
///
///   {"least" | "most" | "sum" | "exponent" | "the": value, "of": table, "where": {members}}, of
///   the rows with
///     these members (of a list any; "peer": whether they are another library's; "@isa": the active
///     instruction set; the exponent is that of growth with "objects"); "else_existing": number, if
///     there are none
///   {"existing": number}: a time of another library, elsewhere, scaled by how much slower the
///     reference sweep was while the rows were measured
///   {"least_of": [FIGURE, ...]}: the least of those that there are
///
/// each with "divided_by": number. What cannot be answered does not hold; asks for what this
/// machine does not have make no goals. Throws std::runtime_error if an entry says nothing
/// sensible.
[[nodiscard]] std::vector<Goal> evaluate(const Json& ask, Lab& lab);

}  // namespace winnow::bench
