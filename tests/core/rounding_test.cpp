// Outward rounding of doubles to floats and of sums: tight, on the right side, and equal in every
// floating-point mode.

#include <gtest/gtest.h>
#include <winnow/core/volumes.h>

#include <bit>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/numbers/rounding.h"
#include "tests/support/exact.h"
#include "tests/support/float_modes.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr float kInfF = std::numeric_limits<float>::infinity();
constexpr float kDenormal = std::numeric_limits<float>::denorm_min();

// Tests the definition: the result is on the right side of the value, and the next float inward is
// on the other side.
void expect_tight(double value) {
  const float down = round_down(value);
  const float up = round_up(value);
  EXPECT_LE(static_cast<double>(down), value);
  EXPECT_GE(static_cast<double>(up), value);
  if (std::isfinite(value)) {
    EXPECT_GT(static_cast<double>(std::nextafter(down, kInfF)), value);
    EXPECT_LT(static_cast<double>(std::nextafter(up, -kInfF)), value);
  }
}

TEST(Rounding, floats_are_returned_unchanged) {
  for (const float f :
       {0.0F, 1.0F, -1.5F, FLT_MAX, -FLT_MAX, FLT_MIN, kDenormal, -kDenormal, kInfF, -kInfF}) {
    EXPECT_EQ(round_down(static_cast<double>(f)), f);
    EXPECT_EQ(round_up(static_cast<double>(f)), f);
  }
  EXPECT_TRUE(std::signbit(round_down(-0.0)));
  EXPECT_TRUE(std::signbit(round_up(-0.0)));
}

TEST(Rounding, rounding_is_tight_near_powers_of_two) {
  for (int exponent = -160; exponent <= 127; ++exponent) {
    for (const double sign : {-1.0, 1.0}) {
      const double power = sign * std::exp2(exponent);
      for (const double factor : {1.0, 1.0 + 1e-15, 1.0 - 1e-15, 1.0 + 1e-8, 1.0 - 1e-8, 1.5}) {
        expect_tight(power * factor);
      }
    }
  }
}

TEST(Rounding, rounding_is_tight_for_random_doubles) {
  Random random(1);
  for (int i = 0; i < 200000; ++i) {
    const double magnitude = random.log_uniform(1e-46, 3.4e38);
    expect_tight(random.chance(0.5) ? magnitude : -magnitude);
  }
}

TEST(Rounding, sums_round_to_the_nearest_double_outward) {
  Random random(2);
  std::size_t inexact = 0;
  for (int i = 0; i < 200000; ++i) {
    const double a = random.log_uniform(1e-9, 1e9) * (random.chance(0.5) ? 1.0 : -1.0);
    const double b = random.log_uniform(1e-9, 1e9) * (random.chance(0.5) ? 1.0 : -1.0);
    const double sum = a + b;
    // Exact, because the operand of greater magnitude comes first.
    const double first = std::abs(a) > std::abs(b) ? a : b;
    const double second = std::abs(a) > std::abs(b) ? b : a;
    const double rest = (first - sum) + second;
    EXPECT_EQ(add_down(a, b), rest < 0 ? std::nextafter(sum, -kInf) : sum);
    EXPECT_EQ(add_up(a, b), rest > 0 ? std::nextafter(sum, kInf) : sum);
    inexact += rest != 0 ? 1 : 0;
  }
  EXPECT_GT(inexact, 100000U);
  EXPECT_EQ(add_down(1.0, -1.0), 0.0);
  EXPECT_EQ(add_up(-0.5, 0.5), 0.0);
}

TEST(Rounding, values_below_the_denormals_round_outward) {
  EXPECT_EQ(round_down(1e-300), 0.0F);
  EXPECT_EQ(round_up(1e-300), kDenormal);
  EXPECT_EQ(round_down(-1e-300), -kDenormal);
  EXPECT_EQ(round_up(-1e-300), 0.0F);
  EXPECT_EQ(round_up(std::numeric_limits<double>::denorm_min()), kDenormal);
}

TEST(Rounding, values_beyond_the_range_round_outward) {
  for (const double huge : {std::nextafter(static_cast<double>(FLT_MAX), kInf), 1e39, 1e308,
                            std::numeric_limits<double>::max()}) {
    EXPECT_EQ(round_down(huge), FLT_MAX);
    EXPECT_EQ(round_up(huge), kInfF);
    EXPECT_EQ(round_down(-huge), -kInfF);
    EXPECT_EQ(round_up(-huge), -FLT_MAX);
  }
}

TEST(Rounding, infinity_and_nan_are_kept) {
  EXPECT_EQ(round_down(kInf), kInfF);
  EXPECT_EQ(round_up(kInf), kInfF);
  EXPECT_EQ(round_down(-kInf), -kInfF);
  EXPECT_EQ(round_up(-kInf), -kInfF);
  EXPECT_TRUE(std::isnan(round_down(std::numeric_limits<double>::quiet_NaN())));
  EXPECT_TRUE(std::isnan(round_up(std::numeric_limits<double>::quiet_NaN())));
}

TEST(Rounding, finite_float_is_clamped_to_the_largest_float) {
  const auto most = static_cast<double>(FLT_MAX);
  EXPECT_EQ(finite_float(0.1), 0.1F);
  EXPECT_EQ(finite_float(-1.5), -1.5F);
  EXPECT_EQ(finite_float(most), FLT_MAX);
  for (const double beyond : {1.5 * most, 1e300, kInf}) {
    EXPECT_EQ(finite_float(beyond), FLT_MAX);
    EXPECT_EQ(finite_float(-beyond), -FLT_MAX);
  }
  EXPECT_TRUE(std::isnan(finite_float(std::nan(""))));
}

