// Queries of scenes of tiny and flat shapes in every floating-point mode of the caller: nothing is
// missed, and the results equal the default mode bit by bit.

#include <gtest/gtest.h>
#include <winnow/pipeline/continuous_collision.h>
#include <winnow/pipeline/scene_queries.h>

#include <bit>
#include <cfloat>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "tests/pipeline/query_world.h"
#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/float_modes.h"

namespace winnow::test {
namespace {

/// The numbers of all results, bit by bit.
class Bits {
 public:
  void add(double number) {
    if (std::isnan(number)) ++nan_;
    bits_.push_back(std::bit_cast<std::uint64_t>(number));
  }
  void add(std::span<const double> numbers) {
    for (const double number : numbers) add(number);
  }
  void add(const SceneHit& hit) {
    bits_.push_back(std::uint64_t{hit.key.id} << 32U | hit.part);
    add(hit.t);
    add(hit.normal);
    add(hit.point);
  }
  void add(const SceneDistance& to) {
    bits_.push_back(to.key.id);
    bits_.push_back(std::uint64_t{to.part_a} << 32U | to.part);
    add(to.distance);
    add(to.error_bound);
    add(to.normal);
    add(to.point_a);
    add(to.point_b);
  }
  template <typename Many>
  void add_all(const Many& many) {
    bits_.push_back(many.size());
    for (const auto& one : many) add(one);
  }
  void add(const SceneImpact& impact) {
    bits_.push_back(std::uint64_t{impact.a.id} << 32U | impact.b.id);
    bits_.push_back(std::uint64_t{impact.part_a} << 32U | impact.part_b);
    add(impact.time);
    add(impact.gap);
    add(impact.normal);
  }
  void add(const SceneOverlap& overlap) {
    bits_.push_back(std::uint64_t{overlap.key.id} << 32U | overlap.part);
  }

  [[nodiscard]] std::size_t nan() const { return nan_; }
  friend bool operator==(const Bits&, const Bits&) = default;

 private:
  std::vector<std::uint64_t> bits_;
  std::size_t nan_ = 0;
};

/// Shapes of one size on a lattice around the origin. Many faces are in coordinate planes.
class TinyWorld {
 public:
  TinyWorld(double size, float mesh_size, const Execution& execution)
      : size_(size), mesh_size_(mesh_size) {
    std::vector<ShapeId> shapes = make_shapes();
    std::vector<BodyDefinition> bodies;
    for (std::size_t i = 0; i < kBodies; ++i) {
      BodyDefinition body;
      body.shape = shapes[i % shapes.size()];
      place(i, body.pose.position);
      body.state = static_cast<BodyState>(i % kBodyStates);
      bodies.push_back(body);
    }
    SceneOptions options;
    options.composites = &composites_;
    options.execution = execution;
    scene_ = std::make_unique<Scene>(pool_, options);
    keys_.resize(bodies.size());
    EXPECT_EQ(scene_->add(bodies, keys_), Status::ok);
    EXPECT_EQ(scene_->refresh(), Status::ok);
  }

  static constexpr std::size_t kBodies = 27;

  [[nodiscard]] Scene& scene() { return *scene_; }
  [[nodiscard]] std::span<const Key> keys() const { return keys_; }
  [[nodiscard]] ShapeId box() const { return box_; }
  [[nodiscard]] double size() const { return size_; }
  /// Returns the position of body i, in a coordinate plane for many bodies.
  void place(std::size_t i, Vec3d& position) const {
    for (double& x : position) {
      x = 4.0 * size_ * (static_cast<double>(i % 3) - 1.0);
      i /= 3;
    }
  }

