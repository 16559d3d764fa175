#include "bench/report/report.h"
#include "bench/commands/command.h"
#include "bench/commands/options.h"
#include "bench/common/json.h"
#include "bench/rows/machine.h"
#include "bench/scenes/scene.h"

#include <algorithm>
#include <iostream>
#include <utility>

namespace winnow::bench {
namespace {

constexpr int kInterrupted = 130;  // exit status of shells after SIGINT

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
