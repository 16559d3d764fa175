#include "bench/measure/impact_race.h"

#include "bench/common/interleaved_runs.h"
#include "bench/common/need.h"
#include "bench/contenders/reference_sweep.h"
#include "bench/contenders/winnow_impacts.h"
#include "bench/contenders/winnow_narrow.h"
#include "bench/peers/peers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

namespace winnow::bench {
namespace {

constexpr int kSampleTimes = 64;
/// winnow's default tolerance.
constexpr double kLoose = 1e-6;
/// Effect of rounding of the motions on gaps, in radii.
constexpr double kRounding = 1e-12;
constexpr double kEndless = std::numeric_limits<double>::infinity();

/// Returns nanoseconds per pair.
double timed_ns(std::size_t pairs, const auto& work) {
  const ThreadStopwatch clock;
  work();
  return clock.ms() * 1e6 / static_cast<double>(pairs);
}

}  // namespace

ImpactJudge::ImpactJudge(const MovingPairSet& set)
    : set_(set), poses_(set.motions.size()), overlap_(set.middle->pairs.size(), kEndless) {
  std::vector<double> times(set.middle->pairs.size());
  for (int look = 0; look <= kSampleTimes; ++look) {
    std::fill(times.begin(), times.end(), static_cast<double>(look) / kSampleTimes);
    const NarrowResult& found = distances_at(times);
    for (std::size_t k = 0; k < found.size(); ++k) {
      const std::uint32_t i = found.pair_of(k);
      if (found.distance()[k] < -found.error_bound()[k]) {
        overlap_[i] = std::min(overlap_[i], times[i]);
      }
    }
  }
}

void ImpactJudge::judge(ImpactEngine& engine, ImpactTiming& timing) {
  const std::vector<BodyPair>& pairs = set_.middle->pairs;
  engine.run(pairs);
  std::vector<double> times(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) times[i] = engine.answer(i).time;
  const NarrowResult& found = distances_at(times);
  std::vector<double> gaps;
  for (std::size_t k = 0; k < found.size(); ++k) {
    const std::uint32_t i = found.pair_of(k);
    const ImpactAnswer answer = engine.answer(i);
    timing.missed += !answer.hit && overlap_[i] < kEndless ? 1 : 0;
    if (!answer.hit) continue;
    ++timing.hits;
    const double size = std::min(size_of(pairs[i].a), size_of(pairs[i].b));
    const double doubt = found.error_bound()[k] + kRounding * size;
    // Bodies that overlap at the start have impact time 0, which is never late.
    const bool late =
        answer.time > 0.0 && (overlap_[i] < answer.time || found.distance()[k] < -doubt);
    timing.late += late ? 1 : 0;
    if (late) continue;
    gaps.push_back(std::max(0.0, found.distance()[k]) / size);
    timing.loose += found.distance()[k] - doubt > kLoose * size ? 1 : 0;
  }
  timing.judged = pairs.size();
  timing.median_gap = median_of(gaps);
  for (const double gap : gaps) timing.worst_gap = std::max(timing.worst_gap, gap);
}

/// Returns the length that tolerances are relative to: the radius of a body. Half-spaces have none.
double ImpactJudge::size_of(std::uint32_t body) const {
  const ShapeId shape = set_.middle->shapes[body];
  if (shape.kind() == ShapeKind::half_space) return kEndless;
  if (shape.kind() == ShapeKind::hull) {
    return set_.middle->pool.tables().hulls[shape.index()].radius;
  }
  return set_.middle->radius[body];
}

const NarrowResult& ImpactJudge::distances_at(const std::vector<double>& times) {
  const PairSet& middle = *set_.middle;
  for (std::size_t i = 0; i < times.size(); ++i) {
    for (const std::uint32_t body : {middle.pairs[i].a, middle.pairs[i].b}) {
      poses_[body] = set_.motions[body].at(times[i]);
    }
  }
  need(narrow_.collide(middle.pool, {middle.shapes, poses_}, middle.pairs,
                       {.level = ContactLevel::distance, .tier = NarrowTier::reference}, result_),
       "distances");
  return result_;
}

ImpactMeasurement measure_impacts(const ImpactRaceOptions& options) {
  const MovingPairSet set =
      make_moving_pairs(options.kind, options.turn, {.pairs = options.pairs, .seed = options.seed});
  std::vector<std::unique_ptr<ImpactEngine>> engines;
  engines.push_back(std::make_unique<WinnowImpacts>());
  if (options.peers) {
    for (auto& peer : make_impact_peers()) {
      if (peer->takes(options.kind, options.turn)) engines.push_back(std::move(peer));
    }
  }
  const std::vector<BodyPair>& pairs = set.middle->pairs;
  ImpactMeasurement measured;
  ImpactJudge judge(set);
  for (const auto& engine : engines) {
    engine->start(set);
    measured.timings.push_back({.engine = engine->name()});
    judge.judge(*engine, measured.timings.back());
  }
  WinnowNarrow distances(NarrowTier::robust, 1);
  distances.start(*set.middle);
  MachineClock clock;
  clock.tick();
  auto ns = run_interleaved(engines.size() + 1, options.rounds, 1, [&](std::size_t, std::size_t i) {
    return timed_ns(pairs.size(), [&] {
      if (i == engines.size()) {
        distances.run(ContactLevel::distance, pairs);
      } else {
        engines[i]->run(pairs);
      }
    });
  });
  clock.tick();
  measured.machine_ms = clock.median_ms();
  for (std::size_t i = 0; i < engines.size(); ++i) measured.timings[i].ns = std::move(ns[i]);
  measured.distance_ns = std::move(ns.back());
  return measured;
}

}  // namespace winnow::bench
