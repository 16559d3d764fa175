// Rays and swept volumes in every partition, compared with brute force.

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <vector>

#include "tests/queries/questions.h"
#include "tests/support/answers.h"
#include "tests/support/hostile_casts.h"
#include "tests/support/motion.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

using Hits = std::vector<Hit>;

Hits all_of(World& world, const Cast& cast, HitBuffer& buffer, const Filter& filter = {}) {
  EXPECT_EQ(world.threads().run([&] { return world.partition().all(cast, buffer, filter); }),
            Status::ok);
  EXPECT_EQ(buffer.queries(), 1U);
  return {buffer.begin(), buffer.end()};
}

Hit closest_of(World& world, const Cast& cast, const Filter& filter = {}) {
  Hit hit{{1, 2}, 3, 4.0F};
  hit = expect_ok(world.partition().closest(cast, filter));
  return hit;
}

Hit any_of(World& world, const Cast& cast, const Filter& filter = {}) {
  Hit hit{{1, 2}, 3, 4.0F};
  hit = expect_ok(world.partition().any(cast, filter));
  return hit;
}

std::vector<Ray> rays_among(const std::vector<Cast>& casts) {
  std::vector<Ray> rays;
  for (const Cast& cast : casts) {
    if (const auto* ray = std::get_if<Ray>(&cast)) rays.push_back(*ray);
  }
  return rays;
}

/// One hit for each of several rays.
struct FoundOfEach {
  explicit FoundOfEach(std::size_t rays) : key(rays), data(rays), t(rays) {}

  HitColumns columns() { return {key.data(), data.data(), t.data()}; }
  Hit operator[](std::size_t i) const { return {key[i], data[i], t[i]}; }

  std::vector<Key> key;
  std::vector<ClientData> data;
  std::vector<float> t;
};

std::vector<ClientData> data_for(std::size_t count) {
  std::vector<ClientData> data;
  for (std::size_t i = 0; i < count; ++i) data.push_back(~ClientData{0} - 3 * i);
  return data;
}

class Casts : public Conformance {};

// The buffers are reused for all scenes and partitions.
TEST_P(Casts, casts_of_every_kind_hit_exactly) {
  HitBuffer buffer;
  for (const QuestionSet& set : question_sets()) {
    World world(config());
    world.insert(set.boxes, data_for(set.boxes.size()));
    for (std::size_t i = 0; i < set.casts.size(); ++i) {
      const Cast& cast = set.casts[i];
      SCOPED_TRACE(set.name + ", " + to_string(cast));
      const Hits all = all_of(world, cast, buffer);
      ASSERT_TRUE(right_hits(all, set.cast_truths[i], world.partition()));
      ASSERT_TRUE(is_first_of(closest_of(world, cast), all));
      ASSERT_TRUE(is_any_of(any_of(world, cast), all));
    }
  }
}

TEST_P(Casts, batch_of_rays_equals_single_rays) {
  HitBuffer single;
  HitBuffer batch;
  for (const QuestionSet& set : question_sets()) {
    SCOPED_TRACE(set.name);
    World world(config());
    world.insert(set.boxes, data_for(set.boxes.size()));
    const Partition& p = world.partition();
    const std::vector<Ray> rays = rays_among(set.casts);
    FoundOfEach hit(rays.size());
    const HitColumns columns = hit.columns();
    ASSERT_EQ(world.threads().run([&] { return p.all(RayBatch(rays), batch); }), Status::ok);
    ASSERT_EQ(batch.queries(), rays.size());
    ASSERT_EQ(world.threads().run([&] { return p.closest(RayBatch(rays), columns); }), Status::ok);
    std::size_t total = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      SCOPED_TRACE(to_string(Cast(rays[i])));
      const Hits all = all_of(world, rays[i], single);
      ASSERT_TRUE(same_hits(batch.of(i), all));
      ASSERT_TRUE(is_first_of(hit[i], all));
      total += all.size();
    }
    ASSERT_EQ(batch.size(), total);
    ASSERT_EQ(world.threads().run([&] { return p.any(RayBatch(rays), columns); }), Status::ok);
    for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_TRUE(is_any_of(hit[i], batch.of(i)));
  }
}

