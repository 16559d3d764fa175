// Refused input of the narrow phase, and its memory.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <memory_resource>
#include <utility>
#include <vector>

#include "tests/pipeline/pair_results.h"
#include "tests/pipeline/pair_scenes.h"
#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/counting_memory.h"
#include "tests/support/heap_count.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Fills blocks with large numbers, so that a call that uses elements before it writes them
/// fails.
class FilledMemory final : public std::pmr::memory_resource {
  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    void* const block = std::pmr::new_delete_resource()->allocate(bytes, alignment);
    std::memset(block, 0x7f, bytes);
    return block;
  }
  void do_deallocate(void* block, std::size_t bytes, std::size_t alignment) override {
    std::pmr::new_delete_resource()->deallocate(block, bytes, alignment);
  }
  [[nodiscard]] bool do_is_equal(const memory_resource& other) const noexcept override {
    return this == &other;
  }
};

/// Checks that a batch is refused, and its body named, if pair `bad` has an invalid pose, whichever
/// shape of the pair has it and comes first.
void expect_bad_pose_refused(PairScene& scene, std::size_t bad, const NarrowOptions& options) {
  BodyPair& pair = scene.pairs[bad];
  const BodyPair before = pair;
  for (const std::uint32_t body : {before.a, before.b}) {
    const Pose good = scene.poses[body];
    for (const Pose& pose :
         {Pose::at(kNan, 0, 0), Pose::at(2, 0, -kInfinity), Pose{{1, 2, 3}, {1, kNan, 0, 0}}}) {
      // Spheres ignore their quaternion.
      if (scene.shapes[body].kind() == ShapeKind::sphere && pose.position[0] == 1.0) continue;
      scene.poses[body] = pose;
      for (const BodyPair given : {before, BodyPair{before.b, before.a}}) {
        pair = given;
        FilledMemory memory;
        NarrowPhase phase(&memory);
        NarrowResult result(&memory);
        EXPECT_EQ(phase.collide(scene.pool, scene.bodies(), scene.pairs, options, result),
                  Status::invalid_pose);
        EXPECT_EQ(phase.bad_body(), body);
        EXPECT_EQ(result.size(), 0U);
        EXPECT_EQ(result.contacts(), 0U);
      }
    }
    scene.poses[body] = good;
  }
  pair = before;
}

class NarrowInput : public testing::Test {
 protected:
  NarrowInput() {
    Random random(23);
    for (const ShapeKind a : all_kinds()) {
      for (const ShapeKind b : all_kinds()) {
        add_pairs(scene_, a, b, PairStyle::ordinary, 3, random);
      }
    }
  }

  [[nodiscard]] Status collide(const NarrowOptions& options = {}) {
    return phase_.collide(scene_.pool, scene_.bodies(), scene_.pairs, options, result_);
  }
  /// Checks that the call is refused and the result is empty.
  void expect_refused(Status expected, const NarrowOptions& options = {}) {
    EXPECT_EQ(collide(options), expected);
    EXPECT_EQ(result_.size(), 0U);
    EXPECT_EQ(result_.contacts(), 0U);
    EXPECT_TRUE(result_.runs().empty());
  }

  PairScene scene_;
  NarrowPhase phase_;
  NarrowResult result_;
};

TEST_F(NarrowInput, empty_pairs_give_empty_result) {
  scene_.pairs.clear();
  EXPECT_EQ(collide(), Status::ok);
  EXPECT_EQ(result_.size(), 0U);
  EXPECT_EQ(phase_.collide(scene_.pool, {}, {}, {}, result_), Status::ok);
}

TEST_F(NarrowInput, moved_from_result_is_empty) {
  for (const ContactLevel level :
       {ContactLevel::boolean, ContactLevel::distance, ContactLevel::manifold}) {
    NarrowResult from;
    ASSERT_EQ(phase_.collide(scene_.pool, scene_.bodies(), scene_.pairs, {.level = level}, from),
              Status::ok);
    const NarrowResult to(std::move(from));
    EXPECT_EQ(to.size(), scene_.pairs.size());
    EXPECT_EQ(from.size(), 0U);
    EXPECT_TRUE(from.runs().empty());
    EXPECT_EQ(from.contacts(), 0U);
  }
}

