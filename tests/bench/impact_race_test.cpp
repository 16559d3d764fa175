// Races of time-of-impact engines: correct answers have no faults, and each wrong answer is counted
// under its kind of fault.

#include "bench/measure/impact_race.h"
#include "bench/contenders/winnow_impacts.h"
#include "bench/measure/continuous_race.h"
#include "bench/measure/feature_race.h"

#include <gtest/gtest.h>

namespace winnow::bench {
namespace {

/// Returns one fixed answer for every pair.
class FixedImpact final : public ImpactEngine {
 public:
  explicit FixedImpact(const ImpactAnswer& answer) : answer_(answer) {}
  [[nodiscard]] std::string name() const override { return "stubborn"; }
  [[nodiscard]] bool takes(const PairKind&, PairTurn) const override { return true; }
  void start(const MovingPairSet&) override {}
  void run(std::span<const BodyPair>) override {}
  [[nodiscard]] ImpactAnswer answer(std::size_t) const override { return answer_; }

 private:
  ImpactAnswer answer_;
};

constexpr std::size_t kPairs = 200;

ImpactTiming judged(const MovingPairSet& set, ImpactEngine& engine) {
  engine.start(set);
  ImpactTiming timing;
  ImpactJudge(set).judge(engine, timing);
  EXPECT_EQ(timing.judged, kPairs);
  return timing;
}

TEST(ImpactRace, winnow_has_no_faults_on_any_motion) {
  for (const char* kind :
       {"sphere-box", "box-box", "triangle-triangle", "own-own", "cylinder-half_space"}) {
    for (const PairTurn turn : kPairTurns) {
      const MovingPairSet set = make_moving_pairs(*find_pair_kind(kind), turn, {.pairs = kPairs});
      WinnowImpacts winnow;
      const ImpactTiming timing = judged(set, winnow);
      EXPECT_EQ(timing.missed + timing.late + timing.loose, 0U) << kind;
      EXPECT_GE(timing.hits, kPairs / 2);
      EXPECT_LE(timing.worst_gap, 1e-6);
    }
  }
}

TEST(ImpactRace, missed_late_and_early_answers_are_counted) {
  const MovingPairSet set =
      make_moving_pairs(*find_pair_kind("box-box"), PairTurn::little, {.pairs = kPairs});
  FixedImpact blind({false, 1.0});
  EXPECT_GE(judged(set, blind).missed, kPairs / 2);
  FixedImpact late({true, 0.6});
  EXPECT_GE(judged(set, late).late, kPairs / 2);
  FixedImpact early({true, 0.0});
  const ImpactTiming timing = judged(set, early);
  EXPECT_EQ(timing.loose, kPairs);
  EXPECT_EQ(timing.late + timing.missed, 0U);
}

TEST(ImpactRace, features_that_touch_hit_and_others_miss) {
  for (const FeaturePair kind : kFeaturePairs) {
    for (const FeatureSteps steps : kFeatureSteps) {
      const FeatureTiming timing = measure_features(kind, steps, 500, 1, 3);
      EXPECT_EQ(timing.missed + timing.invented, 0U);
      EXPECT_EQ(timing.ns.size(), 1U);
      if (steps == FeatureSteps::touching) {
        EXPECT_EQ(timing.hits, 500U);
      }
    }
  }
}

TEST(ImpactRace, impacts_of_a_heap_are_timed) {
  const ContinuousTiming timing =
      measure_continuous_collision({.bodies = 200, .fast = 20, .frames = 2});
  EXPECT_EQ(timing.collide_ms.size(), 2U);
  EXPECT_EQ(timing.impacts_ms.size(), 2U);
  EXPECT_EQ(timing.all_ms.size(), 2U);
  EXPECT_GT(timing.pairs, 20U);
  EXPECT_GT(timing.impacts, 10U);
}

}  // namespace
}  // namespace winnow::bench
