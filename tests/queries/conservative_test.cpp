// No ray misses a box that it touches in exact arithmetic. Tests more than ten million pairs of a
// ray and a box; a million of them are hard cases.

#include <winnow/core/eigen.h>
#include <algorithm>
#include <vector>

#include "tests/queries/answers.h"
#include "tests/support/hostile_casts.h"
#include "tests/support/hostile_scenes.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

std::vector<Config> configs() {
  std::vector<Config> result = all_configs();
  std::erase_if(result,
                [](const Config& config) { return config.threads == 2 || !config.host.empty(); });
  return result;
}

// Checks every partition on every instruction set; returns the number of pairs of a ray and a box.
std::size_t check(const std::vector<Aabb>& boxes, const std::vector<Ray>& rays) {
  const std::vector<Object> objects = numbered(boxes);
  std::vector<CastCandidates> truths;
  truths.reserve(rays.size());
  for (const Ray& ray : rays) truths.push_back(candidates(ray, objects));
  for (const Config& config : configs()) {
    const IsaScope isa(config.isa);
    World world(config);
    world.insert(boxes);
    HitBuffer hits;
    EXPECT_EQ(world.threads().run([&] { return world.partition().all(RayBatch(rays), hits); }),
              Status::ok);
    if (hits.queries() != rays.size()) {
      ADD_FAILURE() << to_string(config);
      return 0;
    }
    std::vector<Key> keys(rays.size());
    EXPECT_EQ(world.threads().run(
                  [&] { return world.partition().closest(RayBatch(rays), {.key = keys.data()}); }),
              Status::ok);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const std::span<const Hit> found = hits.of(i);
      EXPECT_TRUE(right_hits(found, truths[i], world.partition()))
          << to_string(config) << ", ray from " << as_eigen(rays[i].origin).transpose() << " along "
          << as_eigen(rays[i].direction).transpose() << ", t " << rays[i].min_t << " .. "
          << rays[i].max_t;
      EXPECT_EQ(keys[i], found.empty() ? Key{} : found[0].key);
      if (testing::Test::HasFailure()) return 0;
    }
  }
  return boxes.size() * rays.size();
}

TEST(Rays, rays_in_large_random_scenes_miss_nothing) {
  std::size_t pairs = 0;
  const std::size_t count = scaled(16384);
  for (const std::vector<Aabb>& boxes : {uniform_boxes(count), mixed_boxes(count)}) {
    Random random(31);
    pairs += check(boxes, plain_rays(boxes, 320, random));
  }
  EXPECT_GE(pairs, scaled(10'000'000));
}

TEST(Rays, rays_near_edges_of_hard_scenes_miss_nothing) {
  std::size_t pairs = 0;
  std::uint64_t stream = 32;
  for (const auto* scenes : {&degenerate_scenes(), &infinite_scenes(), &extreme_float_scenes()}) {
    for (const Scene& scene : *scenes) {
      SCOPED_TRACE(scene.name);
      Random random(stream++);
      std::vector<Ray> rays;
      while (rays.size() < scaled(150)) {
        rays.push_back(hostile_ray(scene.boxes[random.below(scene.boxes.size())], random));
      }
      pairs += check(scene.boxes, rays);
      ASSERT_FALSE(HasFailure());
    }
  }
  EXPECT_GE(pairs, scaled(1'000'000));
}

// One box and rays aimed at its features: every pair is a hard case.
TEST(Rays, rays_aimed_at_a_single_box_miss_nothing) {
  Random random(60);
  for (std::size_t n = 0; n < scaled(60); ++n) {
    Aabb box;
    const double size = random.chance(0.5) ? 1.0 : random.log_uniform(1e-30, 1e30);
    const double offset = random.chance(0.5) ? 0.0 : size * random.log_uniform(1.0, 1e7);
    for (int k = 0; k < 3; ++k) {
      const double low = offset + size * std::round(random.uniform(-4.0, 4.0));
      const double extent = random.chance(0.3) ? 0.0 : size * random.unit();
      box.min[k] = static_cast<float>(low);
      box.max[k] = std::max(box.min[k], static_cast<float>(low + extent));
    }
    std::vector<Ray> rays;
    while (rays.size() < 400) rays.push_back(hostile_ray(box, random));
    check({box}, rays);
    ASSERT_FALSE(HasFailure()) << as_eigen(box.min).transpose() << " .. "
                               << as_eigen(box.max).transpose();
  }
}

}  // namespace
}  // namespace winnow::test
