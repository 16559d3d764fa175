#pragma once

#include "bench/goals/measurement_cache.h"

#include <string>
#include <vector>

namespace winnow::bench {

/// One goal: a bound, and the value measured now.
struct Goal {
  std::string topic{};
  std::string what{};
  std::string unit{};
  bool at_least = false;
  double bound = 0.0;
  double measured = 0.0;
  std::string detail{};  ///< the rows from which the value was computed

  [[nodiscard]] bool holds() const noexcept {
    return at_least ? measured >= bound : measured <= bound;
  }
};

/// Evaluates a parsed entry, which is a predicate over the rows of tables:
///
///   "measure": {NAME: options}, or a list of these: the measurements that make the rows, see
///     measurements.h
///   "value": FIGURE, "over": FIGURE: the measured value, and its divisor if there is one
///   "at_most" or "at_least": FIGURE: the bound
///   "by": [keys]: one goal for each combination of these keys among the rows of the value
///   "worst_by": [keys]: the value is the worst one among the combinations of these keys
///   "median_by": [keys]: the value is the median of the combinations of these keys
///   "optional": true: no goal if a figure has no row
///
/// A FIGURE is a number, or one of these objects:
///
///   {RULE: value, "of": table, "where": {members}}: applies RULE to the value in the rows of the
///     table that have these members. RULE is "least", "most", "sum", "exponent" (of growth with
///     "objects") or "the" (there must be only one row). A member given as a list matches any of
///     its elements, "@isa" matches the active instruction set, and "peer": true selects rows of
///     other libraries. "else_existing": number is used as "existing" if there are no such rows.
///   {"existing": number}: a time of another library on the reference machine, multiplied by how
///     much slower the reference sweep was during this measurement
///   {"least_of": [FIGURE, ...]}: the least of the figures that have rows
///
/// An object may have "divided_by": number. A goal without a value fails. There are no goals if
/// this machine lacks what is measured. Throws std::runtime_error if an entry is malformed.
[[nodiscard]] std::vector<Goal> evaluate(const Json& entry, MeasurementCache& measurement_cache);

}  // namespace winnow::bench
