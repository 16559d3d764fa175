#include "queries/query_race.h"
#include "recordings/recording.h"
#include "scenes/scene.h"
#include "tool/arguments.h"
#include "tool/command.h"
#include "tool/measure_queries.h"
#include "tool/output.h"
#include "tool/progress.h"
#include "tool/table.h"

#include <algorithm>
#include <iostream>
#include <optional>

namespace winnow::bench {
namespace {

struct Queries {
  Choice choice;
  std::string scene = "uniform";
  std::string recording;
  std::size_t objects = 100'000;
  int threads = 1;
  std::size_t rays = 100'000;
  std::size_t rounds = 5;
  std::vector<std::string> sets;
  std::string json;

  int run();
};

std::string asked(const QueryRun& run) {
  return run.asking == Asking::single ? "single" : "batch";
}

/// Of all who answered the set in some manner of asking, which other library was fastest; null if
/// none answered.
const QueryRun* best_peer(const QueryMeasurement& measured, const std::string& set) {
  const QueryRun* best = nullptr;
  for (const QueryRun& run : measured.runs) {
    if (run.set != set || !run.answered() || !measured.is_peer(run)) continue;
    if (best == nullptr || run.ns_a_question() < best->ns_a_question()) best = &run;
  }
  return best;
}

std::vector<std::string> row_of(const QueryMeasurement& measured, const QueryRun& run) {
  std::vector<std::string> row{run.set, run.engine, asked(run)};
  if (!run.answered()) {
    row.insert(row.end(), {"-", "-", "-", "-", "-", "-", "refused: " + run.refusal});
    return row;
  }
  const double ns = run.ns_a_question();
  const QueryRun* peer = best_peer(measured, run.set);
  row.insert(row.end(),
             {short_number(median_of(run.ms)), grouped(run.questions),
              ns > 0.0 ? short_number(1e3 / ns) : "-", short_number(run.found_a_question()),
              peer != nullptr && ns > 0.0 ? short_number(peer->ns_a_question() / ns) + "x" : "-",
              std::to_string(run.comparison.undecided),
              run.comparison.agree() ? "yes"
                                     : "NO: " + std::to_string(run.comparison.wrong) + " wrong, " +
                                           run.comparison.first});
  return row;
}

Json to_json(const QueryMeasurement& measured, const QueryRun& run) {
  return {{"scene", measured.scene},
          {"objects", measured.objects},
          {"set", run.set},
          {"engine", run.engine},
          {"asked", asked(run)},
          {"threads", run.threads},
          {"isa", isa_name()},
          {"questions", run.questions},
          {"found", run.found},
          {"found_a_question", run.found_a_question()},
          {"median_ms", median_of(run.ms)},
          {"ns_a_question", run.ns_a_question()},
          {"ms", run.ms},
          {"undecided", run.comparison.undecided},
          {"wrong", run.comparison.wrong},
          {"first_wrong", run.comparison.first},
          {"refusal", run.refusal}};
}

int Queries::run() {
  choose_isa(choice.isa);
  std::optional<Recording> file;
  if (!recording.empty()) file = read_recording(recording);
  QueryMeasureOptions options{.scene = scene,
                              .recording = file ? &*file : nullptr,
                              .objects = objects,
                              .seed = choice.seed,
                              .partitions = choice.partitions,
                              .threads = threads,
                              .rays = rays,
                              .rounds = rounds,
                              .sets = sets,
                              .peers = true,
                              .before_set = {}};
  QueryMeasurement measured;
  {
    Progress progress(sets.empty() ? question_set_names().size() : sets.size());
    options.before_set = [&](const QuestionSet& set) { progress.step(set.name); };
    measured = measure_queries(options);
  }
  std::cout << measured.scene << ", " << grouped(measured.objects) << " objects, " << threads
            << (threads == 1 ? " thread, " : " threads, ") << isa_name() << ", medians of "
            << rounds << " rounds; reference sweep " << short_number(measured.machine_ms)
            << " ms\n";
  Table table({"questions", "engine", "asked", "ms", "number", "M/s", "found/question",
               "best peer / this", "undecided", "agrees"});
  for (const std::size_t column : {1, 2, 9}) table.flush_left(column);
  Json rows = Json::array();
  bool agree = true;
  for (const QueryRun& one : measured.runs) {
    table.add(row_of(measured, one));
    rows.push_back(to_json(measured, one));
    agree = agree && one.answered() && one.comparison.agree();
  }
  std::cout << table << skipped_line(measured.skipped);
  write_json(json, rows);
  if (agree) return kDone;
  std::cerr << "winnow: some questions were refused, or not all found the same\n";
  return kFailed;
}

}  // namespace

Command add_queries(CLI::App& app) {
  auto queries = std::make_shared<Queries>();
  CLI::App* sub = app.add_subcommand(
      "queries",
      "Rays, boxes, frusta, balls, sweeps and nearest objects on one frame of a scene: partitions "
      "and Embree in turns. What they find is compared hit by hit; \"undecided\" counts questions "
      "on which Embree's float arithmetic may fall either way.");
  std::vector<std::string> scenes;
  for (const SceneInfo& info : scene_infos()) scenes.emplace_back(info.name);
  const auto names = question_set_names();
  CLI::Option* scene = sub->add_option("--scene", queries->scene, "A scene, in its first frame")
                           ->check(CLI::IsMember(scenes))
                           ->capture_default_str();
  sub->add_option("--recording", queries->recording, "The first frame of a recording instead")
      ->excludes(scene);
  sub->add_option("--objects", queries->objects, "Number of objects of the scene")
      ->check(CLI::Range(std::size_t{1}, std::size_t{100'000'000}))
      ->capture_default_str();
  add_partitions_option(*sub, queries->choice);
  sub->add_option("--threads", queries->threads, "Threads")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  add_isa_option(*sub, queries->choice);
  sub->add_option("--rays", queries->rays, "Rays of a set; dearer questions are fewer")
      ->check(CLI::Range(std::size_t{1}, std::size_t{100'000'000}))
      ->capture_default_str();
  sub->add_option("--rounds", queries->rounds, "Rounds in which all take turns")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1000}))
      ->capture_default_str();
  sub->add_option("--set", queries->sets, "Only these sets of questions")
      ->delimiter(',')
      ->check(CLI::IsMember(std::vector<std::string>(names.begin(), names.end())));
  add_seed_option(*sub, queries->choice);
  add_json_option(*sub, queries->json);
  return {sub, [queries] { return queries->run(); }};
}

}  // namespace winnow::bench
