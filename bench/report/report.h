#pragma once

#include "bench/report/plan.h"

#include <string>

namespace winnow::bench {

/// Writes results.json and index.html into a folder, which it creates. Each file is replaced as a
/// whole, so that it is complete at any time. Without Chart.js no page is written and the context
/// notes that. Throws ArgumentError if a file cannot be written.
void write_report(const std::string& folder, Json document);

/// Runs the steps and rewrites the report every few seconds, so that an interrupted run keeps its
/// measurements. SIGINT and SIGTERM end it after the current step. Returns true if everything was
/// measured.
bool make_report(const std::string& folder, const ReportOptions& options, const ReportSteps& steps,
                 Results& results);

}  // namespace winnow::bench
