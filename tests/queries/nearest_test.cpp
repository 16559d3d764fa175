// Nearest objects, compared with distances that are computed one by one.

#include <winnow/core/eigen.h>
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/queries/questions.h"
#include "tests/support/motion.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

using Eigen::Vector3f;

constexpr float kInf = std::numeric_limits<float>::infinity();

struct Question {
  Aabb from;
  std::size_t count = 1;
  float radius = kInf;
};

std::string to_string(const Question& q) {
  std::ostringstream out;
  out.precision(9);
  out << q.count << " nearest to {" << as_eigen(q.from.min).transpose() << "} .. {"
      << as_eigen(q.from.max).transpose() << "} within " << q.radius;
  return out.str();
}

std::vector<Question> some_questions(std::span<const Aabb> boxes, std::size_t count,
                                     Random& random) {
  std::vector<Question> questions;
  while (questions.size() < count) {
    Question q{{Vector3f::Zero(), Vector3f::Zero()}};
    if (!boxes.empty()) {
      const Aabb at = finite(boxes[random.below(boxes.size())]);
      const Aabb other = finite(boxes[random.below(boxes.size())]);
      const std::array<Vector3f, 4> points{at.min, at.max, 0.5F * at.max + 0.5F * other.min,
                                           0.75F * at.min + 0.25F * other.max};
      const Vector3f point = points[random.below(points.size())];
      q.from = random.chance(0.3) ? at : Aabb{point, point};
      // A radius that equals the distance of one of the objects.
      if (random.chance(0.4)) q.radius = round_down(distance(q.from, other));
    }
    if (random.chance(0.1)) q.radius = 0.0F;
    q.count =
        std::array<std::size_t, 8>{0, 1, 2, 15, 16, 17, 100, ~std::size_t{0}}[random.below(8)];
    questions.push_back(q);
  }
  return questions;
}

std::vector<Hit> query_nearest(World& world, const Question& q, HitBuffer& buffer,
                               const Filter& filter = {}) {
  EXPECT_EQ(world.threads().run([&] {
    return world.partition().nearest(q.from, q.count, q.radius, buffer, filter);
  }),
            Status::ok);
  return {buffer.begin(), buffer.end()};
}

class Nearest : public Conformance {};

TEST_P(Nearest, nearest_objects_are_right_in_every_scene) {
  HitBuffer buffer;
  for (const QuestionSet& set : question_sets()) {
    Random random(8);
    World world(config());
    world.insert(set.boxes);
    for (const Question& q : some_questions(set.boxes, scaled(16), random)) {
      SCOPED_TRACE(set.name + ", " + to_string(q));
      ASSERT_TRUE(right_nearest(query_nearest(world, q, buffer), q.from, q.count, q.radius,
                                set.objects, world.partition()));
    }
  }
}

TEST_P(Nearest, nearest_among_changing_objects_are_right) {
  World world(config());
  std::vector<Aabb> boxes = mixed_boxes(800);
  std::vector<Key> keys = world.insert(boxes);
  Random random(9);
  HitBuffer buffer;
  for (int frame = 0; frame < 10; ++frame) {
    SCOPED_TRACE(frame);
    move(kMotions[static_cast<std::size_t>(frame) % kMotions.size()], boxes, random);
    world.update(keys, boxes);
    for (int n = 0; n < 40; ++n) {
      const std::size_t i = random.below(keys.size());
      world.remove(keys[i]);
      keys[i] = world.insert(boxes[i], random.bits());
    }
    for (const Question& q : some_questions(boxes, 16, random)) {
      SCOPED_TRACE(to_string(q));
      ASSERT_TRUE(right_nearest(query_nearest(world, q, buffer), q.from, q.count, q.radius,
                                world.objects(), world.partition()));
    }
  }
}

