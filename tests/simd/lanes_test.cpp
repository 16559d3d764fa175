// Every operation on lanes compared with a scalar loop, on every instruction set of this machine,
// with hostile floats.

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cfloat>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <vector>

#include "tests/simd/lanes_ops.h"
#include "tests/support/config.h"
#include "tests/support/random.h"

namespace winnow::test {

WINNOW_DEFINE_KERNELS(LanesOps, lanes_ops)

namespace {

using Floats = std::array<float, 16>;
using Uints = std::array<std::uint32_t, 16>;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kDenormal = std::numeric_limits<float>::denorm_min();
constexpr std::array kHostile{0.0F,       -0.0F,          1.0F,    -1.0F,    kInf,      -kInf,
                              FLT_MAX,    -FLT_MAX,       FLT_MIN, -FLT_MIN, kDenormal, -kDenormal,
                              16777216.F, 0x1.fffffep-1F, 1e30F,   -1e-30F};

class LaneOps : public testing::TestWithParam<Isa> {
 protected:
  const LanesOps& ops() { return lanes_ops(); }

  // Returns sixteen floats: hostile ones, ordinary ones and optionally NaNs.
  Floats lanes(bool with_nan = false) {
    Floats result;
    for (float& f : result) {
      if (with_nan && random_.chance(0.2)) {
        f = random_.chance(0.5) ? kNan : -kNan;
      } else if (random_.chance(0.6)) {
        f = kHostile[random_.below(kHostile.size())];
      } else {
        f = static_cast<float>(random_.uniform(-2, 2));
      }
    }
    return result;
  }

  using Binary = void (*)(const float*, const float*, float*);
  void expect_lane_wise(Binary by_lanes, const std::function<float(float, float)>& scalar,
                        bool with_nan) {
    for (int round = 0; round < 5000; ++round) {
      const Floats a = lanes(with_nan);
      const Floats b = lanes(with_nan);
      Floats out;
      by_lanes(a.data(), b.data(), out.data());
      for (std::size_t i = 0; i < 16; ++i) {
        const float expected = scalar(a[i], b[i]);
        // Zeros of either sign count as equal, as do all NaNs.
        ASSERT_TRUE(out[i] == expected || (std::isnan(out[i]) && std::isnan(expected)))
            << a[i] << ", " << b[i] << " gives " << out[i];
      }
    }
  }

  Random random_{1};

