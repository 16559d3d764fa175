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

/// Times of one engine on the pairs of one set at one level.
struct NarrowTiming {
  std::string engine;
  ContactLevel level{};
  int threads = 1;
  std::vector<double> ns{};  ///< ns per pair, one entry per round
  double recomputed = 0.0;   ///< share of pairs computed twice; NaN if unavailable
  /// Verdicts that differ from the first engine's, among `compared` pairs.
  std::size_t disagree = 0;
  std::size_t compared = 0;
  /// Share of the overlapping pairs whose depth differs from the first engine's by more than 1 % of
  /// the sizes; pairs without a depth do not count as different.
  double other_depth = 0.0;
  /// Mean number of contacts of the overlapping pairs, at level manifold.
  double contacts = 0.0;

  [[nodiscard]] double median_ns() const { return median_of(ns); }
};

/// An engine, and its number of threads.
struct NarrowContender {
  std::unique_ptr<NarrowEngine> engine;
  int threads = 1;
};

/// Selects the contenders.
struct NarrowContenderOptions {
  std::vector<NarrowTier> tiers{NarrowTier::robust};
  std::vector<int> threads{1};  ///< of winnow; other libraries use one
  bool one_a_call = false;      ///< also winnow's function for a single pair
  bool peers = false;           ///< also other libraries, if the tool was built with them
};

/// Makes the contenders and starts them with the set.
[[nodiscard]] std::vector<NarrowContender> narrow_contenders(const PairSet& set,
                                                             const NarrowContenderOptions& options);

struct NarrowRaceOptions {
  std::size_t rounds = 7;
  /// Approximate duration of a turn: fast engines run several times over the pairs, slow ones over
  /// a part of them, and in the next turn over the next part.
  double turn_ms = 4.0;
  /// Least number of pairs of a part.
  std::size_t smallest_part = 2048;
  /// Number of pairs whose verdicts are compared.
  std::size_t compared = 8192;
};

/// Runs all contenders that support the level on the pairs of a set: once to compare their verdicts
/// with the verdicts of the first contender, then in rounds in which they take turns. On one thread
/// the time is the thread's CPU time, which other load on the machine hardly affects; on several it
/// is wall-clock time. The engines must have been started with the set.
[[nodiscard]] std::vector<NarrowTiming> race_pairs(const PairSet& set, ContactLevel level,
                                                   std::span<NarrowContender> contenders,
                                                   const NarrowRaceOptions& options);

/// Sets with more pairs than this do not fit the caches; their bodies are in random order.
inline constexpr std::size_t kMaxPairsInCache = 16'384;

/// Options of a race on the pairs of one kind.
struct NarrowMeasureOptions {
  PairKind kind;
  std::size_t pairs = 8192;
  std::vector<ContactLevel> levels{ContactLevel::boolean, ContactLevel::distance,
                                   ContactLevel::manifold};
  NarrowContenderOptions contenders{};
  std::uint64_t seed = 1;
  bool upright = false;  ///< see PairSetOptions
  NarrowRaceOptions race{};
};

struct NarrowMeasurement {
  PairKind kind;
  std::size_t pairs = 0;
  std::vector<NarrowTiming> timings;
  double machine_ms = 0.0;  ///< of the MachineClock, interleaved with the race

  /// Returns null if no engine of this tier was measured at this level on this number of threads.
  [[nodiscard]] const NarrowTiming* find(NarrowTier tier, ContactLevel level,
                                         int threads = 1) const noexcept;
  /// Returns false for systematic errors: verdicts that differ in more than 1 of 100 pairs, depths
  /// in more than 1 of 10, or fewer than half the contacts of the first engine of the level.
  [[nodiscard]] bool is_right(const NarrowTiming& timing) const noexcept;
};

[[nodiscard]] NarrowMeasurement measure_narrow(const NarrowMeasureOptions& options);

}  // namespace winnow::bench
