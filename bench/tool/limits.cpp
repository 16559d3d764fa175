#include "engine/frame_limit.h"
#include "tool/arguments.h"
#include "tool/command.h"
#include "tool/measure.h"
#include "tool/output.h"
#include "tool/progress.h"
#include "tool/table.h"

#include <iostream>

namespace winnow::bench {
namespace {

struct Limits {
  Choice choice;
  std::string json;

  int run();

 private:
  void add(const std::string& scene, std::size_t objects, Table& table, Json& rows) const;
};

void Limits::add(const std::string& scene, std::size_t objects, Table& table, Json& rows) const {
  MeasureOptions options;
  options.scene = scene;
  options.objects = objects;
  options.seed = choice.seed;
  options.partitions = choice.partitions;
  const Measurement measured = measure(options);
  const Run* const best = measured.fastest(1);
  if (best == nullptr) return;
  const auto pairs = static_cast<std::size_t>(best->pairs_a_frame());
  const FrameLimit limit = measure_frame_limit(objects, pairs);
  const double ms = best->median_ms();
  table.add({scene, grouped(objects), grouped(pairs), short_number(limit.bandwidth),
             short_number(limit.sort), short_number(limit.permute), short_number(limit.emission),
             short_number(limit.total()), best->engine, short_number(best->median_update_ms()),
             short_number(ms), short_number(ms / limit.total()) + "x"});
  rows.push_back({{"scene", scene},
                  {"objects", objects},
                  {"pairs", pairs},
                  {"bandwidth_ms", limit.bandwidth},
                  {"sort_ms", limit.sort},
                  {"permute_ms", limit.permute},
                  {"emission_ms", limit.emission},
                  {"limit_ms", limit.total()},
                  {"partition", best->engine},
                  {"update_ms", best->median_update_ms()},
                  {"frame_ms", ms}});
}

int Limits::run() {
  choose_isa(choice.isa);
  if (choice.scenes.empty()) choice.scenes = main_scenes();
  if (choice.objects.empty()) choice.objects = {10'000, 100'000};
  Table table({"scene", "objects", "pairs", "bandwidth", "sort", "permute", "emission", "sum",
               "best partition", "update", "frame", "frame / sum"});
  table.flush_left(8);
  Json rows = Json::array();
  Progress progress(choice.scenes.size() * choice.objects.size());
  for (const std::size_t objects : choice.objects) {
    for (const std::string& scene : choice.scenes) {
      progress.step(scene + ", " + grouped(objects) + " objects");
      add(scene, objects, table, rows);
    }
  }
  progress.clear();
  std::cout << "What a frame costs at least if every box moves and nothing is kept, part by part, "
               "and what it costs; ms, 1 thread, "
            << isa_name() << '\n'
            << table;
  write_json(json, rows);
  return kDone;
}

}  // namespace

Command add_limits(CLI::App& app) {
  auto limits = std::make_shared<Limits>();
  CLI::App* sub =
      app.add_subcommand("limits", "How far the best partition is from what memory alone allows");
  add_scenes_option(*sub, limits->choice);
  add_objects_option(*sub, limits->choice);
  add_partitions_option(*sub, limits->choice);
  add_isa_option(*sub, limits->choice);
  add_seed_option(*sub, limits->choice);
  add_json_option(*sub, limits->json);
  return {sub, [limits] { return limits->run(); }};
}

}  // namespace winnow::bench
