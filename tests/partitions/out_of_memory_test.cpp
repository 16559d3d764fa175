// A memory resource that refuses each request in turn: the call returns an error, nothing is lost,
// and the same call succeeds once memory is available again.

#include <winnow/core/eigen.h>
#include <functional>

#include "tests/support/counting_memory.h"
#include "tests/support/motion.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

class OutOfMemory : public Conformance {
 protected:
  OutOfMemory() : world_(config(), &memory_) {}
  void SetUp() override { WINNOW_TEST_NEEDS_EXCEPTIONS(); }

  // Repeats `call` while request k is refused, only this request or also all later ones, for k = 0,
  // 1, ..., until no request is refused. A call may also succeed with less memory than it
  // requested. `prepare` ensures that the call has work to do.
  void refuse_each_request(const std::function<void()>& prepare,
                           const std::function<Status()>& call,
                           const std::function<void()>& expect_intact) {
    for (std::size_t n = 0; n < 200; ++n) {
      SCOPED_TRACE(testing::Message() << "refused from request " << n);
      prepare();
      const std::size_t refusals = memory_.refusals();
      if (n % 2 == 0) {
        memory_.refuse_after(n / 2);
      } else {
        memory_.refuse_one_after(n / 2);
      }
      const Status status = world_.threads().run(call);
      memory_.grant_all();
      const bool refused = memory_.refusals() != refusals;
      if (!refused) {
        ASSERT_EQ(status, Status::ok);
        if (n % 2 == 0) return;
        continue;
      }
      ASSERT_TRUE(status == Status::out_of_memory || status == Status::ok)
          << winnow::to_string(status);
      if (status == Status::ok) continue;
      ASSERT_NO_FATAL_FAILURE(expect_intact());
      ASSERT_EQ(world_.threads().run(call), Status::ok);
    }
    FAIL() << "the call never stopped requesting memory";
  }

  void expect_intact() {
    ASSERT_TRUE(world_.holds_its_objects());
    EXPECT_EQ(world_.partition().footprint().total().reserved, memory_.outstanding());
  }

  // Releases all memory, fills the partition and refreshes it.
  void fill_anew(std::span<const Aabb> boxes) {
    world_.clear();
    world_.partition().release_memory();
    world_.insert(boxes);
    ASSERT_TRUE(world_.agrees());
  }

  CountingMemory memory_;
  World world_;
};

TEST_P(OutOfMemory, refused_bulk_insert_changes_nothing) {
  const std::vector<Aabb> boxes = uniform_boxes(120);
  std::vector<Key> keys(boxes.size());
  world_.insert(boxes);
  // Each successful insert is undone, so that the model stays right. The memory is released first,
  // so that the insert must allocate.
  refuse_each_request(
      [&] {
        world_.clear();
        world_.partition().release_memory();
        world_.insert(std::span<const Aabb>(boxes).first(40));
        keys.assign(keys.size(), Key{});
      },
      [&] {
        const Status status = world_.partition().insert(boxes, {}, keys);
        if (status != Status::ok) return status;
        return world_.partition().remove(keys);
      },
      [&] {
        EXPECT_EQ(keys, std::vector<Key>(keys.size())) << "a refused call wrote its output";
        expect_intact();
        ASSERT_TRUE(world_.agrees());
      });
  EXPECT_TRUE(world_.agrees());
}

TEST_P(OutOfMemory, refused_single_insert_changes_nothing) {
  const std::vector<Aabb> boxes = uniform_boxes(600);
  for (const Aabb& box : boxes) {
    Key key;
    memory_.refuse_after(0);
    const Status status = world_.partition().insert(box, 1).get(key);
    memory_.grant_all();
    if (status == Status::ok) {
      ASSERT_EQ(world_.partition().remove(key), Status::ok);
    } else {
      ASSERT_EQ(status, Status::out_of_memory);
      ASSERT_EQ(key, Key{});
    }
    ASSERT_EQ(world_.partition().size(), world_.entries().size());
    world_.insert(box);
  }
  EXPECT_TRUE(world_.holds_its_objects());
  EXPECT_TRUE(world_.agrees());
}

TEST_P(OutOfMemory, refused_reserve_changes_nothing) {
  const std::vector<Aabb> boxes = uniform_boxes(90);
  refuse_each_request([&] { fill_anew(boxes); },
                      [&] { return world_.partition().reserve(1000, Pages::prefaulted); },
                      [&] {
                        expect_intact();
                        // This query needs no refresh: it reads what the refused call left.
                        ASSERT_TRUE(world_.agrees());
                      });
  EXPECT_TRUE(world_.agrees());
}

TEST_P(OutOfMemory, refused_insert_keeps_refreshed_objects_up_to_date) {
  const std::vector<Aabb> boxes = uniform_boxes(90);
  std::vector<Key> keys(300);
  refuse_each_request([&] { fill_anew(boxes); },
                      [&] {
                        const Status status =
                            world_.partition().insert(uniform_boxes(300), {}, keys);
                        return status == Status::ok ? world_.partition().remove(keys) : status;
                      },
                      [&] {
                        expect_intact();
                        ASSERT_TRUE(world_.agrees());
                      });
}