// Rays in separate columns and in a struct with other members give the results of an array.
TEST_P(Casts, batch_reads_columns_and_writes_some_columns) {
  World world(config());
  world.insert(mixed_boxes(900), data_for(900));
  Random random(3);
  const std::vector<Ray> rays = plain_rays(mixed_boxes(900), 65, random);
  std::array<std::vector<float>, 8> columns;
  for (const Ray& ray : rays) {
    for (int k = 0; k < 3; ++k) {
      columns[static_cast<std::size_t>(k)].push_back(ray.origin[k]);
      columns[static_cast<std::size_t>(k) + 3].push_back(ray.direction[k]);
    }
    columns[6].push_back(ray.min_t);
    columns[7].push_back(ray.max_t);
  }
  const RayBatch batch({columns[0].data(), columns[1].data(), columns[2].data()},
                       {columns[3].data(), columns[4].data(), columns[5].data()}, rays.size(),
                       columns[6].data(), columns[7].data());
  const Partition& p = world.partition();
  HitBuffer expected;
  HitBuffer got;
  ASSERT_EQ(p.all(RayBatch(rays), expected), Status::ok);
  ASSERT_EQ(p.all(batch, got), Status::ok);
  EXPECT_TRUE(same_hits(got.hits(), expected.hits()));
  ASSERT_FALSE(got.empty());
  FoundOfEach hit(rays.size());
  ASSERT_EQ(p.closest(batch, {.key = hit.key.data()}), Status::ok);
  ASSERT_EQ(p.closest(batch, {.data = hit.data.data()}), Status::ok);
  ASSERT_EQ(p.closest(batch, {.t = hit.t.data()}), Status::ok);
  ASSERT_EQ(p.closest(batch, {}), Status::ok);
  ASSERT_EQ(p.any(batch, {}), Status::ok);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_TRUE(is_first_of(hit[i], expected.of(i))) << i;
  }
}

// The choice of any hit does not depend on the number of threads.
TEST_P(Casts, any_hits_do_not_depend_on_threads) {
  const std::vector<Aabb> boxes = mixed_boxes(2000);
  Random random(9);
  const std::vector<Ray> rays = plain_rays(boxes, 3000, random);
  const auto data_found = [&](const Config& config) {
    World world(config);
    world.insert(boxes, data_for(boxes.size()));
    std::vector<ClientData> data(rays.size());
    const Status status = world.threads().run(
        [&] { return world.partition().any(RayBatch(rays), {.data = data.data()}); });
    EXPECT_EQ(status, Status::ok);
    return data;
  };
  Config serial = config();
  serial.threads = 1;
  serial.host = {};
  EXPECT_TRUE(data_found(config()) == data_found(serial));
}

TEST_P(Casts, empty_batch_has_no_hits) {
  World world(config());
  world.insert(uniform_boxes(100));
  HitBuffer buffer;
  ASSERT_EQ(world.partition().all(Ray{}, buffer), Status::ok);
  ASSERT_EQ(world.partition().all(RayBatch{}, buffer), Status::ok);
  EXPECT_TRUE(buffer.empty());
  EXPECT_EQ(buffer.queries(), 0U);
  EXPECT_EQ(world.partition().closest(RayBatch{}, {}), Status::ok);
  EXPECT_EQ(world.partition().any(RayBatch{}, {}), Status::ok);
}

// Objects that moved or arrived after the build are in other parts of the structure.
TEST_P(Casts, casts_among_changing_objects_are_right) {
  World world(config());
  std::vector<Aabb> boxes = mixed_boxes(800);
  std::vector<Key> keys = world.insert(boxes, data_for(boxes.size()));
  Random random(4);
  HitBuffer buffer;
  // Ids depend only on the calls, so all configurations have the same reference.
  static std::vector<CastCandidates> truths;
  std::size_t question = 0;
  for (int frame = 0; frame < 10; ++frame) {
    SCOPED_TRACE(frame);
    move(kMotions[static_cast<std::size_t>(frame) % kMotions.size()], boxes, random);
    world.update(keys, boxes);
    for (int n = 0; n < 40; ++n) {
      const std::size_t i = random.below(keys.size());
      world.remove(keys[i]);
      keys[i] = world.insert(boxes[i], random.bits());
    }
    const std::vector<Object> objects = world.objects();
    for (const Cast& cast : some_casts(boxes, 12, random)) {
      SCOPED_TRACE(to_string(cast));
      if (question == truths.size()) truths.push_back(candidates(cast, objects));
      const Hits all = all_of(world, cast, buffer);
      ASSERT_TRUE(right_hits(all, truths[question++], world.partition()));
      ASSERT_TRUE(is_first_of(closest_of(world, cast), all));
      ASSERT_TRUE(is_any_of(any_of(world, cast), all));
    }
  }
}

