#include "bench/common/table.h"
#include "bench/contenders/partitions.h"
#include "bench/report/section.h"
#include "bench/rows/advice_rows.h"
#include "bench/rows/cluster_rows.h"
#include "bench/rows/cold_rows.h"
#include "bench/rows/every_scene_rows.h"
#include "bench/rows/filter_rows.h"
#include "bench/rows/frame_rows.h"
#include "bench/rows/memory_rows.h"
#include "bench/rows/query_rows.h"
#include "bench/rows/volume_rows.h"
#include "bench/scenes/scene.h"

#include <algorithm>
#include <initializer_list>
#include <limits>
#include <stdexcept>

namespace winnow::bench {
namespace {

constexpr std::size_t kLargestForPeers = 150'000;
constexpr std::size_t kLargestForMemory = 150'000;
/// Above it the structures of all instruction sets would fill the memory if they raced at once.
constexpr std::size_t kLargestForOneRace = 300'000;

/// The greatest number of objects asked for that is not above `most`, or the least there is.
std::size_t objects_up_to(const ReportOptions& options, std::size_t most) {
  std::size_t chosen = options.objects.front();
  for (const std::size_t objects : options.objects) {
    if (objects <= most) chosen = objects;
  }
  return chosen;
}

/// Where nothing was asked for, a few of the main scenes stand for all.
std::vector<NamedScene> few_scenes(const ReportOptions& options,
                                   std::initializer_list<std::string_view> few) {
  std::vector<std::string> names;
  for (const NamedScene& scene : options.scenes) names.push_back(scene.name);
  std::vector<NamedScene> scenes = options.scenes;
  if (names == main_scenes()) {
    std::erase_if(scenes, [&](const NamedScene& scene) {
      return std::find(few.begin(), few.end(), scene.name) == few.end();
    });
  }
  return scenes;
}

std::string named(const NamedScene& scene, std::size_t objects) {
  return scene.name + ", " + grouped(objects) + " objects";
}

/// Calls it with each scene and each of its sizes: recordings have one.
template <typename Visit>
void each_size(const ReportOptions& options, const std::vector<NamedScene>& scenes, Visit visit) {
  for (const NamedScene& scene : scenes) {
    for (const std::size_t asked : options.objects) {
      visit(scene, scene.objects(asked));
      if (scene.is_recording()) break;
    }
  }
}

/// Frames that give a steady median in little time.
std::size_t throughput_frames(const ReportOptions& options, std::size_t objects) {
  if (options.quick) return 4;
  if (objects <= 2'000) return 31;
  if (objects <= 20'000) return 21;
  return objects <= kLargestForOneRace ? 11 : 6;
}

std::size_t frames_of_slow(const ReportOptions& options, std::size_t objects) {
  return options.quick || objects > 20'000 ? kFingerprintFrames : 6;
}

/// One race, or one for each instruction set where all would be too much.
void race_partitions(Results& results, const ReportOptions& options, const NamedScene& scene,
                     std::size_t objects, const std::vector<std::string>& partitions,
                     std::size_t frames, bool yardstick) {
  if (partitions.empty()) return;
  MeasureOptions race{.objects = objects,
                      .seed = options.seed,
                      .partitions = partitions,
                      .threads = options.threads,
                      .isas = options.isas,
                      .yardstick = yardstick,
                      .frames = frames};
  if (objects <= kLargestForOneRace) {
    add_frame_race(results, scene, race);
    return;
  }
  for (const Isa isa : options.isas) {
    race.isas = {isa};
    add_frame_race(results, scene, race);
  }
}

/// Partitions that suit any size first, then those that take longer.
void measure_throughput(Results& results, const ReportOptions& options, const NamedScene& scene,
                        std::size_t objects) {
  const Partitions partitions = partitions_for({"all"}, objects);
  note_skipped(results, objects, partitions.skipped, false);
  std::vector<std::string> fast;
  std::vector<std::string> slow;
  for (const std::string& name : partitions.taken) {
    const bool limited = largest_for(name) != std::numeric_limits<std::size_t>::max();
    (limited ? slow : fast).push_back(name);
  }
  race_partitions(results, options, scene, objects, fast, throughput_frames(options, objects),
                  options.yardstick);
  race_partitions(results, options, scene, objects, slow, frames_of_slow(options, objects), false);
  derive_frames(results, scene.name, objects);
  const Json where{{"scene", scene.name}, {"objects", objects}};
  if (distinct(results.rows("throughput", where), "fingerprint").size() > 1) {
    throw std::runtime_error("not all found the same pairs");
  }
}

/// With as many threads as may be, beside a partition whose pairs theirs must equal.
void measure_peers(Results& results, const ReportOptions& options, const NamedScene& scene,
                   std::size_t objects) {
  add_frame_race(results, scene,
                 {.objects = objects,
                  .seed = options.seed,
                  .partitions = {"LinearBvh"},
                  .threads = {options.threads.back()},
                  .isas = {options.isas.back()},
                  .peers = true,
                  .frames = frames_of_slow(options, objects)},
                 true);
  derive_frames(results, scene.name, objects);
}

void measure_keys(Results& results, std::size_t objects, bool quick) {
  for (const std::string& partition : testing_partitions()) {
    if (quick && partition != "LinearBvh") continue;
    for (const bool random_order : {false, true}) {
      add_key_costs(results, partition, objects, random_order);
    }
  }
}

/// Races of volumes on the settings and scenes, in the partition where all volumes are compared.
std::vector<VolumeQuestion> volume_questions(const ReportOptions& options) {
  VolumeQuestion asked{.objects = objects_up_to(options, 10'000), .seed = options.seed};
  asked.frames = options.quick ? 2 : volume_frames(asked.objects);
  std::vector<VolumeQuestion> all;
  // Boxes of built-in scenes lie upright: one of them stands for all.
  for (const NamedScene& scene : few_scenes(options, {"uniform"})) {
    all.push_back(asked);
    all.back().setting = "scene";
    all.back().scene = scene;
    all.back().objects = scene.objects(asked.objects);
    all.back().frames = options.quick ? 2 : volume_frames(all.back().objects);
  }
  for (const char* setting : {"cubes", "rods", "slow"}) {
    all.push_back(asked);
    all.back().setting = setting;
  }
  return all;
}

void add_volume_step(ReportSteps& steps, const VolumeQuestion& asked, const std::string& table) {
  constexpr double kEach = 3e-5;  // seconds of an object in a frame
  steps.push_back(
      {(asked.setting == "scene" ? asked.scene.name : asked.setting) + " in " + asked.partition,
       kEach * static_cast<double>(asked.objects) * static_cast<double>(asked.frames + 1),
       [=](Results& results) { add_volumes(results, asked, table); }});
}

/// Where nothing was asked for, all scenes.
void plan_every_scene(const ReportOptions& options, ReportSteps& steps) {
  std::vector<std::string> names;
  for (const NamedScene& scene : options.scenes) names.push_back(scene.name);
  const auto scenes = names == main_scenes() ? named_scenes(scene_names()) : options.scenes;
  for (const NamedScene& scene : scenes) {
    EverySceneQuestion asked{.scene = scene,
                             .objects = scene.objects(objects_up_to(options, 10'000)),
                             .seed = options.seed,
                             .threads = options.threads.front(),
                             .yardstick = options.yardstick};
    if (options.quick) asked.frames = kSettlingFrames + 3;
    steps.push_back({named(scene, asked.objects) + ", worst frames",
                     0.05 + 1e-8 * static_cast<double>(asked.frames * asked.objects * 60),
                     [=](Results& results) { add_every_scene(results, asked); }});
  }
}

void plan_cold(const ReportOptions& options, ReportSteps& steps) {
  const auto scenes = few_scenes(options, {"uniform", "mixed", "clustered"});
  each_size(options, scenes, [&](const NamedScene& scene, std::size_t objects) {
    if (objects > kLargestForPeers) return;
    const std::size_t rounds = options.quick ? 1 : objects > 20'000 ? 3 : 7;
    steps.push_back({named(scene, objects) + ", first frames",
                     1.1e-5 * static_cast<double>((rounds + 1) * objects), [=](Results& results) {
                       add_cold(results, scene, objects, options.seed, unlimited_partitions(),
                                options.threads.front(), rounds, options.yardstick);
                     }});
  });
}

void plan_filters(const ReportOptions& options, ReportSteps& steps) {
  for (const NamedScene& scene : few_scenes(options, {"uniform"})) {
    const std::size_t objects = scene.objects(objects_up_to(options, 10'000));
    const std::size_t rounds = options.quick ? 1 : 7;
    for (const std::string& partition : unlimited_partitions()) {
      if (options.quick && partition != "LinearBvh") continue;
      steps.push_back({named(scene, objects) + ", filters in " + partition,
                       6e-6 * static_cast<double>((rounds + 4) * objects), [=](Results& results) {
                         add_filters(results, scene, objects, options.seed, {partition}, rounds);
                       }});
    }
  }
}

}  // namespace

ReportSteps plan_throughput(const ReportOptions& options) {
  ReportSteps steps;
  each_size(options, options.scenes, [&](const NamedScene& scene, std::size_t objects) {
    const auto n = static_cast<double>(objects);
    steps.push_back(
        {named(scene, objects), options.quick ? 0.1 : 0.4 + n * 5.5e-5,
         [=](Results& results) { measure_throughput(results, options, scene, objects); }});
    if (!options.peers || objects > kLargestForPeers) return;
    steps.push_back({named(scene, objects) + ", other libraries", n * 6e-5,
                     [=](Results& results) { measure_peers(results, options, scene, objects); }});
  });
  plan_every_scene(options, steps);
  plan_cold(options, steps);
  plan_filters(options, steps);
  const std::size_t keyed = objects_up_to(options, 10'000);
  steps.push_back({"keys", options.quick ? 0.1 : 1.5, [=, quick = options.quick](Results& results) {
                     measure_keys(results, keyed, quick);
                   }});
  const std::size_t limited = objects_up_to(options, 100'000);
  steps.push_back({"limits", options.quick ? 0.1 : 1.0, [=](Results& results) {
                     for (const NamedScene& scene : options.scenes) {
                       add_limit(results, scene.name, scene.objects(limited));
                     }
                   }});
  return steps;
}

/// Memory depends little on the scene: an even one and one of many sizes.
ReportSteps plan_memory(const ReportOptions& options) {
  ReportSteps steps;
  const auto scenes = few_scenes(options, {"uniform", "mixed"});
  each_size(options, scenes, [&](const NamedScene& scene, std::size_t objects) {
    if (objects > kLargestForMemory) return;
    steps.push_back(
        {named(scene, objects), 0.1 + static_cast<double>(objects) * 1.5e-5, [=](Results& results) {
           add_footprints_apart(results, scene, objects, options.seed, options.threads.back());
         }});
  });
  return steps;
}

ReportSteps plan_ranks(const ReportOptions& options) {
  ReportSteps steps;
  for (const NamedScene& scene : few_scenes(options, {"uniform", "clustered"})) {
    ClusterQuestion asked{.scene = scene, .ranks = {1, 2, 3, 8, 64, 512}, .seed = options.seed};
    asked.is_uniform = scene.name == "uniform" && !scene.is_recording();
    if (options.quick) {
      asked.objects = 500;
      asked.frames = 3;
      asked.ranks = {1, 2, 8};
    }
    steps.push_back({"ranks: " + scene.name, options.quick ? 0.1 : 3.0,
                     [asked](Results& results) { add_cluster_runs(results, asked); }});
  }
  return steps;
}

ReportSteps plan_volumes(const ReportOptions& options) {
  ReportSteps steps;
  const auto all = volume_questions(options);
  for (const VolumeQuestion& asked : all) add_volume_step(steps, asked, "volumes");
  for (VolumeQuestion asked : all) {
    if (asked.setting != "cubes" && !asked.scene.is_recording()) continue;
    for (const std::string_view partition : volume_partitions()) {
      const bool is_quadratic = partition == "BoundsNSquared" && asked.objects > 2000;
      const bool is_left_out = options.quick && partition != "FlatGrid";
      if (partition == kVolumesPartition || is_quadratic || is_left_out) continue;
      asked.partition = partition;
      add_volume_step(steps, asked, "volumes");
    }
  }
  VolumeQuestion cubes = *std::find_if(
      all.begin(), all.end(), [](const VolumeQuestion& one) { return one.setting == "cubes"; });
  // Ways of objects in a frame, in edges, at which margins are compared.
  for (const double step : {0.001, 0.003, 0.01, 0.03, 0.1}) {
    if (options.quick && step != 0.001 && step != 0.1) continue;
    cubes.step = step;
    add_volume_step(steps, cubes, "margins");
  }
  return steps;
}

/// Sizes that are all alike, and sizes that are not.
ReportSteps plan_queries(const ReportOptions& options) {
  const std::size_t objects = objects_up_to(options, 100'000);
  ReportSteps steps;
  const auto add = [&](const NamedScene& scene, std::size_t rays, int threads,
                       const std::string& partition) {
    const QueryMeasureOptions asked{.objects = objects,
                                    .seed = options.seed,
                                    .partitions = {partition},
                                    .threads = threads,
                                    .rays = rays,
                                    .rounds = options.quick ? 2U : 5U,
                                    .machine_clock = false,
                                    .peers = options.peers};
    const double partitions = partition == "all" ? 9.0 : 2.0;
    steps.push_back({scene.name + ", " + threads_text(threads),
                     1e-4 * partitions * static_cast<double>(rays),
                     [=](Results& results) { add_queries(results, scene, asked); }});
  };
  const auto scenes = few_scenes(options, {"uniform", "mixed"});
  for (const NamedScene& scene : scenes) {
    const bool is_first = &scene == &scenes.front();
    const std::size_t rays = options.quick ? 100 : is_first ? 10'000 : 5'000;
    add(scene, rays, 1, "all");
    const int most = options.threads.back();
    if (most != 1 && is_first) add(scene, rays, most, "LinearBvh");
  }
  if (!std::all_of(scenes.begin(), scenes.end(),
                   [](const NamedScene& one) { return one.is_recording(); })) {
    steps.push_back({"frusta", 1.0, [objects, quick = options.quick](Results& results) {
                       add_frusta(results, objects, quick ? 2 : 15);
                     }});
  }
  return steps;
}

ReportSteps plan_advice(const ReportOptions& options) {
  ReportSteps steps;
  for (const NamedScene& scene : options.scenes) {
    const std::size_t objects = scene.objects(objects_up_to(options, 10'000));
    const std::size_t wanted = options.quick ? 9 : 41;
    const std::size_t frames =
        scene.is_recording() ? std::min(wanted, scene.recording->frames.size()) : wanted;
    for (const int threads : options.threads) {
      steps.push_back({scene.name + ", " + threads_text(threads),
                       0.1 + (options.quick ? 0.0 : static_cast<double>(objects) * 1.1e-4),
                       [=, seed = options.seed](Results& results) {
                         add_advice(results, scene, objects, seed,
                                    partitions_for({"all"}, objects).taken, frames, threads);
                       }});
    }
  }
  return steps;
}

}  // namespace winnow::bench
