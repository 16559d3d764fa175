// Programs that tests of recordings run: sequences of all recorded calls of partitions, scenes,
// queries, sensors and impacts.

#include "tests/recording/programs.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/answers.h"
#include "tests/support/meshes.h"

namespace winnow::test {
namespace {

constexpr auto kNotThirds = [](void*, Key key, ClientData) { return key.id % 3 != 0; };
constexpr auto kNotAlike = [](void*, ObjectId a, ObjectId b) { return (a ^ b) % 5 != 0; };

float uniform_in(Random& random, float low, float high) {
  return static_cast<float>(random.uniform(static_cast<double>(low), static_cast<double>(high)));
}

/// Boxes by key, in a recorded partition.
struct Crowd {
  std::vector<Key> keys;
  std::vector<Aabb> boxes;
};

void spawn(Partition& partition, Crowd& crowd, std::span<const Aabb> boxes) {
  std::vector<Key> keys(boxes.size());
  std::vector<ClientData> data(boxes.size());
  for (std::size_t i = 0; i < data.size(); ++i) data[i] = 1000 + i;
  EXPECT_EQ(partition.insert(boxes, data, keys), Status::ok);
  crowd.keys.insert(crowd.keys.end(), keys.begin(), keys.end());
  crowd.boxes.insert(crowd.boxes.end(), boxes.begin(), boxes.end());
}

void kill_some(Partition& partition, Crowd& crowd, Random& random) {
  std::vector<Key> gone;
  for (std::size_t i = 0; i < crowd.keys.size();) {
    if (random.below(10) == 0) {
      gone.push_back(crowd.keys[i]);
      crowd.keys[i] = crowd.keys.back();
      crowd.boxes[i] = crowd.boxes.back();
      crowd.keys.pop_back();
      crowd.boxes.pop_back();
    } else {
      ++i;
    }
  }
  EXPECT_EQ(partition.remove(gone), Status::ok);
}

void move_some(Partition& partition, Crowd& crowd, Random& random, int frame) {
  std::vector<std::uint32_t> moved;
  for (std::size_t i = 0; i < crowd.keys.size(); ++i) {
    if (frame % 3 != 0 && random.below(4) != 0) continue;
    const Vec3f by(uniform_in(random, -0.2F, 0.2F), uniform_in(random, -0.2F, 0.2F), 0.0F);
    crowd.boxes[i].min = crowd.boxes[i].min + by;
    crowd.boxes[i].max = crowd.boxes[i].max + by;
    moved.push_back(static_cast<std::uint32_t>(i));
  }
  const BoxView boxes{std::span<const Aabb>(crowd.boxes)};
  if (frame % 2 == 0) {
    EXPECT_EQ(partition.update(crowd.keys, boxes), Status::ok);
    return;
  }
  EXPECT_EQ(partition.update(crowd.keys, boxes, IndexSubset::listed(moved)), Status::ok);
  std::vector<std::uint64_t> mask(crowd.keys.size() / 64 + 1, 0x123456789ABCDEFU);
  mask.resize((crowd.keys.size() + 63) / 64);
  EXPECT_EQ(partition.update(crowd.keys, boxes, IndexSubset::masked(mask)), Status::ok);
}

void query_casts(const Partition& partition, Random& random) {
  HitBuffer hits;
  Hit hit;
  std::vector<Ray> rays(20);
  for (Ray& ray : rays) {
    ray.origin = {uniform_in(random, 0.0F, 9.0F), uniform_in(random, 0.0F, 9.0F), -5.0F};
    ray.direction = {uniform_in(random, -0.3F, 0.3F), uniform_in(random, -0.3F, 0.3F), 1.0F};
  }
  const Filter some{.predicate = {kNotThirds, nullptr}};
  hit = expect_ok(partition.closest(rays[0]));
  hit = expect_ok(partition.any(rays[1]));
  EXPECT_EQ(partition.all(rays[2], hits), Status::ok);
  EXPECT_EQ(partition.all(rays[2], hits, some), Status::ok);
  hit = expect_ok(partition.closest(BoxCast{{{0, 0, -5}, {2, 2, -4}}, {0, 0, 1}}, some));
  EXPECT_EQ(partition.all(SphereCast{{{4, 4, -5}, 1}, {0, 0, 1}}, hits), Status::ok);
  hit = expect_ok(partition.any(CapsuleCast{{{4, 4, -5}, {5, 5, -5}, 1}, {0, 0, 1}}));
  std::vector<Key> keys(rays.size());
  std::vector<float> t(rays.size());
  EXPECT_EQ(partition.closest(rays, {.key = keys.data(), .t = t.data()}, some), Status::ok);
  EXPECT_EQ(partition.any(rays, {.t = t.data()}), Status::ok);
  EXPECT_EQ(partition.all(rays, hits), Status::ok);
  EXPECT_EQ(partition.nearest({{3, 3, 3}, {3, 3, 3}}, 7, 100.0F, hits), Status::ok);
  EXPECT_EQ(partition.nearest({{3, 3, 3}, {4, 4, 4}}, 7, 9.0F, hits, some), Status::ok);
}

void query_overlaps(const Partition& partition) {
  OverlapBuffer objects;
  PairBuffer pairs;
  const Filter some{.predicate = {kNotThirds, nullptr}};
  const Aabb box{{1, 1, 1}, {6, 6, 6}};
  const std::vector<Plane> planes(2, Plane{{1, 0, 0}, -3});
  const Frustum frustum =
      Frustum::perspective({-5, 4, 4}, {1, 0, 0}, {0, 0, 1}, 0.8F, 1.3F, 0.1F, 30.0F);
  const Region regions[] = {Vec3f(3, 3, 3),
                            box,
                            OrientedBox{{4, 4, 4}, {2, 1, 3}},
                            Sphere{{4, 4, 4}, 3},
                            Capsule{{1, 1, 1}, {7, 7, 7}, 1},
                            frustum,
                            std::span<const Plane>(planes)};
  for (const Region& region : regions) {
    EXPECT_EQ(partition.overlap(region, objects), Status::ok);
    EXPECT_EQ(partition.overlap(region, objects, some, Order::canonical), Status::ok);
  }
  const std::vector<Aabb> boxes(3, box);
  EXPECT_EQ(partition.overlap(boxes, pairs), Status::ok);
  EXPECT_EQ(partition.overlap(boxes, pairs, some, Order::canonical), Status::ok);
}

}  // namespace

void record_partition(Recorder& recorder, StructureKind structure, std::size_t count, int frames) {
  Random random(7);
  Partition partition(structure, {.fat_margin = {0.0F, 0.02F}, .recorder = &recorder});
  Partition other(linear_bvh(), {.recorder = &recorder});
  Crowd crowd;
  Crowd others;
  spawn(partition, crowd, uniform_boxes(count));
  spawn(other, others, uniform_boxes(count / 4, 2));
  PairBuffer pairs;
  PairBuffer cross;
  PairBuffer plain;
  PairEvents events;
  PairEvents events_only;
  for (int frame = 0; frame < frames; ++frame) {
    if (frame % 4 == 1) kill_some(partition, crowd, random);
    if (frame % 4 == 2)
      spawn(partition, crowd, uniform_boxes(count / 5, static_cast<std::uint64_t>(10 + frame)));
    if (frame == 3) {
      const std::vector<ObjectFilter> filters(crowd.keys.size() / 3, {.layers = 2, .mask = 5});
      EXPECT_EQ(partition.set_filter(std::span(crowd.keys).first(filters.size()), filters),
                Status::ok);
    }
    if (frame == 5) pairs.clear();
    if (frame == 6) {
      EXPECT_EQ(partition.set_structure(hierarchical_grid()), Status::ok);
    }
    move_some(partition, crowd, random, frame);
    if (frame % 5 == 4) {
      EXPECT_EQ(partition.self_pairs(pairs), Status::ok);
    }
    EXPECT_EQ(partition.self_pairs(pairs, events), Status::ok);
    EXPECT_EQ(partition.self_pairs(plain), Status::ok);
    if (frame % 3 == 0) {
      EXPECT_EQ(partition.self_pairs(events_only), Status::ok);
    }
    EXPECT_EQ(partition.pairs_with(other, cross), Status::ok);
    EXPECT_EQ(partition.self_pairs(cross, {.predicate = {kNotAlike, nullptr}}), Status::ok);
    EXPECT_EQ(partition.refresh(), Status::ok);
    query_casts(partition, random);
    query_overlaps(partition);
    recorder.end_frame();
  }
  partition.clear();
  partition.release_memory();
}

void record_volumes(Recorder& recorder, std::size_t count) {
  const std::vector<Aabb> boxes = uniform_boxes(count);
  std::vector<Key> keys(count);
  PairBuffer pairs;
  Partition balls(flat_grid(), {.volume = Volume::sphere, .recorder = &recorder});
  std::vector<Sphere> spheres;
  for (const Aabb& box : boxes) spheres.push_back(Sphere::around(box));
  EXPECT_EQ(balls.insert(std::span<const Sphere>(spheres), {}, keys), Status::ok);
  EXPECT_EQ(balls.self_pairs(pairs), Status::ok);
  for (Sphere& sphere : spheres) sphere.radius *= 0.5F;
  EXPECT_EQ(balls.update(keys, std::span<const Sphere>(spheres)), Status::ok);
  EXPECT_EQ(balls.self_pairs(pairs), Status::ok);
  Partition cut(loose_octree(3.0F), {.volume = Volume::kdop18, .recorder = &recorder});
  std::vector<Kdop<18>> kdops;
  for (const Aabb& box : boxes) kdops.push_back(Kdop<18>::around(box));
  EXPECT_EQ(cut.insert(std::span<const Kdop<18>>(kdops), {}, keys), Status::ok);
  EXPECT_EQ(cut.self_pairs(pairs), Status::ok);
  std::reverse(kdops.begin(), kdops.end());
  EXPECT_EQ(cut.update(keys, std::span<const Kdop<18>>(kdops)), Status::ok);
  EXPECT_EQ(cut.self_pairs(pairs), Status::ok);
}

namespace {

/// A mesh, a height field, two compounds and a compound of surfaces, and their changes in place.
struct Landscape {
  explicit Landscape(const SceneWorld& world)
      : pool(world.pool), land(terrain(5)), heights{0, 1, 0.5F, 0.2F, 0.1F, 0.3F, 1, 0, 0} {
    ids.emplace_back() =
        expect_ok(pool.add_mesh(land.points(), std::span<const std::uint32_t>(land.corners)));
    ids.emplace_back() = expect_ok(pool.add_scaled(ids[0], {0.5, -1.0, 2.0}));
    ids.emplace_back() = expect_ok(pool.add_height_field(samples()));
    add_compound(world, 3);
    const CompoundChild surfaces[] = {{ids[1], Pose::at(0, 0.5, 1)},
                                      {world.shapes[0], Pose::at(0.2, 0, 0)},
                                      {ids[2], Pose::at(-1, 0, 0.3)}};
    ids.emplace_back() = expect_ok(pool.add_compound(surfaces));
    add_compound(world, 18);
  }

