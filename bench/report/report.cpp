// Runs the steps of a report and writes its files again and again, so that an interrupted run
// leaves a valid report of what has been measured. Sections come from sections.cpp, the page from
// page.cpp.

#include "bench/report/report.h"

#include "bench/common/errors.h"
#include "bench/common/other_work.h"
#include "bench/common/progress.h"
#include "bench/report/csv.h"
#include "bench/report/page.h"
#include "bench/rows/machine.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>

namespace winnow::bench {
namespace {

constexpr double kSecondsBetweenWrites = 5.0;
constexpr double kQuickSecondsBetweenWrites = 0.5;

/// Writes files under temporary names and renames all of them at the end, so that the files on disk
/// belong together even if the process ends early.
class FreshFiles {
 public:
  explicit FreshFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}
  FreshFiles(const FreshFiles&) = delete;
  FreshFiles& operator=(const FreshFiles&) = delete;
  ~FreshFiles() {
    std::error_code ignored;
    for (const std::string& name : names_) std::filesystem::remove(fresh(name), ignored);
  }

  /// Returns the temporary path of a file and registers it for `replace`.
  std::filesystem::path add(const std::string& name) {
    if (std::find(names_.begin(), names_.end(), name) == names_.end()) names_.push_back(name);
    return fresh(name);
  }
  void drop(const std::string& name) {
    std::error_code ignored;
    std::filesystem::remove(fresh(name), ignored);
    std::erase(names_, name);
  }
  void write(const std::string& name, const std::string& text) {
    std::ofstream file(add(name), std::ios::binary);
    file << text;
    file.close();
    if (file) return;
    const std::string fault = std::strerror(errno);
    drop(name);
    throw ArgumentError("cannot write " + (folder_ / name).string() + ": " + fault);
  }
  /// Renames all files, the last one first.
  void replace() {
    std::string fault;
    for (; !names_.empty(); names_.pop_back()) {
      const std::filesystem::path path = folder_ / names_.back();
      std::error_code failed;
      std::filesystem::rename(fresh(names_.back()), path, failed);
      if (!failed) continue;
      fault = "cannot write " + path.string() + ": " + failed.message();
      std::filesystem::remove(fresh(names_.back()), failed);
    }
    if (!fault.empty()) throw ArgumentError(fault);
  }

 private:
  [[nodiscard]] std::filesystem::path fresh(const std::string& name) const {
    return folder_ / (name + ".new");
  }

  std::filesystem::path folder_;
  std::vector<std::string> names_;
};

/// Formats the document with one row per line, so that versions can be compared with diff.
std::string document_text(const Json& document) {
  const auto line = [](const Json& json) {
    return json.dump(-1, ' ', true, Json::error_handler_t::replace);
  };
  std::string text = "{";
  for (const auto& [name, member] : document.items()) {
    if (text.size() > 1) text += ",";
    text += "\n\"" + name + "\": ";
    if (name != "tables") {
      text += line(member);
      continue;
    }
    text += "[";
    for (const Json& table : member) {
      Json head = table;
      head.erase("rows");
      std::string open = line(head);
      open.back() = ',';
      text += (&table == &member.front() ? "\n" : ",\n") + open + "\"rows\": [";
      for (const Json& row : table["rows"]) {
        text += (&row == &table["rows"].front() ? "\n" : ",\n") + line(row);
      }
      text += "]}";
    }
    text += "]";
  }
  return text + "\n}\n";
}

std::sig_atomic_t volatile g_stop_requested = 0;

/// While an object of this class exists, the first SIGINT or SIGTERM stops the report after the
/// current step; a second one ends the process.
class StopSignals {
 public:
  StopSignals() {
    g_stop_requested = 0;
    struct sigaction action {};
    action.sa_handler = [](int) {
      g_stop_requested = 1;
      constexpr std::string_view kWord =
          "\nwinnow: stopping after the step that runs; once more stops at once\n";
      if (::write(STDERR_FILENO, kWord.data(), kWord.size()) < 0) return;
    };
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigaction(SIGINT, &action, &old_interrupt_);
    sigaction(SIGTERM, &action, &old_terminate_);
  }
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;
  ~StopSignals() {
    sigaction(SIGINT, &old_interrupt_, nullptr);
    sigaction(SIGTERM, &old_terminate_, nullptr);
  }

  [[nodiscard]] static bool requested() noexcept { return g_stop_requested != 0; }