 private:
  std::vector<ShapeId> make_shapes() {
    std::vector<ShapeId> shapes(6);
    shapes[0] = expect_ok(pool_.add(BoxShape{{size_, size_, size_}}));
    shapes[1] = expect_ok(pool_.add(SphereShape{size_}));
    shapes[2] = expect_ok(pool_.add(CapsuleShape{0.5 * size_, 0.5 * size_}));
    TriangleShape triangle;
    const double corners[3][3] = {{-size_, -size_, 0.0}, {size_, -size_, 0.0}, {0.0, size_, 0.0}};
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) triangle.vertex[i][k] = corners[i][k];
    }
    shapes[3] = expect_ok(pool_.add(triangle));
    shapes[4] = expect_ok(pool_.add(BoxShape{{size_, size_, 0.0}}));
    const float s = mesh_size_;
    const std::vector<Vec3f> vertices{{-s, -s, 0}, {s, -s, 0}, {s, s, 0}, {-s, s, 0}};
    const std::vector<std::uint32_t> indices{0, 1, 2, 0, 2, 3};
    const std::span<const Vec3f> points(vertices);
    const std::span<const std::uint32_t> triangles(indices);
    shapes[5] = expect_ok(composites_.add_mesh(points, triangles));
    box_ = shapes[0];
    return shapes;
  }

  double size_;
  float mesh_size_;  // rounded by the caller, before the floating-point mode is set
  ShapePool pool_;
  CompositePool composites_{pool_};
  std::unique_ptr<Scene> scene_;
  std::vector<Key> keys_;
  ShapeId box_;
};

/// Returns a ray along one axis to a position.
ShapeRay ray_to(const Vec3d& place, int axis, double distance) {
  ShapeRay ray;
  for (int k = 0; k < 3; ++k) {
    ray.origin[k] = place[k] - (k == axis ? distance : 0.0);
    ray.direction[k] = k == axis ? 1.0 : 0.0;
  }
  ray.max_t = kInfinity;
  return ray;
}

struct SceneTally {
  std::size_t query_count = 0;
  std::size_t missed = 0;
};

/// Aims rays, casts, overlaps and nearest queries at each body and counts misses.
void query_bodies(TinyWorld& world, Bits& bits, SceneTally& tally) {
  SceneQueries queries(world.scene());
  std::vector<ShapeRay> rays;
  for (std::size_t i = 0; i < TinyWorld::kBodies; ++i) {
    Vec3d place;
    world.place(i, place);
    const auto found = [&](const auto& many) {
      ++tally.query_count;
      bool is_there = false;
      for (const auto& one : many) is_there = is_there || one.key == world.keys()[i];
      tally.missed += is_there ? 0U : 1U;
      bits.add_all(many);
    };
    for (int axis = 0; axis < 3; ++axis) {
      const ShapeRay& ray = rays.emplace_back(ray_to(place, axis, 2.0 * world.size()));
      std::span<const SceneHit> hits;
      SceneHit hit;
      hits = expect_ok(queries.all(ray));
      found(hits);
      hit = expect_ok(queries.closest(ray));
      bits.add(hit);
      hit = expect_ok(queries.any(ray));
      bits.add(hit);
      ShapeCast cast;
      cast.shape = world.box();
      for (int k = 0; k < 3; ++k) cast.pose.position[k] = ray.origin[k];
      for (int k = 0; k < 3; ++k) cast.direction[k] = ray.direction[k];
      cast.max_t = 4.0 * world.size();
      hits = expect_ok(queries.all(cast));
      found(hits);
    }
    Pose pose;
    for (int k = 0; k < 3; ++k) pose.position[k] = place[k];
    std::span<const SceneOverlap> overlaps = expect_ok(queries.overlap(world.box(), pose));
    found(overlaps);
    std::span<const SceneDistance> nearest = expect_ok(queries.nearest(place, 3, kInfinity));
    found(nearest);
  }
  SceneHitLists lists = expect_ok(queries.all(ShapeRayBatch(rays)));
  bits.add_all(lists.hits);
}

