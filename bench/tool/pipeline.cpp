#include "tool/arguments.h"
#include "tool/command.h"
#include "tool/measure_pipeline.h"
#include "tool/output.h"
#include "tool/progress.h"
#include "tool/table.h"

#include <algorithm>
#include <iostream>
#include <map>

namespace winnow::bench {
namespace {

const std::vector<std::string> kScenes{"pile", "terrain", "tori"};
const std::map<std::string, ContactLevel> kLevelsByName{{"pairs", ContactLevel::pairs},
                                                        {"boolean", ContactLevel::boolean},
                                                        {"distance", ContactLevel::distance},
                                                        {"manifold", ContactLevel::manifold}};

struct Pipeline {
  Choice choice;
  std::vector<std::string> scenes = kScenes;
  std::vector<std::string> levels{"manifold"};
  std::vector<int> threads{1, 2};
  std::size_t frames = 9;
  std::size_t bodies = 0;
  bool peers = true;
  std::string json;

  int run();

 private:
  void race(const std::string& scene, const std::string& level, bool resting, Table& table,
            Json& rows) const;
  [[nodiscard]] Table race_tori(Json& rows) const;
};

std::string times(double ms, double own_ms) {
  return short_number(ms / own_ms) + "x";
}

// Other libraries are asked for manifolds alone.
void Pipeline::race(const std::string& scene, const std::string& level, bool resting, Table& table,
                    Json& rows) const {
  PipelineMeasureOptions options;
  options.scene = scene;
  options.resting = resting;
  options.level = kLevelsByName.at(level);
  options.threads = threads;
  options.peers = peers && options.level == ContactLevel::manifold;
  options.frames = frames;
  options.bodies = bodies;
  options.seed = choice.seed;
  const PipelineMeasurement measured = measure_pipeline(options);
  const char* how = resting ? "at rest" : "moving a little";
  const double first = measured.timings.front().median_ms();
  for (const SceneTiming& timing : measured.timings) {
    table.add({scene, grouped(measured.bodies), grouped(measured.triangles), level, how,
               timing.engine, std::to_string(timing.threads), short_number(timing.median_ms()),
               times(timing.median_ms(), first), grouped(timing.finds.touching),
               grouped(timing.finds.points)});
    rows.push_back({{"scene", scene},
                    {"level", level},
                    {"resting", resting},
                    {"bodies", measured.bodies},
                    {"triangles", measured.triangles},
                    {"engine", timing.engine},
                    {"threads", timing.threads},
                    {"isa", isa_name()},
                    {"median_ms", timing.median_ms()},
                    {"ms", timing.ms},
                    {"touching", timing.finds.touching},
                    {"points", timing.finds.points}});
  }
}

Table Pipeline::race_tori(Json& rows) const {
  const MeshMeasurement measured = measure_meshes(frames, peers);
  Table table({"tori of 20,000 triangles", "by", "ms", "times the first", "triangle pairs",
               "found by one alone"});
  table.flush_left(1);
  const MeshTiming& own = measured.timings.front();
  for (const MeshTiming& timing : measured.timings) {
    const double build = median_of(timing.build_ms);
    table.add({"build, " + short_number(timing.bytes_per_triangle) + " bytes a triangle",
               timing.engine, short_number(build), times(build, median_of(own.build_ms)), "", ""});
    rows.push_back({{"scene", "tori"},
                    {"engine", timing.engine},
                    {"build_ms", build},
                    {"bytes_per_triangle", timing.bytes_per_triangle}});
  }
  for (std::size_t p = 0; p < torus_poses().size(); ++p) {
    for (const MeshTiming& timing : measured.timings) {
      const double ms = median_of(timing.collide_ms[p]);
      table.add({"about " + grouped(torus_poses()[p].about) + " pairs", timing.engine,
                 short_number(ms), times(ms, median_of(own.collide_ms[p])),
                 grouped(timing.pairs[p]), grouped(timing.differ[p])});
      rows.push_back({{"scene", "tori"},
                      {"about", torus_poses()[p].about},
                      {"engine", timing.engine},
                      {"isa", isa_name()},
                      {"median_ms", ms},
                      {"ms", timing.collide_ms[p]},
                      {"pairs", timing.pairs[p]},
                      {"differ", timing.differ[p]}});
    }
  }
  return table;
}

int Pipeline::run() {
  choose_isa(choice.isa);
  Table table({"scene", "bodies", "triangles", "level", "how", "by", "threads", "ms",
               "times the first", "touching", "points"});
  for (const std::size_t column : {3, 4, 5}) table.flush_left(column);
  std::vector<Table> tori;
  Json rows = Json::array();
  bool has_scenes = false;
  {
    Progress progress(2 * scenes.size());
    for (const std::string& scene : scenes) {
      if (scene == "tori") {
        progress.step(scene);
        tori.push_back(race_tori(rows));
        continue;
      }
      has_scenes = true;
      for (const bool resting : {false, true}) {
        progress.step(scene + (resting ? ", at rest" : ", moving a little"));
        for (const std::string& level : levels) race(scene, level, resting, table, rows);
      }
    }
  }
  std::cout << isa_name() << ", medians of " << frames
            << " frames in which all take turns; from poses to contact points\n";
  if (has_scenes) std::cout << table << '\n';
  for (const Table& meshes : tori) std::cout << meshes << '\n';
  write_json(json, rows);
  return kDone;
}

}  // namespace

Command add_pipeline(CLI::App& app) {
  auto pipeline = std::make_shared<Pipeline>();
  CLI::App* sub = app.add_subcommand(
      "pipeline",
      "Milliseconds from poses to contacts: whole scenes, winnow and other libraries in turns. A "
      "pile of 20,000 bodies, 2,000 hulls on a terrain of 200,978 triangles, each moving a little "
      "(nothing is carried over) and at rest (contacts are); two tori of 20,000 triangles.");
  sub->add_option("--scene", pipeline->scenes, "Which")
      ->delimiter(',')
      ->check(CLI::IsMember(kScenes))
      ->capture_default_str();
  sub->add_option("--level", pipeline->levels, "How much winnow is asked for")
      ->delimiter(',')
      ->check(CLI::IsMember(kLevelsByName))
      ->capture_default_str();
  sub->add_option("--threads", pipeline->threads, "Numbers of threads that winnow takes")
      ->delimiter(',')
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  sub->add_option("--frames", pipeline->frames, "Timed frames")
      ->check(CLI::Range(std::size_t{1}, std::size_t{10'000}))
      ->capture_default_str();
  sub->add_option("--bodies", pipeline->bodies, "Fewer or more of them in pile and terrain")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1'000'000}));
  sub->add_flag("!--no-peers", pipeline->peers, "Without other libraries");
  add_isa_option(*sub, pipeline->choice);
  add_seed_option(*sub, pipeline->choice);
  add_json_option(*sub, pipeline->json);
  return {sub, [pipeline] { return pipeline->run(); }};
}

}  // namespace winnow::bench
