// Resting scenes: all boxes jitter and hardly a pair changes. Boxes are then not written to their
// rows, which callers can notice only by the amount of work.

#include <winnow/core/eigen.h>
#include <winnow/core/results.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "tests/support/answers.h"
#include "tests/support/counting_memory.h"
#include "tests/support/platform.h"
#include "tests/support/random.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

#if WINNOW_TEST_THREADS
#include <thread>
#endif

namespace winnow::test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr std::size_t kCount = 500;

Aabb jittered(const Aabb& box, float by, Random& random) {
  Vec3f d;
  for (int axis = 0; axis < 3; ++axis) d[axis] = by * static_cast<float>(random.uniform(-1, 1));
  return {box.min + d, box.max + d};
}

class RestingScenes : public Conformance {
 protected:
  void start(std::vector<Aabb> boxes) {
    rest_ = std::move(boxes);
    world_.emplace(config(), &memory_);
    keys_ = world_->insert(rest_);
  }

  /// Moves all boxes, except one in `still`, around their rest positions.
  void jitter_all(float by, std::size_t still = 100) {
    std::vector<Key> keys;
    std::vector<Aabb> boxes;
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      if (i % still == still - 1) continue;
      keys.push_back(keys_[i]);
      boxes.push_back(jittered(rest_[i], by, random_));
    }
    world_->update(keys, boxes);
  }

  /// Returns a tiny box close to many others, all within the skin of large boxes.
  [[nodiscard]] Aabb tiny_box() {
    const Vec3f at = Vec3f::constant(2.0F + 1e-4F * static_cast<float>(random_.uniform(0, 1)));
    return {at, at + Vec3f::constant(1e-6F)};
  }

  // Runs frames without pair changes until updates are deferred.
  void settle(float by, PairBuffer& buffer) {
    for (int frame = 0; frame < 6; ++frame) {
      jitter_all(by);
      ASSERT_TRUE(world_->agrees(buffer)) << "frame " << frame;
    }
  }

  [[nodiscard]] std::uint64_t full_queries() const {
    return world_->partition().statistics().full_queries;
  }

  CountingMemory memory_;
  CountingMemory results_;
  std::optional<World> world_;
  std::vector<Aabb> rest_;
  std::vector<Key> keys_;
  Random random_{8};
};

TEST_P(RestingScenes, resting_frames_test_no_pair) {
  start(uniform_boxes(kCount));
  PairBuffer buffer;
  settle(1e-5F, buffer);
  const std::uint64_t full = full_queries();
  for (int frame = 0; frame < 20; ++frame) {
    jitter_all(1e-5F);
    ASSERT_TRUE(world_->agrees(buffer)) << "frame " << frame;
    EXPECT_EQ(world_->partition().statistics().last_tests, 0U);
    ASSERT_TRUE(world_->holds_its_objects());
  }
  EXPECT_EQ(full_queries(), full);
}

// Neighbours that touch, or nearly touch, begin and end all the time.
TEST_P(RestingScenes, every_pair_that_begins_or_ends_is_reported) {
  std::vector<Aabb> boxes;
  for (int i = 0; i < 343; ++i) {
    const Vec3f at(static_cast<float>(i % 7), static_cast<float>(i / 7 % 7),
                   static_cast<float>(i / 49));
    boxes.push_back({at, at + Vec3f::constant(i % 5 == 0 ? 1.0F : 0.999F)});
  }
  start(boxes);
  PairBuffer buffer;
  PairEvents events;
  std::vector<Pair> before;
  std::uint64_t full = 0;
  std::size_t changed = 0;
  for (int frame = 0; frame < 40; ++frame) {
    // At first nothing changes.
    jitter_all(frame < 6 ? 0.0F : 8e-5F * static_cast<float>(frame % 6), 50);
    ASSERT_EQ(
        world_->threads().run([&] { return world_->partition().self_pairs(buffer, events, {}); }),
        Status::ok);
    ASSERT_TRUE(world_->has_pairs(buffer)) << "frame " << frame;
    std::vector<Pair> now(buffer.begin(), buffer.end());
    std::ranges::sort(now);
    std::vector<Pair> begun;
    std::vector<Pair> ended;
    std::ranges::set_difference(now, before, std::back_inserter(begun));
    std::ranges::set_difference(before, now, std::back_inserter(ended));
    const auto pair_of = [](const KeyPair& pair) { return Pair{pair.first.id, pair.second.id}; };
    EXPECT_TRUE(std::ranges::equal(events.begun(), begun, {}, pair_of)) << "frame " << frame;
    EXPECT_TRUE(std::ranges::equal(events.ended(), ended, {}, pair_of)) << "frame " << frame;
    EXPECT_EQ(events.persisting() + begun.size(), now.size());
    before = now;
    if (frame == 5) full = full_queries();
    changed += frame > 5 ? begun.size() + ended.size() : 0;
  }
  EXPECT_EQ(full_queries(), full);
  EXPECT_GT(changed, 1000U);
}

