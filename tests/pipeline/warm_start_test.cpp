// Indices of pairs and points in the last frame, compared with a reference implementation that
// stores the whole frame and searches all of it (history_reference.h).

#include "tests/pipeline/composite_world.h"
#include "tests/pipeline/history_reference.h"
#include "tests/pipeline/scene_world.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/counting_memory.h"

namespace winnow::test {
namespace {

/// Bodies of several kinds on a terrain of triangles that move, come, go, sleep and wake. All have
/// the radius kRadius.
class Shuffle {
 public:
  static constexpr double kRadius = 0.75;

  Shuffle(std::size_t count, std::uint64_t seed) : composites_(shapes_), random_(seed) {
    ground_ = add(composites_, grid(8, 0.8F, Cut::random, [](float x, float y) {
                    return 0.2F * std::sin(1.7F * x) * std::cos(1.3F * y);
                  }));
    kinds_.push_back(add(shapes_, BoxShape{{0.5, 0.5, 0.25}, 0.0}));
    kinds_.push_back(add_octahedron(shapes_, kRadius));
    kinds_.push_back(add(shapes_, SphereShape{kRadius}));
    kinds_.push_back(add(shapes_, CapsuleShape{0.25, 0.5}));
    const CompoundChild children[] = {
        {add(shapes_, BoxShape{{0.3, 0.2, 0.1}, 0.0}), Pose::at(kRadius - std::sqrt(0.14), 0, 0)},
        {add(shapes_, SphereShape{0.25}), Pose::at(-0.5, 0, 0)}};
    kinds_.emplace_back();
    kinds_.back() = expect_ok(composites_.add_compound(children));
    for (std::size_t i = 0; i < count; ++i) starts_.push_back(fresh());
  }

  [[nodiscard]] SceneOptions options() const {
    return {.contact_margin = 0.02, .composites = &composites_};
  }
  [[nodiscard]] const ShapePool& shapes() const { return shapes_; }

  void fill(Scene& scene) {
    expect_ok(scene.add({.shape = ground_, .state = BodyState::fixed}));
    keys_.resize(starts_.size());
    bodies_ = starts_;
    EXPECT_EQ(scene.add(bodies_, keys_), Status::ok);
  }

  /// Changes one frame. About 30% of the bodies rest, so that their contacts may be cached.
  void stir(Scene& scene, int frame) {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (random_.chance(0.3)) continue;
      for (double& p : bodies_[i].pose.position) p += random_.uniform(-0.01, 0.01);
      for (double& q : bodies_[i].pose.orientation) q += random_.uniform(-0.01, 0.01);
      EXPECT_EQ(scene.move(keys_[i], bodies_[i].pose), Status::ok);
    }
    const std::size_t one = random_.below(bodies_.size());
    switch (frame % 4) {
      case 0:
        EXPECT_EQ(scene.remove(keys_[one]), Status::ok);
        bodies_[one] = fresh();
        keys_[one] = expect_ok(scene.add(bodies_[one]));
        break;
      case 1:
        EXPECT_EQ(scene.set_body_state(keys_[one], BodyState::sleeping), Status::ok);
        break;
      case 2:
        EXPECT_EQ(scene.set_body_state(keys_, BodyState::dynamic), Status::ok);
        break;
      default:
        EXPECT_EQ(scene.set_shape(keys_[one], kinds_[random_.below(kinds_.size())]), Status::ok);
    }
  }

 private:
  [[nodiscard]] BodyDefinition fresh() {
    BodyDefinition body{.shape = kinds_[random_.below(kinds_.size())]};
    for (int k = 0; k < 2; ++k) body.pose.position[k] = random_.uniform(-2.5, 2.5);
    body.pose.position[2] = random_.uniform(0.1, 0.6);
    for (double& q : body.pose.orientation) q = random_.uniform(-1.0, 1.0);
    return body;
  }

