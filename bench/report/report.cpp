// Runs the steps of a report and writes its files again and again, so that an interrupted run
// leaves a valid report of what has been measured. plan.cpp lists the steps.

#include "bench/report/report.h"

#include "bench/common/errors.h"
#include "bench/common/other_work.h"
#include "bench/common/progress.h"
#include "bench/common/table.h"
#include "bench/contenders/reference_sweep.h"
#include "bench/pages/page.h"
#include "bench/rows/machine.h"

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <exception>
#include <filesystem>
#include <string_view>
#include <system_error>

namespace winnow::bench {
namespace {

constexpr double kMsBetweenWrites = 5000.0;
constexpr double kQuickMsBetweenWrites = 500.0;

/// Replaces a file as a whole: `write` gets the path of a new file, which is renamed at the end.
template <typename Write>
void replace_file(const std::filesystem::path& path, Write write) {
  const std::filesystem::path fresh = path.string() + ".new";
  try {
    write(fresh.string());
    std::filesystem::rename(fresh, path);
  } catch (const std::exception& fault) {
    std::error_code failed;
    std::filesystem::remove(fresh, failed);
    throw ArgumentError(fault.what());
  }
}

std::sig_atomic_t volatile g_stop_requested = 0;

/// The first signal stops the report after the current step; a second one ends the process.
void stop_after_step(int signal) {
  g_stop_requested = 1;
  std::signal(signal, SIG_DFL);
  constexpr std::string_view kWord =
      "\nwinnow: stopping after the step that runs; once more stops at once\n";
  if (::write(STDERR_FILENO, kWord.data(), kWord.size()) < 0) return;
}

/// Adds a warning if other processes used the machine or its speed changed during the run.
void note_disturbances(const OtherWork& others, Json& context) {
  constexpr double kBusy = 0.1;
  constexpr double kOtherSpeed = 1.2;
  Json& warnings = context["warnings"];
  if (const double cores = others.cores().value_or(0.0); cores > kBusy) {
    warnings.push_back("The machine was busy: other processes kept " + short_number(cores) +
                       " cores at work on average while this was measured. Times are too long; "
                       "ratios of contenders that took turns are less affected.");
  }
  const double before = context["reference_sweep_ms"];
  const double after = reference_sweep_ms();
  if (std::max(before, after) > kOtherSpeed * std::min(before, after)) {
    warnings.push_back(
        "The machine's speed changed while this was measured: the reference sweep took " +
        short_number(before) + " ms at the beginning and " + short_number(after) +
        " at the end. Compare values within one table, not between tables.");
  }
}

}  // namespace

void write_report(const std::string& folder, Json document) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  const std::filesystem::path place(folder);
  const auto write_rows = [&](const std::string& path) {
    write_text(path, document_text(document));
  };
  // The most important file is written first, in case the disk is full.
  replace_file(place / "results.json", write_rows);
  try {
    replace_file(place / "index.html",
                 [&](const std::string& path) { write_page(path, kResultsPage, document); });
  } catch (const ArgumentError& error) {
    document["context"]["missing"].push_back(std::string("There is no page: ") + error.what());
    replace_file(place / "results.json", write_rows);
  }
}

bool make_report(const std::string& folder, const ReportOptions& options, const ReportSteps& steps,
                 Results& results) {
  const OtherWork others;
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, stop_after_step);
  Progress progress(steps.size());
  Json& context = results.context();
  context["steps"] = steps.size();
  context["steps_done"] = 0;
  context["complete"] = false;
  write_report(folder, results.document());
  Stopwatch since_written;
  std::size_t done = 0;
  for (const ReportStep& step : steps) {
    if (g_stop_requested != 0) break;
    progress.step(step.section + ": " + step.what);
    try {
      step.run(results);
    } catch (const std::exception& error) {
      context["problems"].push_back(step.section + ", " + step.what + ": " + error.what());
    }
    context["steps_done"] = ++done;
    if (since_written.ms() < (options.quick ? kQuickMsBetweenWrites : kMsBetweenWrites)) continue;
    write_report(folder, results.document());
    since_written = Stopwatch();
  }
  context["complete"] = done == steps.size();
  note_disturbances(others, context);
  write_report(folder, results.document());
  return done == steps.size();
}

}  // namespace winnow::bench
