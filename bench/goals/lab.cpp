#include "goals/lab.h"

#include <winnow/partitions/partition.h>

#include <algorithm>

namespace winnow::bench {
namespace {

MeasureOptions race_on(const std::string& scene, std::size_t objects) {
  MeasureOptions options;
  options.scene = scene;
  options.objects = objects;
  options.frames = objects <= 20'000 ? 81 : objects <= 300'000 ? 26 : 8;
  return options;
}

}  // namespace

const Measurement& Lab::cell(const std::string& scene, std::size_t objects) {
  const auto [at, fresh] = cells_.try_emplace({scene, objects});
  if (fresh) {
    MeasureOptions options = race_on(scene, objects);
    options.threads = {1, 2};
    options.machine_clock = true;
    at->second = measure(options);
  }
  return at->second;
}

Lab::Ratios Lab::measure_ratios(const std::string& scene, const std::string& of,
                                std::size_t objects) {
  constexpr int kRounds = 7;
  MeasureOptions part = race_on(scene, objects);
  part.frames = objects <= 20'000 ? 21 : 9;
  MeasureOptions whole = part;
  whole.scene = of;
  Ratios ratios;
  for (int round = 0; round < kRounds; ++round) {
    const Measurement a = measure(part);
    const Measurement b = measure(whole);
    for (std::size_t i = 0; i < a.partition_runs; ++i) {
      ratios[a.runs[i].engine].push_back(a.runs[i].median_ms() / b.runs[i].median_ms());
    }
  }
  return ratios;
}

double Lab::scene_ratio(const std::string& partition, const std::string& scene,
                        const std::string& of, std::size_t objects) {
  const auto [at, fresh] = ratios_.try_emplace({scene, of, objects});
  if (fresh) at->second = measure_ratios(scene, of, objects);
  return median_of(at->second[partition]);
}

const Measurement& Lab::by_isa(const std::string& scene, std::size_t objects) {
  const auto [at, fresh] = by_isa_.try_emplace({scene, objects});
  if (fresh) {
    MeasureOptions options = race_on(scene, objects);
    options.isas.assign(available_isas().begin(), available_isas().end());
    at->second = measure(options);
  }
  return at->second;
}

const Measurement& Lab::peers(const std::string& scene, std::size_t objects) {
  const auto [at, fresh] = peers_.try_emplace({scene, objects});
  if (fresh && has_peers()) {
    MeasureOptions options = race_on(scene, objects);
    options.partitions = {};
    options.peers = true;
    options.threads = {1, 2};
    options.frames = objects <= 20'000 ? 11 : 4;
    at->second = measure(options);
  }
  return at->second;
}

const KeyCosts& Lab::keys(const std::string& partition, std::size_t objects, bool random_order) {
  const auto [at, fresh] = keys_.try_emplace({partition, objects, random_order});
  if (fresh) at->second = measure_key_costs(partition, objects, random_order);
  return at->second;
}

const std::optional<KernelTimes>& Lab::kernels() {
  if (!kernels_) kernels_ = measure_kernels();
  return *kernels_;
}

double Lab::bytes_per_object(const std::string& partition, const std::string& scene,
                             std::size_t objects) {
  MeasureOptions options = race_on(scene, objects);
  options.partitions = {partition};
  options.threads = {1, 2};
  options.frames = 4;
  const Measurement measured = measure(options);
  double most = 0.0;
  for (const Run& run : measured.runs) most = std::max(most, measured.bytes_per_object(run));
  return most;
}

const QueryMeasurement& Lab::queries(const std::string& partition, const std::string& scene,
                                     std::size_t objects) {
  const auto [at, fresh] = queries_.try_emplace({partition, scene, objects});
  if (fresh) {
    QueryMeasureOptions options;
    options.scene = scene;
    options.objects = objects;
    options.partitions = {partition};
    options.sets = {"ray closest", "ray all", "ray all near", "box 1", "box 5", "box 20"};
    options.rays = 50'000;
    options.rounds = 7;
    options.peers = true;
    at->second = measure_queries(options);
  }
  return at->second;
}

const FrustumCosts& Lab::frustum(const std::string& set, std::size_t objects) {
  const auto at = frustum_.find({set, objects});
  if (at != frustum_.end()) return at->second;
  FrustumCosts costs = measure_frustum_costs(frustum_partitions(), set, objects);
  return frustum_.emplace(Where{set, objects}, std::move(costs)).first->second;
}

const NarrowMeasurement& Lab::narrow(const std::string& kind, std::size_t pairs) {
  const auto [at, fresh] = narrow_.try_emplace({kind, pairs});
  if (fresh) {
    at->second = measure_narrow(
        {.kind = *find_pair_kind(kind),
         .pairs = pairs,
         .tiers = {NarrowTier::fast, NarrowTier::robust},
         .threads = pairs > kMostPairsInCache ? std::vector<int>{1, 2} : std::vector<int>{1},
         .peers = true});
  }
  return at->second;
}

const PipelineMeasurement& Lab::pipeline(const std::string& scene, bool resting) {
  const auto [at, fresh] = pipeline_.try_emplace({scene, resting});
  if (fresh) {
    PipelineMeasureOptions options;
    options.scene = scene;
    options.resting = resting;
    at->second = measure_pipeline(options);
  }
  return at->second;
}

const MeshMeasurement& Lab::meshes() {
  if (!meshes_) meshes_ = measure_meshes(11, true);
  return *meshes_;
}

Spread Lab::machine_ms() const {
  std::vector<double> times;
  for (const auto& [where, cell] : cells_) times.push_back(cell.machine_ms);
  for (const auto& [where, pairs] : narrow_) times.push_back(pairs.machine_ms);
  for (const auto& [where, scene] : pipeline_) times.push_back(scene.machine_ms);
  if (meshes_) times.push_back(meshes_->machine_ms);
  return spread_of(times);
}

std::vector<std::string> Lab::testing_partitions() {
  std::vector<std::string> names;
  for (const std::string_view name : partition_names()) {
    if (name != "NSquared") names.emplace_back(name);
  }
  return names;
}

}  // namespace winnow::bench
