// Answers depend only on the pair, not on its position in the batch, the ISA, the number of threads
// or earlier calls; and the contact levels agree with each other.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "tests/pipeline/pair_results.h"
#include "tests/pipeline/pair_scenes.h"
#include "tests/pipeline/reproduction.h"
#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/random.h"

namespace winnow::test {
namespace {

constexpr NarrowTier kTiers[] = {NarrowTier::robust, NarrowTier::reference};
constexpr ContactLevel kLevels[] = {ContactLevel::boolean, ContactLevel::distance,
                                    ContactLevel::manifold};
constexpr double kMargin = 0.25;

/// Pairs of all kinds in one list, in random order.
PairScene shuffled_scene(std::size_t count) {
  Random random(17);
  PairScene scene;
  for (const PairStyle style : {PairStyle::ordinary, PairStyle::degenerate, PairStyle::lattice}) {
    for (const ShapeKind a : all_kinds()) {
      for (const ShapeKind b : all_kinds()) add_pairs(scene, a, b, style, count, random);
    }
  }
  for (std::size_t i = scene.pairs.size(); i > 1; --i) {
    std::swap(scene.pairs[i - 1], scene.pairs[random.below(i)]);
  }
  return scene;
}

class Batches : public testing::Test {
 protected:
  void expect_same(const std::vector<PairResults>& there, const std::vector<PairResults>& again,
                   const std::string& what) const {
    ASSERT_EQ(there.size(), again.size());
    int faults = 0;
    for (std::size_t i = 0; i < there.size(); ++i) {
      if (same(there[i], again[i]) || ++faults > 2) continue;
      ADD_FAILURE() << what << ": " << there[i].distance << " and " << again[i].distance << ", "
                    << there[i].contacts.size() << " and " << again[i].contacts.size()
                    << " contacts\n"
                    << reproduction(scene_, scene_.pairs[i]);
    }
    EXPECT_EQ(faults, 0) << what;
  }

