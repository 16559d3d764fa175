#pragma once

#include "bench/rows/named_scene.h"
#include "bench/rows/results.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace winnow::bench {

/// A scene on virtual ranks of this process: what they hold and send is counted, and is that of as
/// many processes.
struct ClusterQuestion {
  NamedScene scene;
  std::size_t objects = 20'000;
  std::size_t frames = 6;
  std::vector<std::uint32_t> ranks;  ///< ascending; the first is 1, to which others are compared
  std::uint64_t seed = 1;
  /// Objects are spread evenly, so that the formula of ghosts holds; it tells of 1e9 as well.
  bool is_uniform = false;
};

/// cluster_runs, cluster_model.
void declare_cluster_runs(Results& results);
/// Throws std::runtime_error if some number of ranks finds other pairs than one.
void add_cluster_runs(Results& results, const ClusterQuestion& asked);

/// Ghosts of each body of its own that a rank has, if `ranks` share a cube in which `objects` boxes
/// of edge `edge` are spread evenly, `density` of them in a unit of volume: a rank's cube, grown by
/// half an edge to all sides, less itself.
[[nodiscard]] double ghosts_by_formula(double objects, double ranks, double density, double edge);

}  // namespace winnow::bench