TEST_F(NarrowInput, bad_margin_is_refused) {
  for (const double margin : {-1.0, -1e-300, kNan, kInfinity, -kInfinity}) {
    ASSERT_EQ(collide(), Status::ok);
    expect_refused(Status::invalid_argument, {.contact_margin = margin});
  }
}

TEST_F(NarrowInput, one_bad_margin_of_many_is_refused) {
  std::vector<double> margins(scene_.pairs.size(), 0.125);
  for (const double margin : {-1.0, -1e-300, kNan, kInfinity, -kInfinity}) {
    margins.back() = margin;
    ASSERT_EQ(collide(), Status::ok);
    expect_refused(Status::invalid_argument, {.contact_margins = margins});
  }
}

TEST_F(NarrowInput, wrong_number_of_margins_is_refused) {
  const std::vector<double> margins(scene_.pairs.size() + 1, 0.125);
  for (const std::size_t count : {std::size_t{1}, margins.size() - 2, margins.size()}) {
    ASSERT_EQ(collide(), Status::ok);
    expect_refused(Status::size_mismatch, {.contact_margins = {margins.data(), count}});
  }
}

TEST_F(NarrowInput, body_index_out_of_range_is_refused) {
  const auto count = static_cast<std::uint32_t>(scene_.shapes.size());
  for (const std::uint32_t body : {count, count + 7, ~0U}) {
    for (const bool is_a : {true, false}) {
      const BodyPair before = scene_.pairs[5];
      (is_a ? scene_.pairs[5].a : scene_.pairs[5].b) = body;
      ASSERT_EQ(collide(), Status::invalid_argument);
      expect_refused(Status::invalid_argument);
      scene_.pairs[5] = before;
      EXPECT_EQ(collide(), Status::ok);
    }
  }
}

TEST_F(NarrowInput, missing_pose_is_refused) {
  scene_.poses.pop_back();
  expect_refused(Status::size_mismatch);
}

TEST_F(NarrowInput, unknown_shape_is_refused) {
  expect_ok(scene_.pool.add(SphereShape{1.0}));
  for (const ShapeId id : {ShapeId{}, ShapeId::of(ShapeKind::cone, 1000), ShapeId{9U << 28U},
                           ShapeId::of(ShapeKind::half_space, (1U << 28U) - 1U)}) {
    ShapeId& shape = scene_.shapes[scene_.pairs[7].b];
    const ShapeId before = shape;
    shape = id;
    expect_refused(Status::invalid_key);
    EXPECT_EQ(phase_.bad_body(), scene_.pairs[7].b);
    shape = before;
    EXPECT_EQ(collide(), Status::ok);
  }
}

TEST_F(NarrowInput, new_narrow_phase_has_no_bad_body) {
  EXPECT_EQ(phase_.bad_body(), ~0U);
  scene_.shapes[scene_.pairs[7].b] = ShapeId{};
  expect_refused(Status::invalid_key);
  const NarrowPhase taken(std::move(phase_));
  EXPECT_EQ(taken.bad_body(), scene_.pairs[7].b);
  EXPECT_EQ(phase_.bad_body(), ~0U);  // NOLINT(bugprone-use-after-move)
}