  ShapePool shapes_;
  CompositePool composites_;
  Random random_;
  ShapeId ground_;
  std::vector<ShapeId> kinds_;
  std::vector<BodyDefinition> starts_;
  std::vector<BodyDefinition> bodies_;
  std::vector<Key> keys_;
};

/// Two balls separate and touch again.
TEST(WarmStart, previous_indices_last_as_long_as_contact) {
  ShapePool pool;
  const ShapeId ball = add(pool, SphereShape{1.0});
  Scene scene(pool, {.warm_start = true});
  Key keys[4];
  for (int i = 0; i < 4; ++i) {
    keys[i] = expect_ok(scene.add({.shape = ball, .pose = Pose::at(1.9 * i, 0, 0)}));
  }
  Contacts contacts;
  const auto pairs_before = [&] {
    EXPECT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
    const auto pair = contacts.previous_pair();
    const auto point = contacts.previous_point();
    EXPECT_TRUE(std::equal(pair.begin(), pair.end(), point.begin(), point.end()));
    return std::vector<std::uint32_t>(pair.begin(), pair.end());
  };
  const std::uint32_t none = kNoContact;
  EXPECT_EQ(pairs_before(), (std::vector<std::uint32_t>{none, none, none}));
  EXPECT_EQ(pairs_before(), (std::vector<std::uint32_t>{0, 1, 2}));
  ASSERT_EQ(scene.move(keys[0], Pose::at(-1, 0, 0)), Status::ok);
  EXPECT_EQ(pairs_before(), (std::vector<std::uint32_t>{1, 2}));
  ASSERT_EQ(scene.move(keys[0], Pose::at(0, 0, 0)), Status::ok);
  EXPECT_EQ(pairs_before(), (std::vector<std::uint32_t>{none, 0, 1}));
  contacts.clear();
  EXPECT_EQ(pairs_before(), (std::vector<std::uint32_t>{none, none, none}));
}

TEST(WarmStart, sliding_box_keeps_four_points) {
  ShapePool shapes;
  CompositePool composites(shapes);
  const ShapeId floor =
      add(composites, grid(16, 0.5F, Cut::alternating, [](float, float) { return 0.0F; }));
  const ShapeId box = add(shapes, BoxShape{{0.1, 0.1, 0.1}, 0.0});
  Scene scene(shapes, {.warm_start = true, .composites = &composites});
  Key ground;
  Key key;
  ground = expect_ok(scene.add({.shape = floor, .state = BodyState::fixed}));
  key = expect_ok(scene.add({.shape = box}));
  Contacts contacts;
  for (int frame = 0; frame < 200; ++frame) {
    ASSERT_EQ(scene.move(key, Pose::at(-2.0 + 0.02 * frame, 0.003 * frame, 0.099)), Status::ok);
    ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
    ASSERT_EQ(contacts.points(), 4U);
    if (frame == 0) continue;
    for (const std::uint32_t before : contacts.previous_point()) EXPECT_NE(before, kNoContact);
  }
}

TEST(WarmStart, previous_indices_match_reference) {
  for (const bool reduced : {false, true}) {
    for (const double cache_tolerance : {0.0, 0.005}) {
      Shuffle world(std::max<std::size_t>(20, scaled(60)), 3);
      SceneOptions options = world.options();
      options.part_manifolds = !reduced;
      options.cache_tolerance = cache_tolerance;
      options.warm_start = true;
      Scene scene(world.shapes(), options);
      world.fill(scene);
      Contacts contacts;
      HistoryReference reference;
      for (int frame = 0; frame < 40; ++frame) {
        const ContactLevel level =
            frame % 13 == 12 ? ContactLevel::distance : ContactLevel::manifold;
        ASSERT_EQ(scene.collide(level, contacts), Status::ok);
        // All shapes have this radius, including the capsule.
        ASSERT_NO_FATAL_FAILURE(
            reference.compare(scene, contacts, reduced, [](Key, Key) { return Shuffle::kRadius; }));
        world.stir(scene, frame);
      }
      EXPECT_GT(reference.by_feature, 100U);
      EXPECT_GT(reference.by_place, 0U);
      EXPECT_GT(reference.persisted, 50U);
    }
  }
}

TEST(WarmStart, indices_match_on_any_threads_and_structure) {
  std::vector<std::uint64_t> first;
  for (const StructureKind structure : {linear_bvh(), sweep_and_prune(), automatic()}) {
    for (const int threads : {1, 2, 8}) {
      Shuffle world(scaled(300), 5);
      Threads arena(threads);
      const auto indices = arena.run([&] {
        SceneOptions options = world.options();
        options.execution = threads == 1 ? Execution::serial() : Execution::parallel();
        options.warm_start = true;
        for (StructureKind& kind : options.structures) kind = structure;
        Scene scene(world.shapes(), options);
        world.fill(scene);
        Contacts contacts;
        std::vector<std::uint64_t> bits;
        for (int frame = 0; frame < 12; ++frame) {
          EXPECT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
          for (const auto before : contacts.previous_pair()) bits.push_back(before);
          for (const auto before : contacts.previous_point()) bits.push_back(before);
          world.stir(scene, frame);
        }
        return bits;
      });
      if (first.empty()) first = indices;
      EXPECT_TRUE(indices == first) << threads << " threads";
    }
  }
}

TEST(WarmStart, warm_start_changes_no_other_result) {
  std::vector<std::uint64_t> shown_without;
  std::size_t bytes_without = 0;
  for (const bool warm_start : {false, true}) {
    CountingMemory memory;
    Shuffle world(scaled(60), 7);
    SceneOptions options = world.options();
    options.cache_tolerance = 0.005;
    options.warm_start = warm_start;
    Scene scene(world.shapes(), options);
    world.fill(scene);
    Contacts contacts(&memory);
    std::vector<std::uint64_t> bits;
    for (int frame = 0; frame < 12; ++frame) {
      ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
      EXPECT_EQ(contacts.footprint().total().reserved, memory.outstanding());
      const auto more = digest(contacts);
      bits.insert(bits.end(), more.begin(), more.end());
      world.stir(scene, frame);
    }
    if (warm_start) {
      EXPECT_TRUE(bits == shown_without);
      EXPECT_GT(memory.outstanding(), bytes_without);
    } else {
      EXPECT_TRUE(contacts.previous_pair().empty());
      EXPECT_TRUE(contacts.previous_point().empty());
      shown_without = std::move(bits);
      bytes_without = memory.outstanding();
    }
  }
}

TEST(WarmStart, resting_bodies_keep_indices_without_allocation) {
  Shuffle world(scaled(60), 9);
  for (const double cache_tolerance : {0.0, 0.01}) {
    CountingMemory memory;
    SceneOptions options = world.options();
    options.memory = &memory;
    options.cache_tolerance = cache_tolerance;
    options.warm_start = true;
    Scene scene(world.shapes(), options);
    world.fill(scene);
    Contacts contacts(&memory);
    for (int frame = 0; frame < 3; ++frame) {
      ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
    }
    const std::size_t before = memory.requests();
    for (int frame = 0; frame < 3; ++frame) {
      ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
      for (std::uint32_t i = 0; i < contacts.size(); ++i) {
        ASSERT_EQ(contacts.previous_pair()[i], i);
      }
      for (std::uint32_t p = 0; p < contacts.points(); ++p) {
        ASSERT_EQ(contacts.previous_point()[p], p);
      }
    }
    EXPECT_EQ(memory.requests(), before);
  }
}

}  // namespace
}  // namespace winnow::test
