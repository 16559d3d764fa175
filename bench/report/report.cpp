#include "report/report.h"

#include "report/csv.h"
#include "tool/command.h"
#include "tool/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>
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
  std::string fault = file ? "" : std::strerror(errno);
  std::error_code failed;
  if (file) std::filesystem::rename(fresh, path, failed);
  if (failed) fault = failed.message();
  if (fault.empty()) return;
  std::filesystem::remove(fresh, failed);
  throw ArgumentError("cannot write " + path.string() + ": " + fault);
}

/// Why there is none; empty if there is.
std::string write_page(const std::filesystem::path& path, const Results& results) {
  const std::filesystem::path fresh = path.string() + ".new";
  std::error_code failed;
  try {
    write_report_page(fresh.string(), results);
    std::filesystem::rename(fresh, path, failed);
    if (!failed) return "";
    std::filesystem::remove(fresh, failed);
    return "cannot write " + path.string();
  } catch (const ArgumentError& error) {
    std::filesystem::remove(fresh, failed);
    return error.what();
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
    action.sa_handler = [](int) {
      g_asked_to_stop = 1;
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
  Json& document = results.document();
  // What matters most comes first, should there be no room for all.
  write_whole(path / "results.json", document_text(document));
  if (const std::string fault = write_page(path / "index.html", results); !fault.empty()) {
    Json& missing = document["missing"];
    const std::string what = "There is no page: " + fault;
    if (std::find(missing.begin(), missing.end(), what) == missing.end()) {
      missing.push_back(what);
      write_whole(path / "results.json", document_text(document));
    }
  }
  for (const Json& table : document["tables"]) {
    if (table["rows"].empty()) continue;
    write_whole(path / (table["name"].get<std::string>() + ".csv"), to_csv(table));
  }
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
  std::size_t done = 0;
  for (std::size_t i = 0; i < all.size() && !StopSignals::asked(); ++i) {
    const Stopwatch clock;
    for (const ReportStep& step : all[i].steps) {
      if (StopSignals::asked()) break;
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
  write_report(folder, results);
  return complete;
}

}  // namespace winnow::bench