  void add_compound(const SceneWorld& world, std::size_t count) {
    std::vector<CompoundChild> children;
    for (std::size_t i = 0; i < count; ++i) {
      children.push_back(
          {world.shapes[i % world.shapes.size()], Pose::at(0.4 * static_cast<double>(i), 0.1, 0)});
    }
    ids.emplace_back() = expect_ok(pool.add_compound(children));
  }
  [[nodiscard]] HeightSamples samples() const {
    return {.heights = heights, .columns = 3, .rows = 3};
  }
  void add_to(Scene& scene, SceneWorld& world) const {
    for (const ShapeId id : ids) {
      const bool moves = id.composite_kind() == CompositeKind::compound;
      expect_ok(scene.add({.shape = id,
                           .pose = world.random_pose(),
                           .state = moves ? BodyState::dynamic : BodyState::fixed}));
    }
  }
  void deform() {
    for (Eigen::Vector3f& vertex : land.vertices) vertex.z() += 0.1F * vertex.x();
    EXPECT_EQ(pool.refit_mesh(ids[0], land.points()), Status::ok);
    heights[4] += 0.7F;
    EXPECT_EQ(pool.update_height_field(ids[2], 0, 0, samples()), Status::ok);
  }

  CompositePool pool;
  MeshData land;
  std::vector<float> heights;
  std::vector<ShapeId> ids;
};

/// Changes of bodies other than poses.
void change_bodies(Scene& scene, SceneWorld& world, Landscape& landscape, int frame) {
  if (frame == 1) {
    EXPECT_EQ(scene.set_body_state(world.keys[0], BodyState::sleeping), Status::ok);
  }
  if (frame == 2) {
    EXPECT_EQ(scene.set_ignored(world.keys[1], world.keys[2]), Status::ok);
  }
  if (frame == 3) {
    EXPECT_EQ(scene.remove(world.keys.back()), Status::ok);
    world.keys.pop_back();
    world.bodies.pop_back();
  }
  if (frame == 4) {
    EXPECT_EQ(scene.set_shape(world.keys[3], world.shapes[0]), Status::ok);
    EXPECT_EQ(scene.set_filter(world.keys[4], {.layers = 4}), Status::ok);
  }
  if (frame == 2 || frame == 5) landscape.deform();
  if (frame == 5) {
    // Reuses the id of a body that was removed.
    Key key;
    ShapeId& rock = landscape.ids.back();
    EXPECT_EQ(scene.set_shape(scene.key_of(5), landscape.ids[3]), Status::ok);
    EXPECT_EQ(landscape.pool.remove(rock), Status::ok);
    landscape.ids.pop_back();
    landscape.add_compound(world, 17);
    key = expect_ok(scene.add({.shape = landscape.ids.back(), .pose = world.random_pose()}));
    key = expect_ok(scene.add({.shape = world.shapes[1], .pose = world.random_pose()}));
  }
}

/// Predicates of pairs and of bodies.
struct ModulusPredicate {
  ObjectId modulus = 3;