TEST_P(Casts, casts_hit_infinite_boxes_in_float_range) {
  World world(config());
  constexpr float kEndless = std::numeric_limits<float>::infinity();
  // The ray rises by a thousandth of its length. It reaches the first box at t = 1e38; it would
  // reach the second box at 1e39, beyond the range of float.
  const std::vector<Aabb> boxes{{{-1.0F, 1e35F, -1.0F}, {kEndless, kEndless, 1.0F}},
                                {{-1.0F, 1e36F, -1.0F}, {kEndless, kEndless, 1.0F}}};
  const std::vector<Key> keys = world.insert(boxes);
  HitBuffer buffer;
  const Ray ray{{0.5F, 0.5F, 0.5F}, {1.0F, 1e-3F, 0.0F}};
  const Hits hits = all_of(world, ray, buffer);
  ASSERT_EQ(hits.size(), 1U);
  EXPECT_EQ(hits[0].key, keys[0]);
  EXPECT_EQ(closest_of(world, ray).key, keys[0]);
  EXPECT_EQ(any_of(world, ray).key, keys[0]);
  // A ray that begins in an object hits the object, however far from the origin it begins.
  EXPECT_EQ(all_of(world, Ray{{3.4e38F, 3.4e38F, 0.5F}, {1.0F, 0.0F, 0.0F}}, buffer).size(), 2U);
}

TEST_P(Casts, predicate_selects_the_hits) {
  World world(config());
  std::vector<ClientData> data;
  for (std::size_t i = 0; i < 700; ++i) data.push_back(i);
  const std::vector<Aabb> boxes = mixed_boxes(700);
  world.insert(boxes, data);
  ClientData divisor = 3;
  Filter filter;
  filter.predicate.context = &divisor;
  filter.predicate.accept = [](void* context, Key key, ClientData value) {
    return key.id == value && value % *static_cast<ClientData*>(context) == 0;
  };
  Random random(5);
  HitBuffer buffer;
  const std::vector<Cast> casts = some_casts(boxes, 60, random);
  for (const Cast& cast : casts) {
    SCOPED_TRACE(to_string(cast));
    Hits expected = all_of(world, cast, buffer);
    std::erase_if(expected, [](const Hit& hit) { return hit.data % 3 != 0; });
    ASSERT_TRUE(same_hits(all_of(world, cast, buffer, filter), expected));
    ASSERT_TRUE(is_first_of(closest_of(world, cast, filter), expected));
    ASSERT_TRUE(is_any_of(any_of(world, cast, filter), expected));
  }
  const std::vector<Ray> rays = rays_among(casts);
  HitBuffer batch;
  ASSERT_EQ(world.partition().all(RayBatch(rays), batch, filter), Status::ok);
  FoundOfEach closest(rays.size());
  FoundOfEach any(rays.size());
  ASSERT_EQ(world.partition().closest(RayBatch(rays), closest.columns(), filter), Status::ok);
  ASSERT_EQ(world.partition().any(RayBatch(rays), any.columns(), filter), Status::ok);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_TRUE(same_hits(batch.of(i), all_of(world, rays[i], buffer, filter)));
    ASSERT_TRUE(is_first_of(closest[i], batch.of(i)));
    ASSERT_TRUE(is_any_of(any[i], batch.of(i)));
  }
}

INSTANTIATE_TEST_SUITE_P(All, Casts, testing::ValuesIn(all_configs()),
                         testing::PrintToStringParamName());

// All configurations return the same objects at the same t, to the bit. Keys contain the stamp of
// the partition.
TEST(CastResults, hits_are_identical_in_every_config) {
  struct Found {
    ObjectId id;
    std::uint32_t t;
    bool operator==(const Found&) const = default;
  };
  for (const QuestionSet& set : question_sets()) {
    std::vector<std::vector<Found>> expected;
    for (const Config& config : all_configs()) {
      if (config.threads == 8) continue;
      const IsaScope isa(config.isa);
      World world(config);
      world.insert(set.boxes);
      HitBuffer buffer;
      for (std::size_t i = 0; i < set.casts.size(); ++i) {
        std::vector<Found> found;
        for (const Hit& hit : all_of(world, set.casts[i], buffer)) {
          found.push_back({hit.key.id, std::bit_cast<std::uint32_t>(hit.t)});
        }
        if (i == expected.size()) expected.push_back(found);
        ASSERT_TRUE(found == expected[i])
            << to_string(config) << " on " << set.name << ", " << to_string(set.casts[i]);
      }
    }
  }
}

}  // namespace
}  // namespace winnow::test
