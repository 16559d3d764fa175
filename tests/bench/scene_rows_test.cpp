#include "bench/rows/rows.h"

#include <gtest/gtest.h>

namespace winnow::bench {
namespace {

TEST(SceneCosts, rows_count_bytes_and_contacts_by_margin) {
  Results results;
  add_scene_costs(results, {.scene = "balls", .threads = {1}, .frames = 2, .bodies = 500});
  const auto rows = results.rows("scene_costs");
  ASSERT_EQ(rows.size(), 4U);
  for (std::size_t i = 0; i < rows.size(); i += 2) {
    EXPECT_EQ(value_of(*rows[i], "over_none"), 1.0);
    EXPECT_GT(value_of(*rows[i], "touching"), 5.0 * 500.0);
    EXPECT_GT(value_of(*rows[i + 1], "touching"), value_of(*rows[i], "touching"));
    // The output columns of a contact take at least this many bytes.
    EXPECT_GT(value_of(*rows[i], "bytes_per_contact"), 100.0);
  }
}

}  // namespace
}  // namespace winnow::bench