// By scale: the squares of distances overflow, the squares are denormal, or the distances are
// denormal.
TEST_P(Nearest, nearest_of_layers_are_right_at_any_scale) {
  HitBuffer buffer;
  Random random(11);
  for (const float scale : {1e30F, 1e-30F, 1e-41F}) {
    World world(config());
    std::vector<Aabb> boxes = mixed_boxes(900);
    for (Aabb& box : boxes) {
      for (Vec3f* const end : {&box.min, &box.max}) {
        for (int axis = 0; axis < 3; ++axis) (*end)[axis] *= scale;
      }
    }
    const std::vector<Key> keys = world.insert(boxes);
    std::vector<Object> accepted = world.objects();
    for (std::size_t i = 0; i < keys.size(); i += 3) {
      world.set_filter(keys[i], {.layers = 2});
      std::erase_if(accepted, [&](const Object& object) { return object.id == keys[i].id; });
    }
    Filter filter;
    filter.mask = ~2U;
    for (const Question& q : some_questions(boxes, scaled(16), random)) {
      SCOPED_TRACE(to_string(q));
      ASSERT_TRUE(right_nearest(query_nearest(world, q, buffer, filter), q.from, q.count, q.radius,
                                accepted, world.partition()));
    }
  }
}

TEST_P(Nearest, equal_distances_are_sorted_by_id) {
  World world(config());
  world.insert(std::vector<Aabb>(100, {Vector3f::Ones(), Vector3f::Constant(2)}));
  HitBuffer buffer;
  const std::vector<Hit> hits =
      query_nearest(world, {{Vector3f::Zero(), Vector3f::Zero()}, 40}, buffer);
  ASSERT_EQ(hits.size(), 40U);
  for (std::size_t i = 0; i < hits.size(); ++i) EXPECT_EQ(hits[i].key.id, i);
}

TEST_P(Nearest, predicate_selects_the_nearest_objects) {
  World world(config());
  std::vector<ClientData> data;
  for (std::size_t i = 0; i < 700; ++i) data.push_back(i);
  const std::vector<Aabb> boxes = mixed_boxes(700);
  world.insert(boxes, data);
  Filter filter;
  filter.predicate.accept = [](void*, Key key, ClientData value) {
    return key.id == value && value % 3 == 0;
  };
  Random random(10);
  HitBuffer buffer;
  for (const Question& q : some_questions(boxes, 40, random)) {
    SCOPED_TRACE(to_string(q));
    std::vector<Hit> expected = query_nearest(world, {q.from, boxes.size(), q.radius}, buffer);
    std::erase_if(expected, [](const Hit& hit) { return hit.data % 3 != 0; });
    expected.resize(std::min(expected.size(), q.count));
    ASSERT_TRUE(same_hits(query_nearest(world, q, buffer, filter), expected));
  }
}

INSTANTIATE_TEST_SUITE_P(All, Nearest, testing::ValuesIn(all_configs()),
                         testing::PrintToStringParamName());

TEST(NearestResults, nearest_are_identical_in_every_config) {
  for (const QuestionSet& set : question_sets()) {
    Random stream(11);
    const std::vector<Question> questions = some_questions(set.boxes, scaled(24), stream);
    std::vector<std::vector<std::pair<ObjectId, std::uint32_t>>> expected;
    for (const Config& config : all_configs()) {
      if (config.threads == 8) continue;
      const IsaScope isa(config.isa);
      World world(config);
      world.insert(set.boxes);
      HitBuffer buffer;
      for (std::size_t i = 0; i < questions.size(); ++i) {
        std::vector<std::pair<ObjectId, std::uint32_t>> found;
        for (const Hit& hit : query_nearest(world, questions[i], buffer)) {
          found.emplace_back(hit.key.id, std::bit_cast<std::uint32_t>(hit.t));
        }
        if (i == expected.size()) expected.push_back(found);
        ASSERT_TRUE(found == expected[i])
            << to_string(config) << " on " << set.name << ", " << to_string(questions[i]);
      }
    }
  }
}

}  // namespace
}  // namespace winnow::test
