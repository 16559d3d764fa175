// Races winnow's Scene and other libraries on scenes of bodies (pile, terrain, balls), and meshes
// on two tori. bench/rows/scene_rows.cpp calls it.

#include "bench/measure/scene_race.h"

#include "bench/common/interleaved_runs.h"
#include "bench/common/timed.h"
#include "bench/contenders/reference_sweep.h"
#include "bench/peers/peers.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace winnow::bench {

namespace {

constexpr std::size_t kWarming = 2;

/// Counts pairs in only one of the lists, after sorting both and removing duplicates.
std::size_t count_differing(MeshEngine::TrianglePairs& a, MeshEngine::TrianglePairs& b) {
  for (MeshEngine::TrianglePairs* pairs : {&a, &b}) {
    std::sort(pairs->begin(), pairs->end());
    pairs->erase(std::unique(pairs->begin(), pairs->end()), pairs->end());
  }
  MeshEngine::TrianglePairs differ;
  std::set_symmetric_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(differ));
  return differ.size();
}

}  // namespace

std::vector<SceneTiming> race_scene(const BodySet& set, const PoseNoise& by,
                                    std::span<SceneContender> contenders, std::size_t frames) {
  int most_threads = 1;
  std::vector<SceneTiming> timings;
  for (const SceneContender& contender : contenders) {
    most_threads = std::max(most_threads, contender.threads);
    timings.push_back({.engine = contender.engine->name(), .threads = contender.threads});
  }
  Arenas arenas(most_threads);
  for (const SceneContender& contender : contenders) contender.engine->start(set);
  std::vector<Pose> poses;
  auto ms = run_interleaved(contenders.size(), frames, kWarming, [&](std::size_t f, std::size_t i) {
    if (i == 0) apply_pose_noise(set, by, f, poses);
    return timed(contenders[i].threads, arenas, [&] { contenders[i].engine->frame(poses); });
  });
  for (std::size_t i = 0; i < contenders.size(); ++i) {
    timings[i].ms = std::move(ms[i]);
    timings[i].finds = contenders[i].engine->finds();
    timings[i].bytes = contenders[i].engine->bytes();
  }
  return timings;
}

std::vector<MeshTiming> race_meshes(std::span<const std::unique_ptr<MeshEngine>> engines,
                                    std::size_t rounds) {
  const Triangles torus = make_race_torus();
  Arenas arenas(1);
  const auto turns = [&](std::size_t warming, const auto& work) {
    return run_interleaved(engines.size(), rounds, warming, [&](std::size_t, std::size_t i) {
      return timed(1, arenas, [&] { work(*engines[i]); });
    });
  };
  std::vector<MeshTiming> timings(engines.size());
  auto build_ms = turns(0, [&](MeshEngine& engine) { engine.build(torus); });
  for (std::size_t i = 0; i < engines.size(); ++i) {
    timings[i].engine = engines[i]->name();
    timings[i].build_ms = std::move(build_ms[i]);
  }
  for (std::size_t p = 0; p < torus_poses().size(); ++p) {
    const Pose& pose = torus_poses()[p].pose;
    auto ms = turns(kWarming, [&](MeshEngine& engine) { engine.collide(Pose{}, pose); });
    MeshEngine::TrianglePairs expected = engines.front()->pairs();
    for (std::size_t i = 0; i < engines.size(); ++i) {
      MeshEngine::TrianglePairs found = engines[i]->pairs();
      timings[i].collide_ms[p] = std::move(ms[i]);
      timings[i].differ[p] = count_differing(expected, found);
      timings[i].pairs[p] = found.size();
      timings[i].bytes_per_triangle =
          static_cast<double>(engines[i]->bytes()) / static_cast<double>(torus.size());
    }
  }
  return timings;
}

namespace {

constexpr std::size_t kPileBodies = 20'000;
constexpr std::size_t kBalls = 100'000;
constexpr std::size_t kTerrainBodies = 2'000;
/// 200,978 triangles.
constexpr std::uint32_t kTerrainCells = 317;
constexpr int kTicks = 3;

void tick(MachineClock& clock) {
  for (int i = 0; i < kTicks; ++i) clock.tick();
}

}  // namespace

std::unique_ptr<BodySet> make_pipeline_scene(const std::string& scene, std::size_t bodies,
                                             std::uint64_t seed) {
  if (scene == "pile") return make_heap(bodies != 0 ? bodies : kPileBodies, seed);
  if (scene == "balls") return make_balls(bodies != 0 ? bodies : kBalls, seed);
  if (bodies == 0) return make_landscape(kTerrainBodies, kTerrainCells, seed);
  const double share = static_cast<double>(bodies) / static_cast<double>(kTerrainBodies);
  const auto cells = static_cast<std::uint32_t>(std::lround(kTerrainCells * std::sqrt(share)));
  return make_landscape(bodies, std::max(1U, cells), seed);
}

PipelineMeasurement measure_pipeline(const PipelineMeasureOptions& options) {
  std::unique_ptr<BodySet> made;
  if (options.set == nullptr) {
    made = make_pipeline_scene(options.scene, options.bodies, options.seed);
  }
  const BodySet* set = options.set != nullptr ? options.set : made.get();
  PipelineMeasurement measured;
  measured.bodies = set->poses.size();
  measured.triangles = set->mesh.size();
  std::vector<SceneContender> contenders;
  for (const int threads : options.threads) {
    contenders.push_back(
        {make_winnow_scene(threads, {.cache_tolerance = options.resting ? kCacheTolerance : 0.0,
                                     .level = options.level}),
         threads});
  }
  if (options.peers) {
    for (std::unique_ptr<SceneEngine>& peer : make_scene_peers()) {
      if (options.resting && !peer->caches_contacts()) continue;
      contenders.push_back({std::move(peer), 1});
    }
  }
  MachineClock clock(options.machine_clock);
  tick(clock);
  measured.timings =
      race_scene(*set, options.resting ? kResting : kMoving, contenders, options.frames);
  tick(clock);
  measured.machine_ms = clock.median_ms();
  return measured;
}

std::vector<SceneCost> measure_scene_costs(const SceneCostOptions& options) {
  constexpr double kMargin = 0.02;
  const std::unique_ptr<BodySet> set =
      make_pipeline_scene(options.scene, options.bodies, options.seed);
  std::vector<SceneCost> costs;
  std::vector<SceneContender> contenders;
  for (const ContactLevel level : {ContactLevel::distance, ContactLevel::manifold}) {
    for (const double contact_margin : {0.0, kMargin}) {
      costs.push_back({.level = level, .contact_margin = contact_margin, .timing = {}});
      contenders.push_back(
          {make_winnow_scene(options.threads, {.level = level, .contact_margin = contact_margin}),
           options.threads});
    }
  }
  std::vector<SceneTiming> timings = race_scene(*set, kMoving, contenders, options.frames);
  for (std::size_t i = 0; i < costs.size(); ++i) costs[i].timing = std::move(timings[i]);
  return costs;
}

MeshMeasurement measure_meshes(std::size_t rounds, bool peers, bool machine_clock) {
  std::vector<std::unique_ptr<MeshEngine>> engines;
  engines.push_back(make_winnow_mesh());
  if (peers) {
    for (std::unique_ptr<MeshEngine>& peer : make_mesh_peers()) engines.push_back(std::move(peer));
  }
  MeshMeasurement measured;
  MachineClock clock(machine_clock);
  tick(clock);
  measured.timings = race_meshes(engines, rounds);
  tick(clock);
  measured.machine_ms = clock.median_ms();
  return measured;
}

}  // namespace winnow::bench