TEST_F(NarrowInput, single_bad_pair_fails_like_batch) {
  const auto body = static_cast<std::uint32_t>(scene_.shapes.size());
  scene_.shapes.insert(scene_.shapes.end(), {ShapeId{}, ShapeId::of(ShapeKind::box, 1U << 20U)});
  scene_.poses.resize(scene_.shapes.size());
  for (const std::uint32_t other : {0U, body, body + 1, body + 2, ~0U}) {
    for (const BodyPair pair : {BodyPair{body, other}, BodyPair{other, body}, BodyPair{1, other},
                                BodyPair{other, body + 1}}) {
      const BodyPair twice[] = {pair, pair};
      const Status single = phase_.collide(scene_.pool, scene_.bodies(), {&pair, 1}, {}, result_);
      EXPECT_EQ(single, phase_.collide(scene_.pool, scene_.bodies(), twice, {}, result_));
    }
  }
  for (const BodyPair pair : {BodyPair{0, body}, BodyPair{body, 0}, BodyPair{body, body + 1}}) {
    scene_.pairs = {pair};
    expect_refused(Status::invalid_key);
    EXPECT_EQ(phase_.bad_body(), body);
  }
  scene_.pairs = {{0, body + 2}};
  expect_refused(Status::invalid_argument);
  EXPECT_EQ(phase_.bad_body(), ~0U);
}

TEST_F(NarrowInput, bad_pairs_of_many_fail_on_any_threads) {
  constexpr std::size_t kMany = 100000;  // enough for several checking tasks
  const std::vector<BodyPair> few = scene_.pairs;
  while (scene_.pairs.size() < kMany) {
    scene_.pairs.insert(scene_.pairs.end(), few.begin(), few.end());
  }
  const NarrowOptions options{.level = ContactLevel::boolean, .execution = Execution::parallel()};
  for (const int threads : {1, 2, 5}) {
    const auto refused = [&](Status expected) {
      Threads(threads).run([&] { expect_refused(expected, options); });
    };
    // Two bad bodies: the narrow phase names the one whose pair comes first.
    const auto last = static_cast<std::uint32_t>(scene_.shapes.size());
    scene_.shapes.insert(scene_.shapes.end(), {ShapeId{}, ShapeId{}});
    scene_.poses.resize(scene_.shapes.size());
    const BodyPair before[] = {scene_.pairs[kMany / 3], scene_.pairs[kMany - 2]};
    scene_.pairs[kMany / 3].b = last + 1;
    scene_.pairs[kMany - 2].a = last;
    refused(Status::invalid_key);
    EXPECT_EQ(phase_.bad_body(), last + 1);
    // An index out of range takes precedence at any position.
    scene_.pairs[kMany - 2].a = last + 2;
    refused(Status::invalid_argument);
    EXPECT_EQ(phase_.bad_body(), ~0U);
    scene_.pairs[kMany / 3] = before[0];
    scene_.pairs[kMany - 2] = before[1];
    scene_.shapes.resize(last);
    scene_.poses.resize(last);
    Threads(threads).run([&] { EXPECT_EQ(collide(options), Status::ok); });
  }
}

TEST_F(NarrowInput, bad_pose_is_refused_and_named) {
  const auto reference = compute_results(scene_, {});
  for (const NarrowTier tier : {NarrowTier::robust, NarrowTier::reference}) {
    for (const ContactLevel level :
         {ContactLevel::boolean, ContactLevel::distance, ContactLevel::manifold}) {
      for (std::size_t i = 0; i < scene_.pairs.size(); i += 7) {
        const std::uint32_t body = i % 2 == 0 ? scene_.pairs[i].a : scene_.pairs[i].b;
        const Pose before = scene_.poses[body];
        for (const double bad : {kNan, kInfinity, -kInfinity}) {
          scene_.poses[body].position[i % 3] = bad;
          expect_refused(Status::invalid_pose, {.level = level, .tier = tier});
          EXPECT_EQ(phase_.bad_body(), body);
          scene_.poses[body] = before;
        }
        // Spheres ignore their quaternion.
        if (scene_.shapes[body].kind() == ShapeKind::sphere) continue;
        for (const Pose& bad : {Pose{{1, 2, 3}, {0, 0, 0, 0}}, Pose{{1, 2, 3}, {1, kNan, 0, 0}},
                                Pose{{1, 2, 3}, {1, 0, 0, kInfinity}}}) {
          scene_.poses[body] = bad;
          expect_refused(Status::invalid_pose, {.level = level, .tier = tier});
          EXPECT_EQ(phase_.bad_body(), body);
          scene_.poses[body] = before;
        }
      }
    }
  }
  ASSERT_EQ(collide(), Status::ok);
  const auto after = answers_of(result_, scene_.pairs.size());
  for (std::size_t i = 0; i < after.size(); ++i) EXPECT_TRUE(same(after[i], reference[i])) << i;
}

