// Memory: the footprint equals the allocated memory, to the byte, and a steady frame does not
// allocate.

#include <winnow/core/eigen.h>

#include <algorithm>
#include <atomic>
#include <new>

#include "tests/support/counting_memory.h"
#include "tests/support/heap_count.h"
#include "tests/support/motion.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

class Memory : public Conformance {
 protected:
  [[nodiscard]] testing::AssertionResult footprint_is_exact(const World& world) const {
    const Footprint footprint = world.partition().footprint();
    const Bytes total = footprint.total();
    if (total.reserved != memory_.outstanding()) {
      return testing::AssertionFailure() << "the footprint has " << total.reserved << " bytes, "
                                         << memory_.outstanding() << " are outstanding";
    }
    for (const Bytes* part : {&footprint.bounds, &footprint.keys, &footprint.client_data,
                              &footprint.structure, &footprint.scratch, &footprint.results}) {
      if (part->used > part->reserved) {
        return testing::AssertionFailure() << "used exceeds reserved";
      }
    }
    return testing::AssertionSuccess();
  }

  CountingMemory memory_;
};

TEST_P(Memory, footprint_is_exact_after_every_call) {
  World world(config(), &memory_);
  PairBuffer buffer;
  std::vector<Aabb> boxes = mixed_boxes(700);
  Random random(4);
  EXPECT_TRUE(footprint_is_exact(world)) << "empty";
  ASSERT_EQ(world.partition().reserve(100), Status::ok);
  EXPECT_TRUE(footprint_is_exact(world)) << "reserve";
  std::vector<Key> keys = world.insert(boxes);
  EXPECT_TRUE(footprint_is_exact(world)) << "insert";
  ASSERT_TRUE(world.agrees(buffer));
  EXPECT_TRUE(footprint_is_exact(world)) << "first query";
  for (const Motion motion : kMotions) {
    move(motion, boxes, random);
    world.update(keys, boxes);
    EXPECT_TRUE(footprint_is_exact(world)) << "update";
    ASSERT_TRUE(world.agrees(buffer));
    EXPECT_TRUE(footprint_is_exact(world)) << "query";
    ASSERT_TRUE(world.agrees(buffer, {.order = Order::canonical, .incremental = false}));
    EXPECT_TRUE(footprint_is_exact(world)) << "full query";
  }
  keys.push_back(world.insert(boxes[0]));
  ASSERT_EQ(world.pairs_with(world.partition(), buffer), Status::ok);
  EXPECT_TRUE(footprint_is_exact(world)) << "pairs_with";
  world.remove(std::span<const Key>(keys).first(400));
  EXPECT_TRUE(footprint_is_exact(world)) << "remove";
  ASSERT_TRUE(world.agrees(buffer));
  world.partition().release_memory();
  EXPECT_TRUE(footprint_is_exact(world)) << "release_memory";
  EXPECT_TRUE(world.holds_its_objects());
  ASSERT_TRUE(world.agrees(buffer)) << "after release_memory";
  EXPECT_TRUE(footprint_is_exact(world));
  world.clear();
  EXPECT_TRUE(footprint_is_exact(world)) << "clear";
}

TEST_P(Memory, empty_partition_releases_its_memory) {
  for (const bool filtered : {false, true}) {
    World world(config(), &memory_);
    const std::vector<Key> keys = world.insert(uniform_boxes(2000));
    if (filtered) world.set_filter(keys[7], {.layers = 2});
    if (world.partition().is_exact()) {
      ASSERT_TRUE(world.agrees());
    }
    const std::size_t full = memory_.outstanding();
    world.clear();
    world.partition().release_memory();
    EXPECT_TRUE(footprint_is_exact(world));
    // Slots store which keys they have handed out, at most 4 bytes each, and their row and client
    // data may stay as well.
    EXPECT_LE(memory_.outstanding(), 20 * 2048U);
    EXPECT_LT(memory_.outstanding(), full / 2);
    const World fresh(config());
    const Footprint left = world.partition().footprint();
    const Footprint first = fresh.partition().footprint();
    EXPECT_EQ(left.bounds.reserved, first.bounds.reserved);
    EXPECT_EQ(left.structure.reserved, first.structure.reserved);
    EXPECT_EQ(left.scratch.reserved, first.scratch.reserved);
    EXPECT_FALSE(world.partition().contains(keys[0]));
    world.insert(uniform_boxes(100));
    EXPECT_TRUE(world.agrees());
  }
}

