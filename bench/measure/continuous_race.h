#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace winnow::bench {

/// Options of a race between `collide` at the poses of a scene and continuous collision detection.
struct ContinuousRaceOptions {
  std::size_t bodies = 10'000;
  std::size_t fast = 1'000;  ///< fast bodies among them
  int threads = 1;
  std::size_t frames = 9;
  std::uint64_t seed = 1;
};

struct ContinuousTiming {
  std::vector<double> collide_ms{};  ///< all contacts of the bodies at their poses
  std::vector<double> impacts_ms{};  ///< impacts of the fast bodies; all other bodies rest
  std::vector<double> all_ms{};      ///< impacts of the fast bodies; all other bodies move a little
  // Counts for the fast bodies in the last frame.
  std::size_t pairs = 0;
  std::size_t impacts = 0;
};

/// Times `collide` and `find_impacts` in turns on a heap. In each frame the fast bodies move by up
/// to ten times their size in random directions, and all other bodies by a little.
[[nodiscard]] ContinuousTiming measure_continuous_collision(const ContinuousRaceOptions& options);

}  // namespace winnow::bench
