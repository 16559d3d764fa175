// Partitions and their buffers in C, compared with C++ calls on the same partition.

#include "tests/c/handles_of_c.h"

#include <winnow/core/regions.h>

#include <array>
#include <cmath>
#include <cstring>
#include <string_view>
#include <vector>

namespace winnow::test {
namespace {

constexpr std::size_t kObjects = 200;

[[nodiscard]] bool is_even_in_c(void*, winnow_key key, std::uint64_t) {
  return key.id % 2 == 0;
}
[[nodiscard]] winnow_filter even_in_c() {
  winnow_filter filter = WINNOW_FILTER;
  filter.accept = is_even_in_c;
  return filter;
}
const Filter kEven{.predicate = {[](void*, Key key, ClientData) { return key.id % 2 == 0; }}};
constexpr winnow_filter* kAll = nullptr;

/// A partition of boxes in columns of double, whose memory is counted.
class BoxesOfC {
 public:
  BoxesOfC() : memory(counted.functions()), partition(create()) {
    place(0);
    EXPECT_EQ(winnow_partition_reserve(partition, kObjects, WINNOW_PAGES_TOUCHED), WINNOW_OK);
    const winnow_box_view boxes = view();
    EXPECT_EQ(winnow_partition_insert(partition, &boxes, data.data(), keys.data()), WINNOW_OK);
  }

  [[nodiscard]] winnow_box_view view() const {
    return {{columns[0].data(), columns[1].data(), columns[2].data()},
            {columns[3].data(), columns[4].data(), columns[5].data()},
            0,
            kObjects,
            WINNOW_DOUBLE};
  }
  /// Sets the columns to the positions of a frame.
  void place(std::size_t frame) {
    for (std::size_t i = 0; i < kObjects; ++i) {
      const std::size_t at[3] = {i * 37 % 31, i * 17 % 29, i * 11 % 23};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        columns[axis][i] =
            0.7 * static_cast<double>(at[axis]) + 0.1 * static_cast<double>(frame * (i % 3));
        columns[3 + axis][i] = columns[axis][i] + 1.0 + 0.3 * static_cast<double>(i % 5);
      }
      data[i] = 1000 + 3 * i;
    }
  }
  /// Returns the float box of object i.
  [[nodiscard]] Aabb box(std::size_t i) const {
    return Aabb::outward(Vec3d(columns[0][i], columns[1][i], columns[2][i]),
                         Vec3d(columns[3][i], columns[4][i], columns[5][i]));
  }
  [[nodiscard]] Key key(std::size_t i) const { return c::to_cpp(keys[i]); }

  CountedMemory counted;
  winnow_memory memory;
  std::size_t parallel_calls = 0;
  OwnedPartition partition;
  std::array<std::array<double, kObjects>, 6> columns{};
  std::array<std::uint64_t, kObjects> data{};
  std::array<winnow_key, kObjects> keys{};