  PairScene scene_ = shuffled_scene(scaled(20));
};

TEST_F(Batches, answers_match_on_every_isa_and_thread_count) {
  const Isa widest = available_isas().back();
  for (const NarrowTier tier : kTiers) {
    for (const ContactLevel level : kLevels) {
      NarrowOptions options{.level = level, .tier = tier, .contact_margin = kMargin};
      std::vector<PairResults> first;
      {
        const IsaScope scope(available_isas().front());
        first = compute_results(scene_, options);
      }
      for (const Isa isa : available_isas()) {
        if (is_quick() && isa != widest) continue;
        const IsaScope scope(isa);
        expect_same(first, compute_results(scene_, options), to_string(isa));
        for (const Workers& workers : all_workers()) {
          if (isa != widest) continue;
          options.execution = workers.execution();
          expect_same(
              first, Threads(workers.threads).run([&] { return compute_results(scene_, options); }),
              to_string(workers));
        }
        options.execution = Execution::serial();
      }
    }
  }
}

TEST_F(Batches, batch_position_and_earlier_calls_change_nothing) {
  for (const NarrowTier tier : kTiers) {
    for (const ContactLevel level : kLevels) {
      const NarrowOptions options{.level = level, .tier = tier, .contact_margin = kMargin};
      const auto together = compute_results(scene_, options);
      NarrowPhase phase;
      NarrowResult result;
      // Batches of many sizes put the pairs into different lanes and at the ends of batches.
      std::vector<PairResults> apart;
      const std::span<const BodyPair> pairs(scene_.pairs);
      for (std::size_t at = 0, size = 1; at < pairs.size(); at += size, size = size % 37 + 1) {
        size = std::min(size, pairs.size() - at);
        ASSERT_EQ(
            phase.collide(scene_.pool, scene_.bodies(), pairs.subspan(at, size), options, result),
            Status::ok);
        const auto answers = answers_of(result, size);
        apart.insert(apart.end(), answers.begin(), answers.end());
      }
      expect_same(together, apart, "in pieces");
    }
  }
}

TEST_F(Batches, batch_of_one_matches_large_batch) {
  NarrowPhase phase;
  NarrowResult result;
  for (const NarrowTier tier : kTiers) {
    const auto options_of = [tier](ContactLevel level) {
      return NarrowOptions{.level = level, .tier = tier, .contact_margin = kMargin};
    };
    std::vector<std::vector<PairResults>> together;
    for (const ContactLevel level : kLevels)
      together.push_back(compute_results(scene_, options_of(level)));
    std::vector<PairResults> single;
    std::vector<PairResults> expected;
    // All calls write to one result, at another level each time.
    for (std::size_t i = 0; i < scene_.pairs.size(); ++i) {
      const std::size_t level = i / 2 % 3;
      ASSERT_EQ(phase.collide(scene_.pool, scene_.bodies(), {&scene_.pairs[i], 1},
                              options_of(kLevels[level]), result),
                Status::ok);
      ASSERT_EQ(result.size(), 1U);
      ASSERT_EQ(result.level(), kLevels[level]);
      single.push_back(answers_of(result, 1).front());
      expected.push_back(together[level][i]);
    }
    expect_same(expected, single, "alone");
  }
}

/// Returns the answer of the single-pair function for pair i.
PairResults answer_of_one(const PairScene& scene, std::size_t i, const NarrowOptions& options) {
  const BodyPair pair = scene.pairs[i];
  PairAnswer answer;
  EXPECT_EQ(collide(scene.pool, scene.shapes[pair.a], scene.poses[pair.a], scene.shapes[pair.b],
                    scene.poses[pair.b], options, answer),
            Status::ok);
  PairResults answers;
  answers.overlap = answer.overlap;
  if (options.level == ContactLevel::boolean) return answers;
  answers.distance = answer.distance;
  answers.error_bound = answer.error_bound;
  const bool has_point = options.level == ContactLevel::distance;
  for (int axis = 0; axis < 3; ++axis) {
    answers.normal[axis] = answer.normal[axis];
    answers.point[axis] = has_point ? answer.point[axis] : 0.0;
  }
  answers.contacts.assign(answer.contacts, answer.contacts + answer.contact_count);
  return answers;
}

TEST_F(Batches, per_pair_margins_match_single_queries) {
  Random random(18);
  std::vector<double> margins;
  for (std::size_t i = 0; i < scene_.pairs.size(); ++i) {
    margins.push_back(random.chance(0.2) ? 0.0 : random.uniform(0.0, 2.0 * kMargin));
  }
  for (const NarrowTier tier : kTiers) {
    for (const ContactLevel level : kLevels) {
      std::vector<PairResults> single;
      for (std::size_t i = 0; i < scene_.pairs.size(); ++i) {
        single.push_back(answer_of_one(scene_, i, {level, tier, margins[i]}));
      }
      for (const Isa isa : available_isas()) {
        const IsaScope scope(isa);
        const NarrowOptions options{.level = level, .tier = tier, .contact_margins = margins};
        expect_same(single, compute_results(scene_, options), to_string(isa));
      }
    }
  }
}

TEST_F(Batches, single_pair_function_matches_narrow_phase) {
  for (const NarrowTier tier : kTiers) {
    for (const ContactLevel level : kLevels) {
      const NarrowOptions options{.level = level, .tier = tier, .contact_margin = kMargin};
      std::vector<PairResults> single(scene_.pairs.size());
      // The function is safe to call from several threads.
      const auto work = Execution::parallel();
      Threads(3).run([&] {
        work.for_each(single.size(),
                      [&](std::size_t i) { single[i] = answer_of_one(scene_, i, options); });
      });
      expect_same(compute_results(scene_, options), single, "one pair");
    }
  }
}

void expect_same_verdicts(const PairScene& scene) {
  const NarrowOptions options{.level = ContactLevel::boolean};
  const std::vector<PairResults> together = compute_results(scene, options);
  for (std::size_t i = 0; i < scene.pairs.size(); ++i) {
    if (answer_of_one(scene, i, options).overlap == together[i].overlap) continue;
    ADD_FAILURE() << "in a batch they " << (together[i].overlap ? "overlap" : "are apart") << "\n"
                  << reproduction(scene, scene.pairs[i]);
    return;
  }
}

TEST(OnePair, verdict_matches_batch) {
  Random random(18);
  for (const PairStyle style : kPairStyles) {
    for (const ShapeKind a : kConvexKinds) {
      for (const ShapeKind b : kConvexKinds) {
        SCOPED_TRACE(testing::Message()
                     << to_string(style) << " " << to_string(a) << " " << to_string(b));
        PairScene scene;
        add_pairs(scene, a, b, style, scaled(60), random);
        expect_same_verdicts(scene);
      }
    }
  }
}

/// Adds `count` bodies of one shape at random poses, and pairs each with one of the first `others`
/// bodies in turn.
void add_near(PairScene& scene, ShapeId shape, std::size_t others, std::size_t count,
              Random& random) {
  for (std::size_t i = 0; i < count; ++i) {
    const auto other = static_cast<std::uint32_t>(i % others);
    const auto body = static_cast<std::uint32_t>(scene.shapes.size());
    scene.shapes.push_back(shape);
    Pose pose;
    for (double& x : pose.position) x = random.uniform(-1.5, 1.5);
    for (double& x : pose.orientation) x = random.uniform(-1, 1);
    scene.poses.push_back(pose);
    scene.pairs.push_back({body, other});
  }
}

// The origin of a user shape may be outside it, and one ball of a tapered capsule may contain the
// other.
TEST(OnePair, verdict_matches_batch_for_off_centre_shapes) {
  Random random(19);
  PairScene scene;
  const auto add = [&](const auto& shape) {
    ShapeId id = expect_ok(scene.pool.add(shape));
    scene.shapes.push_back(id);
    scene.poses.push_back({});
  };
  add(BoxShape{{0.3, 0.2, 0.4}});
  add(CylinderShape{0.3, 0.4});
  add(ConeShape{0.3, 0.4, 0.05});
  add(EllipsoidShape{{0.3, 0.2, 0.4}});
  add(CapsuleShape{0.2, 0.4});
  const UserShape& aside = scene.own.emplace_back(UserShape{
      UserShape::corners, {}, {1.0, 0.0, 0.0, 1.2, 0.1, 0.0, 1.1, -0.2, 0.1, 1.0, 0.1, 0.3}});
  ShapeId own = expect_ok(scene.pool.add(shape_of(aside, 0.01)));
  ShapeId nested = expect_ok(scene.pool.add(TaperedCapsuleShape{{0.9, 0.1}, 0.3}));
  const std::size_t others = scene.shapes.size();
  for (const ShapeId shape : {own, nested}) add_near(scene, shape, others, scaled(2000), random);
  expect_same_verdicts(scene);
}

TEST_F(Batches, order_of_many_pairs_matches_on_threads) {
  constexpr std::size_t kMany = 50000;  // enough for several sorting tasks
  const std::size_t few = scene_.pairs.size();
  for (std::size_t i = 0; scene_.pairs.size() < kMany; ++i) {
    scene_.pairs.push_back(scene_.pairs[i * 7919 % few]);
  }
  const auto collide = [&](const Execution& execution, NarrowResult& result) {
    NarrowPhase phase;
    ASSERT_EQ(phase.collide(scene_.pool, scene_.bodies(), scene_.pairs,
                            {.level = ContactLevel::boolean, .execution = execution}, result),
              Status::ok);
  };
  NarrowResult serial;
  collide(Execution::serial(), serial);
  // The order is stable: pairs of the same kinds keep the input order, swapped pairs among the
  // others.
  for (const NarrowRun& run : serial.runs()) {
    for (std::uint32_t i = 1; i < run.count; ++i) {
      ASSERT_LT(serial.pair_of(run.first + i - 1), serial.pair_of(run.first + i));
    }
  }
  for (const int threads : {2, 3, 8}) {
    NarrowResult parallel;
    Threads(threads).run([&] { collide(Execution::parallel(), parallel); });
    ASSERT_EQ(parallel.size(), serial.size());
    for (std::uint32_t i = 0; i < serial.size(); ++i) {
      ASSERT_EQ(parallel.pair_of(i), serial.pair_of(i)) << threads << " threads";
      ASSERT_EQ(parallel.overlap()[i], serial.overlap()[i]) << threads << " threads";
    }
  }
}

TEST_F(Batches, contact_levels_agree) {
  for (const NarrowTier tier : kTiers) {
    const auto yes_no = compute_results(scene_, {.level = ContactLevel::boolean, .tier = tier});
    const auto distances = compute_results(scene_, {.level = ContactLevel::distance, .tier = tier});
    const auto manifolds = compute_results(
        scene_, {.level = ContactLevel::manifold, .tier = tier, .contact_margin = kMargin});
    int faults = 0;
    for (std::size_t i = 0; i < scene_.pairs.size(); ++i) {
      const PairResults& d = distances[i];
      const PairResults& m = manifolds[i];
      const double slack = d.error_bound + m.error_bound;
      bool good = yes_no[i].overlap == d.overlap && m.overlap == d.overlap;
      good = good && d.overlap == (d.distance <= 0.0);
      good = good && (m.distance > kMargin ? m.distance <= d.distance + slack
                                           : std::abs(m.distance - d.distance) <= slack);
      if (m.distance > kMargin) good = good && m.contacts.empty();
      if (good || ++faults > 3) continue;
      ADD_FAILURE() << "tier " << static_cast<int>(tier) << ": " << yes_no[i].overlap << ' '
                    << d.distance << ' ' << m.distance << " +- " << slack << ", "
                    << m.contacts.size() << " contacts\n"
                    << reproduction(scene_, scene_.pairs[i]);
    }
    EXPECT_EQ(faults, 0);
  }
}

TEST_F(Batches, deepest_contact_within_margin_matches_distance) {
  for (const NarrowTier tier : kTiers) {
    for (const double margin : {0.0, kMargin}) {
      const auto answers = compute_results(scene_, {.tier = tier, .contact_margin = margin});
      int faults = 0;
      for (std::size_t i = 0; i < answers.size(); ++i) {
        const PairResults& m = answers[i];
        if (m.distance > margin) continue;
        double deepest = -std::numeric_limits<double>::infinity();
        for (const ContactPoint& c : m.contacts) {
          deepest = std::max(deepest, static_cast<double>(c.depth));
        }
        const double size = extent(scene_, scene_.pairs[i]) + std::abs(m.distance);
        const double slack = 1e-5 * size + m.error_bound;
        const bool good = !m.contacts.empty() && std::abs(deepest + m.distance) <= slack;
        if (good || ++faults > 3) continue;
        ADD_FAILURE() << "tier " << static_cast<int>(tier) << ", margin " << margin << ": distance "
                      << m.distance << ", " << m.contacts.size() << " contacts, deepest " << deepest
                      << '\n'
                      << reproduction(scene_, scene_.pairs[i]);
      }
      EXPECT_EQ(faults, 0);
    }
  }
}

TEST_F(Batches, statistics_count_every_pair) {
  for (const NarrowTier tier : kTiers) {
    NarrowPhase phase;
    NarrowResult result;
    ASSERT_EQ(phase.collide(scene_.pool, scene_.bodies(), scene_.pairs, {.tier = tier}, result),
              Status::ok);
    const NarrowStatistics& counts = phase.statistics();
    EXPECT_EQ(counts.pairs, scene_.pairs.size());
    EXPECT_LE(counts.recomputed + counts.without_lanes, counts.pairs);
    if (tier == NarrowTier::reference) {
      EXPECT_EQ(counts.without_lanes, counts.pairs);
    }
    std::size_t in_runs = 0;
    for (const NarrowRun& run : result.runs()) {
      EXPECT_EQ(run.first, in_runs);
      EXPECT_LE(run.a, run.b);
      in_runs += run.count;
    }
    EXPECT_EQ(in_runs, result.size());
  }
}

}  // namespace
}  // namespace winnow::test