  [[nodiscard]] PairPredicate pairs() {
    return {[](void* context, ObjectId first, ObjectId second) {
              return (first + second) % static_cast<ModulusPredicate*>(context)->modulus != 0;
            },
            this};
  }
  [[nodiscard]] SceneFilter bodies() {
    SceneFilter filter;
    filter.predicate = {[](void* context, Key key, ClientData) {
                          return key.id % static_cast<ModulusPredicate*>(context)->modulus != 0;
                        },
                        this};
    return filter;
  }
};

/// Casts rays and moving shapes.
void cast_all(SceneQueries& queries, SceneWorld& world, ShapeId shape, const SceneFilter& filter) {
  std::vector<ShapeRay> rays;
  for (int i = 0; i < 9; ++i) {
    const Pose from = world.random_pose();
    const Pose to = world.random_pose();
    ShapeRay& ray = rays.emplace_back();
    for (int k = 0; k < 3; ++k) {
      ray.origin[k] = from.position[k];
      ray.direction[k] = to.position[k] - from.position[k];
    }
  }
  SceneHit hit;
  std::span<const SceneHit> hits;
  hit = expect_ok(queries.closest(rays[0], filter));
  hit = expect_ok(queries.any(rays[1], filter));
  hits = expect_ok(queries.all(rays[2], filter));
  std::vector<Key> keys(rays.size());
  std::vector<double> ts(rays.size());
  std::vector<double> heights(rays.size());
  SceneHitColumns columns{
      .key = keys.data(), .t = ts.data(), .point = {nullptr, nullptr, heights.data()}};
  EXPECT_EQ(queries.closest(ShapeRayBatch(rays), columns, filter), Status::ok);
  columns.key = nullptr;
  EXPECT_EQ(queries.any(ShapeRayBatch(rays), columns, filter), Status::ok);
  expect_ok(queries.all(ShapeRayBatch(rays), filter));
  ShapeCast cast{shape, world.random_pose()};
  cast.direction = rays[3].direction;
  hit = expect_ok(queries.closest(cast, filter));
  hits = expect_ok(queries.all(cast, filter, 1e-3));
  cast.touching = false;
  hit = expect_ok(queries.closest(cast, filter));
  hits = expect_ok(queries.all(cast, filter, 1e-3));
  MotionCast turning{shape, RigidMotion::between(world.random_pose(), world.random_pose())};
  hit = expect_ok(queries.closest(turning, filter));
  hits = expect_ok(queries.all(turning, filter, 1e-3));
  turning.touching = false;
  hit = expect_ok(queries.closest(turning, filter));
  hits = expect_ok(queries.all(turning, filter, 1e-3));
}

/// Makes every kind of query of a scene.
void query_all(SceneQueries& queries, SceneWorld& world, ShapeId shape, const SceneFilter& filter) {
  cast_all(queries, world, shape, filter);
  std::span<const SceneOverlap> bodies =
      expect_ok(queries.overlap(shape, world.random_pose(), filter));
  const std::span<const Key> keys(world.keys);
  SceneDistance gap = expect_ok(queries.distance(keys[0], keys[1]));
  gap = expect_ok(queries.distance(keys[0], keys[2], 1e-3));
  SetDistance least = expect_ok(queries.least_distance(keys.first(5), keys.last(9)));
  least = expect_ok(queries.least_distance(keys.first(1), keys.subspan(1, 1), 1e-3));
  std::span<const KeyPair> pairs = expect_ok(queries.overlaps(keys.first(9), keys.last(9)));
  pairs = expect_ok(queries.overlaps(keys, keys, 2));
  gap = expect_ok(queries.distance(keys[0], keys[1], 9.0, PairRules::none));
  least = expect_ok(queries.least_distance(keys.first(5), keys.last(9), 9.0, PairRules::none));
  for (const PairRules rules : {PairRules::scene, PairRules::none}) {
    pairs = expect_ok(queries.overlaps(keys.first(9), keys.last(9), 9, rules));
    KeyPair pair = expect_ok(queries.any_contact(keys.first(9), keys.last(9), 0.5, rules));
    pair = expect_ok(queries.any_contact(0.0, rules));
  }
  std::span<const SceneDistance> near =
      expect_ok(queries.nearest(world.random_pose().position, 4, 9.0, filter));
}

}  // namespace

namespace {

/// Adds, moves, changes and removes sensors of many shapes, and senses.
class Watch {
 public:
  Watch(Scene& scene, std::span<const ShapeId> shapes) : sensors_(scene), shapes_(shapes) {}

