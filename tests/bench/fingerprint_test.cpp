// The fingerprint of a frame's pairs, as the contract of the winnow tool defines it.

#include "bench/measure/fingerprint.h"

#include <gtest/gtest.h>

#include <vector>

namespace winnow::bench {
namespace {

// Boxes 0, 1 and 2 overlap each other, box 5 overlaps box 2, the others overlap nothing.
const std::vector<Aabb> kBoxes{{{0, 0, 0}, {2, 2, 2}},   {{1, 1, 1}, {3, 3, 3}},
                               {{2, 2, 2}, {4, 4, 4}},   {{10, 0, 0}, {11, 1, 1}},
                               {{20, 0, 0}, {21, 1, 1}}, {{4, 4, 4}, {5, 5, 5}}};

TEST(Fingerprint, fingerprint_is_the_wrapping_sum_of_mixed_pairs) {
  EXPECT_EQ(summarize(std::vector<Pair>{{0, 1}}, kBoxes).fingerprint, 0x910A2DEC89025CC1ULL);
  EXPECT_EQ(summarize(std::vector<Pair>{{0, 1}, {0, 2}, {1, 2}}, kBoxes).fingerprint,
            0xDBD29EA339EA23B1ULL);
  EXPECT_EQ(summarize(std::vector<Pair>{{2, 5}}, kBoxes).fingerprint, 0xC75DBBC736C00A84ULL);
  EXPECT_EQ(summarize(std::vector<Pair>{}, kBoxes).fingerprint, 0U);
}

TEST(Fingerprint, fingerprint_does_not_depend_on_pair_order) {
  const PairSummary a = summarize(std::vector<Pair>{{0, 1}, {0, 2}, {2, 5}}, kBoxes);
  const PairSummary b = summarize(std::vector<Pair>{{5, 2}, {1, 0}, {0, 2}}, kBoxes);
  EXPECT_TRUE(a.same_pairs(b));
  EXPECT_EQ(a.pairs, 3U);
}

TEST(Fingerprint, pairs_that_do_not_overlap_are_left_out) {
  const PairSummary all = summarize(std::vector<Pair>{{0, 1}, {0, 3}, {3, 4}}, kBoxes);
  const PairSummary true_ones = summarize(std::vector<Pair>{{0, 1}}, kBoxes);
  EXPECT_EQ(all.reported, 3U);
  EXPECT_EQ(all.pairs, 1U);
  EXPECT_TRUE(all.same_pairs(true_ones));
}

TEST(Fingerprint, missing_false_and_doubled_pairs_change_the_fingerprint) {
  const PairSummary right = summarize(std::vector<Pair>{{0, 1}, {0, 2}}, kBoxes);
  EXPECT_FALSE(right.same_pairs(summarize(std::vector<Pair>{{0, 1}}, kBoxes)));
  EXPECT_FALSE(right.same_pairs(summarize(std::vector<Pair>{{0, 1}, {1, 2}}, kBoxes)));
  EXPECT_FALSE(right.same_pairs(summarize(std::vector<Pair>{{0, 1}, {0, 2}, {0, 2}}, kBoxes)));
}

TEST(Fingerprint, hex_text_has_sixteen_lower_case_digits) {
  EXPECT_EQ(to_hex(0), "0000000000000000");
  EXPECT_EQ(to_hex(0x0123456789ABCDEFULL), "0123456789abcdef");
}

}  // namespace
}  // namespace winnow::bench
