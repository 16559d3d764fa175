// Times of impact of many pairs at once: the same as of each by itself, on every instruction set,
// and beside those of the search that has one pair at a time.

#include <gtest/gtest.h>
#include <winnow/pipeline/time_of_impact.h>
#include <winnow/simd/isa.h>

#include <cmath>
#include <cstddef>
#include <iterator>
#include <span>
#include <vector>

#include "pipeline/motion/impact_search.h"
#include "tests/pipeline/motion_twin.h"

namespace winnow::test {
namespace {

/// Pairs of all kinds, which move in all ways, in any order.
struct Crowd {
  explicit Crowd(std::size_t count, std::uint64_t seed) : random(seed) {
    const std::vector<ShapeKind> kinds = moving_kinds();
    for (std::size_t n = 0; n < count; ++n) {
      const ShapeKind a = kinds[random.below(kinds.size())];
      const ShapeKind b = kinds[random.below(kinds.size())];
      add_pairs(scene, a, b, kPairStyles[random.below(std::size(kPairStyles))], 1, random);
    }
    set_motions();
  }
  /// Of one pair of kinds.
  Crowd(ShapeKind a, ShapeKind b, std::size_t count, std::uint64_t seed) : random(seed) {
    add_pairs(scene, a, b, PairStyle::ordinary, count, random);
    set_motions();
  }
  void set_motions() {
    motions.resize(scene.shapes.size());
    for (const BodyPair& pair : scene.pairs) {
      const MotionStyle style = kMotionStyles[random.below(std::size(kMotionStyles))];
      const MovingShapes moving = moving_pair(scene, pair, style, random);
      if (!moving.motion[0].is_valid() || !moving.motion[1].is_valid()) continue;
      pairs.push_back(pair);
      motions[pair.a] = moving.motion[0];
      motions[pair.b] = moving.motion[1];
    }
  }
  void find(std::span<const BodyPair> asked, ImpactResult& result) const {
    ASSERT_EQ(time_of_impact(scene.pool, {scene.shapes, motions}, asked, {}, result), Status::ok);
  }

  Random random;
  PairScene scene;
  std::vector<RigidMotion> motions;
  std::vector<BodyPair> pairs;
};

void expect_same(const ImpactResult& a, std::size_t i, const ImpactResult& b, std::size_t k) {
  EXPECT_EQ(a.status(i), b.status(k));
  EXPECT_EQ(a.hits(i), b.hits(k));
  EXPECT_EQ(a.time()[i], b.time()[k]);
  EXPECT_EQ(a.gap()[i], b.gap()[k]);
  EXPECT_EQ(a.error_bound()[i], b.error_bound()[k]);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(a.normal(axis)[i], b.normal(axis)[k]);
    EXPECT_EQ(a.point(axis)[i], b.point(axis)[k]);
  }
}

TEST(ImpactBatches, answer_as_each_pair_is_answered_alone) {
  const Crowd crowd(scaled(1500), 81);
  ImpactResult together;
  crowd.find(crowd.pairs, together);
  ImpactResult alone;
  for (std::size_t i = 0; i < crowd.pairs.size(); ++i) {
    SCOPED_TRACE(i);
    crowd.find(std::span(crowd.pairs).subspan(i, 1), alone);
    expect_same(together, i, alone, 0);
  }
}

// Which makes full blocks of lanes.
TEST(ImpactBatches, of_one_pair_of_kinds_answer_as_each_pair_is_answered_alone) {
  const std::vector<ShapeKind> kinds = moving_kinds();
  ImpactResult together;
  ImpactResult alone;
  for (const ShapeKind a : kinds) {
    for (const ShapeKind b : kinds) {
      SCOPED_TRACE(testing::Message() << to_string(a) << " " << to_string(b));
      const Crowd crowd(a, b, scaled(200), 84);
      crowd.find(crowd.pairs, together);
      for (std::size_t i = 0; i < crowd.pairs.size(); ++i) {
        crowd.find(std::span(crowd.pairs).subspan(i, 1), alone);
        expect_same(together, i, alone, 0);
      }
    }
  }
}

TEST(ImpactBatches, are_the_same_on_every_instruction_set) {
  const Crowd crowd(scaled(1500), 82);
  const Isa before = active_isa();
  ImpactResult first;
  crowd.find(crowd.pairs, first);
  for (const Isa isa : available_isas()) {
    SCOPED_TRACE(to_string(isa));
    ASSERT_EQ(set_isa(isa), Status::ok);
    ImpactResult other;
    crowd.find(crowd.pairs, other);
    for (std::size_t i = 0; i < first.size(); ++i) expect_same(first, i, other, i);
  }
  EXPECT_EQ(set_isa(before), Status::ok);
}

// One answer may be early, within the tolerance, where the other is not.
TEST(ImpactBatches, find_what_the_search_for_one_pair_finds) {
  const Crowd crowd(scaled(1500), 83);
  ImpactResult result;
  crowd.find(crowd.pairs, result);
  std::size_t differ = 0;
  for (std::size_t i = 0; i < crowd.pairs.size(); ++i) {
    const auto [a, b] = crowd.pairs[i];
    const impact::Impact found =
        impact::find_impact(crowd.scene.pool.tables(), {crowd.scene.shapes[a], crowd.motions[a]},
                            {crowd.scene.shapes[b], crowd.motions[b]}, 1e-6);
    const bool same = found.hit == result.hits(i) &&
                      std::abs(found.time - result.time()[i]) <= 1e-4 * (1e-3 + found.time);
    differ += same ? 0 : 1;
  }
  EXPECT_LE(differ, crowd.pairs.size() / 50);
}

}  // namespace
}  // namespace winnow::test
