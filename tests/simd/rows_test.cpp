// Loading rows and corners into lanes, and conversions between precisions, compared with scalar
// loops on every instruction set.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "tests/simd/rows_ops.h"
#include "tests/support/config.h"
#include "tests/support/random.h"

namespace winnow::test {

WINNOW_DEFINE_KERNELS(RowsOps, rows_ops)

namespace {

/// Eight rows of eleven doubles at unordered addresses.
class Rows {
 public:
  explicit Rows(Random& random) : memory_(64 * 11) {
    for (double& v : memory_) v = random.uniform(-1.0, 1.0) * random.log_uniform(1e-300, 1e300);
    for (auto& row : rows) row = &memory_[random.below(64) * 11];
  }
  std::array<const double*, 8> rows{};

 private:
  std::vector<double> memory_;
};

class RowsToLanes : public testing::TestWithParam<Isa> {
 protected:
  Random random_{11};

 private:
  IsaScope isa_{GetParam()};
};

TEST_P(RowsToLanes, column_k_has_element_k_of_every_row) {
  for (int round = 0; round < 500; ++round) {
    const Rows in(random_);
    const Rows base(random_);
    std::array<double, 32> four{};
    std::array<double, 32> difference{};
    std::array<double, 16> two{};
    std::array<double, 8> one{};
    rows_ops().load_rows4(in.rows.data(), four.data());
    rows_ops().load_differences4(in.rows.data(), base.rows.data(), difference.data());
    rows_ops().load_rows2(in.rows.data(), two.data());
    rows_ops().load_rows1(in.rows.data(), one.data());
    for (std::size_t lane = 0; lane < 8; ++lane) {
      for (std::size_t k = 0; k < 4; ++k) {
        ASSERT_EQ(four[8 * k + lane], in.rows[lane][k]) << lane << " " << k;
        ASSERT_EQ(difference[8 * k + lane], in.rows[lane][k] - base.rows[lane][k]);
      }
      for (std::size_t k = 0; k < 2; ++k) ASSERT_EQ(two[8 * k + lane], in.rows[lane][k]);
      ASSERT_EQ(one[lane], in.rows[lane][0]);
    }
  }
}

TEST_P(RowsToLanes, conversions_are_rounded_to_nearest) {
  for (int round = 0; round < 500; ++round) {
    std::array<double, 16> in{};
    for (double& v : in) v = random_.uniform(-1.0, 1.0) * random_.log_uniform(1e-44, 1e40);
    std::array<float, 16> single{};
    std::array<double, 16> again{};
    rows_ops().to_single(in.data(), single.data());
    rows_ops().to_double(single.data(), again.data());
    for (std::size_t lane = 0; lane < 16; ++lane) {
      ASSERT_EQ(single[lane], static_cast<float>(in[lane])) << lane;
      ASSERT_EQ(again[lane], static_cast<double>(single[lane])) << lane;
    }
  }
}

TEST_P(RowsToLanes, bytes_become_words_above_a_base) {
  for (int round = 0; round < 500; ++round) {
    const std::uint64_t bytes = random_.bits();
    const auto base = static_cast<std::uint32_t>(random_.bits());
    std::array<std::uint32_t, 8> out{};
    rows_ops().store_bytes(bytes, base, out.data());
    for (unsigned i = 0; i < 8; ++i) {
      ASSERT_EQ(out[i], base + static_cast<std::uint32_t>(bytes >> 8 * i & 0xFFU));
    }
  }
}

TEST_P(RowsToLanes, negation_flips_the_sign_of_zero) {
  const double infinity = std::numeric_limits<double>::infinity();
  const std::array<double, 8> in{0.0, -0.0, 1.0, -1.0, 5e-324, -5e-324, infinity, -infinity};
  std::array<double, 8> out{};
  rows_ops().negate(in.data(), out.data());
  for (std::size_t lane = 0; lane < 8; ++lane) {
    EXPECT_EQ(out[lane], -in[lane]);
    EXPECT_EQ(std::signbit(out[lane]), !std::signbit(in[lane])) << lane;
  }
}

TEST_P(RowsToLanes, corners_are_loaded_in_order_or_shifted) {
  for (int round = 0; round < 500; ++round) {
    std::array<std::array<float, 4>, 3> corner{};
    for (auto& point : corner) {
      for (float& x : point) x = static_cast<float>(random_.uniform(-1.0, 1.0));
    }
    const std::array<const float*, 3> from{corner[0].data(), corner[1].data(), corner[2].data()};
    for (const bool next : {false, true}) {
      std::array<double, 12> out{};
      rows_ops().load_corners(from.data(), next, out.data());
      for (std::size_t axis = 0; axis < 3; ++axis) {
        for (std::size_t lane = 0; lane < 4; ++lane) {
          ASSERT_EQ(out[4 * axis + lane],
                    static_cast<double>(corner[(lane + (next ? 1 : 0)) % 3][axis]))
              << axis << " " << lane;
        }
      }
    }
  }
}

TEST_P(RowsToLanes, joined_corners_are_in_order) {
  const std::array<double, 3> corner{0x1p-1022, -0.0, 1.0 / 3.0};
  std::array<double, 4> out{};
  rows_ops().join_corners(corner.data(), out.data());
  for (std::size_t lane = 0; lane < 4; ++lane) EXPECT_EQ(out[lane], corner[lane % 3]) << lane;
}

INSTANTIATE_TEST_SUITE_P(All, RowsToLanes,
                         testing::ValuesIn(available_isas().begin(), available_isas().end()),
                         [](const auto& isa) { return to_string(isa.param); });

}  // namespace
}  // namespace winnow::test
