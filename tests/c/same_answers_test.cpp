// The C interface returns the same results as the C++ interface, number by number.

#include "tests/c/notes.h"

#include <winnow/c/winnow.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace winnow::test {
namespace {

using Scenario = void (*)(const trace*);

void expect_same(Scenario in_c, Scenario in_cpp) {
  Notes c;
  Notes cpp;
  in_c(c.where());
  in_cpp(cpp.where());
  ASSERT_FALSE(cpp.all().empty());
  const std::size_t both = std::min(c.all().size(), cpp.all().size());
  for (std::size_t i = 0; i < both; ++i) {
    ASSERT_EQ(c.all()[i].first, cpp.all()[i].first) << "note " << i << " of " << both;
    ASSERT_EQ(c.all()[i].second, cpp.all()[i].second) << c.all()[i].first << ", note " << i;
  }
  EXPECT_EQ(c.all().size(), cpp.all().size());
}

TEST(CInterface, partitions_give_the_results_of_cpp) {
  expect_same(run_partitions_in_c, run_partitions_in_cpp);
}

TEST(CInterface, spheres_and_kdops_give_the_results_of_cpp) {
  expect_same(run_volumes_in_c, run_volumes_in_cpp);
}

TEST(CInterface, shapes_give_the_results_of_cpp) {
  expect_same(run_shapes_in_c, run_shapes_in_cpp);
}

TEST(CInterface, pairs_of_shapes_give_the_results_of_cpp) {
  expect_same(run_narrow_phase_in_c, run_narrow_phase_in_cpp);
}

TEST(CInterface, scenes_give_the_results_of_cpp) {
  expect_same(run_scenes_in_c, run_scenes_in_cpp);
}

TEST(CInterface, sensors_and_impacts_give_the_results_of_cpp) {
  expect_same(run_watchers_in_c, run_watchers_in_cpp);
}

TEST(CInterface, motions_and_hooks_give_the_results_of_cpp) {
  expect_same(run_impacts_in_c, run_impacts_in_cpp);
}

/// Returns all pairs of a dense row of boxes.
[[nodiscard]] std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs_on(
    const winnow_execution& execution) {
  std::vector<winnow_aabb> boxes(20000);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const float x = 0.25F * static_cast<float>(i);
    boxes[i] = {{x, 0, 0}, {x + 1.0F, 1, 1}};
  }
  const winnow_box_view view = winnow_boxes(boxes.data(), boxes.size());
  std::vector<winnow_key> keys(boxes.size());
  winnow_partition_options options = WINNOW_PARTITION_OPTIONS;
  options.execution = execution;
  winnow_partition* partition = nullptr;
  winnow_pair_buffer* buffer = nullptr;
  const winnow_pair* first = nullptr;
  std::size_t count = 0;
  EXPECT_EQ(winnow_partition_create({}, &options, &partition), WINNOW_OK);
  EXPECT_EQ(winnow_pair_buffer_create(nullptr, &buffer), WINNOW_OK);
  EXPECT_EQ(winnow_partition_insert(partition, &view, nullptr, keys.data()), WINNOW_OK);
  EXPECT_EQ(winnow_partition_self_pairs(partition, buffer, nullptr, nullptr), WINNOW_OK);
  EXPECT_EQ(winnow_pair_buffer_pairs(buffer, &first, &count), WINNOW_OK);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (std::size_t i = 0; i < count; ++i) pairs.emplace_back(first[i].first, first[i].second);
  winnow_pair_buffer_destroy(buffer);
  winnow_partition_destroy(partition);
  return pairs;
}

TEST(CInterface, pair_order_does_not_depend_on_threads) {
  const auto serial = pairs_on({WINNOW_EXECUTION_SERIAL, {}});
  EXPECT_EQ(serial.size(), 20000U * 4 - 10);
  EXPECT_TRUE(pairs_on({WINNOW_EXECUTION_PARALLEL, {}}) == serial);
  for (const std::size_t count : {1, 2, 5}) {
    winnow_threads* threads = nullptr;
    const winnow_status status = winnow_threads_create(count, &threads);
    if (status == WINNOW_UNSUPPORTED) continue;
    ASSERT_EQ(status, WINNOW_OK);
    winnow_execution execution;
    ASSERT_EQ(winnow_threads_execution(threads, &execution), WINNOW_OK);
    EXPECT_TRUE(pairs_on(execution) == serial) << count;
    winnow_threads_destroy(threads);
  }
}

}  // namespace
}  // namespace winnow::test