 private:
  IsaScope isa_{GetParam()};
};

TEST_P(LaneOps, table_belongs_to_the_active_isa) {
  EXPECT_STREQ(ops().isa_name, to_string(GetParam()));
}

TEST_P(LaneOps, loads_and_stores_keep_every_bit) {
  for (int round = 0; round < 1000; ++round) {
    alignas(64) Floats in = lanes(true);
    std::array<float, 17> shifted;
    std::memcpy(&shifted[1], in.data(), sizeof in);
    Floats out;
    ops().load_store(in.data(), out.data());
    ASSERT_EQ(std::memcmp(in.data(), out.data(), sizeof in), 0);
    ops().load_unaligned_store(&shifted[1], out.data());
    ASSERT_EQ(std::memcmp(in.data(), out.data(), sizeof in), 0);
    Uints words;
    Uints copy;
    std::memcpy(words.data(), in.data(), sizeof in);
    ops().load_store_uint(words.data(), copy.data());
    ASSERT_EQ(words, copy);
  }
}

TEST_P(LaneOps, broadcast_fills_every_lane) {
  for (const float value : kHostile) {
    Floats out;
    ops().broadcast(value, out.data());
    for (const float lane : out) EXPECT_EQ(std::memcmp(&lane, &value, sizeof value), 0);
  }
  for (const std::uint32_t value : {0U, 1U, 0x80000000U, 0xFFFFFFFFU}) {
    Uints out;
    ops().broadcast_uint(value, out.data());
    for (const std::uint32_t lane : out) EXPECT_EQ(lane, value);
  }
}

TEST_P(LaneOps, count_from_counts_up_from_the_base) {
  for (const std::uint32_t base : {0U, 7U, 0x7FFFFFF8U, 0xFFFFFFF8U}) {
    Uints out;
    ops().count_from(base, out.data());
    for (std::uint32_t i = 0; i < 16; ++i) EXPECT_EQ(out[i], base + i);
  }
}

TEST_P(LaneOps, arithmetic_works_on_each_lane) {
  expect_lane_wise(
      ops().min, [](float a, float b) { return b < a ? b : a; }, false);
  expect_lane_wise(
      ops().max, [](float a, float b) { return a < b ? b : a; }, false);
  expect_lane_wise(
      ops().add, [](float a, float b) { return a + b; }, true);
  expect_lane_wise(
      ops().multiply, [](float a, float b) { return a * b; }, true);
  expect_lane_wise(
      ops().divide, [](float a, float b) { return a / b; }, true);
}

TEST_P(LaneOps, square_roots_are_rounded_to_nearest) {
  for (int round = 0; round < 5000; ++round) {
    const Floats in = lanes(true);
    Floats out;
    ops().sqrt(in.data(), out.data());
    for (std::size_t i = 0; i < 16; ++i) {
      const float expected = std::sqrt(in[i]);
      ASSERT_TRUE(out[i] == expected || (std::isnan(out[i]) && std::isnan(expected)))
          << in[i] << " gives " << out[i];
    }
  }
}

TEST_P(LaneOps, multiply_add_is_rounded_once_or_twice) {
  for (int round = 0; round < 5000; ++round) {
    const Floats a = lanes();
    const Floats b = lanes();
    const Floats c = lanes();
    Floats out;
    ops().multiply_add(a.data(), b.data(), c.data(), out.data());
    for (std::size_t i = 0; i < 16; ++i) {
      const float once = std::fma(a[i], b[i], c[i]);
      const float twice = a[i] * b[i] + c[i];
      ASSERT_TRUE(out[i] == once || out[i] == twice || (std::isnan(out[i]) && std::isnan(twice)))
          << a[i] << " * " << b[i] << " + " << c[i] << " gives " << out[i];
    }
  }
}

TEST_P(LaneOps, lanes_that_compare_false_become_infinite) {
  for (int round = 0; round < 5000; ++round) {
    const Floats a = lanes(true);
    const Floats b = lanes(true);
    const Floats v = lanes();
    Floats out;
    ops().keep_less_equal(a.data(), b.data(), v.data(), out.data());
    for (std::size_t i = 0; i < 16; ++i) ASSERT_EQ(out[i], a[i] <= b[i] ? v[i] : kInf);
  }
}

TEST_P(LaneOps, comparisons_are_closed_and_false_for_nan) {
  for (int round = 0; round < 5000; ++round) {
    const Floats a = lanes(true);
    const Floats b = lanes(true);
    std::uint32_t expected = 0;
    for (std::size_t i = 0; i < 16; ++i) expected |= (a[i] <= b[i] ? 1U : 0U) << i;
    ASSERT_EQ(ops().less_equal(a.data(), b.data()), expected);
  }
}

TEST_P(LaneOps, reductions_find_the_extreme_in_any_lane) {
  for (std::size_t at = 0; at < 16; ++at) {
    Floats in;
    in.fill(2.0F);
    in[at] = -3.0F;
    EXPECT_EQ(ops().reduce_min(in.data()), -3.0F) << "lane " << at;
    in[at] = 5.0F;
    EXPECT_EQ(ops().reduce_max(in.data()), 5.0F) << "lane " << at;
  }
  for (int round = 0; round < 5000; ++round) {
    const Floats in = lanes();
    ASSERT_EQ(ops().reduce_min(in.data()), *std::min_element(in.begin(), in.end()));
    ASSERT_EQ(ops().reduce_max(in.data()), *std::max_element(in.begin(), in.end()));
  }
}

TEST_P(LaneOps, packed_points_have_ten_bits_per_axis) {
  for (int round = 0; round < 1000; ++round) {
    alignas(64) std::uint32_t packed[16];
    for (auto& p : packed) p = static_cast<std::uint32_t>(random_.below(1U << 30U));
    packed[0] = round == 0 ? (1U << 30U) - 1U : packed[0];
    float axis[3][16];
    ops().load_packed(packed, axis);
    for (std::size_t i = 0; i < 16; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        ASSERT_EQ(axis[k][i], static_cast<float>(packed[i] >> (10 * k) & 1023U));
      }
    }
  }
}

TEST_P(LaneOps, pick_selects_the_given_lanes) {
  std::array<float, 32> from;
  for (std::size_t i = 0; i < 32; ++i) from[i] = static_cast<float>(i);
  for (int round = 0; round < 1000; ++round) {
    std::array<std::uint8_t, 16> place;
    Floats out;
    for (auto& p : place) p = static_cast<std::uint8_t>(random_.below(16));
    ops().pick_of_16(from.data(), place.data(), out.data());
    for (std::size_t i = 0; i < 16; ++i) ASSERT_EQ(out[i], from[place[i]]);
    for (auto& p : place) p = static_cast<std::uint8_t>(random_.below(32));
    ops().pick_of_32(from.data(), place.data(), out.data());
    for (std::size_t i = 0; i < 16; ++i) ASSERT_EQ(out[i], from[place[i]]);
  }
}

TEST_P(LaneOps, one_place_beyond_the_limit_is_found) {
  for (std::size_t at = 0; at < 48; ++at) {
    std::array<std::uint8_t, 48> place;
    place.fill(15);
    EXPECT_TRUE(ops().are_below_16(place.data()));
    place[at] = 16;
    EXPECT_FALSE(ops().are_below_16(place.data()));
    place[at] = 31;
    EXPECT_TRUE(ops().are_below_32(place.data()));
    place[at] = 32;
    EXPECT_FALSE(ops().are_below_32(place.data()));
  }
}

TEST_P(LaneOps, positive_floats_are_ordered_by_their_bits) {
  for (int round = 0; round < 5000; ++round) {
    const Floats a = lanes();
    Floats b = lanes();
    for (float& f : b) f = f == 0.0F ? 1.0F : std::abs(f);
    Floats larger;
    Floats smaller;
    ops().larger_positive(a.data(), b.data(), larger.data());
    ops().smaller_positive(a.data(), b.data(), smaller.data());
    for (std::size_t i = 0; i < 16; ++i) {
      ASSERT_EQ(larger[i], std::max(a[i], b[i]));
      ASSERT_EQ(smaller[i], std::min(a[i], b[i]));
    }
    const std::uint32_t least = ops().reduce_min_positive(b.data());
    ASSERT_EQ(std::bit_cast<float>(least), *std::min_element(b.begin(), b.end()));
  }
}

TEST_P(LaneOps, scalar_path_equals_the_lanes) {
  const std::array hostile{0.0,     -0.0,     1.0,    -1.0,     static_cast<double>(kInf),
                           DBL_MAX, -DBL_MAX, 5e-324, -DBL_MIN, -static_cast<double>(kInf)};
  const auto draw = [&] {
    return random_.chance(0.4) ? hostile[random_.below(hostile.size())] : random_.uniform(-2, 2);
  };
  for (int round = 0; round < 20000; ++round) {
    const double a = draw();
    const double b = draw();
    std::array<double, kScalarResults> scalar{};
    std::array<double, kScalarResults> lanes{};
    ops().scalar(a, b, scalar.data());
    ops().in_lanes(a, b, lanes.data());
    for (std::size_t i = 0; i < scalar.size(); ++i) {
      const bool same = std::isnan(lanes[i]) ? std::isnan(scalar[i])
                                             : std::bit_cast<std::uint64_t>(scalar[i]) ==
                                                   std::bit_cast<std::uint64_t>(lanes[i]);
      ASSERT_TRUE(same) << "result " << i << " of " << a << " and " << b << ": " << scalar[i]
                        << " and " << lanes[i];
    }
    ASSERT_EQ(std::isnan(scalar[0]), std::isnan(a + b));
    ASSERT_EQ(scalar[14] != 0.0, a == b);
  }
}

TEST_P(LaneOps, masks_are_counted_and_searched) {
  for (std::uint32_t mask = 0; mask < 65536; ++mask) {
    unsigned bits = 0;
    unsigned lowest = 16;
    for (unsigned i = 16; i-- > 0;) {
      if ((mask >> i & 1U) == 0) continue;
      ++bits;
      lowest = i;
    }
    ASSERT_EQ(ops().count(mask), bits);
    if (mask != 0) {
      ASSERT_EQ(ops().first(mask), lowest);
    }
  }
  for (unsigned n = 0; n <= 16; ++n) EXPECT_EQ(ops().lanes_below(n), (1ULL << n) - 1);
}

// Slabs of random volumes, hostile ends and empty rows, compared with the definition.
template <std::size_t Slabs>
class Volumes {
 public:
  explicit Volumes(Random& random) {
    for (std::size_t s = 0; s < Slabs; ++s) {
      for (std::size_t row = 0; row < kRows; ++row) {
        const bool empty = row % 7 == 3;
        low_[s][row] = empty ? kInf : end(random, -1);
        high_[s][row] = empty ? -kInf : end(random, 1);
      }
      columns_[s] = low_[s].data();
      columns_[Slabs + s] = high_[s].data();
      query_low_[s] = end(random, -1);
      query_high_[s] = end(random, 1);
    }
  }

