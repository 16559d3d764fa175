// Queries about two bodies and about sets of bodies consider exactly the pairs that Scene::collide
// would generate (PairRules::scene).

#include <gtest/gtest.h>
#include <winnow/pipeline/scene_queries.h>

#include <algorithm>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "tests/pipeline/query_world.h"
#include "tests/pipeline/user_shapes.h"
#include "tests/support/answers.h"
#include "tests/support/config.h"

namespace winnow::test {
namespace {

using Ids = std::pair<ObjectId, ObjectId>;

Ids ids_of(const KeyPair& pair) {
  return {pair.first.id, pair.second.id};
}

/// Bodies with shapes of every kind and with random states, filters, layers, ignored pairs and
/// predicates; and the distance of each two bodies.
class RuledWorld {
 public:
  explicit RuledWorld(Random& random) {
    fill(world_, 24, 0.0, random);
    add_own(random);
    for (BodyDefinition& body : world_.bodies) {
      if (random.chance(0.6)) body.state = BodyState::dynamic;
      if (random.chance(0.4)) body.filter.layers = random.chance(0.5) ? 2U : 3U;
      if (random.chance(0.4)) body.filter.mask = random.chance(0.5) ? 1U : 2U;
      if (random.chance(0.2)) body.filter.environment = random.chance(0.3) ? kAllEnvironments : 1U;
      body.layer = static_cast<std::uint16_t>(random.below(3));
    }
    world_.add_to_scene({.execution = Execution::serial()});
    set_rules(random);
    EXPECT_EQ(world_.scene->refresh(), Status::ok);
    measure();
  }

  [[nodiscard]] Scene& scene() { return *world_.scene; }
  [[nodiscard]] const std::vector<Key>& keys() const { return world_.keys; }
  [[nodiscard]] std::size_t size() const { return world_.keys.size(); }
  [[nodiscard]] double distance(std::size_t a, std::size_t b) const {
    return distance_[a * size() + b];
  }

  /// Returns whether the two bodies may form a pair, computed from the arguments that the scene was
  /// given and not from its state.
  [[nodiscard]] bool filters_allow(std::size_t a, std::size_t b) const {
    const BodyDefinition& one = world_.bodies[a];
    const BodyDefinition& other = world_.bodies[b];
    if (a == b || (one.state != BodyState::dynamic && other.state != BodyState::dynamic))
      return false;
    if ((one.filter.layers & other.filter.mask) == 0) return false;
    if ((other.filter.layers & one.filter.mask) == 0) return false;
    const std::uint32_t in = one.filter.environment;
    const std::uint32_t of = other.filter.environment;
    if (in != of && in != kAllEnvironments && of != kAllEnvironments) return false;
    if (one.layer + other.layer == 2 && one.layer != other.layer) return false;
    if (ignored_.contains({std::min(a, b), std::max(a, b)})) return false;
    return !has_predicate_ || !is_rejected(keys()[a].id, keys()[b].id);
  }
  [[nodiscard]] bool takes(PairRules rules, std::size_t a, std::size_t b) const {
    return a != b && (rules == PairRules::none || filters_allow(a, b));
  }

 private:
  static bool is_rejected(ObjectId a, ObjectId b) { return (a + b) % 7 == 0; }