 private:
  /// Creates a loose octree that runs its tasks on this thread, the last one first, and makes it a
  /// sweep.
  [[nodiscard]] OwnedPartition create() {
    winnow_partition_options options = WINNOW_PARTITION_OPTIONS;
    options.memory = &memory;
    options.execution = {
        WINNOW_EXECUTION_ON,
        {[](void* context, std::size_t count, void (*task)(void*, std::size_t), void* tasks) {
           ++*static_cast<std::size_t*>(context);
           for (std::size_t i = count; i-- > 0;) task(tasks, i);
         },
         &parallel_calls, 2}};
    OwnedPartition made(winnow_partition_create, winnow_structure_kind{WINNOW_LOOSE_OCTREE, 3.0F},
                        &options);
    EXPECT_TRUE(made->structure() == loose_octree(3.0F));
    EXPECT_EQ(winnow_partition_set_structure(
                  made, got<winnow_structure_kind>(winnow_structure_named, "SweepAndPrune")),
              WINNOW_OK);
    return made;
  }
};

TEST(CInterface, objects_of_a_partition_are_returned) {
  const BoxesOfC world;
  const OwnedPartition& partition = world.partition;
  EXPECT_EQ(got<std::size_t>(winnow_partition_size, partition), kObjects);
  std::array<winnow_aabb, kObjects> all;
  EXPECT_EQ(winnow_partition_bounds_of(partition, world.keys.data(), all.data(), kObjects),
            WINNOW_OK);
  for (std::size_t i = 0; i < kObjects; ++i) {
    const winnow_key key = world.keys[i];
    EXPECT_TRUE(got<bool>(winnow_partition_contains, partition, key));
    EXPECT_TRUE(same(got<winnow_aabb>(winnow_partition_bounds, partition, key), world.box(i)));
    EXPECT_TRUE(same(all[i], world.box(i)));
    EXPECT_EQ(got<std::uint64_t>(winnow_partition_client_data, partition, key), world.data[i]);
    EXPECT_EQ(got<std::uint64_t>(winnow_partition_client_data_of, partition, key.id),
              world.data[i]);
    EXPECT_TRUE(same(got<winnow_key>(winnow_partition_key_of, partition, key.id), world.key(i)));
  }
  EXPECT_EQ(got<std::uint64_t>(winnow_partition_client_data_of, partition, 9999U), 0U);
  const std::array<winnow_object_filter, 2> filters{{{2, 3, 0}, {1, 1, 5}}};
  EXPECT_EQ(winnow_partition_set_filter(partition, &world.keys[3], filters.data(), 2), WINNOW_OK);
  EXPECT_TRUE(same(got<winnow_object_filter>(winnow_partition_filter, partition, world.keys[4]),
                   ObjectFilter{1, 1, 5}));
}

TEST(CInterface, pairs_and_events_are_arrays_of_cpp) {
  BoxesOfC world;
  const OwnedPartition& partition = world.partition;
  const OwnedPairs pairs(winnow_pair_buffer_create, nullptr);
  const OwnedPairs copy(winnow_pair_buffer_create, nullptr);
  const OwnedEvents events(winnow_pair_events_create_with_client_data, nullptr);
  const OwnedEvents plain(winnow_pair_events_create, nullptr);
  EXPECT_EQ(winnow_partition_reserve_pairs(partition, pairs, 1000, WINNOW_PAGES_TOUCHED),
            WINNOW_OK);
  EXPECT_EQ(winnow_partition_reserve_events(partition, events, 1000, false, WINNOW_PAGES_TOUCHED),
            WINNOW_OK);
  EXPECT_EQ(winnow_partition_reserve_events(partition, plain, 1000, true, WINNOW_PAGES_UNTOUCHED),
            WINNOW_OK);

  winnow_pair_options options = WINNOW_PAIR_OPTIONS;
  options.order = WINNOW_ORDER_CANONICAL;
  options.anew = 1;
  options.accept = [](void*, std::uint32_t a, std::uint32_t b) { return (a + b) % 2 == 0; };
  EXPECT_EQ(winnow_partition_self_pairs(partition, copy, nullptr, &options), WINNOW_OK);
  PairBuffer expected;
  EXPECT_EQ(
      partition->self_pairs(expected, {Order::canonical, false, {[](void*, ObjectId a, ObjectId b) {
                                         return (a + b) % 2 == 0;
                                       }}}),
      Status::ok);
  EXPECT_TRUE(same_all(got_all<winnow_pair>(winnow_pair_buffer_pairs, copy), expected.pairs()));

  EXPECT_EQ(winnow_partition_self_pairs(partition, pairs, events, nullptr), WINNOW_OK);
  world.place(1);
  const winnow_box_view view = world.view();
  const std::uint32_t listed[4] = {1, 4, 100, 199};
  const std::uint64_t masked[4] = {0x10, 0, 0x5, 0};
  const winnow_entries list = {listed, nullptr, 4};
  const winnow_entries mask = {nullptr, masked, 4};
  for (const winnow_entries* entries : {&list, &mask}) {
    EXPECT_EQ(winnow_partition_update(partition, world.keys.data(), kObjects, &view, entries),
              WINNOW_OK);
  }
  EXPECT_TRUE(partition->bounds(world.key(100)) == world.box(100));
  EXPECT_FALSE(partition->bounds(world.key(101)) == world.box(101));
  EXPECT_EQ(winnow_partition_self_pairs(partition, pairs, events, nullptr), WINNOW_OK);
  EXPECT_TRUE(is_array_of(got_all<winnow_pair>(winnow_pair_buffer_pairs, pairs), pairs->pairs()));
  EXPECT_TRUE(
      is_array_of(got_all<winnow_key_pair>(winnow_pair_events_begun, events), events->begun()));
  EXPECT_TRUE(
      is_array_of(got_all<winnow_key_pair>(winnow_pair_events_ended, events), events->ended()));
  EXPECT_TRUE(is_array_of(got_all<winnow_client_data_pair>(winnow_pair_events_begun_data, events),
                          events->begun_data()));
  EXPECT_TRUE(is_array_of(got_all<winnow_client_data_pair>(winnow_pair_events_ended_data, events),
                          events->ended_data()));
  EXPECT_GT(events->begun_data().size() + events->ended_data().size(), 0U);
  EXPECT_EQ(got<std::size_t>(winnow_pair_events_persisting, events), events->persisting());
  EXPECT_GT(events->persisting(), 0U);

  EXPECT_EQ(got<winnow_footprint>(winnow_pair_events_footprint, events).results.used,
            events->footprint().results.used);
  EXPECT_EQ(winnow_pair_events_clear(events), WINNOW_OK);
  EXPECT_EQ(winnow_partition_self_pairs(partition, nullptr, plain, nullptr), WINNOW_OK);
  EXPECT_EQ(plain->begun().size(), pairs->size());
  EXPECT_TRUE(plain->begun_data().empty());
  EXPECT_EQ(winnow_pair_buffer_assign(copy, pairs), WINNOW_OK);
  EXPECT_EQ(copy->size(), pairs->size());
  EXPECT_GT(world.parallel_calls, 0U);
}

TEST(CInterface, pair_buffers_are_cleared_and_released) {
  CountedMemory counted;
  const winnow_memory memory = counted.functions();
  const OwnedPairs pairs(winnow_pair_buffer_create, &memory);
  EXPECT_EQ(winnow_pair_buffer_reserve(pairs, 5000, WINNOW_PAGES_UNTOUCHED), WINNOW_OK);
  EXPECT_EQ(got<std::size_t>(winnow_pair_buffer_capacity, pairs), pairs->capacity());
  EXPECT_EQ(winnow_pair_buffer_shrink(pairs, 10), WINNOW_OK);
  EXPECT_LT(got<std::size_t>(winnow_pair_buffer_capacity, pairs), 5000U);
  EXPECT_EQ(winnow_pair_buffer_clear(pairs), WINNOW_OK);
  const auto bytes = [&] {
    return reserved_of(got<winnow_footprint>(winnow_pair_buffer_footprint, pairs));
  };
  EXPECT_EQ(bytes(), counted.outstanding);
  EXPECT_EQ(winnow_pair_buffer_release(pairs), WINNOW_OK);
  EXPECT_EQ(bytes(), counted.outstanding);
  EXPECT_EQ(bytes(), sizeof(winnow_pair_buffer));
}

TEST(CInterface, casts_find_the_hits_of_cpp) {
  const BoxesOfC world;
  const OwnedPartition& partition = world.partition;
  const OwnedHits hits(winnow_hit_buffer_create, nullptr);
  EXPECT_EQ(winnow_hit_buffer_reserve(hits, 100), WINNOW_OK);
  const winnow_filter even = even_in_c();
  std::array<winnow_cast, 4> casts;
  casts.fill(WINNOW_CAST);
  for (winnow_cast& cast : casts) {
    cast.direction[0] = 1.0F;
    cast.direction[1] = 0.1F;
    cast.max_t = 100.0F;
  }
  const Vec3f along(1.0F, 0.1F, 0.0F);
  const Aabb box{Vec3f(-1, 5, 5), Vec3f(0, 6, 6)};
  const Sphere ball{Vec3f(-1, 5, 5), 0.5F};
  const Capsule capsule{Vec3f(-1, 5, 5), Vec3f(-1, 7, 5), 0.5F};
  casts[0].from.origin[0] = -1.0F;
  casts[0].from.origin[1] = casts[0].from.origin[2] = 5.0F;
  casts[1].kind = WINNOW_CAST_BOX;
  *c::as_cpp(&casts[1].from.box) = box;
  casts[2].kind = WINNOW_CAST_SPHERE;
  *c::as_cpp(&casts[2].from.sphere) = ball;
  casts[3].kind = WINNOW_CAST_CAPSULE;
  *c::as_cpp(&casts[3].from.capsule) = capsule;
  const std::array<Cast, 4> expected{
      Ray{Vec3f(-1, 5, 5), along, 0.0F, 100.0F}, BoxCast{box, along, 0.0F, 100.0F},
      SphereCast{ball, along, 0.0F, 100.0F}, CapsuleCast{capsule, along, 0.0F, 100.0F}};
  for (std::size_t i = 0; i < casts.size(); ++i) {
    HitBuffer own;
    const auto closest = got<winnow_hit>(winnow_partition_closest, partition, &casts[i], &even);
    EXPECT_TRUE(same(closest, partition->closest(expected[i], kEven))) << i;
    const auto any = got<winnow_hit>(winnow_partition_any, partition, &casts[i], kAll);
    EXPECT_TRUE(same(any, partition->any(expected[i]))) << i;
    EXPECT_EQ(winnow_partition_all(partition, &casts[i], kAll, hits), WINNOW_OK);
    EXPECT_EQ(partition->all(expected[i], own), Status::ok);
    EXPECT_TRUE(same_all(got_all<winnow_hit>(winnow_hit_buffer_hits, hits), own.hits())) << i;
  }
  const winnow_aabb from = {{7, 3, 2}, {7, 3, 2}};
  HitBuffer own;
  EXPECT_EQ(winnow_partition_nearest(partition, &from, 8, 50.0F, &even, hits), WINNOW_OK);
  EXPECT_EQ(partition->nearest(*c::as_cpp(&from), 8, 50.0F, own, kEven), Status::ok);
  EXPECT_TRUE(same_all(got_all<winnow_hit>(winnow_hit_buffer_hits, hits), own.hits()));
  EXPECT_EQ(reserved_of(got<winnow_footprint>(winnow_hit_buffer_footprint, hits)),
            hits->footprint().total().reserved + sizeof(winnow_hit_buffer));
  EXPECT_EQ(winnow_hit_buffer_clear(hits), WINNOW_OK);
  EXPECT_EQ(got<std::size_t>(winnow_hit_buffer_queries, hits), 0U);
}

TEST(CInterface, batches_of_rays_find_single_hits) {
  const BoxesOfC world;
  const OwnedPartition& partition = world.partition;
  constexpr std::size_t kRays = 10;
  std::array<std::array<float, kRays>, 8> rays;
  std::vector<Cast> single;
  for (std::size_t i = 0; i < kRays; ++i) {
    const auto x = static_cast<float>(i);
    const std::array<float, 8> ray{-1.0F, x, x, 1.0F, 0.1F, 0.1F, 0.5F, 50.0F};
    for (std::size_t k = 0; k < 8; ++k) rays[k][i] = ray[k];
    single.push_back(Ray{Vec3f(-1, x, x), Vec3f(1.0F, 0.1F, 0.1F), 0.5F, 50.0F});
  }
  const winnow_ray_batch batch = {{rays[0].data(), rays[1].data(), rays[2].data()},
                                  {rays[3].data(), rays[4].data(), rays[5].data()},
                                  rays[6].data(),
                                  rays[7].data(),
                                  kRays,
                                  0};
  std::array<winnow_key, kRays> keys;
  std::array<std::uint64_t, kRays> data;
  std::array<float, kRays> t;
  const winnow_hit_columns columns = {keys.data(), data.data(), t.data()};
  EXPECT_EQ(winnow_partition_closest_rays(partition, &batch, kAll, &columns), WINNOW_OK);
  for (std::size_t i = 0; i < kRays; ++i) {
    EXPECT_TRUE(same(winnow_hit{keys[i], data[i], t[i]}, partition->closest(single[i])));
  }
  EXPECT_EQ(winnow_partition_any_rays(partition, &batch, kAll, &columns), WINNOW_OK);
  for (std::size_t i = 0; i < kRays; ++i) {
    EXPECT_EQ(keys[i].id == WINNOW_NO_OBJECT, !partition->any(single[i]));
  }
  const OwnedHits hits(winnow_hit_buffer_create, nullptr);
  EXPECT_EQ(winnow_partition_all_rays(partition, &batch, kAll, hits), WINNOW_OK);
  EXPECT_EQ(got<std::size_t>(winnow_hit_buffer_queries, hits), kRays);
  for (std::size_t i = 0; i < kRays; ++i) {
    EXPECT_TRUE(is_array_of(got_all<winnow_hit>(winnow_hit_buffer_of, hits, i), hits->of(i)));
  }
}

/// Regions of every kind.
[[nodiscard]] std::array<winnow_region, 7> regions_of_c(const winnow_plane (&planes)[2]) {
  std::array<winnow_region, 7> regions{};
  for (std::int32_t kind = 0; kind < 7; ++kind) {
    regions[static_cast<std::size_t>(kind)].kind = kind;
  }
  for (float& x : regions[WINNOW_REGION_POINT].of.point) x = 0.5F;
  regions[WINNOW_REGION_BOX].of.box = {{2, 2, 2}, {9, 9, 9}};
  regions[WINNOW_REGION_ORIENTED_BOX].of.oriented_box = {
      {5, 5, 5}, {4, 3, 2}, {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}};
  regions[WINNOW_REGION_SPHERE].of.sphere = {{5, 5, 5}, 4};
  regions[WINNOW_REGION_CAPSULE].of.capsule = {{5, 5, 5}, {9, 5, 5}, 3};
  const float eye[3] = {10, 10, 60};
  const float ahead[3] = {0, 0, -1};
  const float up[3] = {0, 1, 0};
  regions[WINNOW_REGION_FRUSTUM].of.frustum =
      got<winnow_frustum>(winnow_frustum_perspective, eye, ahead, up, 0.4F, 1.5F, 0.1F, 100.0F);
  regions[WINNOW_REGION_PLANES].of.planes = {planes, 2};
  return regions;
}

TEST(CInterface, regions_find_the_objects_of_cpp) {
  const BoxesOfC world;
  const OwnedPartition& partition = world.partition;
  const winnow_plane planes[2] = {{{1, 0, 0}, -4}, {{0, 1, 0}, -4}};
  const std::array regions = regions_of_c(planes);
  OrientedBox turned;
  turned.center = Vec3f(5, 5, 5);
  turned.half = Vec3f(4, 3, 2);
  turned.axes.set_column(0, Vec3f(0, 1, 0));
  turned.axes.set_column(1, Vec3f(-1, 0, 0));
  const std::array<Region, 7> expected{
      Vec3f(0.5F, 0.5F, 0.5F),
      Aabb{Vec3f(2, 2, 2), Vec3f(9, 9, 9)},
      turned,
      Sphere{Vec3f(5, 5, 5), 4.0F},
      Capsule{Vec3f(5, 5, 5), Vec3f(9, 5, 5), 3.0F},
      Frustum::perspective(Vec3f(10, 10, 60), Vec3f(0, 0, -1), Vec3f(0, 1, 0), 0.4F, 1.5F, 0.1F,
                           100.0F),
      std::span<const Plane>(c::as_cpp(planes), 2)};
  const OwnedOverlaps found(winnow_overlap_buffer_create, nullptr);
  EXPECT_EQ(winnow_overlap_buffer_reserve(found, 100), WINNOW_OK);
  for (std::size_t i = 0; i < regions.size(); ++i) {
    OverlapBuffer own;
    EXPECT_EQ(winnow_partition_overlap(partition, &regions[i], kAll, WINNOW_ORDER_CANONICAL, found),
              WINNOW_OK);
    EXPECT_EQ(partition->overlap(expected[i], own, {}, Order::canonical), Status::ok);
    const std::uint32_t* ids = nullptr;
    std::size_t count = 0;
    std::size_t inside = 0;
    EXPECT_EQ(winnow_overlap_buffer_ids(found, &ids, &count, &inside), WINNOW_OK);
    EXPECT_TRUE(same_all(std::span(ids, count), own.ids())) << i;
    EXPECT_EQ(inside, own.inside().size()) << i;
  }
  EXPECT_GT(got<winnow_footprint>(winnow_overlap_buffer_footprint, found).results.used, 0U);
  EXPECT_EQ(winnow_overlap_buffer_clear(found), WINNOW_OK);
  EXPECT_TRUE(found->empty());
  const OwnedPairs pairs(winnow_pair_buffer_create, nullptr);
  const winnow_box_view view = world.view();
  EXPECT_EQ(winnow_partition_overlap_boxes(partition, &view, kAll, WINNOW_ORDER_CANONICAL, pairs),
            WINNOW_OK);
  std::vector<Aabb> boxes;
  for (std::size_t i = 0; i < kObjects; ++i) boxes.push_back(world.box(i));
  PairBuffer own;
  EXPECT_EQ(partition->overlap(boxes, own, {}, Order::canonical), Status::ok);
  EXPECT_TRUE(same_all(got_all<winnow_pair>(winnow_pair_buffer_pairs, pairs), own.pairs()));
}

TEST(CInterface, state_of_a_partition_equals_cpp) {
  const BoxesOfC world;
  const OwnedPartition& partition = world.partition;
  EXPECT_EQ(winnow_partition_refresh(partition), WINNOW_OK);
  const auto structure = got<winnow_structure_kind>(winnow_partition_structure, partition);
  EXPECT_EQ(winnow_structure_name(structure), partition->name());
  EXPECT_EQ(got<bool>(winnow_partition_is_exact, partition), partition->is_exact());
  EXPECT_EQ(got<winnow_volume>(winnow_partition_volume, partition), WINNOW_VOLUME_AABB);
  EXPECT_EQ(got<winnow_fat_margin>(winnow_partition_fat_margin, partition).share, 0.0F);
  const auto choice = got<winnow_structure_choice>(winnow_partition_choice, partition);
  const StructureChoice chosen = partition->choice();
  EXPECT_EQ(choice.structure.structure, WINNOW_SWEEP_AND_PRUNE);
  EXPECT_EQ(choice.reason, chosen.reason);
  EXPECT_EQ(choice.objects, chosen.features.objects);
  EXPECT_EQ(choice.room[2], chosen.features.room[2]);
  const auto statistics = got<winnow_statistics>(winnow_partition_statistics, partition);
  EXPECT_EQ(statistics.objects, kObjects);
  EXPECT_EQ(statistics.cells, partition->statistics().cells);
  EXPECT_EQ(statistics.builds, partition->statistics().builds);
  EXPECT_EQ(statistics.last_pairs, partition->statistics().last_pairs);
}

/// Counts what is drawn.
struct Drawn {
  std::size_t boxes = 0;
  std::size_t lines = 0;
  std::size_t spheres = 0;
  std::size_t letters = 0;
};
template <std::size_t Drawn::*kCount, typename... Arguments>
void count_item(void* context, Arguments...) {
  ++(static_cast<Drawn*>(context)->*kCount);
}
void count_letters(void* context, const float*, const char*, std::size_t length, winnow_colour) {
  static_cast<Drawn*>(context)->letters += length;
}

TEST(CInterface, drawing_calls_each_callback_that_exists) {
  const BoxesOfC world;
  Drawn drawn;
  winnow_debug_draw draw = {&drawn, count_item<&Drawn::boxes, const winnow_aabb*, winnow_colour>,
                            count_item<&Drawn::lines, const float*, const float*, winnow_colour>,
                            count_item<&Drawn::spheres, const winnow_sphere*, winnow_colour>,
                            count_letters};
  winnow_debug_draw_options options = WINNOW_DEBUG_DRAW_OPTIONS;
  options.labels = 1;
  options.leave_out_structure = 1;
  EXPECT_EQ(winnow_partition_debug_draw(world.partition, &draw, &options), WINNOW_OK);
  EXPECT_EQ(drawn.boxes, kObjects);
  EXPECT_EQ(drawn.letters, std::string_view("1000").size() * kObjects);
  draw = {&drawn, nullptr, nullptr, nullptr, nullptr};
  EXPECT_EQ(winnow_partition_debug_draw(world.partition, &draw, nullptr), WINNOW_OK);
  EXPECT_EQ(drawn.boxes, kObjects);
}

TEST(CInterface, footprint_of_a_partition_is_its_memory) {
  BoxesOfC world;
  const auto bytes = [&] {
    return reserved_of(got<winnow_footprint>(winnow_partition_footprint, world.partition));
  };
  EXPECT_EQ(bytes(), world.counted.outstanding);
  EXPECT_EQ(winnow_partition_remove(world.partition, world.keys.data(), 10), WINNOW_OK);
  EXPECT_EQ(world.partition->size(), kObjects - 10);
  EXPECT_EQ(winnow_partition_clear(world.partition), WINNOW_OK);
  EXPECT_EQ(world.partition->size(), 0U);
  const std::size_t before = bytes();
  EXPECT_EQ(winnow_partition_release_memory(world.partition), WINNOW_OK);
  EXPECT_EQ(bytes(), world.counted.outstanding);
  EXPECT_LT(bytes(), before);
}

TEST(CInterface, two_partitions_and_a_copy_give_pairs) {
  const BoxesOfC world;
  const OwnedPartition copy(winnow_partition_create, winnow_structure_kind{}, nullptr);
  const OwnedSnapshot snapshot(winnow_snapshot_create, nullptr);
  EXPECT_EQ(winnow_partition_save(world.partition, snapshot), WINNOW_OK);
  const auto bytes = got_all<std::uint8_t>(winnow_snapshot_bytes, snapshot);
  EXPECT_EQ(winnow_partition_load(copy, bytes.data(), bytes.size()), WINNOW_OK);
  EXPECT_EQ(copy->size(), kObjects);
  const OwnedPairs pairs(winnow_pair_buffer_create, nullptr);
  winnow_pair_options options = WINNOW_PAIR_OPTIONS;
  options.order = WINNOW_ORDER_CANONICAL;
  EXPECT_EQ(winnow_partition_pairs_with(world.partition, copy, pairs, &options), WINNOW_OK);
  PairBuffer own;
  EXPECT_EQ(world.partition->pairs_with(*copy, own, {Order::canonical}), Status::ok);
  EXPECT_TRUE(same_all(got_all<winnow_pair>(winnow_pair_buffer_pairs, pairs), own.pairs()));
}

TEST(CInterface, spheres_replace_boxes_in_their_partition) {
  winnow_partition_options options = WINNOW_PARTITION_OPTIONS;
  options.volume = WINNOW_VOLUME_SPHERE;
  const OwnedThreads threads(winnow_threads_create, 1U);
  options.execution = got<winnow_execution>(winnow_threads_execution, threads);
  const OwnedPartition partition(winnow_partition_create, winnow_structure_kind{}, &options);
  std::array<winnow_sphere, 3> balls{{{{0, 0, 0}, 1}, {{1.8F, 0, 0}, 1}, {{9, 9, 9}, 1}}};
  std::array<winnow_key, 3> keys;
  EXPECT_EQ(winnow_partition_insert_spheres(partition, balls.data(), 3, nullptr, keys.data()),
            WINNOW_OK);
  balls[2] = {{1, 1, 0}, 2};
  EXPECT_EQ(winnow_partition_update_spheres(partition, keys.data(), balls.data(), 3), WINNOW_OK);
  PairBuffer pairs;
  EXPECT_EQ(partition->self_pairs(pairs), Status::ok);
  EXPECT_EQ(pairs.size(), 3U);
  EXPECT_EQ(partition->volume(), Volume::sphere);
}

template <int K>
void expect_kdops(winnow_volume volume) {
  const winnow_oriented_box turned = {
      {1, 2, 3}, {1, 1, 1}, {{0.6F, 0.8F, 0}, {-0.8F, 0.6F, 0}, {0, 0, 1}}};
  OrientedBox same_box;
  EXPECT_TRUE(c::read(&turned, same_box));
  const Kdop<K> expected = kdop_around<K>(same_box);
  Kdop<K> around;
  EXPECT_EQ(winnow_kdop_around(K, &turned, reinterpret_cast<float*>(&around)), WINNOW_OK);
  EXPECT_EQ(std::memcmp(&around, &expected, sizeof around), 0);
  winnow_partition_options options = WINNOW_PARTITION_OPTIONS;
  options.volume = volume;
  const OwnedPartition partition(winnow_partition_create, winnow_structure_kind{}, &options);
  winnow_key key;
  const float* const slabs = reinterpret_cast<const float*>(&around);
  EXPECT_EQ(winnow_partition_insert_kdops(partition, K, slabs, 1, nullptr, &key), WINNOW_OK);
  EXPECT_EQ(winnow_partition_update_kdops(partition, K, &key, slabs, 1), WINNOW_OK);
  EXPECT_EQ(winnow_partition_update_kdops(partition, 17, &key, slabs, 1), WINNOW_INVALID_ARGUMENT);
  EXPECT_TRUE(partition->bounds(c::to_cpp(key)).overlaps(same_box.bounds()));
}

TEST(CInterface, kdops_of_all_sizes_are_stored) {
  expect_kdops<14>(WINNOW_VOLUME_KDOP14);
  expect_kdops<18>(WINNOW_VOLUME_KDOP18);
  expect_kdops<26>(WINNOW_VOLUME_KDOP26);
}

TEST(CInterface, volumes_made_from_doubles_equal_cpp) {
  const double low[3] = {0.1, 0.2, 0.3};
  const double high[3] = {1.1, 1.2, 1.3};
  const double* const nowhere = nullptr;
  EXPECT_TRUE(same(got<winnow_aabb>(winnow_aabb_outward, low, high, nowhere),
                   Aabb::outward(Vec3d(low), Vec3d(high))));
  EXPECT_TRUE(same(got<winnow_aabb>(winnow_aabb_outward, low, high, low),
                   Aabb::outward(Vec3d(low), Vec3d(high), Vec3d(low))));
  const double matrix[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, -0.2, 0, 0, -1, 0};
  const auto frustum =
      got<winnow_frustum>(winnow_frustum_from_matrix, matrix, WINNOW_NEAR_DEPTH_ZERO);
  const Frustum expected =
      Frustum::from_matrix(c::matrix_by_rows(matrix), Frustum::NearDepth::zero);
  EXPECT_TRUE(have_same_bits(frustum, expected));
}

TEST(CInterface, version_and_instruction_set_are_returned) {
  EXPECT_EQ(winnow_version(),
            WINNOW_VERSION_MAJOR << 16U | WINNOW_VERSION_MINOR << 8U | WINNOW_VERSION_PATCH);
  EXPECT_EQ(winnow_abi(), WINNOW_ABI);
  EXPECT_GT(std::strlen(winnow_version_name()), 0U);
  EXPECT_NE(winnow_available_isa(0), nullptr);
  EXPECT_EQ(winnow_available_isa(99), nullptr);
  EXPECT_EQ(winnow_set_isa(winnow_isa_name()), WINNOW_OK);
  EXPECT_STREQ(winnow_status_name(WINNOW_INVALID_KEY), "invalid_key");
}

}  // namespace
}  // namespace winnow::test