 private:
  struct sigaction old_interrupt_ {};
  struct sigaction old_terminate_ {};
};

struct PlannedSection {
  std::string id;
  std::vector<ReportStep> steps;
};

std::vector<PlannedSection> planned(const ReportOptions& options,
                                    const std::vector<const ReportSection*>& sections,
                                    Results& results) {
  std::vector<PlannedSection> all;
  for (const ReportSection* section : sections) {
    section->declare(results);
    all.push_back({std::string(section->id), section->plan(options)});
    results.document()["sections"].push_back({{"id", section->id},
                                              {"title", section_of(section->id)["title"]},
                                              {"steps", all.back().steps.size()},
                                              {"done", 0},
                                              {"seconds", 0.0}});
  }
  return all;
}

/// Adds a warning if other processes used the machine or its speed changed during the run.
void note_disturbances(const OtherWork& others, Results& results) {
  constexpr double kBusy = 0.1;
  constexpr double kOtherSpeed = 1.2;
  Json& warnings = results.document()["warnings"];
  if (const double cores = others.cores().value_or(0.0); cores > kBusy) {
    warnings.push_back("The machine was busy: other processes kept " + shown(cores, "number") +
                       " cores at work on average while this was measured. Times are too long; "
                       "ratios of contenders that took turns are less affected.");
  }
  const double before = results.document()["machine"]["reference_sweep_ms"];
  const double after = reference_sweep_ms();
  if (std::max(before, after) > kOtherSpeed * std::min(before, after)) {
    warnings.push_back(
        "The machine's speed changed while this was measured: the reference sweep "
        "took " +
        shown(before, "number") + " ms at the beginning and " + shown(after, "number") +
        " at the end. Compare values within one table, not between tables.");
  }
}

void run_step(const std::string& section, const ReportStep& step, Results& results) {
  try {
    step.run(results);
  } catch (const std::exception& error) {
    results.document()["problems"].push_back(section + ", " + step.what + ": " + error.what());
  }
}

}  // namespace

void write_report(const std::string& folder, Results& results) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  Json& document = results.document();
  FreshFiles files(folder);
  // The most important file is written first, in case the disk is full.
  files.write("results.json", document_text(document));
  try {
    write_report_page(files.add("index.html").string(), results);
  } catch (const ArgumentError& error) {
    files.drop("index.html");
    Json& missing = document["missing"];
    const std::string what = std::string("There is no page: ") + error.what();
    if (std::find(missing.begin(), missing.end(), what) == missing.end()) missing.push_back(what);
    files.write("results.json", document_text(document));
  }
  try {
    for (const Json& table : document["tables"]) {
      if (table["rows"].empty()) continue;
      files.write(table["name"].get<std::string>() + ".csv", to_csv(table));
    }
  } catch (const ArgumentError&) {
    files.replace();
    throw;
  }
  files.replace();
}

bool make_report(const std::string& folder, const ReportOptions& options,
                 const std::vector<const ReportSection*>& sections, Results& results) {
  const auto all = planned(options, sections, results);
  std::size_t steps = 0;
  double seconds = 0.0;
  for (const PlannedSection& section : all) {
    steps += section.steps.size();
    for (const ReportStep& step : section.steps) seconds += step.seconds;
  }
  write_report(folder, results);
  const OtherWork others;
  const StopSignals signals;
  Progress progress(steps, seconds);
  const double between = options.quick ? kQuickSecondsBetweenWrites : kSecondsBetweenWrites;
  Stopwatch since_written;
  std::size_t done = 0;
  for (std::size_t i = 0; i < all.size() && !StopSignals::requested(); ++i) {
    const Stopwatch clock;
    for (const ReportStep& step : all[i].steps) {
      if (StopSignals::requested()) break;
      progress.step(all[i].id + ": " + step.what, step.seconds);
      run_step(all[i].id, step, results);
      ++done;
      Json& state = results.document()["sections"][i];
      state["done"] = state["done"].get<std::size_t>() + 1;
      state["seconds"] = clock.ms() / 1000.0;
      if (since_written.ms() < 1000.0 * between) continue;
      write_report(folder, results);
      since_written = Stopwatch();
    }
  }
  const bool complete = done == steps;
  results.document()["complete"] = complete;
  note_disturbances(others, results);
  write_report(folder, results);
  return complete;
}

}  // namespace winnow::bench
