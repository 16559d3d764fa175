#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace winnow::bench {

/// Options of a race between `collide` at the poses of a scene and sweeps.
struct SweepRaceOptions {
  std::size_t bodies = 10'000;
  std::size_t fast = 1'000;  ///< fast bodies among them
  int threads = 1;
  std::size_t frames = 9;
  std::uint64_t seed = 1;
};

struct SweepTiming {
  std::vector<double> collide_ms{};  ///< all contacts of the bodies at their poses
  std::vector<double> sweep_ms{};    ///< sweep of the fast bodies against all others and each other
  std::vector<double> all_ms{};      ///< the same sweep, with all other bodies moving a little
  // Counts of the sweep of the fast bodies in the last frame.
  std::size_t pairs = 0;
  std::size_t impacts = 0;
};

/// Times `collide` and sweeps in turns on a heap in which some bodies move by up to ten times their
/// size per frame, in random directions, while the others jitter.
[[nodiscard]] SweepTiming measure_sweeps(const SweepRaceOptions& options);

}  // namespace winnow::bench
