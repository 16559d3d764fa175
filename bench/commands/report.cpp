#include "bench/report/report.h"
#include "bench/commands/arguments.h"
#include "bench/commands/command.h"
#include "bench/measure/installed_peers.h"
#include "bench/report/markdown.h"
#include "bench/rows/machine.h"
#include "bench/scenes/scene.h"

#include <algorithm>
#include <iostream>
#include <utility>

namespace winnow::bench {
namespace {

constexpr int kInterrupted = 130;  // as shells say of SIGINT

struct ReportCommand {
  Choice choice;
  std::vector<std::string> section_ids;
  bool million = false;
  bool quick = false;
  bool no_peers = false;
  std::string from;
  std::string out = "winnow-report";

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

ReportOptions ReportCommand::options() const {
  ReportOptions options;
  options.scenes = named_scenes(choice.scenes.empty() ? main_scenes() : choice.scenes);
  options.objects = choice.objects;
  if (options.objects.empty()) {
    options.objects = quick ? std::vector<std::size_t>{300, 1000}
                            : std::vector<std::size_t>{1000, 10'000, 100'000};
    if (million) options.objects.push_back(1'000'000);
  }
  sort_once(options.objects);
  options.threads = choice.threads.empty() ? usual_threads() : choice.threads;
  sort_once(options.threads);
  for (const Isa isa : available_isas()) {
    if (isa != active_isa()) options.isas.push_back(isa);
  }
  options.isas.push_back(active_isa());
  options.peers = has_peers() && !no_peers;
  options.quick = quick;
  options.seed = choice.seed;
  return options;
}

std::vector<const ReportSection*> ReportCommand::sections() const {
  std::vector<const ReportSection*> chosen;
  for (const ReportSection& section : report_sections()) {
    const bool asked =
        std::find(section_ids.begin(), section_ids.end(), section.id) != section_ids.end();
    if (asked || section_ids.empty()) chosen.push_back(&section);
  }
  return chosen;
}

void ReportCommand::note_settings(const ReportOptions& options, Results& results) const {
  Json scenes = Json::array();
  for (const NamedScene& scene : options.scenes) scenes.push_back(scene.name);
  results.document()["settings"] = {{"scenes", scenes},
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
  choose_isa(choice.isa);
  if (out.empty()) throw ArgumentError("--out: a folder, please");
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
            << (complete ? "" : "; it holds what was measured until the interruption") << '\n';
  if (!complete) return kInterrupted;
  return results.document()["problems"].empty() ? kDone : kFailed;
}

}  // namespace

Command add_report(CLI::App& app) {
  auto report = std::make_shared<ReportCommand>();
  CLI::App* sub = app.add_subcommand(
      "report",
      "Speed against error of everything, on one page: throughput, memory, volumes, pairs of "
      "shapes, hard cases, queries, the pipeline, and which partition to take");
  std::vector<std::string> ids;
  for (const ReportSection& section : report_sections()) ids.emplace_back(section.id);
  sub->add_option("--out", report->out,
                  "Folder for index.html, results.json and CSVs; it is made if it is not there")
      ->capture_default_str();
  sub->add_option("--scene", report->choice.scenes,
                  "Built-in scenes or recordings (.aabbs, .aabbs.xz); default: the six main ones")
      ->delimiter(',');
  add_objects_option(*sub, report->choice);
  add_threads_option(*sub, report->choice);
  add_seed_option(*sub, report->choice);
  add_isa_option(*sub, report->choice);
  sub->add_option("--section", report->section_ids, "Only these")
      ->delimiter(',')
      ->check(CLI::IsMember(ids));
  sub->add_flag("--million", report->million, "1,000,000 objects, too");
  sub->add_flag("--quick", report->quick, "Small and unsteady, in seconds: to see what there is");
  sub->add_flag("--no-peers", report->no_peers, "Without other libraries");
  sub->add_option("--from", report->from,
                  "Measure nothing: write the page and the CSVs of this results.json");
  return {sub, [report] { return report->run(); }};
}

}  // namespace winnow::bench