TEST_P(Memory, exchanged_structure_releases_its_memory) {
  World world(config(), &memory_);
  world.insert(uniform_boxes(2000));
  PairBuffer pairs;
  ASSERT_EQ(world.self_pairs(pairs), Status::ok);
  for (const StructureKind next : {linear_bvh(), bounds_n_squared()}) {
    ASSERT_EQ(world.partition().set_structure(next), Status::ok);
    EXPECT_TRUE(footprint_is_exact(world));
    // The memory of a sample of 64 objects may stay.
    EXPECT_LE(world.partition().footprint().scratch.reserved, 64 * 16U);
    ASSERT_EQ(world.self_pairs(pairs), Status::ok);
  }
}

TEST_P(Memory, footprint_contains_bounds_data_and_keys) {
  World world(config(), &memory_);
  world.insert(uniform_boxes(1000));
  const Footprint footprint = world.partition().footprint();
  EXPECT_GE(footprint.bounds.used, 1000 * sizeof(Aabb));
  EXPECT_GE(footprint.client_data.used, 1000 * sizeof(ClientData));
  EXPECT_GE(footprint.keys.used, 1000 * sizeof(std::uint32_t));
}

TEST_P(Memory, pair_buffer_footprint_is_exact) {
  CountingMemory results;
  PairBuffer buffer(&results);
  World world(config(), &memory_);
  std::vector<Aabb> boxes = uniform_boxes(900);
  const std::vector<Key> keys = world.insert(boxes);
  Random random(6);
  for (int frame = 0; frame < 6; ++frame) {
    move(frame % 2 == 0 ? Motion::few : Motion::much, boxes, random);
    world.update(keys, boxes);
    ASSERT_TRUE(world.agrees(buffer));
    EXPECT_EQ(buffer.footprint().total().reserved, results.outstanding());
    EXPECT_EQ(buffer.footprint().results.used, buffer.size() * sizeof(Pair));
    EXPECT_TRUE(footprint_is_exact(world));
  }
}

TEST_P(Memory, inserts_within_the_reserve_do_not_allocate) {
  World world(config(), &memory_);
  ASSERT_EQ(world.partition().reserve(500), Status::ok);
  const std::size_t requests = memory_.requests();
  const std::vector<Aabb> boxes = uniform_boxes(500);
  world.insert(std::span<const Aabb>(boxes).first(300));
  for (std::size_t i = 300; i < 500; ++i) world.insert(boxes[i]);
  EXPECT_EQ(memory_.requests(), requests);
}

TEST_P(Memory, first_frame_within_the_reserve_does_not_allocate) {
  World world(config(), &memory_);
  CountingMemory results;
  PairBuffer buffer(&results);
  const std::vector<Aabb> boxes = uniform_boxes(400);
  ASSERT_EQ(world.partition().reserve(400), Status::ok);
  ASSERT_EQ(world.partition().reserve_pairs(buffer, 400 * 399 / 2), Status::ok);
  const std::size_t before = memory_.requests() + results.requests();
  world.insert(boxes);
  ASSERT_TRUE(world.agrees(buffer));
  EXPECT_EQ(memory_.requests() + results.requests(), before);
  EXPECT_TRUE(footprint_is_exact(world));
}

TEST_P(Memory, events_within_the_reserve_do_not_allocate) {
  constexpr std::size_t kObjects = 60;
  constexpr std::size_t kPairs = kObjects * (kObjects - 1) / 2;
  World world(config(), &memory_);
  CountingMemory results;
  PairBuffer buffer(&results);
  PairEvents events(PairEventsOptions{&results, true});
  PairEvents events_only(&results);
  ASSERT_EQ(world.partition().reserve(kObjects), Status::ok);
  ASSERT_EQ(world.partition().reserve_pairs(buffer, kPairs), Status::ok);
  ASSERT_EQ(world.partition().reserve_events(events, kPairs), Status::ok);
  ASSERT_EQ(world.partition().reserve_events(events_only, kPairs, true), Status::ok);
  const std::size_t requests = results.requests();
  std::vector<Aabb> boxes = uniform_boxes(kObjects);
  const std::vector<Key> keys = world.insert(boxes);
  std::size_t reported = 0;
  for (int frame = 0; frame < 6; ++frame) {
    // Alternately spread boxes, and all boxes at one place.
    const std::vector<Aabb> next = frame % 2 == 0 ? boxes : std::vector<Aabb>(kObjects, boxes[0]);
    ASSERT_EQ(world.partition().update(keys, next), Status::ok);
    ASSERT_EQ(world.partition().self_pairs(buffer, events), Status::ok);
    ASSERT_EQ(world.partition().self_pairs(events_only), Status::ok);
    reported += events.begun().size() + events.ended().size();
    EXPECT_EQ(events_only.begun().size(), events.begun().size()) << frame;
  }
  EXPECT_GE(reported, kPairs);
  EXPECT_EQ(results.requests(), requests);
}