TEST_P(RestingScenes, objects_that_come_go_and_move_are_handled) {
  for (const bool touching : {false, true}) {
    std::vector<Aabb> boxes = uniform_boxes(kCount);
    if (touching) {
      for (Aabb& box : boxes) {
        box.min = as_eigen(box.min).array().round();
        box.max = as_eigen(box.min).array() + 1.0F;
      }
    }
    start(boxes);
    PairBuffer buffer;
    settle(0.0F, buffer);
    const std::uint64_t full = full_queries();
    for (int frame = 0; frame < 60; ++frame) {
      if (frame % 7 == 6) {
        for (std::size_t i = 0; i < keys_.size(); ++i) {
          world_->update(keys_[i], jittered(rest_[i], 1e-4F, random_));
        }
      } else {
        jitter_all(1e-4F, 2 + random_.below(200));
      }
      for (std::size_t change = random_.below(4); change != 0; --change) {
        const std::size_t at = random_.below(keys_.size());
        switch (random_.below(6)) {
          case 0:
            rest_[at] = jittered(rest_[random_.below(rest_.size())], 0.5F, random_);
            world_->update(keys_[at], rest_[at]);
            break;
          case 1:
            world_->remove(keys_[at]);
            keys_[at] = world_->insert(rest_[at]);
            break;
          case 2:
            world_->remove(keys_[at]);
            keys_.erase(keys_.begin() + static_cast<std::ptrdiff_t>(at));
            rest_.erase(rest_.begin() + static_cast<std::ptrdiff_t>(at));
            break;
          case 3:
            rest_.push_back(jittered(rest_[at], 0.3F, random_));
            keys_.push_back(world_->insert(rest_.back()));
            break;
          case 4:
            world_->set_filter(keys_[at], {1, 1, random_.chance(0.5) ? 0U : 1U});
            break;
          default:  // moves away and back in one update
            world_->update(std::vector<Key>{keys_[at], keys_[at]},
                           std::vector<Aabb>{jittered(rest_[at], 5.0F, random_), rest_[at]});
        }
      }
      // Some frames have no query in between.
      if (frame % 5 == 3) continue;
      ASSERT_TRUE(world_->agrees(buffer)) << "frame " << frame;
    }
    EXPECT_TRUE(world_->holds_its_objects());
    EXPECT_LE(full_queries(), full + 20);
  }
}

TEST_P(RestingScenes, rest_ends_if_everything_moves) {
  start(uniform_boxes(kCount));
  PairBuffer buffer;
  for (int round = 0; round < 3; ++round) {
    settle(1e-5F, buffer);
    for (Aabb& box : rest_) box = jittered(box, 0.4F, random_);
    jitter_all(0.0F, 1000);
    ASSERT_TRUE(world_->agrees(buffer));
    ASSERT_TRUE(world_->holds_its_objects());
  }
}

