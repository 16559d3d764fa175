// Compares the packing of set lanes, for every mask, with a loop over bits, and tests that nothing
// is written outside the output array.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <vector>

#include "tests/simd/lanes_ops.h"
#include "tests/support/config.h"

namespace winnow::test {
namespace {

constexpr std::uint32_t kUntouched = 0xA5A5A5A5U;
constexpr std::array<std::uint32_t, 16> kLanes{
    5, 0x80000001U, 0, 77, 0xFFFFFFFEU, 3, 12, 9, 1U << 31U, 16, 2, 8, 0x7FFFFFFFU, 40, 1, 30};

std::vector<std::uint32_t> packed(std::uint32_t mask) {
  std::vector<std::uint32_t> result;
  for (std::size_t i = 0; i < 16; ++i) {
    if ((mask >> i & 1U) != 0) result.push_back(kLanes[i]);
  }
  return result;
}

class Compress : public testing::TestWithParam<Isa> {
 protected:
  const LanesOps& ops() { return lanes_ops(); }

 private:
  IsaScope isa_{GetParam()};
};

TEST_P(Compress, set_lanes_of_every_mask_are_packed) {
  for (std::uint32_t mask = 0; mask < 65536; ++mask) {
    std::array<std::uint32_t, 18> out;
    out.fill(kUntouched);
    const std::vector<std::uint32_t> expected = packed(mask);
    ASSERT_EQ(ops().compress_store(mask, kLanes.data(), out.data() + 1), expected.size());
    ASSERT_TRUE(std::equal(expected.begin(), expected.end(), out.begin() + 1)) << mask;
    ASSERT_EQ(out.front(), kUntouched) << mask;
    ASSERT_EQ(out.back(), kUntouched) << mask;
  }
}

TEST_P(Compress, floats_are_packed_like_integers) {
  std::array<float, 16> lanes;
  std::transform(kLanes.begin(), kLanes.end(), lanes.begin(),
                 [](std::uint32_t lane) { return std::bit_cast<float>(lane); });
  for (std::uint32_t mask = 0; mask < 65536; ++mask) {
    std::array<float, 18> out;
    out.fill(std::bit_cast<float>(kUntouched));
    const std::vector<std::uint32_t> expected = packed(mask);
    ASSERT_EQ(ops().compress_store_floats(mask, lanes.data(), out.data() + 1), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      ASSERT_EQ(std::bit_cast<std::uint32_t>(out[i + 1]), expected[i]) << mask;
    }
    ASSERT_EQ(std::bit_cast<std::uint32_t>(out.front()), kUntouched) << mask;
    ASSERT_EQ(std::bit_cast<std::uint32_t>(out.back()), kUntouched) << mask;
  }
}

TEST_P(Compress, pairs_of_every_mask_are_emitted_in_order) {
  for (const std::uint32_t q : {0U, 10U, 0x80000000U, 0xFFFFFFFDU}) {
    for (std::uint32_t mask = 0; mask < 65536; ++mask) {
      std::array<std::uint32_t, 34> plain;
      std::array<std::uint32_t, 34> sorted;
      plain.fill(kUntouched);
      sorted.fill(kUntouched);
      const std::vector<std::uint32_t> lanes = packed(mask);
      ASSERT_EQ(ops().emit_pairs(mask, kLanes.data(), q, plain.data() + 1), lanes.size());
      ASSERT_EQ(ops().emit_sorted_pairs(mask, kLanes.data(), q, sorted.data() + 1), lanes.size());
      for (std::size_t i = 0; i < lanes.size(); ++i) {
        ASSERT_EQ(plain[2 * i + 1], q);
        ASSERT_EQ(plain[2 * i + 2], lanes[i]);
        ASSERT_EQ(sorted[2 * i + 1], std::min(q, lanes[i])) << "unsigned, not signed";
        ASSERT_EQ(sorted[2 * i + 2], std::max(q, lanes[i]));
      }
      ASSERT_EQ(plain.front(), kUntouched);
      ASSERT_EQ(plain.back(), kUntouched);
      ASSERT_EQ(sorted.front(), kUntouched);
      ASSERT_EQ(sorted.back(), kUntouched);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, Compress,
                         testing::ValuesIn(available_isas().begin(), available_isas().end()),
                         [](const auto& isa) { return to_string(isa.param); });

}  // namespace
}  // namespace winnow::test
