// Dyadic, the fixed-size exact numbers of the exact overlap test, compared with doubles and with
// the integers of Boost.

#include "pipeline/exact/dyadic.h"
#include <gtest/gtest.h>

#include <cfloat>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <vector>

#include "tests/support/random.h"

#if __has_include(<boost/multiprecision/cpp_int.hpp>)
#define WINNOW_HAVE_BOOST_INTEGERS 1
#include <boost/multiprecision/cpp_int.hpp>
#endif

namespace winnow::test {
namespace {

constexpr double kDenormal = std::numeric_limits<double>::denorm_min();

TEST(Dyadic, arithmetic_on_integers_matches_int) {
  for (int a = -9; a <= 9; ++a) {
    for (int b = -9; b <= 9; ++b) {
      const Dyadic x(a);
      const Dyadic y(b);
      EXPECT_EQ(compare(x + y, Dyadic(a + b)), 0);
      EXPECT_EQ(compare(x - y, Dyadic(a - b)), 0);
      EXPECT_EQ(compare(x * y, Dyadic(a * b)), 0);
      EXPECT_EQ(compare(x, y), (a > b) - (a < b));
      EXPECT_EQ((-x).sign(), (a < 0) - (a > 0));
    }
  }
}

TEST(Dyadic, sum_of_distant_doubles_keeps_every_bit) {
  const Dyadic sum = Dyadic(DBL_MAX) + kDenormal;
  EXPECT_EQ(compare(sum, DBL_MAX), 1);
  EXPECT_EQ(compare(sum - DBL_MAX, kDenormal), 0);
  const Dyadic square = sum * sum;
  const Dyadic terms =
      Dyadic(DBL_MAX) * DBL_MAX + Dyadic(2.0) * DBL_MAX * kDenormal + Dyadic(kDenormal) * kDenormal;
  EXPECT_EQ(compare(square, terms), 0);
  EXPECT_EQ(square.lowest_bit(), -2148);
  EXPECT_EQ(square.highest_bit(), 2047);
}

TEST(Dyadic, results_beyond_capacity_are_zero) {
  constexpr int kTooFar = 64 * (kDyadicDigits + 1);
  const Dyadic far = Dyadic::power_of_two(kTooFar);
  EXPECT_EQ((far + 1.0).sign(), 0);
  EXPECT_EQ((far - 1.0).sign(), 0);
  EXPECT_EQ((Dyadic(1.0) - far).sign(), 0);
  const Dyadic wide = Dyadic::power_of_two(64 * (kDyadicDigits / 2)) + 1.0;
  EXPECT_EQ(wide.sign(), 1);
  EXPECT_EQ((wide * wide).sign(), 0);
  EXPECT_EQ((wide * Dyadic(-1.0)).sign(), -1);
}

TEST(Dyadic, sum_of_full_capacity_is_exact) {
  const Dyadic most = Dyadic::power_of_two(64 * (kDyadicDigits - 2) + 63);
  EXPECT_EQ(compare(most + 1.0 - most, 1.0), 0);
  EXPECT_EQ(compare(most - 1.0 - most, -1.0), 0);
}

TEST(Dyadic, self_assignment_keeps_value) {
  Dyadic number(-2.5);
  const Dyadic& same = number;
  number = same;
  EXPECT_EQ(compare(number, -2.5), 0);
  EXPECT_EQ(Dyadic().scaled(3), 0.0);
  EXPECT_EQ(compare(Dyadic(), 0.0), 0);
}

TEST(Dyadic, scaled_returns_nearly_nearest_double) {
  for (const double value : {1.0, 3.0, 0.1, 1e300, -7e-300, DBL_MIN, -DBL_MAX}) {
    EXPECT_EQ(Dyadic(value).scaled(0), value);
    const double third = (Dyadic(value) * 0x1.5555555555555p-2).scaled(0);
    EXPECT_NEAR(third / value, 0x1.5555555555555p-2, 0x1p-52);
  }
}

TEST(Dyadic, root_is_exact_or_slightly_above) {
  Random random(7);
  for (const double value : {1.0, 5.0, 12.0, 0x1p-600, 3.0 * 0x1p500, 0.75}) {
    EXPECT_EQ(compare(root_above(Dyadic(value) * value), value), 0) << value;
  }
  EXPECT_EQ(root_above(Dyadic(0.0)).sign(), 0);
  for (int i = 0; i < 1000; ++i) {
    const Dyadic square = Dyadic(random.log_uniform(1e-300, 1e300)) * random.unit();
    if (square.sign() == 0) continue;
    const Dyadic root = root_above(square);
    EXPECT_GE(compare(root * root, square), 0);
    EXPECT_LE(compare(root * root, square * (1.0 + 0x1p-50)), 0);
  }
}

#ifdef WINNOW_HAVE_BOOST_INTEGERS
using Integer = boost::multiprecision::cpp_int;

// Numbers are multiples of 2^-1200.
constexpr int kScale = 1200;

[[nodiscard]] Integer integer_of(double value, int scale) {
  int exponent = 0;
  const double mantissa = std::frexp(value, &exponent);
  const Integer digits(static_cast<long long>(std::ldexp(mantissa, 53)));
  return digits * (Integer(1) << (scale + exponent - 53));
}

[[nodiscard]] double any_double(Random& random) {
  static const double kNice[] = {0.0, 1.0, -1.0, 0.5, 3.0, 0x1p64, 0x1p-64, 0x1p63 - 512.0};
  if (random.chance(0.3)) return kNice[random.below(std::size(kNice))];
  const double value = random.log_uniform(1e-120, 1e120);
  return random.chance(0.5) ? value : -value;
}

TEST(Dyadic, polynomials_match_big_integers) {
  Random random(11);
  for (std::size_t i = 0; i < scaled(20000); ++i) {
    double v[5];
    for (double& x : v) x = any_double(random);
    const Dyadic made = (Dyadic(v[0]) * v[1] - Dyadic(v[2]) * v[3] + v[4]) * v[0] - v[2];
    const auto as_integer = [](double x) { return integer_of(x, kScale); };
    const Integer pair = as_integer(v[0]) * as_integer(v[1]) - as_integer(v[2]) * as_integer(v[3]) +
                         integer_of(v[4], 2 * kScale);
    const Integer whole = pair * as_integer(v[0]) - integer_of(v[2], 3 * kScale);
    ASSERT_EQ(made.sign(), whole.sign());
    if (made.sign() == 0) continue;
    const Integer size = abs(whole);
    ASSERT_EQ(made.lowest_bit() + 3 * kScale, static_cast<int>(lsb(size)));
    ASSERT_EQ(made.highest_bit() + 3 * kScale, static_cast<int>(msb(size)));
    // All bits agree: subtracting the leading double again and again ends at zero.
    Dyadic rest = made;
    Integer other = whole;
    for (int part = 0; part < 64 && rest.sign() != 0; ++part) {
      const int top = rest.highest_bit();
      const double lead = rest.scaled(-top);
      const Dyadic piece = Dyadic(lead) * Dyadic::power_of_two(top);
      rest = rest - piece;
      other -= integer_of(lead, 60) * (Integer(1) << (3 * kScale + top)) / (Integer(1) << 60);
      ASSERT_EQ(rest.sign(), other.sign());
    }
    ASSERT_EQ(rest.sign(), 0);
  }
}

/// Sums of a few powers of two near the ends of digits, so that carries and borrows run through all
/// digits.
struct Runs {
  Dyadic number;
  Integer integer;  // times 2^kRunScale