// All other queries read the current boxes.
TEST_P(RestingScenes, every_query_reads_the_current_boxes) {
  start(uniform_boxes(kCount));
  World other(config());
  other.insert(uniform_boxes(100, 2));
  PairBuffer buffer;
  PairBuffer second;
  for (int question = 0; question < 10; ++question) {
    settle(1e-4F, buffer);
    jitter_all(1e-4F);
    const Partition& partition = world_->partition();
    switch (question) {
      case 0:
        ASSERT_TRUE(world_->agrees(second));
        break;
      case 1: {
        ASSERT_EQ(world_->pairs_with(other.partition(), second), Status::ok);
        EXPECT_TRUE(right_cross_pairs(
            second.pairs(), cross_pairs(world_->objects(), other.objects()), partition.is_exact()));
        break;
      }
      case 2: {
        const std::vector<Aabb> query_boxes = uniform_boxes(50, 3);
        ASSERT_EQ(partition.overlap(BoxView(query_boxes), second), Status::ok);
        EXPECT_TRUE(right_cross_pairs(second.pairs(),
                                      cross_pairs(numbered(query_boxes), world_->objects()), true));
        break;
      }
      case 3: {
        Hit hit;
        const Aabb box = world_->entries().at(keys_[3].id).box;
        hit = expect_ok(partition.closest(Ray{box.min, {1, 0, 0}}));
        EXPECT_EQ(hit.t, 0.0F);
        break;
      }
      case 4:
        ASSERT_TRUE(world_->agrees(buffer, {.order = Order::canonical}));
        break;
      case 5:
        ASSERT_TRUE(world_->agrees(buffer, {.incremental = false}));
        break;
      case 6:
        ASSERT_EQ(partition.refresh(), Status::ok);
        break;
      case 7:
        world_->partition().release_memory();
        break;
      case 8:
        ASSERT_EQ(world_->partition().set_structure(linear_bvh()), Status::ok);
        break;
      default:
        buffer.clear();
    }
    ASSERT_TRUE(world_->holds_its_objects()) << "question " << question;
    if (world_->partition().is_exact() == config().make().is_exact()) {
      ASSERT_TRUE(world_->agrees(buffer)) << "question " << question;
    }
  }
  world_->clear();
  ASSERT_TRUE(world_->agrees(buffer));
}

TEST_P(RestingScenes, infinite_huge_tiny_and_flat_boxes_are_right) {
  std::vector<Aabb> boxes = uniform_boxes(300);
  for (std::size_t i = 0; i < 60; ++i) boxes[i].max = boxes[i].min;
  for (std::size_t i = 60; i < 100; ++i) boxes[i].max[2] = boxes[i].min[2];
  boxes[100] = {{-kInf, -kInf, -kInf}, {kInf, kInf, 2.0F}};
  boxes[101] = {{0, 0, 0}, {kInf, 1, 1}};
  boxes[102] = {{-3e38F, -3e38F, -3e38F}, {3e38F, 3e38F, 3e38F}};
  boxes[103] = {{1e30F, 1e30F, 1e30F}, {1e30F, 1e30F, 1e30F}};
  boxes[104] = {{1e-40F, 0, 0}, {1e-40F, 0, 0}};
  start(boxes);
  PairBuffer buffer;
  settle(1e-5F, buffer);
  for (int frame = 0; frame < 12; ++frame) {
    jitter_all(1e-5F);
    ASSERT_TRUE(world_->agrees(buffer)) << "frame " << frame;
    ASSERT_TRUE(world_->holds_its_objects());
  }
}

// Nearly all pairs of the tiny boxes would have to be watched (resting.h), so that the scene does
// not count as resting.
TEST_P(RestingScenes, tiny_boxes_among_large_ones_prevent_rest) {
  std::vector<Aabb> boxes = uniform_boxes(kCount);
  for (std::size_t i = 0; i < kCount / 2; ++i) boxes.push_back(tiny_box());
  start(boxes);
  PairBuffer buffer;
  settle(1e-5F, buffer);
  for (int frame = 0; frame < 10; ++frame) {
    jitter_all(1e-5F);
    ASSERT_TRUE(world_->agrees(buffer)) << "frame " << frame;
    EXPECT_GT(world_->partition().statistics().last_tests, 0U);
  }
}

TEST_P(RestingScenes, rest_ends_if_tiny_boxes_gather) {
  start(uniform_boxes(kCount));
  PairBuffer buffer;
  settle(1e-5F, buffer);
  const std::uint64_t full = full_queries();
  for (std::size_t frame = 0; frame < 40; ++frame) {
    jitter_all(1e-5F);
    for (std::size_t i = 0; i < 5; ++i) {
      rest_[5 * frame + i] = tiny_box();
      world_->update(keys_[5 * frame + i], rest_[5 * frame + i]);
    }
    ASSERT_TRUE(world_->agrees(buffer)) << "frame " << frame;
  }
  EXPECT_GT(full_queries(), full);
}

TEST_P(RestingScenes, invalid_calls_are_refused) {
  start(uniform_boxes(kCount));
  PairBuffer buffer;
  settle(1e-5F, buffer);
  Partition& partition = world_->partition();
  const std::vector<Aabb> inverted{rest_[0], {{1, 0, 0}, {0, 1, 1}}};
  const std::vector<Aabb> nan{rest_[0], {{NAN, 0, 0}, {1, 1, 1}}};
  const std::vector<Aabb> fine{rest_[0], rest_[1]};
  const std::vector<Key> two{keys_[0], keys_[1]};
  EXPECT_EQ(partition.update(two, inverted), Status::invalid_bounds);
  EXPECT_EQ(partition.update(two, nan), Status::invalid_bounds);
  EXPECT_EQ(partition.update(std::vector<Key>{keys_[0], Key{}}, fine), Status::invalid_key);
  EXPECT_EQ(partition.update(std::vector<Key>{keys_[0]}, fine), Status::size_mismatch);
  EXPECT_TRUE(world_->holds_its_objects());
  EXPECT_TRUE(world_->agrees(buffer));
}

