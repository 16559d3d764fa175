// Functions that winnow computes itself, because the last digits of the C library differ between
// machines.

#include <gtest/gtest.h>

#include <cfloat>
#include <cmath>
#include <iterator>

#include "pipeline/kinds/hypotenuse.h"
#include "pipeline/shapes/directions_around.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

TEST(Hypotenuse, error_is_at_most_one_ulp) {
  Random random(1);
  for (int i = 0; i < 20000; ++i) {
    const double x = std::ldexp(random.uniform(-1, 1), static_cast<int>(random.below(1800)) - 900);
    const double y = i % 2 == 0 ? x * random.uniform(-1, 1)
                                : std::ldexp(x, static_cast<int>(random.below(120)) - 60);
    const double exact = static_cast<double>(std::hypot(static_cast<long double>(x), y));
    const double h = hypotenuse(x, y);
    ASSERT_GE(h, std::nextafter(exact, 0.0)) << x << ' ' << y;
    ASSERT_LE(h, std::nextafter(exact, DBL_MAX)) << x << ' ' << y;
    ASSERT_EQ(h, hypotenuse(y, x));
  }
}

TEST(Hypotenuse, extreme_numbers_do_not_overflow_or_underflow) {
  constexpr double kSmallestDouble = 0x1p-1074;
  EXPECT_EQ(hypotenuse(0.0, -0.0), 0.0);
  EXPECT_EQ(hypotenuse(3 * kSmallestDouble, 4 * kSmallestDouble), 5 * kSmallestDouble);
  EXPECT_EQ(hypotenuse(-0x1.8p1022, 0x1p1023), 0x1.4p1023);
  EXPECT_EQ(hypotenuse(DBL_MAX, 1.0), DBL_MAX);
}

// std::hypot rounds these differently on some machines.
TEST(Hypotenuse, results_match_on_every_machine) {
  EXPECT_EQ(hypotenuse(0x1.afc6ee0bf2c94p-3, 0x1.ae08b6db8c605p-4), 0x1.e25a3164e4df5p-3);
  EXPECT_EQ(hypotenuse(-0x1.4477333de437cp-1, 0x1.4b0bdc90827bcp-9), 0x1.4477dc1f10afap-1);
  EXPECT_EQ(hypotenuse(0x1.76ebdffb7ee66p+28, -0x1.910018dca413bp+6), 0x1.76ebdffb7ef3cp+28);
  EXPECT_EQ(hypotenuse(0x1.141f1d77ac737p+4, -0x1.c7624fbd8cfc8p+3), 0x1.65e4611fa7899p+4);
}

TEST(DirectionsAround, table_entries_divide_full_turn) {
  const auto expect_parts = [](const auto& directions) {
    const double step = 2 * std::acos(-1.0) / static_cast<double>(std::size(directions));
    for (std::size_t k = 0; k < std::size(directions); ++k) {
      EXPECT_NEAR(directions[k][0], std::cos(step * static_cast<double>(k)), 2e-15) << k;
      EXPECT_NEAR(directions[k][1], std::sin(step * static_cast<double>(k)), 2e-15) << k;
    }
  };
  expect_parts(kSixteenthsOfTurn);
  expect_parts(kFifteenthsOfTurn);
}

}  // namespace
}  // namespace winnow::test
