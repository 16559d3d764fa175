#pragma once

#include "report/page.h"
#include "report/results.h"
#include "tool/measure_accuracy.h"

#include <string>
#include <vector>

namespace winnow::bench {

// Errors of answers about pairs, as rows of the sections that have some.

/// Logarithmic axes have no 0: plots show errors that are smaller than this as this.
inline constexpr double kLeastErrorShown = 1e-17;

/// The columns of to_json(Accuracy), of the judge, and of what is drawn.
[[nodiscard]] std::vector<ValueColumn> accuracy_columns();
/// Those of them that rows of curves have, of which there are many.
[[nodiscard]] std::vector<ValueColumn> accuracy_curve_columns();

/// Adds a row of the keys, the figures that the table has columns for, and how to measure them
/// again.
void add_accuracy_row(Results& results, const std::string& table, Json row,
                      const Accuracy& accuracy, const AccuracyOptions& options);

/// A command, by which other libraries are installed first.
[[nodiscard]] std::string with_peers(const std::string& command);

/// The command of the first row that has these members, if there is one.
void show_command(ReportPage& page, const std::string& table, const Json& where);

/// "1e-06".
[[nodiscard]] std::string power_text(double value);

}  // namespace winnow::bench
