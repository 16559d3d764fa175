// The incremental counts of a filter table equal a count over all filters.

#include "partitions/rows/filter_table.h"
#include <gtest/gtest.h>
#include <winnow/core/filter.h>

#include <algorithm>
#include <memory_resource>
#include <vector>

#include "tests/support/random.h"

namespace winnow::test {
namespace {

constexpr std::size_t kObjects = 6;

// Reference: all filters, and a loop over them for each result.
struct FilterReference {
  std::vector<ObjectFilter> filters = std::vector<ObjectFilter>(kObjects);
  std::size_t changed = 0;

  void set(ObjectId id, const ObjectFilter& filter) {
    changed += filters[id].environment != filter.environment ? 1 : 0;
    filters[id] = filter;
  }
  [[nodiscard]] bool has_environments() const {
    return std::any_of(filters.begin(), filters.end(), [](const ObjectFilter& filter) {
      return filter.environment != 0 && filter.environment != kAllEnvironments;
    });
  }
};

ObjectFilter of_environment(std::uint32_t environment) {
  ObjectFilter filter;
  filter.environment = environment;
  return filter;
}

TEST(FilterTable, table_has_environments_while_an_object_has_one) {
  FilterTable table(std::pmr::get_default_resource());
  FilterReference reference;
  ASSERT_TRUE(table.reserve(kObjects));
  ASSERT_TRUE(table.begin_use());
  Random random(11);
  int together = 0;
  for (int step = 0; step < 4000; ++step) {
    const auto id = static_cast<ObjectId>(random.below(kObjects));
    if (random.chance(0.4)) {
      table.reset(id);
      reference.filters[id] = {};
    } else {
      constexpr std::uint32_t kEnvironments[] = {0, 0, kAllEnvironments, 1, 2};
      const ObjectFilter filter = of_environment(kEnvironments[random.below(5)]);
      table.set(id, filter);
      reference.set(id, filter);
    }
    ASSERT_EQ(table.has_environments(), reference.has_environments()) << "step " << step;
    ASSERT_EQ(table.changed_environments(), reference.changed) << "step " << step;
    together += reference.has_environments() ? 0 : 1;
  }
  EXPECT_GT(together, 100);
  EXPECT_LT(together, 3900);
}

ObjectFilter any_of_few(Random& random) {
  const auto bits = [&] { return static_cast<std::uint32_t>(random.below(8)); };
  constexpr std::uint32_t kEnvironments[] = {0, 0, 0, 0, 0, kAllEnvironments, kAllEnvironments, 1};
  const std::uint32_t mask = random.chance(0.5) ? ~bits() : bits();
  return {bits(), mask, kEnvironments[random.below(8)]};
}

TEST(FilterSpans, surely_match_is_true_only_if_all_match) {
  Random random(5);
  int sure = 0;
  for (int round = 0; round < 20000; ++round) {
    std::vector<ObjectFilter> sides[2];
    FilterSpan spans[2];
    for (int side = 0; side < 2; ++side) {
      for (std::size_t i = 0; i <= random.below(3); ++i) {
        sides[side].push_back(any_of_few(random));
        spans[side].add(sides[side].back());
      }
    }
    bool all = true;
    for (const ObjectFilter& a : sides[0]) {
      for (const ObjectFilter& b : sides[1]) all = all && filters_allow(a, b);
    }
    const bool certain = surely_match(spans[0], spans[1]);
    ASSERT_TRUE(all || !certain) << round;
    ASSERT_EQ(certain, surely_match(spans[1], spans[0])) << round;
    // With a single filter on each side the result is exact, unless the environments of both
    // filters are neither 0 nor kAllEnvironments.
    const bool single = sides[0].size() == 1 && sides[1].size() == 1;
    if (single && !(spans[0].environments && spans[1].environments)) {
      ASSERT_EQ(certain, all) << round;
    }
    sure += certain ? 1 : 0;
  }
  EXPECT_GT(sure, 1000);
}

TEST(FilterTable, span_covers_every_object_exactly_after_a_build) {
  FilterTable table(std::pmr::get_default_resource());
  ASSERT_TRUE(table.reserve(kObjects));
  ASSERT_TRUE(table.begin_use());
  Random random(2);
  std::vector<bool> live(kObjects);
  const auto span = [&] {
    FilterSpan of_all;
    for (ObjectId id = 0; id < kObjects; ++id) {
      if (live[id]) of_all.add(table.of(id));
    }
    return of_all;
  };
  for (int step = 0; step < 4000; ++step) {
    const auto id = static_cast<ObjectId>(random.below(kObjects));
    if (!live[id]) {
      table.note_new();
      live[id] = true;
    } else if (random.chance(0.3)) {
      table.reset(id);
      live[id] = false;
    } else {
      table.set(id, any_of_few(random));
    }
    const FilterSpan least = span();
    FilterSpan kept = table.span();
    ASSERT_EQ(kept.any_layers & least.any_layers, least.any_layers) << step;
    ASSERT_EQ(kept.any_mask & least.any_mask, least.any_mask) << step;
    ASSERT_EQ(kept.every_layers & least.every_layers, kept.every_layers) << step;
    ASSERT_EQ(kept.every_mask & least.every_mask, kept.every_mask) << step;
    ASSERT_TRUE((kept.any_unpairable || !least.any_unpairable) &&
                (least.all_environments || !kept.all_environments))
        << step;
    ASSERT_EQ(kept.environments, least.environments) << step;
    if (step % 7 != 0) continue;
    std::vector<ObjectId> ids;
    for (ObjectId object = 0; object < kObjects; ++object) {
      ids.push_back(live[object] ? object : kNoObject);
    }
    table.note_build(ids);
    kept = table.span();
    ASSERT_EQ(kept.any_layers, least.any_layers) << step;
    ASSERT_EQ(kept.every_layers, least.every_layers) << step;
    ASSERT_EQ(kept.any_mask, least.any_mask) << step;
    ASSERT_EQ(kept.every_mask, least.every_mask) << step;
    ASSERT_EQ(kept.any_unpairable, least.any_unpairable) << step;
    ASSERT_EQ(kept.all_environments, least.all_environments) << step;
  }
}

TEST(FilterTable, cleared_table_has_no_environment) {
  FilterTable table(std::pmr::get_default_resource());
  ASSERT_TRUE(table.reserve(kObjects));
  ASSERT_TRUE(table.begin_use());
  table.set(3, of_environment(5));
  EXPECT_TRUE(table.has_environments());
  table.clear();
  EXPECT_FALSE(table.has_environments());
  EXPECT_FALSE(table.in_use());
  EXPECT_EQ(table.changed_environments(), 0U);
  // A new object gets the default filter.
  ASSERT_TRUE(table.begin_use());
  EXPECT_EQ(table.of(3).environment, 0U);
}

}  // namespace
}  // namespace winnow::test
