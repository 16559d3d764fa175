// The command `winnow report`: runs the steps that report/plan.cpp lists and writes its files again
// and again, so that an interrupted run leaves a valid report of what has been measured.

#include "bench/report/report.h"
#include "bench/commands/command.h"
#include "bench/commands/options.h"
#include "bench/common/json.h"
#include "bench/common/other_work.h"
#include "bench/common/progress.h"
#include "bench/common/table.h"
#include "bench/contenders/reference_sweep.h"
#include "bench/pages/page.h"
#include "bench/rows/machine.h"
#include "bench/scenes/scene.h"

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <exception>
#include <filesystem>
#include <iostream>
#include <string_view>
#include <system_error>
#include <utility>

namespace winnow::bench {
namespace {

constexpr int kInterrupted = 130;  // exit status of shells after SIGINT

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

/// Writes results.json and index.html into a folder, which it creates. Each file is replaced as a
/// whole, so that it is complete at any time. Without Chart.js no page is written and the context
/// notes that. Throws ArgumentError if a file cannot be written.
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

/// Runs the steps and rewrites the report every few seconds, so that an interrupted run keeps its
/// measurements. SIGINT and SIGTERM end it after the current step. Returns true if everything was
/// measured.
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

struct ReportCommand {
  std::vector<std::string> scenes = main_scenes();
  std::vector<std::size_t> objects;
  std::vector<int> threads = usual_threads();
  std::uint64_t seed = 1;
  std::string isa;
  std::vector<std::string> section_ids;
  bool million = false;
  bool quick = false;
  bool no_peers = false;
  std::vector<std::string> from;
  std::string out = "winnow-report";

  void add_options(CLI::App& app);
  int run();

 private:
  [[nodiscard]] ReportOptions options() const;
  [[nodiscard]] Json merged() const;
  void note_settings(const ReportOptions& options, Results& results) const;
};

template <typename T>
void sort_once(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

void ReportCommand::add_options(CLI::App& app) {
  option(app, "--out", out, "Folder for index.html and results.json; created if missing");
  option(app, "--scene", scenes,
         "Scenes, or files of recordings (.aabbs or .winnow, also compressed as .xz)");
  add_objects_option(app, objects, "Numbers of objects");
  add_threads_option(app, threads, "Numbers of threads");
  add_seed_option(app, seed);
  add_isa_option(app, isa);
  one_of(app, "--section", section_ids, report_sections(),
         "Sections (default: all but goals, whose rows only bench/run goals needs)");
  app.add_flag("--million", million, "Also measure 1,000,000 objects");
  app.add_flag("--quick", quick,
               "Measure small scenes in seconds, with unreliable times: a preview");
  app.add_flag("--no-peers", no_peers, "Do not measure other libraries");
  option(
      app, "--from", from,
      "Measure nothing: write the report of the rows of these files (results.json, or results of "
      "Google Benchmark); the first one's context remains");
}

ReportOptions ReportCommand::options() const {
  ReportOptions options;
  options.scenes = named_scenes(scenes);
  options.objects = objects;
  if (options.objects.empty()) {
    options.objects = quick ? std::vector<std::size_t>{300, 1000}
                            : std::vector<std::size_t>{1000, 10'000, 100'000};
    if (million) options.objects.push_back(1'000'000);
  }
  sort_once(options.objects);
  options.threads = threads;
  sort_once(options.threads);
  for (const Isa one : available_isas()) {
    if (WINNOW_NATIVE == 0 && one != active_isa()) options.isas.push_back(one);
  }
  options.isas.push_back(active_isa());
  options.peers = has_peers() && !no_peers;
  options.yardstick = has_yardstick() && !no_peers;
  options.quick = quick;
  options.seed = seed;
  return options;
}

/// Joins the rows of files. Throws ArgumentError if a file has none.
Json ReportCommand::merged() const {
  Json document;
  for (const std::string& path : from) {
    Json one = read_json(path);
    if (!member(one, "benchmarks").is_array() || !member(one, "context").is_object()) {
      throw ArgumentError(path + ": there are no \"context\" and \"benchmarks\" in it");
    }
    if (document.is_null()) {
      document = std::move(one);
      continue;
    }
    Json& rows = document["benchmarks"];
    rows.insert(rows.end(), one["benchmarks"].begin(), one["benchmarks"].end());
  }
  return document;
}

void ReportCommand::note_settings(const ReportOptions& options, Results& results) const {
  Json names = Json::array();
  for (const NamedScene& scene : options.scenes) names.push_back(scene.name);
  results.context()["settings"] = {{"scenes", names},
                                   {"objects", options.objects},
                                   {"threads", options.threads},
                                   {"seed", options.seed},
                                   {"quick", quick},
                                   {"other_libraries", options.peers}};
  if (no_peers) {
    results.context()["missing"].push_back("Other libraries were left out (--no-peers).");
    return;
  }
  for (const Peer& peer : missing_peers()) {
    results.context()["missing"].push_back("Not measured against " + peer.name +
                                           ", which is not installed (Debian: " + peer.package +
                                           ", or all of them: bench/run --with-peers report).");
  }
}

int ReportCommand::run() {
  choose_isa(isa);
  if (out.empty()) throw ArgumentError("--out: a folder is needed");
  if (!from.empty()) {
    write_report(out, merged());
    std::cout << out << "/index.html\n";
    return kDone;
  }
  const ReportOptions chosen = options();
  Results results;
  results.context() = machine_facts();
  for (const char* notes : {"missing", "warnings", "problems"}) {
    results.context()[notes] = Json::array();
  }
  note_settings(chosen, results);
  const bool complete = make_report(out, chosen, report_steps(chosen, section_ids), results);
  print_rows(std::cout, results, "hard_cases_all");
  print_rows(std::cout, results, "advice", {"take", "next", "next_over_best", "auto_over_best"});
  for (const char* notes : {"missing", "warnings", "problems"}) {
    for (const Json& one : results.context()[notes]) std::cout << one.get<std::string>() << '\n';
  }
  std::cout << out << "/index.html: open it in a browser"
            << (complete ? "" : "; it contains the measurements up to the interruption") << '\n';
  if (!complete) return kInterrupted;
  return results.context()["problems"].empty() ? kDone : kFailed;
}

}  // namespace

void add_report(CLI::App& app) {
  command<ReportCommand>(app, "report", "Measures speed and error of all parts and writes one page",
                         "The page shows throughput, memory, volumes, pairs of shapes, hard cases, "
                         "queries and whole scenes, and recommends a structure.");
}

}  // namespace winnow::bench