  void add_own(Random& random) {
    for (const UserShape::Form form : {UserShape::block, UserShape::drum, UserShape::egg}) {
      world_.shapes.own.push_back({form, {0.9, 0.9, 1.4}, {}});
      ShapeId id = expect_ok(world_.shapes.pool.add(shape_of(world_.shapes.own.back(), 0.1)));
      for (int i = 0; i < 2; ++i) world_.add(id, random_pose(world_.size, random), random);
    }
    ShapeId ground =
        expect_ok(world_.shapes.pool.add(HalfSpaceShape{{0.0, 0.0, 1.0}, -0.8 * world_.size}));
    world_.add(ground, Pose{}, random);
  }
  void set_rules(Random& random) {
    Scene& scene = *world_.scene;
    ASSERT_EQ(scene.set_layers_collide(0, 2, false), Status::ok);
    for (std::size_t n = 0; n < 3 * size(); ++n) {
      const std::size_t a = random.below(size());
      const std::size_t b = random.below(size());
      if (a == b || !ignored_.insert({std::min(a, b), std::max(a, b)}).second) continue;
      ASSERT_EQ(scene.set_ignored(keys()[a], keys()[b]), Status::ok);
    }
    has_predicate_ = random.chance(0.5);
    if (!has_predicate_) return;
    scene.set_predicate({[](void*, ObjectId a, ObjectId b) { return !is_rejected(a, b); }});
  }
  void measure() {
    SceneQueries queries(*world_.scene);
    distance_.resize(size() * size());
    for (std::size_t i = 0; i < distance_.size(); ++i) {
      SceneDistance found;
      if (i / size() == i % size()) continue;
      found = expect_ok(
          queries.distance(keys()[i / size()], keys()[i % size()], kInfinity, PairRules::none));
      distance_[i] = found ? found.distance : kInfinity;
    }
  }

