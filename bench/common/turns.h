#pragma once

#include <cstddef>
#include <vector>

namespace winnow::bench {

/// What `count` contenders take for their turns, by contender and round: `turn(round, i)` gives it.
/// All have a turn in each round, so that whatever disturbs the machine disturbs them alike. The
/// first `warming` rounds do not count.
template <typename Turn>
std::vector<std::vector<double>> take_turns(std::size_t count, std::size_t rounds,
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
