// Invalid calls of the C interface return a status: null pointers, one or all; struct sizes of
// other versions; kinds that do not exist; stale keys; refused memory.

#include "tests/c/handles_of_c.h"
#include "tests/c/hostile_world.h"

#include <winnow/c/winnow.h>

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>
#include <tuple>

namespace winnow::test {
namespace {

constexpr std::size_t kNone = ~std::size_t{0};

/// Calls the function with arguments from the world, one of which is null.
template <typename... Arguments, std::size_t... kIndex>
winnow_status call_without(std::size_t missing, HostileWorld& world,
                           winnow_status (*function)(Arguments...),
                           std::index_sequence<kIndex...>) {
  const auto argument = [&]<typename T>(std::size_t index, T*) {
    if constexpr (std::is_pointer_v<T>) {
      if (index == missing) return T{};
    }
    return world.get<T>(index);
  };
  const winnow_status status =
      function(argument(kIndex, static_cast<std::remove_const_t<Arguments>*>(nullptr))...);
  world.end_made();
  return status;
}

template <typename... Arguments>
winnow_status call_without(std::size_t missing, HostileWorld& world,
                           winnow_status (*function)(Arguments...)) {
  return call_without(missing, world, function, std::index_sequence_for<Arguments...>());
}

template <typename... Arguments>
winnow_status call_with_zeros(winnow_status (*function)(Arguments...)) {
  return function(Arguments{}...);
}

template <typename... Arguments>
constexpr std::size_t count_of(winnow_status (*)(Arguments...)) {
  return sizeof...(Arguments);
}

TEST(CInterface, calls_with_zeros_are_refused) {
#define WINNOW_CALL(function) \
  EXPECT_EQ(call_with_zeros(&(function)), WINNOW_INVALID_ARGUMENT) << #function;
#include <winnow_calls.inc>
#undef WINNOW_CALL
}

TEST(CInterface, calls_with_one_null_pointer_return_a_status) {
  HostileWorld world;
#define WINNOW_CALL(function)                                                    \
  for (std::size_t missing = 0; missing < count_of(&(function)); ++missing) {    \
    const winnow_status status = call_without(missing, world, &(function));      \
    EXPECT_STRNE(winnow_status_name(status), "unknown") << #function << missing; \
  }
#include <winnow_calls.inc>
#undef WINNOW_CALL
}

TEST(CInterface, structs_of_another_size_are_refused) {
  for (const std::size_t size : {std::size_t{0}, std::size_t{8}, std::size_t{5000}}) {
    HostileWorld world;
    world.size_of_structs = size;
#define WINNOW_CALL(function)                                                                 \
  if (takes_sized(&(function))) {                                                             \
    EXPECT_EQ(call_without(kNone, world, &(function)), WINNOW_INVALID_ARGUMENT) << #function; \
  }
#include <winnow_calls.inc>
#undef WINNOW_CALL
  }
}

TEST(CInterface, longer_struct_with_zero_tail_is_accepted) {
  struct {
    winnow_pair_options now = WINNOW_PAIR_OPTIONS;
    std::uint64_t later = 0;
  } options;
  struct {
    winnow_statistics now{};
    std::uint64_t later = 7;
  } statistics;
  options.now.size = sizeof options;
  statistics.now.size = sizeof statistics;
  HostileWorld world;
  EXPECT_EQ(winnow_partition_self_pairs(world.partition, world.pairs, nullptr, &options.now),
            WINNOW_OK);
  EXPECT_EQ(winnow_partition_statistics(world.partition, &statistics.now), WINNOW_OK);
  EXPECT_EQ(statistics.later, 0U);
  EXPECT_EQ(statistics.now.size, sizeof statistics);
  options.later = 1;
  EXPECT_EQ(winnow_partition_self_pairs(world.partition, world.pairs, nullptr, &options.now),
            WINNOW_INVALID_ARGUMENT);
}

TEST(CInterface, unknown_kinds_are_refused) {
  HostileWorld world;
  for (const std::int32_t none : {-1, 1000, std::numeric_limits<std::int32_t>::max()}) {
    winnow_partition* partition = nullptr;
    winnow_partition_options options = WINNOW_PARTITION_OPTIONS;
    EXPECT_EQ(winnow_partition_create({none, 0}, nullptr, &partition), WINNOW_INVALID_ARGUMENT);
    options.volume = none;
    EXPECT_EQ(winnow_partition_create({}, &options, &partition), WINNOW_INVALID_ARGUMENT);
    options.volume = WINNOW_VOLUME_AABB;
    options.execution.kind = none;
    EXPECT_EQ(winnow_partition_create({}, &options, &partition), WINNOW_INVALID_ARGUMENT);
    EXPECT_EQ(partition, nullptr);
    winnow_cast cast{};
    cast.kind = none;
    winnow_hit hit;
    EXPECT_EQ(winnow_partition_closest(world.partition, &cast, nullptr, &hit),
              WINNOW_INVALID_ARGUMENT);
    winnow_region region{};
    region.kind = none;
    EXPECT_EQ(winnow_partition_overlap(world.partition, &region, nullptr, WINNOW_ORDER_FAST,
                                       world.overlaps),
              WINNOW_INVALID_ARGUMENT);
    winnow_shape shape{};
    shape.kind = none;
    winnow_shape_id id = WINNOW_NO_SHAPE;
    EXPECT_EQ(winnow_shape_pool_add(world.shapes, &shape, &id), WINNOW_INVALID_ARGUMENT);
    EXPECT_EQ(winnow_scene_collide(world.scene, none, world.contacts), WINNOW_INVALID_ARGUMENT);
    EXPECT_STREQ(winnow_structure_name({none, 0}), "");
    EXPECT_STREQ(winnow_status_name(none), "unknown");
    EXPECT_STREQ(winnow_shape_kind_name(none), "none");
  }
  EXPECT_EQ(winnow_set_isa("abacus"), WINNOW_INVALID_ARGUMENT);
  winnow_structure_kind structure{};
  EXPECT_EQ(winnow_structure_named("Heap", &structure), WINNOW_INVALID_ARGUMENT);
}

TEST(CInterface, stale_keys_are_refused) {
  HostileWorld world;
  const winnow_aabb box = {{0, 0, 0}, {1, 1, 1}};
  const winnow_box_view boxes = winnow_boxes(&box, 1);
  winnow_key key = WINNOW_NULL_KEY;
  ASSERT_EQ(winnow_partition_insert(world.partition, &boxes, nullptr, &key), WINNOW_OK);
  ASSERT_EQ(winnow_partition_remove(world.partition, &key, 1), WINNOW_OK);
  EXPECT_EQ(winnow_partition_remove(world.partition, &key, 1), WINNOW_INVALID_KEY);
  EXPECT_EQ(winnow_partition_update(world.partition, &key, 1, &boxes, nullptr), WINNOW_INVALID_KEY);
  EXPECT_EQ(winnow_partition_update(world.partition, &key, 0, &boxes, nullptr),
            WINNOW_SIZE_MISMATCH);
  winnow_aabb bounds;
  EXPECT_EQ(winnow_partition_bounds(world.partition, key, &bounds), WINNOW_INVALID_KEY);
  EXPECT_EQ(winnow_partition_bounds_of(world.partition, &key, &bounds, 1), WINNOW_INVALID_KEY);
  EXPECT_EQ(winnow_partition_bounds_of(world.partition, &key, nullptr, 1), WINNOW_INVALID_ARGUMENT);
  winnow_body_definition body = WINNOW_BODY_DEFINITION;
  EXPECT_EQ(winnow_scene_body(world.scene, key, &body), WINNOW_INVALID_KEY);
  EXPECT_EQ(winnow_scene_add(world.scene, &body, 1, &key), WINNOW_INVALID_KEY);
  winnow_shape shape;
  EXPECT_EQ(winnow_shape_pool_shape(world.shapes, WINNOW_NO_SHAPE, &shape), WINNOW_INVALID_KEY);
  std::size_t parts = 0;
  EXPECT_EQ(winnow_composite_pool_parts(world.composites, 77, &parts), WINNOW_INVALID_KEY);
  EXPECT_EQ(winnow_composite_pool_set_solid(world.composites, 77, true), WINNOW_INVALID_KEY);
  EXPECT_EQ(winnow_composite_pool_set_solid(nullptr, 77, true), WINNOW_INVALID_ARGUMENT);
  EXPECT_EQ(winnow_composite_pool_is_solid(world.composites, 77, nullptr), WINNOW_INVALID_ARGUMENT);
  std::uint32_t child = 0;
  std::uint32_t part = 0;
  EXPECT_EQ(winnow_composite_pool_part(world.composites, 77, 0, &child, &part), WINNOW_INVALID_KEY);
  EXPECT_EQ(winnow_composite_pool_part(world.composites, 77, 0, &child, nullptr),
            WINNOW_INVALID_ARGUMENT);
}

TEST(CInterface, partition_of_a_scene_cannot_be_changed) {
  HostileWorld world;
  const winnow_partition* view = nullptr;
  ASSERT_EQ(winnow_scene_partition(world.scene, WINNOW_BODY_STATE_DYNAMIC, &view), WINNOW_OK);
  ASSERT_NE(view, nullptr);
  auto* partition = const_cast<winnow_partition*>(view);
  const winnow_box_view none{};
  EXPECT_EQ(winnow_partition_insert(partition, &none, nullptr, nullptr), WINNOW_INVALID_ARGUMENT);
  EXPECT_EQ(winnow_partition_clear(partition), WINNOW_INVALID_ARGUMENT);
  std::size_t size = 0;
  EXPECT_EQ(winnow_partition_size(view, &size), WINNOW_OK);
  EXPECT_EQ(size, 1U);
}

/// Creates a partition and finds its pairs; returns the first status that is not ok.
[[nodiscard]] winnow_status pairs_in(const winnow_memory& memory) {
  const double low[3] = {0.0, 0.5, 4.0};
  const double high[3] = {1.0, 1.5, 5.0};
  const winnow_box_view boxes = {{low, low, low}, {high, high, high}, 0, 3, WINNOW_DOUBLE};
  winnow_partition_options options = WINNOW_PARTITION_OPTIONS;
  options.memory = &memory;
  winnow_partition* partition = nullptr;
  winnow_pair_buffer* pairs = nullptr;
  winnow_key keys[3];
  winnow_status status = winnow_partition_create({}, &options, &partition);
  if (status == WINNOW_OK) status = winnow_pair_buffer_create(&memory, &pairs);
  if (status == WINNOW_OK) status = winnow_partition_insert(partition, &boxes, nullptr, keys);
  if (status == WINNOW_OK) status = winnow_partition_self_pairs(partition, pairs, nullptr, nullptr);
  winnow_pair_buffer_destroy(pairs);
  winnow_partition_destroy(partition);
  return status;
}

TEST(CInterface, refused_memory_gives_a_status_and_no_leak) {
  winnow_status status = WINNOW_OUT_OF_MEMORY;
  std::size_t granted = 0;
  for (; status != WINNOW_OK; ++granted) {
    CountedMemory source{granted};
    status = pairs_in(source.functions());
    EXPECT_EQ(source.outstanding, 0U);
    EXPECT_EQ(status, source.requests > granted ? WINNOW_OUT_OF_MEMORY : WINNOW_OK);
    ASSERT_LT(granted, 1000U);
  }
  EXPECT_GT(granted, 3U);
}

}  // namespace
}  // namespace winnow::test
