#pragma once

#include "bench/common/sample.h"
#include "bench/contenders/narrow_engine.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace winnow::bench {

/// One engine on the pairs of one set at one level.
struct NarrowTiming {
  std::string engine;
  ContactLevel level{};
  int threads = 1;
  std::vector<double> ns{};  ///< a pair, one entry a round
  double recomputed = 0.0;   ///< share of the pairs; NaN: the engine cannot tell
  /// Verdicts that differ from those of the first engine, of `compared`.
  std::size_t disagree = 0;
  std::size_t compared = 0;
  /// Share of the pairs that overlap whose depth is given, but differs from that of the first
  /// engine by more than 1 % of the sizes.
  double other_depth = 0.0;
  /// Mean number of contacts of the pairs that overlap, at level manifold.
  double contacts = 0.0;

  [[nodiscard]] double median_ns() const { return median_of(ns); }
};

/// Who takes part, and on how many threads.
struct NarrowContender {
  std::unique_ptr<NarrowEngine> engine;
  int threads = 1;
};

/// Which of them.
struct NarrowContenderOptions {
  std::vector<NarrowTier> tiers{NarrowTier::robust};
  std::vector<int> threads{1};  ///< winnow's; other libraries use one
  bool one_a_call = false;      ///< winnow's tiers also as they answer a single pair
  bool peers = false;           ///< other libraries too, where the tool was built with them
};

/// All started with the set.
[[nodiscard]] std::vector<NarrowContender> narrow_contenders(const PairSet& set,
                                                             const NarrowContenderOptions& options);

struct NarrowRaceOptions {
  std::size_t rounds = 7;
  /// A turn lasts about so long: fast engines go over the pairs several times, slow ones over a
  /// part of them, in the next turn over the next part.
  double turn_ms = 4.0;
  /// No part is smaller than this.
  std::size_t smallest_part = 2048;
  /// Pairs whose verdicts are compared.
  std::size_t compared = 8192;
};

/// Lets all contenders that have a way to do it answer the pairs of a set at a level: once to
/// compare verdicts with those of the first, then in rounds in which they take turns. Time on one
/// thread is what the thread computed, so that other work on the machine counts for little; on
/// several it is that of the clock on the wall. The engines must have been started with the set.
[[nodiscard]] std::vector<NarrowTiming> race_pairs(const PairSet& set, ContactLevel level,
                                                   std::span<NarrowContender> contenders,
                                                   const NarrowRaceOptions& options);

/// Sets of more pairs than this are too large for the caches: their bodies lie in random order.
inline constexpr std::size_t kMostPairsInCache = 16'384;

/// A race on the pairs of one kind.
struct NarrowMeasureOptions {
  PairKind kind;
  std::size_t pairs = 8192;
  std::vector<ContactLevel> levels{ContactLevel::boolean, ContactLevel::distance,
                                   ContactLevel::manifold};
  NarrowContenderOptions contenders{};
  std::uint64_t seed = 1;
  bool upright = false;  ///< as PairSetOptions say
  NarrowRaceOptions race{};
};

struct NarrowMeasurement {
  PairKind kind;
  std::size_t pairs = 0;
  std::vector<NarrowTiming> timings;
  double machine_ms = 0.0;  ///< of the MachineClock, interleaved with the race

  /// Null if there is none.
  [[nodiscard]] const NarrowTiming* find(NarrowTier tier, ContactLevel level,
                                         int threads = 1) const noexcept;
  /// False for what is systematically wrong: verdicts in more than 1 of 100 pairs, other depths in
  /// more than 1 of 10, or less than half as many contacts as the first engine of the level finds.
  [[nodiscard]] bool is_right(const NarrowTiming& timing) const noexcept;
};

[[nodiscard]] NarrowMeasurement measure_narrow(const NarrowMeasureOptions& options);

}  // namespace winnow::bench
