#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace winnow::bench {

/// Frames of a scene that is collided as it stands, and swept.
struct SweepRaceOptions {
  std::size_t bodies = 10'000;
  std::size_t fast = 1'000;  ///< of them
  int threads = 1;
  std::size_t frames = 9;
  std::uint64_t seed = 1;
};

struct SweepTiming {
  std::vector<double> collide_ms{};  ///< all contacts of the bodies where they are
  std::vector<double> sweep_ms{};    ///< the fast bodies against all others and each other
  std::vector<double> all_ms{};      ///< the same where all others move a little, too
  // Of the fast ones in the last frame.
  std::size_t pairs = 0;
  std::size_t impacts = 0;
};

/// A heap of which some bodies fly by up to ten times their size in a frame, in random directions,
/// while the others tremble. The scene's contacts beside sweeps, in turns.
[[nodiscard]] SweepTiming measure_sweeps(const SweepRaceOptions& options);

}  // namespace winnow::bench