/// Moves a box through each body, and measures the distance of each body from the next.
void query_moving(TinyWorld& world, Bits& bits, SceneTally& tally) {
  SceneQueries queries(world.scene());
  for (std::size_t i = 0; i < TinyWorld::kBodies; ++i) {
    Vec3d place;
    world.place(i, place);
    const double reach = 2.0 * world.size();
    const Pose from = Pose::at(place[0] - reach, place[1], place[2]);
    const Pose to = Pose::at(place[0] + reach, place[1], place[2]);
    SceneHit hit = expect_ok(queries.closest(
        MotionCast{world.box(), RigidMotion::between(from, to)}, {}, 1e-3 * world.size()));
    ++tally.query_count;
    tally.missed += hit.key == Key{} ? 1U : 0U;
    bits.add(hit);
    SceneDistance distance = expect_ok(queries.distance(
        world.keys()[i], world.keys()[(i + 1) % TinyWorld::kBodies], kInfinity, PairRules::none));
    bits.add(distance);
  }
}

/// Moves the first body through its neighbour.
void find_impacts(TinyWorld& world, Bits& bits, SceneTally& tally) {
  ContinuousCollision ccd(world.scene());
  Vec3d place;
  world.place(2, place);
  const Key mover = world.keys()[0];
  const Pose end = Pose::at(place[0], place[1], place[2]);
  ContinuousOptions options;
  options.tolerance = 1e-3 * world.size();
  EXPECT_EQ(ccd.find_impacts({&mover, 1}, PoseView(std::span<const Pose>(&end, 1)), options),
            Status::ok);
  ++tally.query_count;
  tally.missed += ccd.impacts().empty() ? 1U : 0U;
  bits.add_all(ccd.impacts());
}

/// Moves a dynamic body onto other bodies, one after the other.
void collide(TinyWorld& world, Bits& bits, SceneTally& tally) {
  Contacts contacts;
  const Key mover = world.keys()[1];
  for (const std::size_t other : {0U, 2U, 3U}) {
    Vec3d place;
    world.place(other, place);
    Pose pose;
    for (int k = 0; k < 3; ++k) pose.position[k] = place[k];
    EXPECT_EQ(world.scene().move(mover, pose), Status::ok);
    EXPECT_EQ(world.scene().collide(ContactLevel::manifold, contacts), Status::ok);
    ++tally.query_count;
    tally.missed += contacts.size() == 0 ? 1U : 0U;
    bits.add(static_cast<double>(contacts.size()));
    bits.add(contacts.distance());
    for (int axis = 0; axis < 3; ++axis) {
      bits.add(contacts.normal(axis));
      bits.add(contacts.point(axis));
    }
  }
}

class SceneModes : public testing::TestWithParam<double> {};

TEST_P(SceneModes, float_modes_do_not_change_results) {
  const auto run = [](const FloatMode& mode, const Execution& execution, Bits& bits) {
    SceneTally tally;
    const auto mesh_size = static_cast<float>(GetParam());
    const FloatModeScope scope(mode);
    TinyWorld world(GetParam(), mesh_size, execution);
    query_bodies(world, bits, tally);
    query_moving(world, bits, tally);
    find_impacts(world, bits, tally);
    collide(world, bits, tally);
    return tally;
  };
  Bits standard;
  const SceneTally plain = run({}, Execution::serial(), standard);
  EXPECT_EQ(plain.missed, 0U) << "of " << plain.query_count;
  EXPECT_EQ(standard.nan(), 0U);
  for (const FloatMode& mode : all_float_modes()) {
    Bits bits;
    const SceneTally tally = run(mode, Execution::serial(), bits);
    EXPECT_EQ(tally.missed, 0U) << "of " << tally.query_count << ", " << to_string(mode);
    EXPECT_TRUE(bits == standard) << to_string(mode);
    Threads arena(2);
    Bits shared;
    arena.run([&] { run(mode, Execution::parallel(), shared); });
    EXPECT_TRUE(shared == standard) << to_string(mode) << ", two threads";
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, SceneModes, testing::Values(1.0, 1e-18, 0x1p-126, 1e-40, 0x1p-148));

}  // namespace
}  // namespace winnow::test
