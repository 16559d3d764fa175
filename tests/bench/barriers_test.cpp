// Simulations of fast bodies, a blade and a cloth: continuous collision detection lets nothing pass
// a barrier; without it the passages are counted.

#include "bench/simulation/barriers.h"
#include "tests/support/config.h"

#include <gtest/gtest.h>

namespace winnow::bench {
namespace {

std::uint64_t fingerprint_of(const BarrierOptions& options) {
  const auto barrier = make_barrier(options);
  for (int i = 0; i < (options.scene == "cloth" ? 40 : 10); ++i) barrier->step();
  return barrier->figures().fingerprint;
}

/// Expects the same fingerprint on all instruction sets and on two threads.
void expect_the_same_everywhere(BarrierOptions options) {
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
  for (const char* const scene : {"funnel", "blade"}) {
    const auto bodies = make_barrier({.scene = scene, .size = 12});
    for (int i = 0; i < 60; ++i) bodies->step();
    const BarrierFigures figures = bodies->figures();
    EXPECT_EQ(figures.passed, 0U);
    EXPECT_EQ(figures.cut_short, 0U);
    EXPECT_GT(figures.impacts, 30U);
    EXPECT_GT(figures.fastest, 4.0);
  }
}

TEST(Barriers, bodies_without_continuous_collision_pass) {
  for (const char* const scene : {"funnel", "blade"}) {
    const auto bodies = make_barrier({.scene = scene, .size = 12, .continuous = false});
    for (int i = 0; i < 10; ++i) bodies->step();
    EXPECT_GT(bodies->figures().passed, 0U);
    EXPECT_EQ(bodies->figures().impacts, 0U);
  }
  const auto cloth = make_barrier({.scene = "cloth", .size = 10, .continuous = false});
  std::size_t passed = 0;
  for (int i = 0; i < 45; ++i) {
    cloth->step();
    passed += cloth->figures().passed;
  }
  EXPECT_GT(passed, 0U);
}

TEST(Barriers, cloth_that_drops_on_a_ball_is_held) {
  const auto cloth = make_barrier({.scene = "cloth", .size = 14});
  for (int i = 0; i < 90; ++i) {
    cloth->step();
    EXPECT_EQ(cloth->figures().passed, 0U) << i;
  }
  // The cloth hangs down beside the ball.
  EXPECT_LT(cloth->figures().lowest, -0.1);
  EXPECT_GT(cloth->figures().lowest, -1.5);
  EXPECT_LT(cloth->figures().strain, 0.5);
}

TEST(Barriers, results_are_equal_on_all_isas_and_threads) {
  expect_the_same_everywhere({.scene = "funnel", .size = 8});
  expect_the_same_everywhere({.scene = "blade", .size = 8});
  expect_the_same_everywhere({.scene = "cloth", .size = 10});
}

}  // namespace
}  // namespace winnow::bench
