#pragma once

#include <cstddef>
#include <vector>

namespace winnow::bench {

/// Measures `count` contenders in turns and returns the results by contender and round.
/// `turn(round, i)` runs contender i once and returns its measurement. Each round runs all
/// contenders, so that disturbances of the machine affect all alike. The first `warming` rounds are
/// dropped.
template <typename Turn>
std::vector<std::vector<double>> run_interleaved(std::size_t count, std::size_t rounds,
                                                 std::size_t warming, Turn&& turn) {
  std::vector<std::vector<double>> taken(count);
  for (std::size_t round = 0; round < warming + rounds; ++round) {
    for (std::size_t i = 0; i < count; ++i) {
      const double one = turn(round, i);
      if (round >= warming) taken[i].push_back(one);
    }
  }
  return taken;
}

}  // namespace winnow::bench
