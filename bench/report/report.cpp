#include "report/report.h"

#include "report/csv.h"
#include "tool/command.h"
#include "tool/progress.h"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numeric>
#include <system_error>

namespace winnow::bench {
namespace {

constexpr double kSecondsBetweenWrites = 5.0;
constexpr double kQuickSecondsBetweenWrites = 0.5;

void write_whole(const std::filesystem::path& path, const std::string& text) {
  const std::filesystem::path fresh = path.string() + ".new";
  std::ofstream file(fresh, std::ios::binary);
  file << text;
  file.close();
  std::error_code failed;
  if (file) std::filesystem::rename(fresh, path, failed);
  if (!file || failed) {
    throw ArgumentError("cannot write " + path.string() + ": " +
                        (failed ? failed.message() : std::strerror(errno)));
  }
}

/// One row a line, so that versions of the document can be compared.
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

std::sig_atomic_t volatile g_asked_to_stop = 0;

/// While it lives, SIGINT and SIGTERM ask the report to stop; a second one ends the process.
class StopSignals {
 public:
  StopSignals() {
    g_asked_to_stop = 0;
    struct sigaction action {};
    action.sa_handler = [](int) { g_asked_to_stop = 1; };
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

  [[nodiscard]] static bool asked() noexcept { return g_asked_to_stop != 0; }

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
                                              {"title", section->title},
                                              {"steps", all.back().steps.size()},
                                              {"done", 0},
                                              {"seconds", 0.0}});
  }
  return all;
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
  const std::filesystem::path path(folder);
  const std::string page = (path / "index.html").string();
  try {
    write_report_page(page + ".new", results);
    std::filesystem::rename(page + ".new", page);
  } catch (const ArgumentError& error) {
    Json& missing = results.document()["missing"];
    const std::string what = std::string("There is no page: ") + error.what();
    if (std::find(missing.begin(), missing.end(), what) == missing.end()) missing.push_back(what);
  }
  for (const Json& table : results.document()["tables"]) {
    if (table["rows"].empty()) continue;
    write_whole(path / (table["name"].get<std::string>() + ".csv"), to_csv(table));
  }
  write_whole(path / "results.json", document_text(results.document()));
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
  const StopSignals signals;
  Progress progress(steps, seconds);
  const double between = options.quick ? kQuickSecondsBetweenWrites : kSecondsBetweenWrites;
  Stopwatch since_written;
  for (std::size_t i = 0; i < all.size() && !StopSignals::asked(); ++i) {
    const Stopwatch clock;
    for (const ReportStep& step : all[i].steps) {
      if (StopSignals::asked()) break;
      progress.step(all[i].id + ": " + step.what, step.seconds);
      run_step(all[i].id, step, results);
      Json& state = results.document()["sections"][i];
      state["done"] = state["done"].get<std::size_t>() + 1;
      state["seconds"] = clock.ms() / 1000.0;
      if (since_written.ms() < 1000.0 * between) continue;
      write_report(folder, results);
      since_written = Stopwatch();
    }
  }
  const bool complete = !StopSignals::asked();
  results.document()["complete"] = complete;
  write_report(folder, results);
  return complete;
}

}  // namespace winnow::bench
