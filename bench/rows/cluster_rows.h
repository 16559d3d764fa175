#pragma once

#include "bench/rows/named_scene.h"
#include "bench/rows/results.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace winnow::bench {

/// A scene on virtual ranks within this process. The number of objects of each rank and the number
/// of bytes sent are the same as with one process for each rank.
struct ClusterRowOptions {
  NamedScene scene;
  std::size_t objects = 20'000;
  std::size_t frames = 6;
  std::vector<std::uint32_t> ranks;  ///< ascending; the first is 1, the reference
  std::uint64_t seed = 1;
  /// True if the objects are spread evenly. The formula for ghosts is then added to the rows, and
  /// `cluster_model` gets its predictions for up to 1e9 objects.
  bool is_uniform = false;
};

/// Adds the rows. Throws std::runtime_error if a number of ranks finds other pairs than one rank.
void add_cluster_runs(Results& results, const ClusterRowOptions& options);

/// Returns the number of ghosts for each body that a rank owns, if `ranks` ranks share a cube with
/// `objects` evenly spread boxes of edge `edge`, `density` of them in a unit of volume. The centres
/// of the ghosts are in the rank's cube grown by half an edge on all sides, minus the cube itself.
[[nodiscard]] double ghosts_by_formula(double objects, double ranks, double density, double edge);

}  // namespace winnow::bench