/// Numbers of any size, including denormal floats and doubles.
std::vector<double> some_numbers(std::size_t count, Random& random) {
  std::vector<double> numbers{
      0.0, -0.0, DBL_MIN,  -DBL_MIN, DBL_TRUE_MIN, -DBL_TRUE_MIN, FLT_MIN, -FLT_MIN, kDenormal,
      1.0, -1.0, 0x1p-959, 0x1p-960, -0x1p-960,    1e-310,        -1e-310, 1e300,    1.5 * DBL_MIN};
  while (numbers.size() < count) {
    const double size =
        random.chance(0.5) ? random.log_uniform(1e-50, 1e-30) : random.log_uniform(1e-320, 1e300);
    numbers.push_back(random.chance(0.5) ? size : -size);
  }
  return numbers;
}

TEST(Rounding, rounding_is_equal_in_every_float_mode) {
  Random random(5);
  const std::vector<double> numbers = some_numbers(scaled(4000), random);
  std::vector<std::uint32_t> standard;
  const auto append = [&](std::vector<std::uint32_t>& bits) {
    for (const double number : numbers) {
      const volatile double seen = number;
      bits.push_back(std::bit_cast<std::uint32_t>(round_up(seen)));
      bits.push_back(std::bit_cast<std::uint32_t>(round_down(seen)));
    }
  };
  append(standard);
  for (const FloatMode& mode : all_float_modes()) {
    std::vector<std::uint32_t> bits;
    {
      const FloatModeScope scope(mode);
      append(bits);
    }
    EXPECT_EQ(bits, standard) << to_string(mode);
  }
}

TEST(Rounding, sums_round_outward_in_every_float_mode) {
  Random random(6);
  std::vector<double> numbers = some_numbers(scaled(400), random);
  std::erase_if(numbers, [](double x) { return x != 0.0 && std::abs(x) < 0x1p-959; });
  for (const FloatMode& mode : all_float_modes()) {
    std::size_t inward = 0;
    for (std::size_t i = 0; i < 20 * numbers.size(); ++i) {
      const volatile double a = numbers[i % numbers.size()];
      volatile double b = numbers[random.below(numbers.size())];
      if (random.chance(0.1)) b = -a;
      volatile double down = 0.0;
      volatile double up = 0.0;
      {
        const FloatModeScope scope(mode);
        down = add_down(a, b);
        up = add_up(a, b);
      }
      inward += down == add_down(a, b) && up == add_up(a, b) ? 0U : 1U;
      // The exact sum below needs terms that are far from denormal.
      if (std::abs(a) < 1e-250 || std::abs(b) < 1e-250) continue;
      const Exact sum = Exact(a) + Exact(b);
      inward += Exact(down) <= sum && sum <= Exact(up) ? 0U : 1U;
    }
    EXPECT_EQ(inward, 0U) << to_string(mode);
  }
}

TEST(Rounding, to_double_is_exact_in_every_float_mode) {
  for (const FloatMode& mode : all_float_modes()) {
    for (const float value : {0.0F, -0.0F, kDenormal, -kDenormal, FLT_MIN - kDenormal, FLT_MIN,
                              1.0F, -FLT_MAX, kInfF, -kInfF}) {
      const volatile float given = value;
      volatile double seen = 0.0;
      {
        const FloatModeScope scope(mode);
        seen = to_double(given);
      }
      EXPECT_EQ(seen, static_cast<double>(value)) << to_string(mode);
      EXPECT_EQ(std::signbit(seen), std::signbit(value)) << to_string(mode);
    }
  }
}

TEST(Rounding, vectors_are_rounded_by_component) {
  const Vec3d v(0.1, -0.1, 1e308);
  EXPECT_EQ(round_down(v), Vec3f(round_down(0.1), round_down(-0.1), FLT_MAX));
  EXPECT_EQ(round_up(v), Vec3f(round_up(0.1), round_up(-0.1), kInfF));
}

// Compilers vectorise such loops, and g++ 12 with its SLP vectoriser replaces a double that is
// rounded to float and back with the double itself.
TEST(Rounding, rounding_is_outward_in_vectorised_code) {
  Random random(2);
  std::vector<double> values(4096);
  for (double& value : values) value = random.uniform(-1, 1);
  std::vector<double> down(values.size());
  std::vector<double> up(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    down[i] = static_cast<double>(round_down(values[i]));
    up[i] = static_cast<double>(round_up(values[i]));
  }
  for (std::size_t i = 0; i + 2 < values.size(); i += 3) {
    const Vec3d v(values[i], values[i + 1], values[i + 2]);
    const Vec3d v_down = round_down(v).cast<double>();
    const Vec3d v_up = round_up(v).cast<double>();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = k;
      ASSERT_LT(down[i + k], values[i + k]) << "not even a float";
      ASSERT_GT(up[i + k], values[i + k]) << "not even a float";
      ASSERT_EQ(v_down[axis], down[i + k]);
      ASSERT_EQ(v_up[axis], up[i + k]);
    }
  }
}

}  // namespace
}  // namespace winnow::test