  static constexpr int kRunScale = 400;

  Runs(Random& random, std::size_t terms) : number(0.0), integer(0) {
    for (std::size_t i = 0; i < terms; ++i) {
      static const int kEnds[] = {-256, -193, -192, -130, -128, -127, -65, -64, -63, -62, -53,
                                  -52,  -2,   -1,   0,    1,    10,   52,  61,  62,  63,  64,
                                  65,   124,  125,  126,  127,  128,  191, 192, 255, 256, 320};
      const int exponent = kEnds[random.below(std::size(kEnds))];
      const Dyadic power = Dyadic::power_of_two(exponent);
      const Integer same = Integer(1) << (kRunScale + exponent);
      const bool negative = random.chance(0.5);
      number = negative ? number - power : number + power;
      integer += negative ? Integer(-same) : same;
    }
  }
};

/// Checks that a number is an integer times 2^-scale: sign, lowest and highest bit, and all bits
/// between them.
void expect_is(const Dyadic& number, const Integer& integer, int scale) {
  ASSERT_EQ(number.sign(), integer.sign());
  if (integer == 0) return;
  const Integer size = abs(integer);
  const int low = static_cast<int>(lsb(size));
  const int high = static_cast<int>(msb(size));
  ASSERT_EQ(number.lowest_bit(), low - scale);
  ASSERT_EQ(number.highest_bit(), high - scale);
  // Only the last few of the upper 60 bits may be missing.
  const Integer top = high >= 60 ? Integer(size >> (high - 60)) : Integer(size << (60 - high));
  const double mantissa = static_cast<double>(static_cast<std::uint64_t>(top)) * 0x1p-60;
  const double scaled = number.scaled(scale - high);
  ASSERT_LE(std::abs(std::abs(scaled) - mantissa), 0x1p-50);
  ASSERT_EQ(scaled < 0.0, integer.sign() < 0);
  // Subtracting all set bits, from the lowest up, leaves zero.
  Dyadic rest = integer.sign() < 0 ? -number : number;
  for (int bit = low; bit <= high; ++bit) {
    if (!bit_test(size, static_cast<unsigned>(bit))) continue;
    ASSERT_EQ(rest.lowest_bit(), bit - scale);
    rest = rest - Dyadic::power_of_two(bit - scale);
  }
  ASSERT_EQ(rest.sign(), 0);
}

TEST(Dyadic, carries_through_all_digits_match_big_integers) {
  Random random(12);
  constexpr int kUnit = Runs::kRunScale;
  for (int i = 0; i < 1500; ++i) {
    const Runs a(random, 1 + random.below(4));
    const Runs b(random, 1 + random.below(4));
    expect_is(a.number, a.integer, kUnit);
    expect_is(a.number + b.number, a.integer + b.integer, kUnit);
    expect_is(a.number - b.number, a.integer - b.integer, kUnit);
    expect_is(a.number - a.number, 0, kUnit);
    expect_is(a.number * b.number, a.integer * b.integer, 2 * kUnit);
    const int order = a.integer < b.integer ? -1 : a.integer > b.integer ? 1 : 0;
    ASSERT_EQ(compare(a.number, b.number), order) << i;
    ASSERT_EQ(compare(b.number, a.number), -order) << i;
    ASSERT_EQ(compare(a.number, a.number), 0) << i;
    const Dyadic copy = a.number;
    ASSERT_EQ(compare(copy, a.number), 0) << i;
    if (HasFatalFailure()) FAIL() << i;
  }
}

TEST(Dyadic, root_of_near_squares_is_tight) {
  Random random(13);
  for (int i = 0; i < 1000; ++i) {
    // Squares of numbers with few bits, and their neighbours.
    const double root = std::ldexp(static_cast<double>(1 + random.below(1U << 25U)),
                                   static_cast<int>(random.below(400)) - 200);
    const Dyadic square = Dyadic(root) * root;
    ASSERT_EQ(compare(root_above(square), root), 0) << root;
    const Dyadic more = square + Dyadic::power_of_two(square.highest_bit() - 52);
    ASSERT_GT(compare(root_above(more), root), 0) << root;
    ASSERT_LE(compare(root_above(more), Dyadic(root) * (1.0 + 0x1p-51)), 0) << root;
    const Dyadic less = square - Dyadic::power_of_two(square.highest_bit() - 70);
    ASSERT_EQ(compare(root_above(less), root), 0) << root;
  }
}
#endif

}  // namespace
}  // namespace winnow::test
