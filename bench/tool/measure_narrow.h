#pragma once

#include "narrow/narrow_race.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace winnow::bench {

/// Sets of more pairs than this are too large for the caches: their bodies lie in random order.
inline constexpr std::size_t kMostPairsInCache = 16'384;

/// A race on the pairs of one kind.
struct NarrowMeasureOptions {
  PairKind kind;
  std::size_t pairs = 8192;
  std::vector<ContactLevel> levels{ContactLevel::boolean, ContactLevel::distance,
                                   ContactLevel::manifold};
  std::vector<NarrowTier> tiers{NarrowTier::robust};
  std::vector<int> threads{1};  ///< winnow's; other libraries use one
  bool peers = false;           ///< other libraries too, where the tool was built with them
  std::uint64_t seed = 1;
  NarrowRaceOptions race{};
};

struct NarrowMeasurement {
  PairKind kind;
  std::size_t pairs = 0;
  std::vector<NarrowTiming> timings;
  std::vector<std::string> peers;  ///< names of the other libraries that took part
  double machine_ms = 0.0;         ///< of the MachineClock, interleaved with the race

  [[nodiscard]] bool is_peer(const NarrowTiming& timing) const noexcept;
  /// Null if there is none.
  [[nodiscard]] const NarrowTiming* find(NarrowTier tier, ContactLevel level,
                                         int threads = 1) const noexcept;
  /// False for what is systematically wrong: verdicts in more than 1 of 100 pairs, other depths in
  /// more than 1 of 10, or less than half as many contacts as the first engine of the level finds.
  [[nodiscard]] bool is_right(const NarrowTiming& timing) const noexcept;
  /// Of the other libraries that are right the fastest; null if there is none.
  [[nodiscard]] const NarrowTiming* best_peer(ContactLevel level) const noexcept;
};

[[nodiscard]] NarrowMeasurement measure_narrow(const NarrowMeasureOptions& options);

/// The other libraries that answer pairs; none if the tool was built without.
[[nodiscard]] std::vector<std::unique_ptr<NarrowEngine>> narrow_peers();

}  // namespace winnow::bench
