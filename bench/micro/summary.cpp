#include "bench/micro/summary.h"

#include "bench/common/sample.h"

#include <cstdio>
#include <utility>

namespace winnow::bench {
namespace {

/// "kernel/isa" -> ("kernel", "isa").
std::pair<std::string, std::string> split(const std::string& name) {
  const std::size_t at = name.rfind('/');
  if (at == std::string::npos) return {name, ""};
  return {name.substr(0, at), name.substr(at + 1)};
}

}  // namespace

bool SummaryReporter::ReportContext(const Context& context) {
  PrintBasicContext(&GetErrorStream(), context);
  return true;
}

void SummaryReporter::ReportRuns(const std::vector<Run>& runs) {
  for (const Run& run : runs) {
    const std::string& name = run.run_name.function_name;
    if (run.error_occurred) {
      errors_.push_back(name + ": " + run.error_message);
      continue;
    }
    if (run.run_type != Run::RT_Iteration || run.iterations == 0) continue;
    Row& row = rows_[{run.family_index, name}];
    row.nanoseconds.push_back(run.real_accumulated_time / static_cast<double>(run.iterations) *
                              1e9);
    const auto items = run.counters.find("items_per_second");
    if (items != run.counters.end()) row.items_per_second.push_back(items->second.value);
  }
}

void SummaryReporter::print_row(const std::string& isa, const Row& row, double baseline_ns) const {
  const double ns = median_of(row.nanoseconds);
  std::printf("  %-10s %12.3f us %12.1f M items/s %8.2f x\n", isa.c_str(), ns / 1e3,
              median_of(row.items_per_second) / 1e6, ns > 0.0 ? baseline_ns / ns : 0.0);
}

void SummaryReporter::Finalize() {
  std::string kernel;
  double baseline_ns = 0.0;
  for (const auto& [key, row] : rows_) {
    const auto [name, isa] = split(key.second);
    if (name != kernel) {
      kernel = name;
      baseline_ns = median_of(row.nanoseconds);
      std::printf("%s\n", kernel.c_str());
    }
    print_row(isa, row, baseline_ns);
  }
  if (!rows_.empty()) std::printf("x: times the speed of the first row of the same benchmark\n");
  for (const std::string& error : errors_) std::printf("failed: %s\n", error.c_str());
}

}  // namespace winnow::bench
