#include "tool/measure_pipeline.h"

#include "engine/reference_sweep.h"

#include <algorithm>

#if WINNOW_HAVE_PEERS
#include "peers/peers.h"
#endif

namespace winnow::bench {
namespace {

constexpr std::size_t kPileBodies = 20'000;
constexpr std::size_t kTerrainBodies = 2'000;
/// 200,978 triangles.
constexpr std::uint32_t kTerrainCells = 317;
constexpr int kTicks = 3;

std::vector<std::unique_ptr<SceneEngine>> scene_peers() {
#if WINNOW_HAVE_PEERS
  return make_scene_peers();
#else
  return {};
#endif
}

std::vector<std::unique_ptr<MeshEngine>> mesh_peers() {
#if WINNOW_HAVE_PEERS
  return make_mesh_peers();
#else
  return {};
#endif
}

void tick(MachineClock& clock) {
  for (int i = 0; i < kTicks; ++i) clock.tick();
}

}  // namespace

const SceneTiming* PipelineMeasurement::winnow(int threads) const noexcept {
  for (const SceneTiming& timing : timings) {
    const bool is_peer = std::find(peers.begin(), peers.end(), timing.engine) != peers.end();
    if (!is_peer && timing.threads == threads) return &timing;
  }
  return nullptr;
}

const SceneTiming* PipelineMeasurement::peer(const std::string& name) const noexcept {
  for (const SceneTiming& timing : timings) {
    if (timing.engine == name) return &timing;
  }
  return nullptr;
}

PipelineMeasurement measure_pipeline(const PipelineMeasureOptions& options) {
  const auto set = options.scene == "pile"
                       ? make_heap(kPileBodies, options.seed)
                       : make_landscape(kTerrainBodies, kTerrainCells, options.seed);
  PipelineMeasurement measured;
  measured.bodies = set->poses.size();
  measured.triangles = set->mesh.size();
  std::vector<SceneContender> contenders;
  for (const int threads : options.threads) {
    contenders.push_back(
        {make_winnow_scene(threads, options.resting ? kCarryOver : 0.0, options.level), threads});
  }
  if (options.peers) {
    for (std::unique_ptr<SceneEngine>& peer : scene_peers()) {
      if (options.resting && !peer->carries_over()) continue;
      measured.peers.push_back(peer->name());
      contenders.push_back({std::move(peer), 1});
    }
  }
  MachineClock clock;
  tick(clock);
  measured.timings =
      race_scene(*set, options.resting ? kResting : kMoving, contenders, options.frames);
  tick(clock);
  measured.machine_ms = clock.median_ms();
  return measured;
}

MeshMeasurement measure_meshes(std::size_t rounds, bool peers) {
  std::vector<std::unique_ptr<MeshEngine>> engines;
  engines.push_back(make_winnow_mesh());
  if (peers) {
    for (std::unique_ptr<MeshEngine>& peer : mesh_peers()) engines.push_back(std::move(peer));
  }
  MeshMeasurement measured;
  MachineClock clock;
  tick(clock);
  measured.timings = race_meshes(engines, rounds);
  tick(clock);
  measured.machine_ms = clock.median_ms();
  return measured;
}

}  // namespace winnow::bench
