#pragma once

#include "bench/rows/results.h"

#include <cstddef>
#include <string>
#include <vector>

namespace winnow::bench {

/// Something fast of which nothing may pass through anything.
struct BarrierQuestion {
  std::string scene = "funnel";  ///< see barrier_names()
  std::size_t steps = 200;
  /// Bodies, or vertices along an edge of the cloth; 0: as many as suit it.
  std::size_t size = 0;
  int threads = 1;
};

/// barriers.
void declare_barriers(Results& results);
/// Runs one. False if something passed through.
bool add_barrier(Results& results, const BarrierQuestion& asked);

/// "funnel", "blade", "cloth".
[[nodiscard]] std::vector<std::string> barrier_names();

}  // namespace winnow::bench
