// Invalid queries: the call returns an error, clears its output and changes nothing.

#include <winnow/core/eigen.h>
#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "tests/partitions/snapshot.h"
#include "tests/support/scenes.h"
#include "tests/support/world.h"

namespace winnow::test {
namespace {

using Eigen::Vector3f;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
const Aabb kUnit{Vector3f::Zero(), Vector3f::Ones()};

std::vector<Ray> bad_rays() {
  const Ray good{{-1, 0.5F, 0.5F}, {1, 0, 0}, 0.0F, 10.0F};
  std::vector<Ray> bad;
  const auto add = [&](const auto& spoil) {
    bad.push_back(good);
    spoil(bad.back());
  };
  for (int k = 0; k < 3; ++k) {
    for (const float value : {kNan, kInf, -kInf}) {
      add([&](Ray& ray) { ray.direction[k] = value; });
      add([&](Ray& ray) { ray.origin[k] = value; });
    }
  }
  add([](Ray& ray) { as_eigen(ray.direction).setZero(); });
  add([](Ray& ray) { ray.direction = {-0.0F, 0.0F, -0.0F}; });
  add([](Ray& ray) { ray.min_t = -1e-30F; });
  add([](Ray& ray) { ray.min_t = kNan; });
  add([](Ray& ray) { ray.max_t = kNan; });
  add([](Ray& ray) { ray.min_t = std::nextafter(10.0F, 11.0F); });
  add([](Ray& ray) { ray.min_t = ray.max_t = kInf; });
  add([](Ray& ray) { ray.max_t = -1.0F; });
  add([](Ray& ray) { ray.max_t = -kInf; });
  return bad;
}

std::vector<Sphere> bad_spheres() {
  std::vector<Sphere> bad;
  for (const float radius : {kNan, -kNan, kInf, -1.0F, -1e-40F}) {
    bad.push_back({Vector3f::Zero(), radius});
  }
  for (const float x : {kNan, kInf, -kInf}) bad.push_back({{0, x, 0}, 1.0F});
  return bad;
}

std::vector<Capsule> bad_capsules() {
  std::vector<Capsule> bad;
  for (const Sphere& sphere : bad_spheres()) {
    bad.push_back({sphere.center, Vector3f::Ones(), sphere.radius});
    bad.push_back({Vector3f::Ones(), sphere.center, sphere.radius});
  }
  return bad;
}

std::vector<Aabb> bad_boxes() {
  std::vector<Aabb> bad{Aabb{}};
  for (int k = 0; k < 3; ++k) {
    bad.push_back(kUnit);
    bad.back().min[k] = std::nextafter(1.0F, 2.0F);
    bad.push_back(kUnit);
    bad.back().min[k] = kNan;
    bad.push_back(kUnit);
    bad.back().max[k] = kNan;
    bad.push_back(kUnit);
    bad.back().min[k] = bad.back().max[k] = kInf;
  }
  return bad;
}

std::vector<Cast> bad_casts() {
  std::vector<Cast> bad;
  for (const Ray& ray : bad_rays()) {
    bad.emplace_back(ray);
    const Capsule capsule{ray.origin, Vector3f::Ones(), 1.0F};
    bad.emplace_back(BoxCast{{ray.origin, ray.origin}, ray.direction, ray.min_t, ray.max_t});
    bad.emplace_back(SphereCast{{ray.origin, 1.0F}, ray.direction, ray.min_t, ray.max_t});
    bad.emplace_back(CapsuleCast{capsule, ray.direction, ray.min_t, ray.max_t});
  }
  for (const Sphere& sphere : bad_spheres()) bad.emplace_back(SphereCast{sphere});
  for (const Capsule& capsule : bad_capsules()) bad.emplace_back(CapsuleCast{capsule});
  for (const Aabb& box : bad_boxes()) bad.emplace_back(BoxCast{box});
  bad.emplace_back(BoxCast{{Vector3f::Constant(-kInf), Vector3f::Zero()}});
  return bad;
}

class QueryInput : public Conformance {
 protected:
  QueryInput() : world_(config()) {
    world_.insert(uniform_boxes(80));
    // Fills the buffers with results that a refused call must clear.
    EXPECT_EQ(partition().all(Ray{}, hits_), Status::ok);
    EXPECT_EQ(partition().overlap(Region(kUnit), objects_), Status::ok);
  }

  [[nodiscard]] const Partition& partition() const { return world_.partition(); }

  void fill() {
    const Ray through{{-1, 2, 2}, {1, 0, 0}};
    ASSERT_EQ(partition().all(BoxCast{{through.origin, Vector3f::Constant(3)}}, hits_), Status::ok);
    ASSERT_FALSE(hits_.empty());
    ASSERT_EQ(partition().overlap(std::span<const Plane>{}, objects_), Status::ok);
    ASSERT_EQ(objects_.size(), 80U);
  }

  void expect_refused(const Region& region) {
    fill();
    EXPECT_EQ(partition().overlap(region, objects_), Status::invalid_argument);
    EXPECT_TRUE(objects_.empty());
    EXPECT_TRUE(objects_.inside().empty());
    EXPECT_TRUE(objects_.crossing().empty());
  }