TEST(EventsMemory, refused_reserve_of_events_succeeds_later) {
  CountingMemory memory;
  Partition partition(linear_bvh(), {.execution = Execution::serial()});
  ASSERT_EQ(partition.reserve(10), Status::ok);
  std::size_t refused = 0;
  for (Status status = Status::out_of_memory; status != Status::ok; ++refused) {
    PairEvents events(PairEventsOptions{&memory, true});
    memory.refuse_after(refused);
    status = partition.reserve_events(events, 100, true);
    memory.grant_all();
    EXPECT_EQ(partition.reserve_events(events, 100, true), Status::ok) << refused;
  }
  EXPECT_GT(refused, 10U);
}

// Memory that was reserved for a number of blocks suffices for fewer blocks, also if their tree has
// another number of levels.
TEST(TreeMemory, reserve_suffices_for_smaller_trees_of_other_depth) {
  constexpr std::size_t kObjects = 3900 * 16;
  const std::vector<Aabb> boxes = uniform_boxes(kObjects);
  for (const std::size_t blocks : {3700U, 3854U, 3855U, 3899U}) {
    CountingMemory memory;
    Partition partition(linear_bvh(), {.memory = &memory, .execution = Execution::serial()});
    ASSERT_EQ(partition.reserve(kObjects), Status::ok);
    const std::size_t requests = memory.requests();
    std::vector<Key> keys(blocks * 16);
    ASSERT_EQ(partition.insert(std::span(boxes).first(keys.size()), {}, keys), Status::ok);
    ASSERT_EQ(partition.refresh(), Status::ok);
    EXPECT_EQ(memory.requests(), requests) << blocks;
  }
}

// Returns scenes with as many cells as possible, with lines and nodes of one object each, with
// crowds, and with all objects in the tree.
std::vector<std::vector<Aabb>> scenes_to_reserve_for(std::size_t count) {
  std::vector<std::vector<Aabb>> scenes{
      uniform_boxes(count),   clustered_boxes(count), mixed_boxes(count),
      wall_boxes(count, 1),   two_scale_boxes(count), outlier_boxes(count),
      exponential_boxes(200), rod_boxes(count),       pile_boxes(count)};
  for (const Vec3f& spread :
       {Vec3f(1e4F, 1e4F, 1e4F), Vec3f(1e5F, 1e5F, 1.0F), Vec3f(1e5F, 0.1F, 0.1F)}) {
    scenes.push_back(uniform_boxes(count));
    for (Aabb& box : scenes.back()) {
      const Vec3f edge = box.max - box.min;
      box.min = as_eigen(box.min).cwiseProduct(as_eigen(spread)).eval();
      box.max = box.min + edge;
    }
  }
  scenes.emplace_back(count, Aabb{Vec3f{}, Vec3f::constant(1.0F)});
  return scenes;
}

TEST_P(Memory, reserve_suffices_for_any_placement_of_objects) {
  const std::size_t count = config().make().is_exact() ? 2500 : 300;
  for (const std::vector<Aabb>& boxes : scenes_to_reserve_for(count)) {
    SCOPED_TRACE(testing::Message() << "from " << as_eigen(boxes[0].min).transpose() << " to "
                                    << as_eigen(boxes[0].max).transpose());
    PairBuffer found;
    for (const std::size_t inserted : {boxes.size(), boxes.size() * 2 / 3}) {
      World fresh(config());
      (void)fresh.insert(std::span(boxes).first(inserted));
      ASSERT_EQ(fresh.self_pairs(found), Status::ok);
      CountingMemory results;
      PairBuffer buffer(&results);
      World world(config(), &memory_);
      ASSERT_EQ(world.partition().reserve(boxes.size()), Status::ok);
      ASSERT_EQ(world.partition().reserve_pairs(buffer, found.size()), Status::ok);
      const std::size_t before = memory_.requests() + results.requests();
      (void)world.insert(std::span(boxes).first(inserted));
      ASSERT_EQ(world.self_pairs(buffer), Status::ok);
      EXPECT_EQ(memory_.requests() + results.requests(), before);
      EXPECT_EQ(buffer.size(), found.size());
    }
  }
}