TEST_P(RestingScenes, results_are_right_after_any_refused_memory) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  for (std::size_t granted = 0; granted < 12; ++granted) {
    start(uniform_boxes(300));
    PairBuffer buffer(&results_);
    for (std::size_t frame = 0; frame < 12; ++frame) {
      jitter_all(1e-5F);
      if (frame % 4 == 2) {
        rest_[5] = jittered(rest_[frame], 0.5F, random_);
        world_->update(keys_[5], rest_[5]);
        rest_.push_back(jittered(rest_[9], 0.5F, random_));
        keys_.push_back(world_->insert(rest_.back()));
      }
      if (frame == 3 || frame == 8) memory_.refuse_after(granted / 3);
      if (frame == 3 || frame == 9) results_.refuse_after(granted % 3);
      const Status status = world_->self_pairs(buffer);
      memory_.grant_all();
      results_.grant_all();
      if (status == Status::ok) {
        ASSERT_TRUE(world_->has_pairs(buffer)) << "frame " << frame;
      } else {
        ASSERT_EQ(status, Status::out_of_memory);
      }
      ASSERT_TRUE(world_->holds_its_objects());
      EXPECT_EQ(world_->partition().footprint().total().reserved, memory_.outstanding());
      EXPECT_EQ(buffer.footprint().total().reserved, results_.outstanding());
    }
    ASSERT_TRUE(world_->agrees(buffer));
  }
}

// Events contain all changes since the last successful frame, wherever memory was refused; a copy
// of the buffer of that frame can be continued, too.
TEST_P(RestingScenes, events_after_a_refusal_cover_all_changes) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  const auto sorted = [](const PairBuffer& buffer) {
    std::vector<Pair> pairs(buffer.begin(), buffer.end());
    std::ranges::sort(pairs);
    return pairs;
  };
  const auto pair_of = [](const KeyPair& pair) { return Pair{pair.first.id, pair.second.id}; };
  int failures = 0;
  bool was_refused = true;
  for (std::size_t granted = 0; was_refused && granted < 40; ++granted) {
    start(uniform_boxes(300));
    PairBuffer buffer(&results_);
    PairEvents events(&results_);
    const auto query = [&] {
      return world_->threads().run(
          [&] { return world_->partition().self_pairs(buffer, events, {}); });
    };
    for (int frame = 0; frame < 8; ++frame) {
      jitter_all(1e-5F);
      ASSERT_EQ(query(), Status::ok);
    }
    const std::vector<Pair> before = sorted(buffer);
    PairBuffer copy;
    ASSERT_TRUE(copy.assign(buffer));
    const auto change = [&] {
      jitter_all(1e-5F);
      for (std::size_t i = 0; i < 6; ++i) {
        rest_[i] = jittered(rest_[i + 9], 0.5F, random_);
        world_->update(keys_[i], rest_[i]);
      }
      for (const Aabb& box : uniform_boxes(8, 5)) {
        rest_.push_back(box);
        keys_.push_back(world_->insert(box));
      }
    };
    change();
    const std::size_t refusals = memory_.refusals() + results_.refusals();
    memory_.refuse_after(granted);
    results_.refuse_after(granted);
    const Status status = query();
    memory_.grant_all();
    results_.grant_all();
    was_refused = memory_.refusals() + results_.refusals() != refusals;
    if (status == Status::ok) continue;
    ++failures;
    ASSERT_EQ(status, Status::out_of_memory);
    ASSERT_EQ(sorted(buffer), before);
    ASSERT_TRUE(world_->agrees(copy)) << granted;
    change();
    ASSERT_EQ(query(), Status::ok);
    ASSERT_TRUE(world_->has_pairs(buffer));
    const std::vector<Pair> now = sorted(buffer);
    std::vector<Pair> begun;
    std::vector<Pair> ended;
    std::ranges::set_difference(now, before, std::back_inserter(begun));
    std::ranges::set_difference(before, now, std::back_inserter(ended));
    EXPECT_TRUE(std::ranges::equal(events.begun(), begun, {}, pair_of)) << granted;
    EXPECT_TRUE(std::ranges::equal(events.ended(), ended, {}, pair_of)) << granted;
    EXPECT_EQ(events.persisting() + begun.size(), now.size());
  }
  EXPECT_GT(failures, 0);
}

