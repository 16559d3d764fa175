#pragma once

#include "bench/report/section.h"

#include <string>
#include <vector>

namespace winnow::bench {

/// Writes results.json, index.html and a CSV for each table into a folder, which it creates. Each
/// file is replaced as a whole, so that it is complete at any time. Without Chart.js no page is
/// written and the document notes that. Throws ArgumentError if a file cannot be written.
void write_report(const std::string& folder, Results& results);

/// Measures section by section and rewrites the report every few seconds, so that an interrupted
/// run keeps its measurements. SIGINT and SIGTERM end it after the current step. Returns true if
/// everything was measured.
bool make_report(const std::string& folder, const ReportOptions& options,
                 const std::vector<const ReportSection*>& sections, Results& results);

}  // namespace winnow::bench
