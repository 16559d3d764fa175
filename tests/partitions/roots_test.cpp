// Roots that determine the layout of cells: accurate, and equal on every machine.

#include "partitions/structures/roots.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "tests/support/random.h"

namespace winnow::test {
namespace {

// Returns a number of any exponent.
double any_number(Random& random) {
  return std::ldexp(random.uniform(1.0, 2.0), static_cast<int>(random.below(600)) - 300);
}

TEST(Roots, roots_equal_cmath_within_few_ulps) {
  Random random(1);
  for (int i = 0; i < 20000; ++i) {
    const double value = any_number(random);
    EXPECT_EQ(root(1, value), value);
    EXPECT_EQ(root(2, value), std::sqrt(value));
    EXPECT_NEAR(root(3, value) / std::cbrt(value), 1.0, 0x1p-50);
  }
}

TEST(Roots, roots_of_products_beyond_double_are_right) {
  EXPECT_NEAR(root_of_product(3, std::array{1e300, 2e300, 4e300}) / 2e300, 1.0, 0x1p-50);
  EXPECT_NEAR(root_of_product(3, std::array{1e-300, 2e-300, 4e-300}) / 2e-300, 1.0, 0x1p-50);
  EXPECT_NEAR(root_of_product(2, std::array{5e-324, 5e-324}) / 5e-324, 1.0, 0x1p-50);
  EXPECT_NEAR(root_of_product(2, std::array{1e300, 4e300}) / 2e300, 1.0, 0x1p-50);
}

TEST(Roots, roots_of_special_values_follow_cmath) {
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  for (const unsigned degree : {1U, 2U, 3U}) {
    EXPECT_EQ(root(degree, 0.0), 0.0);
    EXPECT_EQ(root(degree, kEndless), kEndless);
    EXPECT_TRUE(std::isnan(root(degree, std::nan(""))));
    EXPECT_TRUE(std::isnan(root_of_product(degree, std::array{0.0, kEndless})));
  }
}

TEST(Roots, roots_are_equal_on_every_machine) {
  std::uint64_t state = 0;
  const auto number = [&state] {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    const double fraction = 1.0 + static_cast<double>(state >> 12U) * 0x1p-52;
    return std::ldexp(fraction, static_cast<int>(state >> 56U) - 128);
  };
  std::uint64_t digest = 0;
  for (int i = 0; i < 10000; ++i) {
    const std::array<double, 3> factor{number(), number(), number()};
    for (const unsigned degree : {1U, 2U, 3U}) {
      const double result = root_of_product(degree, factor);
      digest = std::rotl(digest, 7) * 3 + std::bit_cast<std::uint64_t>(result);
    }
  }
  EXPECT_EQ(digest, 1707059288945695157U);
}

}  // namespace
}  // namespace winnow::test
