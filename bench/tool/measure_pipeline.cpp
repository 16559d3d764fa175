#include "tool/measure_pipeline.h"

#include "engine/reference_sweep.h"

#include <algorithm>
#include <cmath>
#include <optional>

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

void tick(std::optional<MachineClock>& clock) {
  for (int i = 0; clock && i < kTicks; ++i) clock->tick();
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

std::unique_ptr<BodySet> make_pipeline_scene(const std::string& scene, std::size_t bodies,
                                             std::uint64_t seed) {
  if (scene == "pile") return make_heap(bodies != 0 ? bodies : kPileBodies, seed);
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
        {make_winnow_scene(threads, options.resting ? kCarryOver : 0.0, options.level), threads});
  }
  if (options.peers) {
    for (std::unique_ptr<SceneEngine>& peer : scene_peers()) {
      if (options.resting && !peer->carries_over()) continue;
      measured.peers.push_back(peer->name());
      contenders.push_back({std::move(peer), 1});
    }
  }
  std::optional<MachineClock> clock;
  if (options.machine_clock) clock.emplace();
  tick(clock);
  measured.timings =
      race_scene(*set, options.resting ? kResting : kMoving, contenders, options.frames);
  tick(clock);
  if (clock) measured.machine_ms = clock->median_ms();
  return measured;
}

MeshMeasurement measure_meshes(std::size_t rounds, bool peers, bool machine_clock) {
  std::vector<std::unique_ptr<MeshEngine>> engines;
  engines.push_back(make_winnow_mesh());
  if (peers) {
    for (std::unique_ptr<MeshEngine>& peer : mesh_peers()) engines.push_back(std::move(peer));
  }
  MeshMeasurement measured;
  std::optional<MachineClock> clock;
  if (machine_clock) clock.emplace();
  tick(clock);
  measured.timings = race_meshes(engines, rounds);
  tick(clock);
  if (clock) measured.machine_ms = clock->median_ms();
  return measured;
}

}  // namespace winnow::bench