TEST_F(NarrowInput, bad_pose_reads_no_unwritten_result) {
  std::vector<ShapeKind> kinds = all_kinds();
  kinds.push_back(ShapeKind::support);
  Random random(29);
  for (const ShapeKind a : kinds) {
    for (const ShapeKind b : kinds) {
      if (b < a) continue;
      PairScene scene;
      add_pairs(scene, a, b, PairStyle::ordinary, 3, random);
      add_pairs(scene, ShapeKind::sphere, ShapeKind::box, PairStyle::ordinary, 1, random);
      for (const NarrowTier tier : {NarrowTier::robust, NarrowTier::reference}) {
        for (const ContactLevel level :
             {ContactLevel::boolean, ContactLevel::distance, ContactLevel::manifold}) {
          SCOPED_TRACE(testing::Message()
                       << to_string(a) << ", " << to_string(b) << ", tier "
                       << static_cast<int>(tier) << ", level " << static_cast<int>(level));
          for (std::size_t bad = 0; bad < 3; ++bad) {
            expect_bad_pose_refused(scene, bad, {.level = level, .tier = tier});
          }
        }
      }
    }
  }
}

TEST_F(NarrowInput, bad_pose_in_task_reads_no_unwritten_result) {
  constexpr std::size_t kMany = 1400;  // three tasks
  Random random(31);
  PairScene scene;
  add_pairs(scene, ShapeKind::box, ShapeKind::sphere, PairStyle::ordinary, kMany, random);
  for (const NarrowTier tier : {NarrowTier::robust, NarrowTier::reference}) {
    const NarrowOptions options{.level = ContactLevel::manifold,
                                .tier = tier,
                                .execution = Execution::parallel(),
                                .contact_margins = {}};
    for (const int threads : {1, 3}) {
      for (const std::size_t bad : {std::size_t{0}, kMany / 2, kMany - 1}) {
        Threads(threads).run([&] { expect_bad_pose_refused(scene, bad, options); });
      }
    }
  }
}

TEST_F(NarrowInput, single_pair_function_refuses_like_narrow_phase) {
  const auto expect_the_same = [&](std::uint32_t a, std::uint32_t b, const NarrowOptions& options) {
    PairAnswer answer;
    answer.distance = 17.0;
    answer.overlap = true;
    const Status status = winnow::collide(scene_.pool, scene_.shapes[a], scene_.poses[a],
                                          scene_.shapes[b], scene_.poses[b], options, answer);
    scene_.pairs = {{a, b}};
    ASSERT_EQ(status, collide(options));
    if (status == Status::ok) return;
    EXPECT_EQ(answer.distance, 17.0);
    EXPECT_TRUE(answer.overlap);
  };
  const std::vector<BodyPair> pairs = scene_.pairs;
  const auto other = static_cast<std::uint32_t>(scene_.shapes.size());
  scene_.shapes.push_back({});
  scene_.poses.push_back({});
  for (const BodyPair pair : pairs) {
    for (const ContactLevel level : {ContactLevel::pairs, ContactLevel::boolean,
                                     ContactLevel::distance, ContactLevel::manifold}) {
      for (const NarrowTier tier : {NarrowTier::robust, NarrowTier::reference}) {
        expect_the_same(pair.a, pair.b, {.level = level, .tier = tier});
        expect_the_same(pair.a, pair.b, {.level = level, .tier = tier, .contact_margin = kNan});
        const Pose good = scene_.poses[pair.b];
        for (const Pose& bad :
             {Pose{{1, kInfinity, 3}, {1, 0, 0, 0}}, Pose{{1, 2, 3}, {0, 0, 0, 0}},
              Pose{{1, 2, 3}, {1, kNan, 0, 0}}, Pose{{1, 2, 3}, {1, 0, 0, kInfinity}}}) {
          scene_.poses[pair.b] = bad;
          expect_the_same(pair.a, pair.b, {.level = level, .tier = tier});
          expect_the_same(pair.b, pair.a, {.level = level, .tier = tier});
        }
        scene_.poses[pair.b] = good;
      }
    }
    for (const ShapeId id : {ShapeId{}, ShapeId::of(ShapeKind::cone, 1000), ShapeId{9U << 28U},
                             ShapeId::of(ShapeKind::half_space, (1U << 28U) - 1U)}) {
      scene_.shapes[other] = id;
      expect_the_same(pair.a, other, {});
      expect_the_same(other, pair.a, {});
    }
  }
}