  QueryWorld world_;
  std::set<std::pair<std::size_t, std::size_t>> ignored_;
  bool has_predicate_ = false;
  std::vector<double> distance_;
};

/// A random set of bodies: their indices and keys.
struct Chosen {
  Chosen(const RuledWorld& world, std::size_t count, Random& random) {
    for (std::size_t i = 0; i < count; ++i) {
      numbers.push_back(random.below(world.size()));
      keys.push_back(world.keys()[numbers.back()]);
    }
  }
  std::vector<std::size_t> numbers;
  std::vector<Key> keys;
};

/// Returns, in order, all pairs of two sets that the rules allow and whose distance is at most the
/// margin.
std::vector<Ids> brute_pairs(const RuledWorld& world, const Chosen& a, const Chosen& b,
                             double margin, PairRules rules) {
  std::vector<Ids> found;
  for (const std::size_t one : a.numbers) {
    for (const std::size_t other : b.numbers) {
      if (!world.takes(rules, one, other) || world.distance(one, other) > margin) continue;
      found.emplace_back(world.keys()[one].id, world.keys()[other].id);
    }
  }
  return found;
}

void expect_sets(RuledWorld& world, SceneQueries& queries, Random& random, PairRules rules) {
  const Chosen a(world, random.below(9), random);
  const Chosen b(world, random.below(9), random);
  std::span<const KeyPair> pairs =
      expect_ok(queries.overlaps(a.keys, b.keys, ~std::size_t{0}, rules));
  std::vector<Ids> found;
  for (const KeyPair& pair : pairs) found.push_back(ids_of(pair));
  EXPECT_EQ(found, brute_pairs(world, a, b, 0.0, rules));

  double least = kInfinity;
  for (const std::size_t one : a.numbers) {
    for (const std::size_t other : b.numbers) {
      if (world.takes(rules, one, other)) least = std::min(least, world.distance(one, other));
    }
  }
  SetDistance closest = expect_ok(queries.least_distance(a.keys, b.keys, kInfinity, rules));
  ASSERT_EQ(static_cast<bool>(closest), least < kInfinity);
  if (closest) {
    EXPECT_NEAR(closest.to.distance, least, 1e-9);
  }

  for (const double margin : {0.0, random.uniform(0.0, 2.0)}) {
    const auto expect_first = [&](const Chosen& first, const Chosen& second) {
      const std::vector<Ids> all = brute_pairs(world, first, second, margin, rules);
      KeyPair pair = expect_ok(queries.any_contact(first.keys, second.keys, margin, rules));
      EXPECT_EQ(ids_of(pair), all.empty() ? Ids(kNoObject, kNoObject) : all.front());
    };
    expect_first(a, b);
    expect_first(a, a);
  }
}

void expect_whole_scene(RuledWorld& world, SceneQueries& queries, double margin, PairRules rules) {
  Ids least(kNoObject, kNoObject);
  for (std::size_t a = 0; a < world.size(); ++a) {
    BodyDefinition body = expect_ok(world.scene().body(world.keys()[a]));
    if (rules == PairRules::scene && body.state != BodyState::dynamic) continue;
    for (std::size_t b = 0; b < world.size(); ++b) {
      if (!world.takes(rules, a, b) || world.distance(a, b) > margin) continue;
      least = std::min(least, {world.keys()[a].id, world.keys()[b].id});
    }
  }
  KeyPair pair = expect_ok(queries.any_contact(margin, rules));
  EXPECT_EQ(ids_of(pair), least);
}

TEST(SceneRules, distance_considers_pairs_of_collide) {
  Random random(61);
  for (std::size_t round = 0; round < scaled(6); ++round) {
    RuledWorld world(random);
    Contacts contacts;
    ASSERT_EQ(world.scene().collide(ContactLevel::boolean, contacts), Status::ok);
    std::set<Ids> touching;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      touching.insert(std::minmax(contacts.a()[i].id, contacts.b()[i].id));
    }
    SceneQueries queries(world.scene());
    for (std::size_t a = 0; a < world.size(); ++a) {
      for (std::size_t b = 0; b < world.size(); ++b) {
        SceneDistance found = expect_ok(queries.distance(world.keys()[a], world.keys()[b]));
        ASSERT_EQ(static_cast<bool>(found), world.filters_allow(a, b)) << a << ' ' << b;
        if (!found) continue;
        EXPECT_EQ(found.distance, world.distance(a, b));
        const Ids pair = std::minmax(world.keys()[a].id, world.keys()[b].id);
        EXPECT_EQ(touching.contains(pair), found.distance <= 0.0);
      }
    }
  }
}

TEST(SceneRules, set_queries_match_brute_force) {
  Random random(62);
  for (std::size_t round = 0; round < scaled(6); ++round) {
    RuledWorld world(random);
    SceneQueries queries(world.scene());
    for (std::size_t n = 0; n < 30; ++n) {
      expect_sets(world, queries, random, n % 3 == 0 ? PairRules::none : PairRules::scene);
    }
  }
}

TEST(SceneRules, any_contact_of_scene_matches_brute_force) {
  Random random(63);
  for (std::size_t round = 0; round < scaled(8); ++round) {
    RuledWorld world(random);
    SceneQueries queries(world.scene());
    for (const PairRules rules : {PairRules::scene, PairRules::none}) {
      expect_whole_scene(world, queries, 0.0, rules);
      expect_whole_scene(world, queries, random.uniform(0.0, 1.0), rules);
    }
    // Ignores each pair that is returned, until there is none left.
    for (std::size_t n = 0; n < world.size() * world.size(); ++n) {
      KeyPair pair = expect_ok(queries.any_contact());
      if (pair.first == Key{}) break;
      ASSERT_FALSE(world.scene().is_ignored(pair.first, pair.second));
      ASSERT_EQ(world.scene().set_ignored(pair.first, pair.second), Status::ok);
    }
    Contacts contacts;
    ASSERT_EQ(world.scene().collide(ContactLevel::boolean, contacts), Status::ok);
    EXPECT_EQ(contacts.size(), 0U);
  }
}

/// A chain of capsules, each of which overlaps the next, and a fixed box 0.1 beyond its end.
struct Robot {
  static constexpr int kLinks = 5;

  Robot() {
    const ShapeId capsule = shapes.add(CapsuleShape{0.1, 0.5});
    for (int i = 0; i < kLinks; ++i) {
      links.push_back(scene.add({.shape = capsule, .pose = Pose::at(0.15 * i, 0, 0)}));
    }
    const ShapeId box = shapes.add(BoxShape{{0.1, 0.1, 0.1}});
    table = scene.add({.shape = box, .pose = Pose::at(0.9, 0, 0), .state = BodyState::fixed});
    EXPECT_EQ(scene.refresh(), Status::ok);
  }
  void ignore_neighbours() {
    for (int i = 0; i + 1 < kLinks; ++i) {
      EXPECT_EQ(scene.set_ignored(links[i], links[i + 1]), Status::ok);
    }
  }

