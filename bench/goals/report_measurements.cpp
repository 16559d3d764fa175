// Measurements for goals about `winnow report`: runs it in another process, to its end or killed
// half-way, and checks the page and the rows. goals/measurements.cpp lists them.

#include "bench/common/errors.h"
#include "bench/common/sample.h"
#include "bench/common/table.h"
#include "bench/goals/measurements.h"
#include "bench/report/trace.h"
#include "bench/rows/own_process.h"
#include "bench/rows/results.h"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <thread>

namespace winnow::bench {
namespace {

/// A report that this tool makes in another process.
class ReportProcess {
 public:
  explicit ReportProcess(const std::vector<std::string>& options)
      : process_(with_folder(options, folder_.path()), true) {}

  [[nodiscard]] OwnProcess& process() noexcept { return process_; }
  /// Returns the text of the page; empty if there is none.
  [[nodiscard]] std::string page() const {
    std::ifstream file(folder_.path() / "index.html", std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  /// Throws ArgumentError if there is none, or it cannot be read.
  [[nodiscard]] Results results() const {
    return read_results((folder_.path() / "results.json").string());
  }
  [[nodiscard]] std::size_t rows() const {
    std::size_t count = 0;
    try {
      const Results all = results();
      for (const Json& table : all.document()["tables"]) count += table["rows"].size();
    } catch (const ArgumentError&) {
      return 0;
    }
    return count;
  }

 private:
  static std::vector<std::string> with_folder(std::vector<std::string> options,
                                              const std::filesystem::path& folder) {
    options.insert(options.begin(), {"report", "--out", folder.string()});
    return options;
  }

  TemporaryFolder folder_;
  OwnProcess process_;
};

void declare_process(Results& results) {
  results.declare(
      {"report_process",
       "report",
       "a report that was made in another process",
       {"what"},
       {{"value", "value", ""}, {"detail", "detail", "", Better::neither, Format::text}}});
}

void add_of_process(Results& results, const std::string& what, double value,
                    const std::string& detail) {
  results.add("report_process", {{"what", what}, {"value", value}, {"detail", detail}});
}

/// Counts the figures of the page that differ from their rows.
void add_trace(Results& results, const ReportProcess& report) {
  const std::string page = report.page();
  if (page.empty()) throw std::runtime_error("there is no page (Chart.js?)");
  const Trace trace = trace_page(page, report.results().document());
  if (trace.cells == 0 || trace.points == 0) throw std::runtime_error("the page shows nothing");
  std::string detail = grouped(trace.cells) + " cells, " + grouped(trace.points) + " points, " +
                       grouped(trace.derived) + " derived rows";
  if (!trace.wrong.empty()) detail = trace.wrong.front() + "; " + detail;
  add_of_process(results, "wrong figures", static_cast<double>(trace.wrong.size()), detail);
}

/// Counts problems and steps that were not measured.
void add_faults(Results& results, const ReportProcess& report) {
  if (report.rows() == 0) throw std::runtime_error("the report has no rows");
  const Results made = report.results();
  auto faults = static_cast<double>(made.document()["problems"].size());
  for (const Json& section : made.document()["sections"]) {
    faults += section["steps"].get<double>() - section["done"].get<double>();
  }
  add_of_process(results, "faults", faults, grouped(report.rows()) + " rows");
}

void require_done(int status) {
  if (status != 0) throw std::runtime_error("the report ended with " + std::to_string(status));
}

}  // namespace

void measure_default_report(const Json& /*options*/, MeasurementCache& /*measurement_cache*/,
                            Measured& measured) {
  declare_process(measured.results);
  const Stopwatch clock;
  ReportProcess report({});
  require_done(report.process().wait());
  add_of_process(measured.results, "seconds", clock.ms() / 1000.0, "");
  add_faults(measured.results, report);
  add_trace(measured.results, report);
}

void measure_lone_report(const Json& /*options*/, MeasurementCache& /*measurement_cache*/,
                         Measured& measured) {
  declare_process(measured.results);
  ReportProcess report({"--quick", "--no-peers"});
  require_done(report.process().wait());
  add_faults(measured.results, report);
  const Json missing = report.results().document()["missing"];
  add_of_process(measured.results, "notes", static_cast<double>(missing.size()),
                 missing.empty() ? "" : missing[0].get<std::string>());
}

void measure_killed_report(const Json& /*options*/, MeasurementCache& /*measurement_cache*/,
                           Measured& measured) {
  declare_process(measured.results);
  ReportProcess report({"--quick", "--no-peers"});
  while (report.process().runs() && report.rows() == 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  const bool half_way = report.process().runs();
  report.process().kill();
  const std::size_t rows = report.rows();
  const std::string page = report.page();
  const bool whole = rows > 0 && report.results().document()["complete"].get<bool>();
  const Trace trace =
      rows > 0 && !page.empty() ? trace_page(page, report.results().document()) : Trace{};
  const std::pair<bool, const char*> expected[] = {
      {half_way, "it had ended before"},
      {rows > 0, "no rows are left"},
      {!whole, "it is marked as complete"},
      {page.find("This report is not complete") != std::string::npos,
       "its page lacks the note that it is not complete"},
      {trace.points > 0 && trace.wrong.empty(), "its page does not match its rows"}};
  std::string faults;
  double count = 0.0;
  for (const auto& [holds, fault] : expected) {
    if (holds) continue;
    faults += (count > 0.0 ? "; " : "") + std::string(fault);
    ++count;
  }
  add_of_process(measured.results, "faults", count,
                 faults.empty() ? grouped(rows) + " rows were left" : faults);
}

}  // namespace winnow::bench