TEST_P(RestingScenes, steady_frames_do_not_allocate) {
  start(uniform_boxes(kCount));
  PairBuffer buffer(&results_);
  settle(1e-5F, buffer);
  for (int frame = 0; frame < 6; ++frame) {
    jitter_all(1e-5F);
    ASSERT_EQ(world_->self_pairs(buffer), Status::ok);
  }
  const std::size_t requests = memory_.requests() + results_.requests();
  for (int frame = 0; frame < 20; ++frame) {
    jitter_all(1e-5F);
    ASSERT_EQ(world_->self_pairs(buffer), Status::ok);
  }
  EXPECT_EQ(memory_.requests() + results_.requests(), requests);
}

// Frames also do not allocate if each frame has another query, which needs the current rows.
TEST_P(RestingScenes, steady_frames_with_queries_do_not_allocate) {
  start(uniform_boxes(kCount));
  PairBuffer buffer(&results_);
  const auto play = [&] {
    jitter_all(1e-5F);
    ASSERT_EQ(world_->self_pairs(buffer), Status::ok);
    expect_ok(world_->partition().closest(Ray{{-5, 2, 2}, {1, 0, 0}}));
  };
  for (int frame = 0; frame < 12; ++frame) play();
  const std::size_t requests = memory_.requests() + results_.requests();
  for (int frame = 0; frame < 60; ++frame) play();
  EXPECT_EQ(memory_.requests() + results_.requests(), requests);
}

#if WINNOW_TEST_THREADS
// The thread sanitizer finds races that happen to give the right results.
TEST_P(RestingScenes, concurrent_queries_are_safe) {
  start(uniform_boxes(300));
  std::array<PairBuffer, 3> buffers;
  for (int round = 0; round < 6; ++round) {
    settle(1e-5F, buffers[0]);
    jitter_all(1e-5F);
    const Partition& partition = world_->partition();
    std::vector<std::thread> readers;
    for (std::size_t i = 0; i < buffers.size(); ++i) {
      readers.emplace_back([&, i] {
        EXPECT_EQ(partition.self_pairs(buffers[i]), Status::ok);
        Aabb box = expect_ok(partition.bounds(keys_[i]));
        EXPECT_EQ(box, world_->entries().at(keys_[i].id).box);
        Hit hit = expect_ok(partition.closest(Ray{box.min, {1, 0, 0}}));
        EXPECT_EQ(hit.t, 0.0F);
        (void)partition.footprint();
      });
    }
    for (std::thread& reader : readers) reader.join();
    for (const PairBuffer& buffer : buffers) ASSERT_TRUE(world_->has_pairs(buffer));
  }
}
#endif

INSTANTIATE_TEST_SUITE_P(All, RestingScenes, testing::ValuesIn(exact_configs()),
                         testing::PrintToStringParamName());

// Results are byte-identical on every instruction set and number of threads.
TEST(RestingScenesOfAnyConfig, results_are_equal_in_every_config) {
  for (const std::string_view name : structure_names()) {
    std::vector<std::vector<Pair>> expected;
    for (const Config& config : exact_configs()) {
      if (config.partition != name) continue;
      const IsaScope isa(config.isa);
      World world(config);
      const std::vector<Aabb> rest = uniform_boxes(2000);
      const std::vector<Key> keys = world.insert(rest);
      PairBuffer buffer;
      Random random(5);
      for (std::size_t frame = 0; frame < 12; ++frame) {
        std::vector<Aabb> boxes = rest;
        for (Aabb& box : boxes) box = jittered(box, frame < 5 ? 1e-6F : 1e-3F, random);
        for (std::size_t i = 0; i < frame; ++i) boxes[7 * i] = rest[7 * i + 9];
        world.update(keys, boxes);
        ASSERT_EQ(world.self_pairs(buffer), Status::ok);
        if (expected.size() == frame) expected.emplace_back(buffer.begin(), buffer.end());
        EXPECT_TRUE(std::ranges::equal(buffer, expected[frame])) << to_string(config);
      }
    }
  }
}

}  // namespace
}  // namespace winnow::test