  ShapePool shapes;
  Scene scene{shapes};
  std::vector<Key> links;
  Key table;
};

TEST(SceneRules, robot_with_ignored_neighbours_is_free) {
  Robot robot;
  SceneQueries queries(robot.scene);
  KeyPair pair = expect_ok(queries.any_contact(robot.links, robot.links));
  EXPECT_EQ(pair, (KeyPair{robot.links[0], robot.links[1]}));
  robot.ignore_neighbours();
  for (const double margin : {0.0, 0.09}) {
    pair = expect_ok(queries.any_contact(robot.links, robot.links, margin));
    EXPECT_EQ(pair, KeyPair{});
  }
  pair = expect_ok(queries.any_contact(robot.links, robot.links, 0.11));
  EXPECT_EQ(pair, (KeyPair{robot.links[0], robot.links[2]}));
  SetDistance least = expect_ok(queries.least_distance(robot.links, robot.links));
  EXPECT_NEAR(least.to.distance, 0.1, 1e-12);
  std::span<const KeyPair> pairs = expect_ok(queries.overlaps(robot.links, robot.links));
  EXPECT_TRUE(pairs.empty());
  pairs = expect_ok(queries.overlaps(robot.links, robot.links, 1, PairRules::none));
  EXPECT_EQ(pairs.size(), 1U);
  const Key table[] = {robot.table};
  pair = expect_ok(queries.any_contact(robot.links, table, 0.2));
  EXPECT_EQ(pair, (KeyPair{robot.links[4], robot.table}));
}

TEST(SceneRules, two_fixed_bodies_are_no_pair) {
  Robot robot;
  ASSERT_EQ(robot.scene.set_body_state(robot.links, BodyState::fixed), Status::ok);
  ASSERT_EQ(robot.scene.refresh(), Status::ok);
  SceneQueries queries(robot.scene);
  KeyPair pair = expect_ok(queries.any_contact());
  EXPECT_EQ(pair, KeyPair{});
  pair = expect_ok(queries.any_contact(0.0, PairRules::none));
  EXPECT_EQ(pair, (KeyPair{robot.links[0], robot.links[1]}));
  SceneDistance apart = expect_ok(queries.distance(robot.links[4], robot.table));
  EXPECT_FALSE(apart);
  apart = expect_ok(queries.distance(robot.links[4], robot.table, kInfinity, PairRules::none));
  EXPECT_NEAR(apart.distance, 0.1, 1e-12);
}

TEST(SceneRules, any_contact_matches_for_every_structure) {
  Random random(64);
  ShapePool shapes;
  const ShapeId ball = shapes.add(SphereShape{0.5});
  for (std::size_t round = 0; round < scaled(20); ++round) {
    std::vector<BodyDefinition> bodies(400);
    for (BodyDefinition& body : bodies) {
      body = {.shape = ball, .pose = random_pose(9.0, random)};
      body.state = static_cast<BodyState>(random.below(kBodyStates));
    }
    std::set<Ids> answers;
    for (const StructureKind kind :
         {linear_bvh(), static_bvh(), sweep_and_prune(), hierarchical_grid(), n_squared()}) {
      for (const Execution& execution : {Execution::serial(), Execution::parallel()}) {
        Scene scene(shapes, {.execution = execution, .structures = {kind, kind, kind}});
        std::vector<Key> keys(bodies.size());
        ASSERT_EQ(scene.add(bodies, keys), Status::ok);
        ASSERT_EQ(scene.refresh(), Status::ok);
        SceneQueries queries(scene);
        KeyPair pair = expect_ok(queries.any_contact());
        answers.insert(ids_of(pair));
      }
    }
    EXPECT_EQ(answers.size(), 1U);
  }
}

}  // namespace
}  // namespace winnow::test
