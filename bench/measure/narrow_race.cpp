// Races narrow-phase engines on the pairs of a set at one level, and compares their verdicts,
// depths and numbers of contacts. bench/rows (pair times) and accuracy.cpp call it.

#include "bench/measure/narrow_race.h"

#include "bench/common/interleaved_runs.h"
#include "bench/common/timed.h"
#include "bench/contenders/reference_sweep.h"
#include "bench/contenders/winnow_narrow.h"
#include "bench/peers/peers.h"

#include <algorithm>
#include <cmath>

namespace winnow::bench {

namespace {

/// Pairs computed before a turn is timed.
constexpr std::size_t kWarming = 512;

/// One contender at the level of the race.
class PairEntry {
 public:
  PairEntry(const PairSet& set, ContactLevel level, const NarrowContender& contender)
      : set_(set), engine_(*contender.engine) {
    timing_.engine = engine_.name();
    timing_.level = level;
    timing_.threads = contender.threads;
  }

  /// Computes a part of the pairs, compares the verdicts, and sets the number of pairs per turn.
  void check(std::vector<NarrowAnswer>& expected, const NarrowRaceOptions& options,
             Arenas& arenas) {
    const std::span<const BodyPair> all = set_.pairs;
    const std::span<const BodyPair> part = all.first(std::min(options.compared, all.size()));
    const double ms = timed(timing_.threads, arenas, [&] { engine_.run(timing_.level, part); });
    timing_.recomputed = engine_.recomputed();
    compare(part, expected);
    const double pairs_per_turn =
        options.turn_ms * static_cast<double>(part.size()) / std::max(ms, 1e-3);
    const std::size_t least = std::min(options.smallest_part, all.size());
    part_ = std::clamp(static_cast<std::size_t>(pairs_per_turn), least, all.size());
    passes_ = std::max<std::size_t>(1, static_cast<std::size_t>(pairs_per_turn) / part_);
  }

  /// Times one turn and returns nanoseconds per pair.
  double time(Arenas& arenas) {
    const std::span<const BodyPair> part = next_part();
    // Warms the caches, which the previous turn has filled with other data.
    engine_.run(timing_.level, part.last(std::min(kWarming, part.size())));
    const double ms = timed(timing_.threads, arenas, [&] {
      for (std::size_t pass = 0; pass < passes_; ++pass) engine_.run(timing_.level, part);
    });
    return ms * 1e6 / static_cast<double>(passes_ * part.size());
  }

  [[nodiscard]] NarrowTiming& timing() noexcept { return timing_; }

 private:
  /// Compares with the answers of the first engine, or stores them if `expected` is empty.
  void compare(std::span<const BodyPair> pairs, std::vector<NarrowAnswer>& expected) {
    const bool is_first = expected.empty();
    std::size_t overlapping = 0;
    std::size_t other_depth = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const NarrowAnswer answer = engine_.answer(i);
      if (is_first) expected.push_back(answer);
      timing_.disagree += answer.overlap == expected[i].overlap ? 0 : 1;
      if (!answer.overlap || !expected[i].overlap) continue;
      const double sizes = set_.radius[pairs[i].a] + set_.radius[pairs[i].b];
      const double off = std::abs(answer.distance - expected[i].distance);
      other_depth += off > 0.01 * sizes ? 1 : 0;
      timing_.contacts += answer.contacts;
      ++overlapping;
    }
    timing_.compared = pairs.size();
    const double all = std::max(1.0, static_cast<double>(overlapping));
    timing_.other_depth = static_cast<double>(other_depth) / all;
    timing_.contacts /= all;
  }

  std::span<const BodyPair> next_part() {
    const std::span<const BodyPair> all = set_.pairs;
    if (first_ + part_ > all.size()) first_ = 0;
    const std::span<const BodyPair> part = all.subspan(first_, part_);
    first_ += part_;
    return part;
  }

  const PairSet& set_;
  NarrowEngine& engine_;
  NarrowTiming timing_;
  std::size_t part_ = 0;
  std::size_t passes_ = 1;
  std::size_t first_ = 0;
};

}  // namespace

std::vector<NarrowContender> narrow_contenders(const PairSet& set,
                                               const NarrowContenderOptions& options) {
  std::vector<NarrowContender> contenders;
  for (const NarrowTier tier : options.tiers) {
    for (const int count : options.threads) {
      contenders.push_back({std::make_unique<WinnowNarrow>(tier, count), count});
    }
    if (options.one_a_call) contenders.push_back({std::make_unique<WinnowOnePair>(tier), 1});
  }
  if (options.peers) {
    for (auto& peer : make_narrow_peers()) {
      const bool takes_any = std::any_of(kLevels.begin(), kLevels.end(), [&](ContactLevel level) {
        return peer->takes(set.kind, level);
      });
      if (takes_any) contenders.push_back({std::move(peer), 1});
    }
  }
  for (const NarrowContender& contender : contenders) contender.engine->start(set);
  return contenders;
}

std::vector<NarrowTiming> race_pairs(const PairSet& set, ContactLevel level,
                                     std::span<NarrowContender> contenders,
                                     const NarrowRaceOptions& options) {
  int most_threads = 1;
  std::vector<PairEntry> entries;
  for (const NarrowContender& contender : contenders) {
    if (!contender.engine->takes(set.kind, level)) continue;
    most_threads = std::max(most_threads, contender.threads);
    entries.emplace_back(set, level, contender);
  }
  Arenas arenas(most_threads);
  std::vector<NarrowAnswer> expected;
  for (PairEntry& entry : entries) entry.check(expected, options, arenas);
  auto ns = run_interleaved(entries.size(), options.rounds, 0,
                            [&](std::size_t, std::size_t i) { return entries[i].time(arenas); });
  std::vector<NarrowTiming> timings;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    timings.push_back(std::move(entries[i].timing()));
    timings.back().ns = std::move(ns[i]);
  }
  return timings;
}

const NarrowTiming* NarrowMeasurement::find(NarrowTier tier, ContactLevel level,
                                            int threads) const noexcept {
  for (const NarrowTiming& timing : timings) {
    if (timing.engine == to_text(tier) && timing.level == level && timing.threads == threads) {
      return &timing;
    }
  }
  return nullptr;
}

bool NarrowMeasurement::is_right(const NarrowTiming& timing) const noexcept {
  if (100 * timing.disagree > timing.compared || timing.other_depth > 0.1) return false;
  const auto first = std::find_if(timings.begin(), timings.end(), [&](const NarrowTiming& other) {
    return other.level == timing.level;
  });
  return first == timings.end() || 2.0 * timing.contacts >= first->contacts;
}

NarrowMeasurement measure_narrow(const NarrowMeasureOptions& options) {
  NarrowMeasurement measured;
  measured.kind = options.kind;
  measured.pairs = options.pairs;
  const auto set = make_pair_set(options.kind, {.pairs = options.pairs,
                                                .seed = options.seed,
                                                .scattered = options.pairs > kMaxPairsInCache,
                                                .upright = options.upright});
  std::vector<NarrowContender> contenders = narrow_contenders(*set, options.contenders);
  MachineClock clock;
  for (const ContactLevel level : options.levels) {
    clock.tick();
    for (NarrowTiming& timing : race_pairs(*set, level, contenders, options.race)) {
      measured.timings.push_back(std::move(timing));
    }
  }
  clock.tick();
  measured.machine_ms = clock.median_ms();
  return measured;
}

}  // namespace winnow::bench
