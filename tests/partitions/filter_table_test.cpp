// What a table of filters counts as it goes along is what a count over all filters says.

#include "partitions/rows/filter_table.h"
#include <gtest/gtest.h>

#include <algorithm>
#include <memory_resource>
#include <vector>

#include "tests/support/random.h"

namespace winnow::test {
namespace {

constexpr std::size_t kObjects = 6;

// All filters, and a walk over them for each answer.
struct FilterTwin {
  std::vector<ObjectFilter> filters = std::vector<ObjectFilter>(kObjects);
  std::size_t changed = 0;

  void set(ObjectId id, const ObjectFilter& filter) {
    changed += filters[id].environment != filter.environment ? 1 : 0;
    filters[id] = filter;
  }
  [[nodiscard]] bool has_environments() const {
    return std::any_of(filters.begin(), filters.end(), [](const ObjectFilter& filter) {
      return filter.environment != 0 && filter.environment != kEveryEnvironment;
    });
  }
};

ObjectFilter of_environment(std::uint32_t environment) {
  ObjectFilter filter;
  filter.environment = environment;
  return filter;
}

TEST(FilterTable, has_environments_as_long_as_an_object_is_in_one) {
  FilterTable table(std::pmr::get_default_resource());
  FilterTwin twin;
  ASSERT_TRUE(table.reserve(kObjects));
  ASSERT_TRUE(table.begin_use());
  Random random(11);
  int together = 0;
  for (int step = 0; step < 4000; ++step) {
    const auto id = static_cast<ObjectId>(random.below(kObjects));
    if (random.chance(0.4)) {
      table.reset(id);
      twin.filters[id] = {};
    } else {
      constexpr std::uint32_t kEnvironments[] = {0, 0, kEveryEnvironment, 1, 2};
      const ObjectFilter filter = of_environment(kEnvironments[random.below(5)]);
      table.set(id, filter);
      twin.set(id, filter);
    }
    ASSERT_EQ(table.has_environments(), twin.has_environments()) << "step " << step;
    ASSERT_EQ(table.changed_environments(), twin.changed) << "step " << step;
    together += twin.has_environments() ? 0 : 1;
  }
  EXPECT_GT(together, 100);
  EXPECT_LT(together, 3900);
}

TEST(FilterTable, that_is_cleared_knows_no_environment) {
  FilterTable table(std::pmr::get_default_resource());
  ASSERT_TRUE(table.reserve(kObjects));
  ASSERT_TRUE(table.begin_use());
  table.set(3, of_environment(5));
  EXPECT_TRUE(table.has_environments());
  table.clear();
  EXPECT_FALSE(table.has_environments());
  EXPECT_FALSE(table.in_use());
  EXPECT_EQ(table.changed_environments(), 0U);
  // What comes later finds the default.
  ASSERT_TRUE(table.begin_use());
  EXPECT_EQ(table.of(3).environment, 0U);
}

}  // namespace
}  // namespace winnow::test
