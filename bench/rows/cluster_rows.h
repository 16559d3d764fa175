#pragma once

#include "bench/rows/named_scene.h"
#include "bench/rows/results.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace winnow::bench {

/// A scene on virtual ranks within this process. The counts of objects held and bytes sent equal
/// those with one process for each rank.
struct ClusterRowOptions {
  NamedScene scene;
  std::size_t objects = 20'000;
  std::size_t frames = 6;
  std::vector<std::uint32_t> ranks;  ///< ascending; the first is 1, the reference
  std::uint64_t seed = 1;
  /// The objects are spread evenly, so that the formula for ghosts holds, also for 1e9 objects.
  bool is_uniform = false;
};

/// Declares cluster_runs and cluster_model.
void declare_cluster_runs(Results& results);
/// Adds the rows. Throws std::runtime_error if a number of ranks finds other pairs than one rank.
void add_cluster_runs(Results& results, const ClusterRowOptions& asked);

/// Returns the number of ghosts for each body that a rank owns, if `ranks` ranks share a cube with
/// `objects` evenly spread boxes of edge `edge`, `density` of them in a unit of volume. The ghosts
/// are in the rank's cube grown by half an edge on all sides, minus the cube itself.
[[nodiscard]] double ghosts_by_formula(double objects, double ranks, double density, double edge);

}  // namespace winnow::bench