// Queries directly after `reserve`, without a refresh: they would be wrong if `reserve` did not
// copy the nodes, the cells or the padding of the rows.
TEST_P(Memory, reserve_keeps_the_content) {
  for (const Pages pages : {Pages::untouched, Pages::prefaulted}) {
    World world(config(), &memory_);
    PairBuffer buffer;
    std::vector<Aabb> boxes = mixed_boxes(333);
    const std::vector<Key> keys = world.insert(boxes);
    ASSERT_TRUE(world.agrees());
    for (const std::size_t objects : {0U, 100U, 400U, 5000U, 5000U}) {
      ASSERT_EQ(world.partition().reserve(objects, pages), Status::ok);
      EXPECT_TRUE(footprint_is_exact(world));
      EXPECT_TRUE(world.holds_its_objects());
      ASSERT_TRUE(world.agrees()) << objects;
    }
    Random random(3);
    for (const Motion motion : kMotions) {
      move(motion, boxes, random);
      world.update(keys, boxes);
      ASSERT_TRUE(world.agrees(buffer));
    }
  }
}

TEST_P(Memory, release_memory_returns_the_reserve) {
  World world(config(), &memory_);
  const std::size_t empty = memory_.outstanding();
  ASSERT_EQ(world.partition().reserve(3000, Pages::prefaulted), Status::ok);
  EXPECT_TRUE(footprint_is_exact(world));
  world.partition().release_memory();
  EXPECT_EQ(memory_.outstanding(), empty);
  EXPECT_EQ(world.partition().reserve(~std::size_t{0}), Status::too_many_objects);
  EXPECT_EQ(memory_.outstanding(), empty);
}

// Boxes that overlap many others: more pairs than a fresh buffer has room for.
TEST_P(Memory, many_pairs_cause_few_requests_and_tests) {
  std::vector<Aabb> boxes = uniform_boxes(2000);
  for (Aabb& box : boxes) as_eigen(box.max).array() += 4.0F;
  World world(config(), &memory_);
  world.insert(boxes);
  std::atomic<std::size_t> calls{0};
  const auto count = [](void* context, ObjectId, ObjectId) {
    ++*static_cast<std::atomic<std::size_t>*>(context);
    return true;
  };
  CountingMemory results;
  PairBuffer buffer(&results);
  ASSERT_EQ(world.self_pairs(buffer, {.predicate = {count, &calls}}), Status::ok);
  ASSERT_GT(buffer.size(), 150'000U);
  EXPECT_TRUE(world.has_pairs(buffer));
  EXPECT_LE(results.requests(), 20U);
  EXPECT_LE(calls, 2 * buffer.size());
}

// All boxes overlap each other: pairs that a predicate rejects take no memory, however many there
// are.
TEST_P(Memory, pair_memory_follows_the_accepted_pairs) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  constexpr std::size_t kObjects = 1500;
  World world(config());
  const std::vector<Aabb> boxes(kObjects, Aabb{{0, 0, 0}, {1, 1, 1}});
  world.insert(boxes);
  constexpr std::size_t kAll = kObjects * (kObjects - 1) / 2;
  for (const ObjectId accepted : {ObjectId{kObjects}, ObjectId{7}}) {
    std::atomic<std::size_t> calls{0};
    struct Context {
      ObjectId accepted;
      std::atomic<std::size_t>& calls;
    } context{accepted, calls};
    const auto accept = [](void* c, ObjectId first, ObjectId second) {
      const auto& it = *static_cast<Context*>(c);
      it.calls.fetch_add(1, std::memory_order_relaxed);
      return first == it.accepted || second == it.accepted;
    };
    CountingMemory results;
    results.refuse_beyond(kAll * sizeof(Pair) / 3);
    PairBuffer buffer(&results);
    ASSERT_EQ(
        world.self_pairs(buffer, {.order = Order::canonical, .predicate = {accept, &context}}),
        Status::ok);
    EXPECT_EQ(calls, kAll);
    std::vector<Pair> truth;
    for (ObjectId other = 0; accepted < kObjects && other < kObjects; ++other) {
      if (other != accepted)
        truth.push_back({std::min(accepted, other), std::max(accepted, other)});
    }
    EXPECT_EQ(std::vector<Pair>(buffer.begin(), buffer.end()), truth);
  }
}

