// Kernels that copy boxes into rows and find the boxes that left their old bounds, compared with
// tests of each box.

#include <gtest/gtest.h>
#include <winnow/simd/isa.h>
#include "partitions/rows/box_compare.kernel.h"
#include "partitions/rows/box_input.kernel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/config.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

constexpr std::size_t kFloats = 6;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Returns boxes of six floats each, some of which are infinite.
std::vector<float> some_boxes(Random& random, std::size_t count) {
  std::vector<float> floats;
  for (std::size_t i = 0; i < count; ++i) {
    float box[kFloats];
    for (int axis = 0; axis < 3; ++axis) {
      box[axis] = static_cast<float>(random.uniform(-10.0, 10.0));
      box[3 + axis] = box[axis] + static_cast<float>(random.uniform(0.0, 2.0));
    }
    if (i % 13 == 5) box[i % 3] = -kInfinity;
    if (i % 17 == 3) box[3 + i % 3] = kInfinity;
    floats.insert(floats.end(), box, box + kFloats);
  }
  return floats;
}

class BoxInput : public testing::TestWithParam<Isa> {};

TEST_P(BoxInput, boxes_not_within_a_box_are_found) {
  const IsaScope scope(GetParam());
  Random random(1);
  for (std::size_t count = 0; count < 120; ++count) {
    const std::vector<float> boxes = some_boxes(random, count);
    for (const float reach : {0.0F, 4.0F, 11.0F, 13.0F, kInfinity}) {
      const float around[kFloats] = {-reach, -reach, -kInfinity, reach, kInfinity, reach};
      std::vector<std::uint32_t> expected;
      for (std::uint32_t i = 0; i < count; ++i) {
        const float* const box = boxes.data() + i * kFloats;
        bool inside = true;
        for (int axis = 0; axis < 3; ++axis) {
          inside = inside && around[axis] <= box[axis] && box[3 + axis] <= around[3 + axis];
        }
        if (!inside) expected.push_back(i);
      }
      std::vector<std::uint32_t> found(count);
      found.resize(box_compare_kernels().beyond(boxes.data(), around, count, found.data()));
      EXPECT_EQ(found, expected);
    }
  }
}

TEST_P(BoxInput, boxes_are_copied_and_distant_ones_found) {
  const IsaScope scope(GetParam());
  Random random(2);
  for (std::size_t count = 0; count < 120; ++count) {
    const std::vector<float> near = some_boxes(random, count);
    std::vector<float> boxes = near;
    for (float& end : boxes) end += static_cast<float>(random.uniform(-1.0, 1.0));
    for (const float skin : {0.0F, 0.9F, 0.99F, 2.0F}) {
      std::vector<std::uint32_t> expected;
      for (std::uint32_t i = 0; i < count; ++i) {
        bool is_near = true;
        for (std::size_t c = i * kFloats; c < (i + 1) * kFloats; ++c) {
          is_near = is_near && (std::abs(boxes[c] - near[c]) <= skin || boxes[c] == near[c]);
        }
        if (!is_near) expected.push_back(i);
      }
      std::vector<float> to(boxes.size());
      std::vector<std::uint32_t> left(count + 32);
      left.resize(box_compare_kernels().copy_near(boxes.data(), near.data(), to.data(), count, skin,
                                                  left.data(), static_cast<std::uint32_t>(count)));
      EXPECT_EQ(left, expected);
      EXPECT_EQ(to, boxes);
    }
  }
}

// Returns the value that rows store for an infinite end.
float stored_end(float end) {
  constexpr float kLargestFloat = std::numeric_limits<float>::max();
  return std::clamp(end, -kLargestFloat, kLargestFloat);
}

