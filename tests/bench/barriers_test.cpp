// Fast bodies, a blade and a cloth: nothing passes through anything, and what would is counted.

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

/// On any instruction set and number of threads.
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

TEST(Barriers, stop_fast_bodies) {
  for (const FastScene scene : {FastScene::funnel, FastScene::blade}) {
    FastBodies bodies({.scene = scene, .bodies = 12});
    for (int i = 0; i < 60; ++i) bodies.step();
    EXPECT_EQ(bodies.passed(), 0U);
    EXPECT_EQ(bodies.cut_short(), 0U);
    EXPECT_GT(bodies.impacts(), 30U);
    EXPECT_GT(bodies.fastest(), 4.0);
  }
}

TEST(Barriers, stop_nothing_that_is_not_swept) {
  for (const FastScene scene : {FastScene::funnel, FastScene::blade}) {
    FastBodies bodies({.scene = scene, .bodies = 12, .swept = false});
    for (int i = 0; i < 10; ++i) bodies.step();
    EXPECT_GT(bodies.passed(), 0U);
    EXPECT_EQ(bodies.impacts(), 0U);
  }
  ClothDrop cloth({.side = 10, .swept = false});
  std::size_t passed = 0;
  for (int i = 0; i < 45; ++i) {
    cloth.step();
    passed += cloth.passed();
  }
  EXPECT_GT(passed, 0U);
}

TEST(Barriers, hold_a_cloth_that_drops_on_a_ball) {
  ClothDrop cloth({.side = 14});
  for (int i = 0; i < 90; ++i) {
    cloth.step();
    EXPECT_EQ(cloth.passed(), 0U) << i;
  }
  // It hangs down beside the ball.
  EXPECT_LT(cloth.lowest(), -0.1);
  EXPECT_GT(cloth.lowest(), -1.5);
  EXPECT_LT(cloth.stretch(), 0.5);
}

TEST(Barriers, are_the_same_on_any_instruction_set_and_number_of_threads) {
  expect_the_same_everywhere(FastBodiesOptions{.scene = FastScene::funnel, .bodies = 8});
  expect_the_same_everywhere(FastBodiesOptions{.scene = FastScene::blade, .bodies = 8});
  expect_the_same_everywhere(ClothOptions{.side = 10});
}

}  // namespace
}  // namespace winnow::bench
