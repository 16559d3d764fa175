// Const queries from several threads at once. The results must be right; the thread sanitizer finds
// races that happen to give the right results.

#include <array>

#include "tests/support/motion.h"
#include "tests/support/platform.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

#if WINNOW_TEST_THREADS
#include <thread>

namespace winnow::test {
namespace {

constexpr std::size_t kReaders = 4;

class Concurrency : public Conformance {
 protected:
  // Starts all readers at the same time, each with its number.
  template <typename Body>
  static void read_at_once(const Body& body) {
    std::vector<std::thread> readers;
    for (std::size_t i = 0; i < kReaders; ++i) readers.emplace_back(body, i);
    for (std::thread& reader : readers) reader.join();
  }
};

// The first readers after a change find the structure out of date and must refresh it without a
// race.
TEST_P(Concurrency, concurrent_self_pairs_after_a_change_are_safe) {
  World world(config());
  std::vector<Aabb> boxes = mixed_boxes(600);
  const std::vector<Key> keys = world.insert(boxes);
  std::array<PairBuffer, kReaders> buffers;
  std::array<Status, kReaders> statuses{};
  Random random(21);
  for (int frame = 0; frame < 10; ++frame) {
    move(frame % 2 == 0 ? Motion::few : Motion::much, boxes, random);
    world.update(keys, boxes);
    const Partition& partition = world.partition();
    read_at_once([&](std::size_t i) {
      const Order order = i % 2 == 0 ? Order::fast : Order::canonical;
      statuses[i] = partition.self_pairs(buffers[i], {.order = order});
    });
    const std::vector<Pair> truth = true_pairs(world.objects());
    for (std::size_t i = 0; i < kReaders; ++i) {
      ASSERT_EQ(statuses[i], Status::ok);
      ASSERT_TRUE(right_pairs(buffers[i].pairs(), truth, partition.is_exact()))
          << "frame " << frame << ", reader " << i;
    }
  }
}

TEST_P(Concurrency, concurrent_const_calls_are_safe) {
  World a(config());
  World b(config());
  std::vector<Aabb> boxes_a = mixed_boxes(400);
  std::vector<Aabb> boxes_b = mixed_boxes(300, 2);
  const std::vector<Key> keys_a = a.insert(boxes_a);
  const std::vector<Key> keys_b = b.insert(boxes_b);
  std::array<PairBuffer, kReaders> buffers;
  std::array<Status, kReaders> statuses{};
  Random random(22);
  for (int frame = 0; frame < 8; ++frame) {
    move(Motion::little, boxes_a, random);
    move(Motion::little, boxes_b, random);
    a.update(keys_a, boxes_a);
    b.update(keys_b, boxes_b);
    const Partition& p = a.partition();
    const Partition& q = b.partition();
    // Both directions at once: locking two partitions in either order must not deadlock.
    read_at_once([&](std::size_t i) {
      const Partition& queried = i % 2 == 0 ? p : q;
      const Partition& other = i % 2 == 0 ? q : p;
      statuses[i] = queried.pairs_with(other, buffers[i]);
      Aabb box;
      if (p.bounds(keys_a[i]).get(box) != Status::ok || !p.contains(keys_a[i]) ||
          p.size() != keys_a.size() || p.statistics().objects != keys_a.size() ||
          p.footprint().total().reserved == 0) {
        statuses[i] = Status::invalid_key;
      }
    });
    const std::vector<Pair> forward = cross_pairs(a.objects(), b.objects());
    const std::vector<Pair> backward = cross_pairs(b.objects(), a.objects());
    for (std::size_t i = 0; i < kReaders; ++i) {
      ASSERT_EQ(statuses[i], Status::ok);
      ASSERT_TRUE(
          right_cross_pairs(buffers[i].pairs(), i % 2 == 0 ? forward : backward, p.is_exact()))
          << "frame " << frame << ", reader " << i;
    }
  }
}

// Partitions share nothing: each may be changed by its own thread.
TEST_P(Concurrency, concurrent_changes_to_different_partitions_are_safe) {
  std::array<testing::AssertionResult, kReaders> results{
      testing::AssertionSuccess(), testing::AssertionSuccess(), testing::AssertionSuccess(),
      testing::AssertionSuccess()};
  read_at_once([&](std::size_t i) {
    World world(config());
    std::vector<Aabb> boxes = mixed_boxes(200, i + 1);
    const std::vector<Key> keys = world.insert(boxes);
    Random random(i);
    PairBuffer buffer;
    for (int frame = 0; frame < 5 && results[i]; ++frame) {
      move(Motion::few, boxes, random);
      world.update(keys, boxes);
      results[i] = world.agrees(buffer);
    }
  });
  for (const testing::AssertionResult& result : results) EXPECT_TRUE(result);
}

INSTANTIATE_TEST_SUITE_P(All, Concurrency, testing::ValuesIn(all_configs()),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace winnow::test

#endif