TEST_F(NarrowInput, bad_pose_outside_pairs_is_ignored) {
  scene_.shapes.push_back(scene_.shapes.front());
  scene_.poses.push_back({{kNan, 0, 0}, {0, 0, 0, 0}});
  EXPECT_EQ(collide(), Status::ok);
}

TEST_F(NarrowInput, body_with_itself_overlaps) {
  for (BodyPair& pair : scene_.pairs) pair.b = pair.a;
  for (const NarrowTier tier : {NarrowTier::robust, NarrowTier::reference}) {
    ASSERT_EQ(collide({.level = ContactLevel::distance, .tier = tier}), Status::ok);
    for (std::size_t i = 0; i < result_.size(); ++i) {
      EXPECT_TRUE(result_.overlaps(i)) << to_string(scene_.shapes[scene_.pairs[i].a].kind());
      EXPECT_FALSE(std::isnan(result_.distance()[i]));
    }
  }
}

TEST_F(NarrowInput, refused_memory_changes_nothing) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  const auto expected = compute_results(scene_, {});
  std::size_t refusals = 0;
  for (std::size_t granted = 0;; ++granted) {
    CountingMemory memory;
    {
      NarrowPhase phase(&memory);
      NarrowResult result(&memory);
      memory.refuse_after(granted);
      const Status status = phase.collide(scene_.pool, scene_.bodies(), scene_.pairs, {}, result);
      if (status == Status::ok) break;
      ++refusals;
      EXPECT_EQ(status, Status::out_of_memory);
      EXPECT_EQ(result.size(), 0U);
      memory.grant_all();
      ASSERT_EQ(phase.collide(scene_.pool, scene_.bodies(), scene_.pairs, {}, result), Status::ok);
      const auto answers = answers_of(result, scene_.pairs.size());
      for (std::size_t i = 0; i < answers.size(); ++i) EXPECT_TRUE(same(answers[i], expected[i]));
    }
    EXPECT_EQ(memory.outstanding(), 0U);
    ASSERT_LT(granted, 1000U);
  }
  EXPECT_GT(refusals, 3U);
}

TEST_F(NarrowInput, second_call_allocates_nothing) {
  for (const NarrowTier tier : {NarrowTier::robust, NarrowTier::reference}) {
    for (const ContactLevel level :
         {ContactLevel::boolean, ContactLevel::distance, ContactLevel::manifold}) {
      CountingMemory memory;
      NarrowPhase phase(&memory);
      NarrowResult result(&memory);
      const NarrowOptions options{.level = level, .tier = tier};
      ASSERT_EQ(phase.collide(scene_.pool, scene_.bodies(), scene_.pairs, options, result),
                Status::ok);
      const std::size_t requests = memory.requests();
      const std::size_t heap = heap_requests();
      ASSERT_EQ(phase.collide(scene_.pool, scene_.bodies(), scene_.pairs, options, result),
                Status::ok);
      EXPECT_EQ(memory.requests(), requests);
      EXPECT_EQ(heap_requests(), heap)
          << "tier " << static_cast<int>(tier) << ", level " << static_cast<int>(level);
      EXPECT_EQ(phase.footprint().total().reserved + result.footprint().total().reserved,
                memory.outstanding());
    }
  }
}

}  // namespace
}  // namespace winnow::test
