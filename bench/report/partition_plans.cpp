// Plans the report's sections about partitions: for each scene and size, which races run, with how
// many frames, and an estimate of the time. report.cpp runs the steps; bench/rows has the
// measurements.

#include "bench/common/table.h"
#include "bench/contenders/partitions.h"
#include "bench/report/section.h"
#include "bench/rows/advice_rows.h"
#include "bench/rows/cluster_rows.h"
#include "bench/rows/cold_rows.h"
#include "bench/rows/every_scene_rows.h"
#include "bench/rows/frame_rows.h"
#include "bench/rows/memory_rows.h"
#include "bench/scenes/scene.h"

#include <algorithm>
#include <initializer_list>
#include <limits>
#include <stdexcept>

namespace winnow::bench {
namespace {

constexpr std::size_t kLargestForPeers = 150'000;
constexpr std::size_t kLargestForMemory = 150'000;
/// With more objects, the structures of all instruction sets at once would exceed the memory.
constexpr std::size_t kLargestForOneRace = 300'000;

/// Returns the largest requested number of objects up to `most`, or the smallest requested.
std::size_t objects_up_to(const ReportOptions& options, std::size_t most) {
  std::size_t chosen = options.objects.front();
  for (const std::size_t objects : options.objects) {
    if (objects <= most) chosen = objects;
  }
  return chosen;
}

/// Returns the requested scenes. If they are the default ones, only those named in `few`.
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

/// Calls visit(scene, objects) for each scene and size; a recording has only one size.
template <typename Visit>
void each_size(const ReportOptions& options, const std::vector<NamedScene>& scenes, Visit visit) {
  for (const NamedScene& scene : scenes) {
    for (const std::size_t requested : options.objects) {
      visit(scene, scene.objects(requested));
      if (scene.is_recording()) break;
    }
  }
}

/// Returns the number of frames whose median is stable at little cost.
std::size_t throughput_frames(const ReportOptions& options, std::size_t objects) {
  if (options.quick) return 4;
  if (objects <= 2'000) return 31;
  if (objects <= 20'000) return 21;
  return objects <= kLargestForOneRace ? 11 : 6;
}

std::size_t frames_of_slow(const ReportOptions& options, std::size_t objects) {
  return options.quick || objects > 20'000 ? kFingerprintFrames : 6;
}

/// Runs one race of all instruction sets, or one race each if there are too many objects.
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

/// Measures partitions without a size limit first, then the slower ones.
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

/// Measures other libraries with the largest number of threads, together with a partition that must
/// find the same pairs.
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

/// Measures the requested scenes; all scenes if the default ones are requested.
void plan_every_scene(const ReportOptions& options, ReportSteps& steps) {
  std::vector<std::string> names;
  for (const NamedScene& scene : options.scenes) names.push_back(scene.name);
  const auto scenes = names == main_scenes() ? named_scenes(scene_names()) : options.scenes;
  for (const NamedScene& scene : scenes) {
    EverySceneOptions request{.scene = scene,
                              .objects = scene.objects(objects_up_to(options, 10'000)),
                              .seed = options.seed,
                              .threads = options.threads.front(),
                              .yardstick = options.yardstick};
    if (options.quick) request.frames = kSettlingFrames + 3;
    steps.push_back({named(scene, request.objects) + ", worst frames",
                     0.05 + 1e-8 * static_cast<double>(request.frames * request.objects * 60),
                     [=](Results& results) { add_every_scene(results, request); }});
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
  const std::size_t limited = objects_up_to(options, 100'000);
  steps.push_back({"limits", options.quick ? 0.1 : 1.0, [=](Results& results) {
                     for (const NamedScene& scene : options.scenes) {
                       add_limit(results, scene.name, scene.objects(limited));
                     }
                   }});
  return steps;
}

/// Measures two scenes, one with equal sizes and one with mixed sizes: memory depends little on the
/// scene.
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
    ClusterRowOptions request{.scene = scene, .ranks = {1, 2, 3, 8, 64, 512}, .seed = options.seed};
    request.is_uniform = scene.name == "uniform" && !scene.is_recording();
    if (options.quick) {
      request.objects = 500;
      request.frames = 3;
      request.ranks = {1, 2, 8};
    }
    steps.push_back({"ranks: " + scene.name, options.quick ? 0.1 : 3.0,
                     [request](Results& results) { add_cluster_runs(results, request); }});
  }
  return steps;
}

ReportSteps plan_advice(const ReportOptions& options) {
  ReportSteps steps;
  for (const NamedScene& scene : options.scenes) {
    const std::size_t objects = scene.objects(objects_up_to(options, 10'000));
    const std::size_t requested = options.quick ? 9 : 41;
    const std::size_t frames =
        scene.is_recording() ? std::min(requested, scene.recording->frames.size()) : requested;
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
