#pragma once

#include "bench/rows/results.h"

#include <cstddef>
#include <string>
#include <vector>

namespace winnow::bench {

/// A simulation of fast motion in which nothing may tunnel through anything.
struct BarrierRowOptions {
  std::string scene = "funnel";  ///< see barrier_names()
  std::size_t steps = 200;
  /// Number of bodies, or of vertices along an edge of the cloth; 0 chooses a size that suits the
  /// scene.
  std::size_t size = 0;
  int threads = 1;
};

/// Runs one simulation and adds its row. Returns false if something tunnelled.
bool add_barrier(Results& results, const BarrierRowOptions& row_options);

/// Returns "funnel", "blade", "cloth".
[[nodiscard]] std::vector<std::string> barrier_names();

}  // namespace winnow::bench