// As above, for pairs of query boxes and objects.
TEST_P(Memory, overlap_memory_follows_the_accepted_pairs) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  constexpr std::size_t kObjects = 1000;
  World world(config());
  const std::vector<Aabb> boxes(kObjects, Aabb{{0, 0, 0}, {1, 1, 1}});
  const std::vector<Key> keys = world.insert(boxes);
  Key accepted = keys[11];
  const auto accept = [](void* context, Key key, ClientData) {
    return key == *static_cast<const Key*>(context);
  };
  CountingMemory results;
  results.refuse_beyond(kObjects * kObjects * sizeof(Pair) / 3);
  PairBuffer buffer(&results);
  const Status status = world.threads().run([&] {
    return world.partition().overlap(BoxView(boxes), buffer, {.predicate = {accept, &accepted}});
  });
  ASSERT_EQ(status, Status::ok);
  ASSERT_EQ(buffer.size(), kObjects);
  for (std::size_t i = 0; i < kObjects; ++i) {
    EXPECT_EQ(buffer[i], (Pair{static_cast<ObjectId>(i), accepted.id}));
  }
}

TEST_P(Memory, only_the_calling_thread_allocates) {
  CountingMemory results;
  PairBuffer buffer(&results);
  World world(config(), &memory_);
  std::vector<Aabb> boxes = uniform_boxes(3000);
  if (!world.partition().is_exact()) boxes.resize(500);
  const std::vector<Key> keys = world.insert(boxes);
  Random random(2);
  for (int frame = 0; frame < 4; ++frame) {
    move(frame % 2 == 0 ? Motion::few : Motion::much, boxes, random);
    world.update(keys, boxes);
    ASSERT_EQ(world.self_pairs(buffer), Status::ok);
  }
  EXPECT_GT(memory_.requests(), 0U);
  EXPECT_EQ(memory_.requests_from_elsewhere(), 0U);
  EXPECT_EQ(results.requests_from_elsewhere(), 0U);
}

// Repeats four frames, as a scene at rest or in steady flow does.
class SteadyFrames : public Memory {
 protected:
  void expect_no_requests(Motion motion, std::size_t count, const PairOptions& options) {
    SCOPED_TRACE(to_string(motion));
    CountingMemory results;
    PairBuffer buffer(&results);
    World world(config(), &memory_);
    std::vector<std::vector<Aabb>> frames{mixed_boxes(count)};
    Random random(1);
    while (frames.size() < 4) {
      frames.push_back(frames.back());
      move(motion, frames.back(), random);
    }
    const std::vector<Key> keys = world.insert(frames[0]);
    const auto play = [&](std::size_t frame) {
      world.update(keys, frames[frame % frames.size()]);
      ASSERT_EQ(world.self_pairs(buffer, options), Status::ok);
    };
    for (std::size_t frame = 0; frame < 12; ++frame) play(frame);
    const std::size_t structure = memory_.requests();
    const std::size_t pairs = results.requests();
    const std::size_t heap = heap_requests();
    for (std::size_t frame = 12; frame < 32; ++frame) play(frame);
    EXPECT_EQ(memory_.requests(), structure);
    EXPECT_EQ(results.requests(), pairs);
    if (config().threads == 1) {
      // The model of World does not allocate in updates either. Several threads are left out,
      // because oneTBB allocates.
      EXPECT_EQ(heap_requests(), heap) << "allocated behind the memory resource";
    }
  }
};

TEST_P(SteadyFrames, steady_frames_do_not_allocate) {
  for (const Motion motion : kMotions) expect_no_requests(motion, 800, {});
}

TEST_P(SteadyFrames, steady_canonical_frames_do_not_allocate) {
  expect_no_requests(Motion::little, 800, {.order = Order::canonical});
  expect_no_requests(Motion::few, 800, {.order = Order::canonical});
}

TEST_P(SteadyFrames, steady_full_queries_do_not_allocate) {
  expect_no_requests(Motion::few, 800, {.incremental = false});
}

TEST_P(SteadyFrames, steady_pairs_with_does_not_allocate) {
  World a(config(), &memory_);
  World b(config(), &memory_);
  const std::vector<Aabb> boxes = mixed_boxes(500);
  const std::vector<Key> keys = a.insert(boxes);
  b.insert(mixed_boxes(300, 2));
  CountingMemory results;
  PairBuffer buffer(&results);
  const auto play = [&] {
    a.update(keys, boxes);
    ASSERT_EQ(a.pairs_with(b.partition(), buffer), Status::ok);
  };
  for (int frame = 0; frame < 5; ++frame) play();
  const std::size_t before = memory_.requests() + results.requests();
  for (int frame = 0; frame < 5; ++frame) play();
  EXPECT_EQ(memory_.requests() + results.requests(), before);
}

INSTANTIATE_TEST_SUITE_P(All, Memory, testing::ValuesIn(all_configs()),
                         testing::PrintToStringParamName());
INSTANTIATE_TEST_SUITE_P(All, SteadyFrames, testing::ValuesIn(all_configs()),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace winnow::test
