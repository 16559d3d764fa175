// Simulations of stacked structures, with a solver that starts from the impulses of the last frame:
// they stay up with and without contact reduction, and the results are equal on all ISAs and
// threads.

#include "bench/simulation/standing.h"
#include "tests/support/config.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace winnow::bench {
namespace {

TEST(Standing, structures_settle_and_stay_in_place) {
  for (const std::string& structure : standing_names()) {
    for (const bool reduced : {false, true}) {
      SCOPED_TRACE(structure + (reduced ? ", regions" : ", raw"));
      StandingOptions options;
      options.part_manifolds = !reduced;
      Standing standing(structure, options);
      for (int frame = 0; frame < 60; ++frame) standing.step();
      EXPECT_LT(standing.drift(), 0.05);
      standing.mark();
      double kept = 1.0;
      for (int frame = 0; frame < 120; ++frame) {
        standing.step();
        kept = std::min(kept, standing.kept_points());
      }
      EXPECT_LT(standing.drift(), 0.01);
      EXPECT_LT(standing.tilt(), 0.001);
      EXPECT_LT(standing.deepest(), 0.005);
      EXPECT_GT(kept, 0.7);
      EXPECT_EQ(standing.islands(), 1U);
    }
  }
}

TEST(Standing, results_are_equal_on_all_isas_and_threads) {
  for (const std::string& structure : standing_names()) {
    const auto fingerprint = [&](Execution execution) {
      StandingOptions options;
      options.execution = execution;
      Standing standing(structure, options);
      for (int frame = 0; frame < 40; ++frame) standing.step();
      return standing.fingerprint();
    };
    const std::uint64_t expected = fingerprint(Execution::serial());
    test::Threads threads(2);
    EXPECT_EQ(threads.run([&] { return fingerprint(Execution::parallel()); }), expected);
    for (const Isa isa : available_isas()) {
      const test::IsaScope scope(isa);
      EXPECT_EQ(fingerprint(Execution::serial()), expected) << to_string(isa);
    }
  }
}

}  // namespace
}  // namespace winnow::bench
