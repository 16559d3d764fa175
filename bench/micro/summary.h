#pragma once

#include <benchmark/benchmark.h>

#include <map>
#include <string>
#include <vector>

namespace winnow::bench {

/// Prints, when all is done, a row per benchmark and instruction set: median time of the
/// repetitions, items per second, and how many times the speed of the first instruction set of the
/// same benchmark that is.
class SummaryReporter final : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context& context) override;
  void ReportRuns(const std::vector<Run>& runs) override;
  void Finalize() override;

 private:
  struct Row {
    std::vector<double> nanoseconds;
    std::vector<double> items_per_second;
  };
  void print_row(const std::string& isa, const Row& row, double baseline_ns) const;

  // Rows run in random order; they are printed in the order of registration.
  std::map<std::pair<std::int64_t, std::string>, Row> rows_;
  std::vector<std::string> errors_;
};

}  // namespace winnow::bench