TEST_P(OutOfMemory, refused_reserve_of_pairs_changes_nothing) {
  world_.insert(mixed_boxes(500));
  auto buffer = std::make_unique<PairBuffer>(&memory_);
  refuse_each_request(
      [&] {
        buffer = std::make_unique<PairBuffer>(&memory_);
        ASSERT_EQ(world_.self_pairs(*buffer), Status::ok);
      },
      [&] { return world_.partition().reserve_pairs(*buffer, 300'000); },
      [&] { ASSERT_TRUE(world_.has_pairs(*buffer)); });
  EXPECT_TRUE(world_.agrees(*buffer));
}

TEST_P(OutOfMemory, refused_bulk_update_and_removal_change_nothing) {
  const std::vector<Aabb> boxes = uniform_boxes(200);
  std::vector<Key> keys = world_.insert(boxes);
  const std::vector<Aabb> moved = uniform_boxes(200, 2);
  refuse_each_request(
      [&] {
        world_.clear();
        world_.partition().release_memory();
        keys = world_.insert(boxes);
        ASSERT_TRUE(world_.agrees());
      },
      [&] { return world_.partition().update(keys, moved); },
      [&] {
        expect_intact();
        ASSERT_TRUE(world_.agrees());
      });
  refuse_each_request(
      [&] {
        world_.clear();
        world_.partition().release_memory();
        keys = world_.insert(boxes);
        ASSERT_TRUE(world_.agrees());
      },
      [&] { return world_.partition().remove(keys); },
      [&] {
        expect_intact();
        ASSERT_TRUE(world_.agrees());
      });
}

TEST_P(OutOfMemory, refused_refresh_changes_nothing) {
  world_.insert(mixed_boxes(700));
  refuse_each_request([&] { world_.partition().release_memory(); },
                      [&] { return world_.partition().refresh(); }, [&] { expect_intact(); });
  EXPECT_TRUE(world_.agrees());
}

TEST_P(OutOfMemory, refused_pair_query_changes_nothing) {
  std::vector<Aabb> boxes = mixed_boxes(700);
  const std::vector<Key> keys = world_.insert(boxes);
  Random random(11);
  for (const Order order : {Order::fast, Order::canonical}) {
    for (const Motion motion : {Motion::few, Motion::much}) {
      SCOPED_TRACE(to_string(motion));
      // The buffer uses the same memory resource, so its requests are refused as well.
      auto buffer = std::make_unique<PairBuffer>(&memory_);
      refuse_each_request(
          [&] {
            world_.partition().release_memory();
            buffer = std::make_unique<PairBuffer>(&memory_);
            const Status status = world_.self_pairs(*buffer);
            ASSERT_EQ(status, Status::ok);
            move(motion, boxes, random);
            world_.update(keys, boxes);
            world_.partition().release_memory();
          },
          [&] { return world_.partition().self_pairs(*buffer, {.order = order}); },
          [&] { ASSERT_TRUE(world_.holds_its_objects()); });
      EXPECT_TRUE(world_.agrees(*buffer, {.order = order}));
    }
  }
}

// After a refusal the buffer must not count as the complete result of an earlier frame.
TEST_P(OutOfMemory, refused_query_leaves_a_buffer_that_recovers) {
  std::vector<Aabb> boxes = uniform_boxes(500);
  const std::vector<Key> keys = world_.insert(boxes);
  Random random(12);
  for (std::size_t n = 0; n < 12; ++n) {
    PairBuffer buffer(&memory_);
    ASSERT_TRUE(world_.agrees(buffer));
    // More pairs than the buffer has room for.
    for (Aabb& box : boxes) as_eigen(box.max).array() += 0.3F;
    world_.update(keys, boxes);
    memory_.refuse_after(n / 2);
    const Status status = world_.self_pairs(buffer);
    memory_.grant_all();
    ASSERT_TRUE(status == Status::ok || status == Status::out_of_memory);
    move(Motion::few, boxes, random);
    world_.update(keys, boxes);
    ASSERT_TRUE(world_.agrees(buffer)) << "refused after " << n / 2;
    boxes = uniform_boxes(500);
    world_.update(keys, boxes);
  }
}

TEST_P(OutOfMemory, refused_pairs_with_changes_nothing) {
  world_.insert(mixed_boxes(500));
  World other(config(), &memory_);
  other.insert(mixed_boxes(300, 2));
  auto buffer = std::make_unique<PairBuffer>(&memory_);
  refuse_each_request(
      [&] {
        world_.partition().release_memory();
        other.partition().release_memory();
        buffer = std::make_unique<PairBuffer>(&memory_);
      },
      [&] { return world_.partition().pairs_with(other.partition(), *buffer); },
      [&] {
        ASSERT_TRUE(world_.holds_its_objects());
        ASSERT_TRUE(other.holds_its_objects());
      });
  EXPECT_TRUE(right_cross_pairs(buffer->pairs(), cross_pairs(world_.objects(), other.objects()),
                                world_.partition().is_exact()));
}

INSTANTIATE_TEST_SUITE_P(All, OutOfMemory, testing::ValuesIn(all_configs()),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace winnow::test