  World world_;
  HitBuffer hits_;
  OverlapBuffer objects_;
};

TEST_P(QueryInput, bad_cast_is_refused) {
  Snapshot before(world_);
  const std::vector<Cast> casts = bad_casts();
  for (std::size_t i = 0; i < casts.size(); ++i) {
    SCOPED_TRACE(i);
    fill();
    EXPECT_EQ(partition().all(casts[i], hits_), Status::invalid_argument);
    EXPECT_TRUE(hits_.empty());
    for (const Answer<Hit>& hit : {partition().closest(casts[i]), partition().any(casts[i])}) {
      EXPECT_EQ(hit.status, Status::invalid_argument);
      EXPECT_EQ(static_cast<const Hit&>(hit), Hit{});
    }
  }
  EXPECT_TRUE(before.unchanged());
}

TEST_P(QueryInput, one_bad_ray_refuses_the_batch) {
  Snapshot before(world_);
  for (const Ray& bad : bad_rays()) {
    for (const std::size_t at : {std::size_t{0}, std::size_t{16}, std::size_t{40}}) {
      std::vector<Ray> rays(41, Ray{{-1, 2, 2}, {1, 0, 0}});
      rays[at] = bad;
      fill();
      EXPECT_EQ(partition().all(RayBatch(rays), hits_), Status::invalid_argument);
      EXPECT_TRUE(hits_.empty());
      std::vector<Key> keys(rays.size());
      EXPECT_EQ(partition().closest(RayBatch(rays), {.key = keys.data()}),
                Status::invalid_argument);
      EXPECT_EQ(partition().any(RayBatch(rays), {.key = keys.data()}), Status::invalid_argument);
    }
  }
  EXPECT_TRUE(before.unchanged());
}

TEST_P(QueryInput, bad_region_is_refused) {
  Snapshot before(world_);
  for (int k = 0; k < 3; ++k) {
    for (const float value : {kNan, kInf, -kInf}) {
      Vector3f point = Vector3f::Zero();
      point[k] = value;
      expect_refused(point);
      OrientedBox box{Vector3f::Zero(), Vector3f::Ones()};
      box.center[k] = value;
      expect_refused(box);
      box = {Vector3f::Zero(), Vector3f::Ones()};
      box.half[k] = value;
      expect_refused(box);
      box = {Vector3f::Zero(), Vector3f::Ones()};
      box.axes(k, 1) = value;
      expect_refused(box);
    }
    OrientedBox box{Vector3f::Zero(), Vector3f::Ones()};
    box.half[k] = -1e-30F;
    expect_refused(box);
  }
  for (const Aabb& box : bad_boxes()) expect_refused(box);
  for (const Sphere& sphere : bad_spheres()) expect_refused(sphere);
  for (const Capsule& capsule : bad_capsules()) expect_refused(capsule);
  EXPECT_TRUE(before.unchanged());
}

TEST_P(QueryInput, bad_plane_is_refused) {
  const std::vector<Plane> bad{{{0, 0, 0}, 1.0F},     {{-0.0F, 0, 0}, 1.0F}, {{kNan, 0, 1}, 1.0F},
                               {{1, kInf, 0}, 1.0F},  {{1, 0, 0}, kNan},     {{1, 0, 0}, kInf},
                               {{0, 0, -kInf}, -1.0F}};
  const Frustum good = Frustum::perspective({0, 0, -9}, Vector3f::UnitZ(), Vector3f::UnitY(), 1.0F,
                                            1.0F, 1.0F, 99.0F);
  ASSERT_TRUE(good.is_valid());
  for (const Plane& plane : bad) {
    for (std::size_t at = 0; at < 6; ++at) {
      Frustum frustum = good;
      frustum.planes[at] = plane;
      expect_refused(frustum);
      std::vector<Plane> planes(11, good.planes[0]);
      planes[2 * at] = plane;
      expect_refused(std::span<const Plane>(planes));
    }
  }
  Frustum frustum = good;
  frustum.bounds = Aabb{};
  expect_refused(frustum);
}

TEST_P(QueryInput, one_bad_box_refuses_the_query) {
  Snapshot before(world_);
  PairBuffer pairs;
  for (const Aabb& bad : bad_boxes()) {
    for (const std::size_t at : {std::size_t{0}, std::size_t{16}, std::size_t{32}}) {
      std::vector<Aabb> boxes(33, kUnit);
      ASSERT_TRUE(world_.agrees(pairs));
      boxes[at] = bad;
      const Status status = partition().overlap(BoxView(boxes), pairs);
      EXPECT_TRUE(status == Status::invalid_argument || status == Status::invalid_bounds);
      EXPECT_TRUE(pairs.empty());
    }
  }
  EXPECT_TRUE(before.unchanged());
}

TEST_P(QueryInput, nearest_with_bad_input_is_refused) {
  Snapshot before(world_);
  for (const float radius : {kNan, -1.0F, -kInf, -1e-40F}) {
    fill();
    EXPECT_EQ(partition().nearest(kUnit, 3, radius, hits_), Status::invalid_argument);
    EXPECT_TRUE(hits_.empty());
  }
  for (const Aabb& box : bad_boxes()) {
    fill();
    EXPECT_EQ(partition().nearest(box, 3, kInf, hits_), Status::invalid_argument);
    EXPECT_TRUE(hits_.empty());
  }
  ASSERT_EQ(partition().nearest(kUnit, 0, kInf, hits_), Status::ok);
  EXPECT_TRUE(hits_.empty());
  EXPECT_TRUE(before.unchanged());
}

INSTANTIATE_TEST_SUITE_P(All, QueryInput, testing::ValuesIn(all_configs()),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace winnow::test
