// Times of impact of many pairs at once: equal to single-pair queries on every ISA, and close to
// the scalar search for one pair.

#include <gtest/gtest.h>
#include <winnow/pipeline/impacts.h>
#include <winnow/simd/isa.h>

#include <cmath>
#include <cstddef>
#include <iterator>
#include <span>
#include <vector>

#include "pipeline/motion/impact_search.h"
#include "tests/pipeline/motion_reference.h"

namespace winnow::test {
namespace {

/// Pairs of all kinds and motion styles in random order.
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
  /// Pairs of two given kinds.
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
  void find(std::span<const BodyPair> selected, ImpactResult& result) const {
    ASSERT_EQ(time_of_impact(scene.pool, {scene.shapes, motions}, selected, {}, result),
              Status::ok);
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

TEST(ImpactBatches, mixed_batch_matches_single_pairs) {
  const Crowd crowd(scaled(1500), 81);
  ImpactResult together;
  crowd.find(crowd.pairs, together);
  ImpactResult single;
  for (std::size_t i = 0; i < crowd.pairs.size(); ++i) {
    SCOPED_TRACE(i);
    crowd.find(std::span(crowd.pairs).subspan(i, 1), single);
    expect_same(together, i, single, 0);
  }
}

// Pairs of the same kinds fill whole blocks of lanes.
TEST(ImpactBatches, batch_of_equal_kinds_matches_single_pairs) {
  const std::vector<ShapeKind> kinds = moving_kinds();
  ImpactResult together;
  ImpactResult single;
  for (const ShapeKind a : kinds) {
    for (const ShapeKind b : kinds) {
      SCOPED_TRACE(testing::Message() << to_string(a) << " " << to_string(b));
      const Crowd crowd(a, b, scaled(200), 84);
      crowd.find(crowd.pairs, together);
      for (std::size_t i = 0; i < crowd.pairs.size(); ++i) {
        crowd.find(std::span(crowd.pairs).subspan(i, 1), single);
        expect_same(together, i, single, 0);
      }
    }
  }
}

TEST(ImpactBatches, impacts_match_on_every_isa) {
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

// Results may differ within the tolerance: either may stop early.
TEST(ImpactBatches, batch_is_close_to_scalar_search) {
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
