#include "bench/measure/impact_judge.h"

#include "bench/common/need.h"
#include "bench/common/sample.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow::bench {
namespace {

constexpr int kSampleTimes = 64;
/// winnow's default tolerance.
constexpr double kLoose = 1e-6;
/// Effect of rounding of the motions on gaps, in radii.
constexpr double kRounding = 1e-12;
constexpr double kEndless = std::numeric_limits<double>::infinity();

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

ImpactFaults ImpactJudge::judge(ImpactEngine& engine) {
  ImpactFaults faults;
  const std::vector<BodyPair>& pairs = set_.middle->pairs;
  engine.run(pairs);
  std::vector<double> times(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) times[i] = engine.answer(i).time;
  const NarrowResult& found = distances_at(times);
  std::vector<double> gaps;
  for (std::size_t k = 0; k < found.size(); ++k) {
    const std::uint32_t i = found.pair_of(k);
    const ImpactAnswer answer = engine.answer(i);
    faults.missed += !answer.hit && overlap_[i] < kEndless ? 1 : 0;
    if (!answer.hit) continue;
    ++faults.hits;
    const double size = std::min(size_of(pairs[i].a), size_of(pairs[i].b));
    const double doubt = found.error_bound()[k] + kRounding * size;
    // Bodies that overlap at the start have impact time 0, which is never late.
    const bool late =
        answer.time > 0.0 && (overlap_[i] < answer.time || found.distance()[k] < -doubt);
    faults.late += late ? 1 : 0;
    if (late) continue;
    gaps.push_back(std::max(0.0, found.distance()[k]) / size);
    faults.loose += found.distance()[k] - doubt > kLoose * size ? 1 : 0;
  }
  faults.judged = pairs.size();
  faults.median_gap = median_of(gaps);
  for (const double gap : gaps) faults.worst_gap = std::max(faults.worst_gap, gap);
  return faults;
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

}  // namespace winnow::bench
