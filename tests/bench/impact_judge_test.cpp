// Times of impact: correct answers have no faults, and each wrong answer is counted under its kind
// of fault.

#include "bench/measure/impact_judge.h"
#include "bench/contenders/winnow_engines.h"

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

ImpactFaults judged(const MovingPairSet& set, ImpactEngine& engine) {
  engine.start(set);
  const ImpactFaults faults = ImpactJudge(set).judge(engine);
  EXPECT_EQ(faults.judged, kPairs);
  return faults;
}

TEST(ImpactJudge, winnow_has_no_faults_on_any_motion) {
  for (const char* kind :
       {"sphere-box", "box-box", "triangle-triangle", "own-own", "cylinder-half_space"}) {
    for (const PairTurn turn : kPairTurns) {
      const MovingPairSet set = make_moving_pairs(*find_pair_kind(kind), turn, {.pairs = kPairs});
      const ImpactFaults faults = judged(set, *make_winnow_impacts());
      EXPECT_EQ(faults.missed + faults.late + faults.loose, 0U) << kind;
      EXPECT_GE(faults.hits, kPairs / 2);
      EXPECT_LE(faults.worst_gap, 1e-6);
    }
  }
}

TEST(ImpactJudge, missed_late_and_early_answers_are_counted) {
  const MovingPairSet set =
      make_moving_pairs(*find_pair_kind("box-box"), PairTurn::little, {.pairs = kPairs});
  FixedImpact blind({false, 1.0});
  EXPECT_GE(judged(set, blind).missed, kPairs / 2);
  FixedImpact late({true, 0.6});
  EXPECT_GE(judged(set, late).late, kPairs / 2);
  FixedImpact early({true, 0.0});
  const ImpactFaults faults = judged(set, early);
  EXPECT_EQ(faults.loose, kPairs);
  EXPECT_EQ(faults.late + faults.missed, 0U);
}

}  // namespace
}  // namespace winnow::bench
