// Simulations of fast bodies, a blade and a cloth: continuous collision detection lets nothing pass
// a barrier; without it the passages are counted.

#include "bench/simulation/cloth_drop.h"
#include "bench/simulation/fast_bodies.h"
#include "tests/support/config.h"

#include <gtest/gtest.h>

namespace winnow::bench {
namespace {

std::uint64_t fingerprint_of(const FastBodiesOptions& options) {
  FastBodies bodies(options);
  for (int i = 0; i < 10; ++i) bodies.step();
  return bodies.fingerprint();
}

std::uint64_t fingerprint_of(const ClothOptions& options) {
  ClothDrop cloth(options);
  for (int i = 0; i < 40; ++i) cloth.step();
  return cloth.fingerprint();
}

/// Expects the same fingerprint on all instruction sets and on two threads.
template <typename Options>
void expect_the_same_everywhere(Options options) {
  const std::uint64_t expected = fingerprint_of(options);
  for (const Isa isa : available_isas()) {
    const test::IsaScope scope(isa);
    EXPECT_EQ(fingerprint_of(options), expected) << to_string(isa);
  }
  options.execution = Execution::parallel();
  test::Threads threads(2);
  EXPECT_EQ(threads.run([&] { return fingerprint_of(options); }), expected);
}

TEST(Barriers, continuous_collision_lets_no_fast_body_pass) {
  for (const FastScene scene : {FastScene::funnel, FastScene::blade}) {
    FastBodies bodies({.scene = scene, .bodies = 12});
    for (int i = 0; i < 60; ++i) bodies.step();
    EXPECT_EQ(bodies.passed(), 0U);
    EXPECT_EQ(bodies.cut_short(), 0U);
    EXPECT_GT(bodies.impacts(), 30U);
    EXPECT_GT(bodies.fastest(), 4.0);
  }
}

TEST(Barriers, bodies_without_continuous_collision_pass) {
  for (const FastScene scene : {FastScene::funnel, FastScene::blade}) {
    FastBodies bodies({.scene = scene, .bodies = 12, .continuous = false});
    for (int i = 0; i < 10; ++i) bodies.step();
    EXPECT_GT(bodies.passed(), 0U);
    EXPECT_EQ(bodies.impacts(), 0U);
  }
  ClothDrop cloth({.side = 10, .continuous = false});
  std::size_t passed = 0;
  for (int i = 0; i < 45; ++i) {
    cloth.step();
    passed += cloth.passed();
  }
  EXPECT_GT(passed, 0U);
}

TEST(Barriers, cloth_that_drops_on_a_ball_is_held) {
  ClothDrop cloth({.side = 14});
  for (int i = 0; i < 90; ++i) {
    cloth.step();
    EXPECT_EQ(cloth.passed(), 0U) << i;
  }
  // The cloth hangs down beside the ball.
  EXPECT_LT(cloth.lowest(), -0.1);
  EXPECT_GT(cloth.lowest(), -1.5);
  EXPECT_LT(cloth.max_strain(), 0.5);
}

TEST(Barriers, results_are_equal_on_all_isas_and_threads) {
  expect_the_same_everywhere(FastBodiesOptions{.scene = FastScene::funnel, .bodies = 8});
  expect_the_same_everywhere(FastBodiesOptions{.scene = FastScene::blade, .bodies = 8});
  expect_the_same_everywhere(ClothOptions{.side = 10});
}

}  // namespace
}  // namespace winnow::bench