  std::uint32_t expected(std::size_t row) const {
    std::uint32_t mask = 0;
    for (std::size_t i = 0; i < 16; ++i) {
      bool hit = true;
      for (std::size_t s = 0; s < Slabs; ++s) {
        hit = hit && low_[s][row + i] <= query_high_[s] && query_low_[s] <= high_[s][row + i];
      }
      mask |= (hit ? 1U : 0U) << i;
    }
    return mask;
  }

  using Overlap = std::uint32_t (*)(const float* const*, std::size_t, const float*, const float*);
  std::uint32_t test_row(Overlap overlap, std::size_t row) const {
    return overlap(columns_.data(), row, query_low_.data(), query_high_.data());
  }

  static constexpr std::size_t kRows = 48;

 private:
  // Mostly ends whose slabs overlap, so that hits are frequent even with many slabs.
  static float end(Random& random, float sign) {
    if (random.chance(0.05)) return kHostile[random.below(kHostile.size())];
    if (random.chance(0.02)) return kNan;
    return sign * static_cast<float>(random.below(5)) - (random.chance(0.05) ? 3.0F * sign : 0.0F);
  }

  alignas(64) std::array<std::array<float, kRows>, Slabs> low_;
  alignas(64) std::array<std::array<float, kRows>, Slabs> high_;
  std::array<const float*, 2 * Slabs> columns_;
  std::array<float, Slabs> query_low_;
  std::array<float, Slabs> query_high_;
};

TEST_P(LaneOps, overlap_is_the_closed_test_of_slabs) {
  std::uint32_t hits3 = 0;
  std::uint32_t hits13 = 0;
  for (int round = 0; round < 5000; ++round) {
    const Volumes<3> boxes(random_);
    const Volumes<13> kdops(random_);
    for (std::size_t row = 0; row < 48; row += 16) {
      ASSERT_EQ(boxes.test_row(ops().overlap3, row), boxes.expected(row));
      ASSERT_EQ(kdops.test_row(ops().overlap13, row), kdops.expected(row));
      hits3 |= boxes.expected(row);
      hits13 |= kdops.expected(row);
    }
    for (std::size_t row = 0; row < 32; ++row) {
      ASSERT_EQ(boxes.test_row(ops().overlap3_unaligned, row), boxes.expected(row));
    }
  }
  EXPECT_EQ(hits3, 0xFFFFU) << "the test hits no pair in some lane";
  EXPECT_EQ(hits13, 0xFFFFU) << "the test hits no pair in some lane";
}

INSTANTIATE_TEST_SUITE_P(All, LaneOps,
                         testing::ValuesIn(available_isas().begin(), available_isas().end()),
                         [](const auto& isa) { return to_string(isa.param); });

}  // namespace
}  // namespace winnow::test
