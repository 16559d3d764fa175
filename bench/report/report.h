#pragma once

#include "bench/report/section.h"

#include <string>
#include <vector>

namespace winnow::bench {

/// Writes results.json, index.html and a CSV for each table into a folder, which it makes. Each
/// file is complete at any time: it is replaced as a whole. Without Chart.js there is no page, and
/// the document says so. Throws ArgumentError if a file cannot be written.
void write_report(const std::string& folder, Results& results);

/// Measures section by section and writes the report again and again, so that whatever ends the
/// process leaves what was measured. SIGINT and SIGTERM end it after the step that runs. True if
/// everything was measured.
bool make_report(const std::string& folder, const ReportOptions& options,
                 const std::vector<const ReportSection*>& sections, Results& results);

}  // namespace winnow::bench