// Compares with the test of a single box: no decision here needs rounding, so the lanes must agree
// exactly.
TEST_P(BoxInput, boxes_still_inside_their_margin_are_found) {
  const IsaScope scope(GetParam());
  Random random(4);
  constexpr float kDistance = 0.25F;
  constexpr float kShare = 0.125F;
  for (std::size_t count = 1; count <= 256; count += 15) {
    const std::size_t rows = (count + 15) / 16 * 16;
    std::vector<std::vector<float>> given(kFloats, std::vector<float>(rows));
    std::vector<std::vector<float>> stored = given;
    std::vector<bool> expected(count);
    for (std::size_t i = 0; i < count; ++i) {
      float longest = 0.0F;
      for (std::size_t a = 0; a < 3; ++a) {
        given[a][i] = static_cast<float>(random.below(64));
        const float edge = static_cast<float>(random.below(5));
        given[3 + a][i] = given[a][i] + edge;
        longest = std::max(longest, edge);
      }
      const std::size_t endless = random.below(12);
      if (endless < kFloats) {
        given[endless][i] = stored_end(endless < 3 ? -kInfinity : kInfinity);
        longest = 0.0F;
        for (std::size_t a = 0; a < 3; ++a) {
          if (a != endless % 3) longest = std::max(longest, given[3 + a][i] - given[a][i]);
        }
      }
      const float margin = kDistance + kShare * longest;
      bool serves = true;
      for (std::size_t a = 0; a < 3; ++a) {
        // Distances in eighths of the margin. In most cases the new box is inside.
        const auto low_by = static_cast<float>(random.below(40)) - 1.0F;
        const auto high_by = static_cast<float>(random.below(18)) - (random.chance(0.1) ? 1.0F : 0);
        const bool endless_axis = endless < kFloats && endless % 3 == a;
        stored[a][i] = given[a][i] - (endless_axis ? 0.0F : margin * low_by / 8.0F);
        stored[3 + a][i] = given[3 + a][i] + (endless_axis ? 0.0F : margin * high_by / 8.0F);
        serves = serves && (endless_axis ||
                            (low_by >= 0.0F && high_by >= 0.0F && low_by + high_by <= 8.0F * 4.0F));
      }
      expected[i] = serves;
    }
    const float* given_columns[kFloats];
    const float* stored_columns[kFloats];
    for (std::size_t c = 0; c < kFloats; ++c) {
      given_columns[c] = given[c].data();
      stored_columns[c] = stored[c].data();
    }
    std::vector<std::uint64_t> words((rows + 63) / 64, ~std::uint64_t{0});
    box_compare_kernels().within(given_columns, stored_columns, count, kDistance, kShare,
                                 words.data());
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ((words[i / 64] >> i % 64 & 1U) != 0, expected[i]) << i << " of " << count;
    }
  }
}

TEST_P(BoxInput, rows_get_only_the_boxes_of_their_objects) {
  const IsaScope scope(GetParam());
  Random random(3);
  constexpr std::size_t kRows = 96;
  for (int round = 0; round < 200; ++round) {
    // Some ids from 10 on have a box; rows hold these ids, other ids or none.
    const std::vector<float> boxes = some_boxes(random, 60);
    std::vector<std::uint32_t> table(80, ~0U);
    const bool listed = round % 2 == 0;
    for (std::uint32_t k = 0; listed && k < 60; ++k) table[k + k / 4] = k;
    const EntryOfId entry_of_id{10, listed ? 80U : 60U, listed ? table.data() : nullptr};
    std::vector<std::uint32_t> ids(kRows + 32, ~0U);
    for (std::uint32_t& id : ids) {
      if (random.below(8) != 0) id = static_cast<std::uint32_t>(random.below(100));
    }
    std::vector<std::vector<float>> columns(kFloats, std::vector<float>(kRows + 16, 77.0F));
    float* pointers[kFloats];
    for (std::size_t c = 0; c < kFloats; ++c) pointers[c] = columns[c].data();
    box_input_kernels().write_rows(boxes.data(), entry_of_id, ids.data(), pointers, 16, kRows);
    for (std::size_t row = 0; row < kRows + 16; ++row) {
      const std::uint32_t k = ids[row] - 10;
      const bool known = row >= 16 && row < kRows && k < entry_of_id.ids;
      const std::uint32_t number = !known ? ~0U : listed ? table[k] : k;
      for (std::size_t c = 0; c < kFloats; ++c) {
        float expected = 77.0F;
        if (number != ~0U) {
          constexpr float kLargestFloat = std::numeric_limits<float>::max();
          expected = std::clamp(boxes[number * kFloats + c], -kLargestFloat, kLargestFloat);
        }
        ASSERT_EQ(columns[c][row], expected) << row << " " << c;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, BoxInput,
                         testing::ValuesIn(available_isas().begin(), available_isas().end()));

}  // namespace
}  // namespace winnow::test
