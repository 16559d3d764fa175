#include "bench/report/report.h"
#include "bench/commands/command.h"
#include "bench/commands/options.h"
#include "bench/report/markdown.h"
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
  std::string from;
  std::string out = "winnow-report";

  void add_options(CLI::App& app);
  int run();

 private:
  [[nodiscard]] ReportOptions options() const;
  [[nodiscard]] std::vector<const ReportSection*> sections() const;
  void note_settings(const ReportOptions& options, Results& results) const;
};

template <typename T>
void sort_once(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

void ReportCommand::add_options(CLI::App& app) {
  option(app, "--out", out,
         "Folder for index.html, results.json and CSV files; created if missing");
  option(app, "--scene", scenes,
         "Scenes, or files of recordings (.aabbs or .winnow, also compressed as .xz)");
  add_objects_option(app, objects, "Numbers of objects");
  add_threads_option(app, threads, "Numbers of threads");
  add_seed_option(app, seed);
  add_isa_option(app, isa);
  std::vector<std::string> ids;
  for (const ReportSection& section : report_sections()) ids.emplace_back(section.id);
  one_of(app, "--section", section_ids, ids, "Sections");
  app.add_flag("--million", million, "Also measure 1,000,000 objects");
  app.add_flag("--quick", quick,
               "Measure small scenes in seconds, with unreliable times: a preview");
  app.add_flag("--no-peers", no_peers, "Do not measure other libraries");
  option(app, "--from", from, "Measure nothing: write the page and CSV files of this results.json");
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

std::vector<const ReportSection*> ReportCommand::sections() const {
  std::vector<const ReportSection*> chosen;
  for (const ReportSection& section : report_sections()) {
    const bool is_selected =
        std::find(section_ids.begin(), section_ids.end(), section.id) != section_ids.end();
    if (is_selected || section_ids.empty()) chosen.push_back(&section);
  }
  return chosen;
}

void ReportCommand::note_settings(const ReportOptions& options, Results& results) const {
  Json names = Json::array();
  for (const NamedScene& scene : options.scenes) names.push_back(scene.name);
  results.document()["settings"] = {{"scenes", names},
                                    {"objects", options.objects},
                                    {"threads", options.threads},
                                    {"seed", options.seed},
                                    {"quick", quick},
                                    {"other_libraries", options.peers}};
  if (no_peers) {
    results.document()["missing"].push_back("Other libraries were left out (--no-peers).");
    return;
  }
  for (const MissingPeer& peer : missing_peers()) {
    results.document()["missing"].push_back("Not measured against " + peer.name +
                                            ", which is not installed (Debian: " + peer.package +
                                            ", or all of them: bench/run --with-peers report).");
  }
}

int ReportCommand::run() {
  choose_isa(isa);
  if (out.empty()) throw ArgumentError("--out: a folder is needed");
  if (!from.empty()) {
    Results results = read_results(from);
    try {
      write_report(out, results);
    } catch (const Json::exception& error) {
      throw ArgumentError("--from: " + from + ": " + error.what());
    }
    std::cout << out << "/index.html\n";
    return kDone;
  }
  const ReportOptions chosen = options();
  Results results;
  results.document()["machine"] = machine_facts();
  note_settings(chosen, results);
  const bool complete = make_report(out, chosen, sections(), results);
  print_summary(results);
  std::cout << out << "/index.html: open it in a browser"
            << (complete ? "" : "; it contains the measurements up to the interruption") << '\n';
  if (!complete) return kInterrupted;
  return results.document()["problems"].empty() ? kDone : kFailed;
}

}  // namespace

void add_report(CLI::App& app) {
  command<ReportCommand>(app, "report", "Measures speed and error of all parts and writes one page",
                         "The page shows throughput, memory, volumes, pairs of shapes, hard cases, "
                         "queries and whole scenes, and recommends a structure.");
}

}  // namespace winnow::bench