  void look(const SceneWorld& world, int frame) {
    Key key;
    const SensorDefinition sensor{
        .shape = shapes_[static_cast<std::size_t>(frame) % shapes_.size()],
        .pose = world.bodies[0].pose,
        .filter = {1, frame % 2 == 0 ? ~0U : 2U, 0},
        .carrier = world.keys[0],
        .data = static_cast<ClientData>(frame)};
    key = expect_ok(sensors_.add(sensor));
    keys_.push_back(key);
    EXPECT_EQ(sensors_.move(keys_.front(), world.bodies[1].pose), Status::ok);
    if (frame % 3 == 1) {
      EXPECT_EQ(sensors_.set(keys_.back(), {.shape = shapes_[0]}), Status::ok);
    }
    if (frame % 3 == 2) {
      EXPECT_EQ(sensors_.remove(keys_.front()), Status::ok);
      keys_.erase(keys_.begin());
    }
    EXPECT_EQ(sensors_.sense(), Status::ok);
    sensed += sensors_.sensed().size();
  }

  std::size_t sensed = 0;

 private:
  Sensors sensors_;
  std::span<const ShapeId> shapes_;
  std::vector<Key> keys_;
};

/// Finds impacts of bodies that move along x, by end poses or by motions; some are bullets.
void find_all_impacts(ContinuousCollision& ccd, const SceneWorld& world, bool by_motions) {
  std::vector<Pose> ends;
  std::vector<RigidMotion> motions;
  std::vector<std::uint8_t> bullets;
  for (const BodyDefinition& body : world.bodies) {
    Pose end = body.pose;
    end.position[0] += 0.4;
    ends.push_back(end);
    motions.push_back(RigidMotion::between(body.pose, end));
    bullets.push_back(bullets.size() % 3 == 0 ? 1 : 0);
  }
  const ContinuousOptions options{ContinuousPairs::bullets_and_fixed, bullets, 1e-5, false,
                                  by_motions};
  EXPECT_EQ(by_motions ? ccd.find_impacts(world.keys, motions, options)
                       : ccd.find_impacts(world.keys, ends),
            Status::ok);
}

/// Saves the scene and its contacts, and loads them again.
void load_again(Scene& scene, Contacts& contacts) {
  Column<std::byte> bodies(std::pmr::get_default_resource());
  Column<std::byte> touching(std::pmr::get_default_resource());
  EXPECT_EQ(scene.save(bodies), Status::ok);
  EXPECT_EQ(scene.save_contacts(contacts, touching), Status::ok);
  EXPECT_EQ(scene.load({bodies.data(), bodies.size()}), Status::ok);
  EXPECT_EQ(scene.load_contacts({touching.data(), touching.size()}, contacts), Status::ok);
}

}  // namespace

void record_scene(Recorder& recorder, std::size_t count, int frames, const SceneOptions& options) {
  SceneWorld world(count);
  const HalfSpaceShape ground{{0.1, -0.2, 0.7}, -1.0};
  ShapeId ground_id = expect_ok(world.pool.add(ground));
  Landscape landscape(world);
  SceneOptions with_landscape = options;
  with_landscape.composites = &landscape.pool;
  Scene scene(world.pool, recorded_by(recorder, with_landscape));
  landscape.add_to(scene, world);
  world.keys.resize(world.bodies.size());
  EXPECT_EQ(scene.add(world.bodies, world.keys), Status::ok);
  ShapeId round[2];
  round[0] = expect_ok(world.pool.add(EllipsoidShape{{0.8, 0.5, 0.3}}));
  round[1] = expect_ok(world.pool.add(TaperedCapsuleShape{{0.5, 0.3}, 0.6}));
  Key ground_key;
  for (const ShapeId shape : round) {
    ground_key = expect_ok(scene.add({.shape = shape, .pose = Pose::at(0.3, 0.2, -0.9)}));
  }
  ground_key = expect_ok(scene.add({.shape = ground_id, .state = BodyState::fixed}));
  Contacts contacts;
  SceneQueries queries(scene);
  ContinuousCollision ccd(scene);
  const ShapeId watching[] = {world.shapes[0], landscape.ids[0], round[0], landscape.ids[3]};
  Watch watch(scene, watching);
  ModulusPredicate predicate;
  for (int frame = 0; frame < frames; ++frame) {
    world.stir(0.05);
    std::vector<Pose> poses;
    for (const BodyDefinition& body : world.bodies) poses.push_back(body.pose);
    EXPECT_EQ(scene.move(world.keys, poses), Status::ok);
    change_bodies(scene, world, landscape, frame);
    EXPECT_EQ(scene.refresh(), Status::ok);
    predicate.modulus = frame < 4 ? 3 : 5;
    if (frame == 2 || frame == 4) scene.set_predicate(predicate.pairs());
    if (frame == 6) scene.set_predicate({});
    const ShapeId by_frame[] = {world.shapes[1], round[1], landscape.ids[3], landscape.ids[0]};
    query_all(queries, world, by_frame[frame % 4],
              frame % 2 == 0 ? SceneFilter{} : predicate.bodies());
    const auto level = frame == 6 ? ContactLevel::distance : ContactLevel::manifold;
    find_all_impacts(ccd, world, frame % 2 == 1);
    EXPECT_EQ(scene.collide(level, contacts), Status::ok);
    watch.look(world, frame);
    if (frame == 3 || frame == 5) load_again(scene, contacts);
    recorder.end_frame();
  }
}

}  // namespace winnow::test
