#include "tool/measure_narrow.h"

#include "engine/reference_sweep.h"
#include "narrow/winnow_narrow.h"

#include <algorithm>

#if WINNOW_HAVE_PEERS
#include "peers/peers.h"
#endif

namespace winnow::bench {

std::vector<std::unique_ptr<NarrowEngine>> narrow_peers() {
#if WINNOW_HAVE_PEERS
  return make_narrow_peers();
#else
  return {};
#endif
}

bool NarrowMeasurement::is_peer(const NarrowTiming& timing) const noexcept {
  return std::find(peers.begin(), peers.end(), timing.engine) != peers.end();
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

const NarrowTiming* NarrowMeasurement::best_peer(ContactLevel level) const noexcept {
  const NarrowTiming* best = nullptr;
  for (const NarrowTiming& timing : timings) {
    if (timing.level != level || !is_peer(timing) || !is_right(timing)) continue;
    if (best == nullptr || timing.median_ns() < best->median_ns()) best = &timing;
  }
  return best;
}

NarrowMeasurement measure_narrow(const NarrowMeasureOptions& options) {
  NarrowMeasurement measured;
  measured.kind = options.kind;
  measured.pairs = options.pairs;
  const auto set = make_pair_set(options.kind, {.pairs = options.pairs,
                                                .seed = options.seed,
                                                .scattered = options.pairs > kMostPairsInCache});
  std::vector<NarrowContender> contenders;
  for (const NarrowTier tier : options.tiers) {
    for (const int threads : options.threads) {
      contenders.push_back({std::make_unique<WinnowNarrow>(tier, threads), threads});
    }
  }
  if (options.peers) {
    for (std::unique_ptr<NarrowEngine>& peer : narrow_peers()) {
      measured.peers.push_back(peer->name());
      contenders.push_back({std::move(peer), 1});
    }
  }
  for (const NarrowContender& contender : contenders) contender.engine->start(*set);
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
