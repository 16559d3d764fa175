#pragma once

#include "engine/key_costs.h"
#include "goals/kernel_times.h"
#include "queries/query_costs.h"
#include "tool/measure.h"
#include "tool/measure_narrow.h"
#include "tool/measure_pipeline.h"
#include "tool/measure_queries.h"

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

namespace winnow::bench {

/// Measures what goals ask about, each thing once.
class Lab {
 public:
  /// The 10k reference sweep, in ms, on the machine on which the existing libraries were timed.
  static constexpr double kReferenceMachineMs = 23.0;

  /// Every partition that suits the size on 1 and 2 threads, interleaved.
  const Measurement& cell(const std::string& scene, std::size_t objects);
  /// A partition's time on one scene over its time on another, one thread: the median of rounds in
  /// which both scenes take turns.
  double scene_ratio(const std::string& partition, const std::string& scene, const std::string& of,
                     std::size_t objects);
  /// Every partition on every instruction set, one thread, interleaved.
  const Measurement& by_isa(const std::string& scene, std::size_t objects);
  /// The other libraries that are installed, over fewer frames; no runs if there are none.
  const Measurement& peers(const std::string& scene, std::size_t objects);
  /// What operations on keys cost one partition.
  const KeyCosts& keys(const std::string& partition, std::size_t objects, bool random_order);

  /// The kernels on every instruction set; none if their benchmarks are not built.
  const std::optional<KernelTimes>& kernels();
  /// What one partition holds without results, the more of 1 and 2 threads.
  double bytes_per_object(const std::string& partition, const std::string& scene,
                          std::size_t objects);

  /// One partition and the other libraries that answer questions, one thread, interleaved.
  const QueryMeasurement& queries(const std::string& partition, const std::string& scene,
                                  std::size_t objects);
  /// Frusta of a set on the `frustum_partitions`. Throws Refusal.
  const FrustumCosts& frustum(const std::string& set, std::size_t objects);
  [[nodiscard]] static std::vector<std::string> frustum_partitions() {
    return {"BoundsNSquared", "FlatGrid", "LinearBvh"};
  }

  /// Pairs of one kind, fast and robust on one thread, robust on two if there are too many pairs
  /// for the caches, and the other libraries, interleaved.
  const NarrowMeasurement& narrow(const std::string& kind, std::size_t pairs);

  /// winnow on 1 and 2 threads and the other libraries on a scene of the pipeline, interleaved.
  const PipelineMeasurement& pipeline(const std::string& scene, bool resting);
  /// winnow and the other libraries on two tori, interleaved.
  const MeshMeasurement& meshes();

  /// How much slower this machine was while the cell was measured than the reference machine.
  [[nodiscard]] static double scale(const Measurement& cell) noexcept {
    return cell.machine_ms / kReferenceMachineMs;
  }
  /// The machine's clock in every cell measured so far. Far apart, the run was disturbed.
  [[nodiscard]] Spread machine_ms() const;
  /// The partitions that test bounds: all but the baseline that does not.
  [[nodiscard]] static std::vector<std::string> testing_partitions();

 private:
  using Where = std::pair<std::string, std::size_t>;

  std::optional<std::optional<KernelTimes>> kernels_;  // empty: not measured yet
  std::map<Where, Measurement> cells_;
  /// By partition, one entry a round.
  using Ratios = std::map<std::string, std::vector<double>>;
  static Ratios measure_ratios(const std::string& scene, const std::string& of,
                               std::size_t objects);

  std::map<std::tuple<std::string, std::string, std::size_t>, Ratios> ratios_;
  std::map<Where, Measurement> by_isa_;
  std::map<Where, Measurement> peers_;
  std::map<std::tuple<std::string, std::size_t, bool>, KeyCosts> keys_;
  std::map<std::tuple<std::string, std::string, std::size_t>, QueryMeasurement> queries_;
  std::map<Where, FrustumCosts> frustum_;
  std::map<Where, NarrowMeasurement> narrow_;
  std::map<std::pair<std::string, bool>, PipelineMeasurement> pipeline_;
  std::optional<MeshMeasurement> meshes_;
};

}  // namespace winnow::bench
