// Scenes with meshes, compounds and height fields, compared with every pair of primitives tested
// one by one.

#include "pipeline/mesh/mesh_view.h"
#include "pipeline/solver/solver.h"

#include <gtest/gtest.h>
#include <winnow/core/hooks.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "tests/pipeline/scene_world.h"
#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/counting_memory.h"
#include "tests/support/meshes.h"

namespace winnow::test {
namespace {

/// A convex primitive of a composite shape.
struct Piece {
  ShapeId shape;
  TriangleShape triangle;
  Pose pose;
  std::uint32_t part;
};

using Parts = std::set<std::tuple<ClientData, ClientData, std::uint32_t, std::uint32_t>>;

[[nodiscard]] Eigen::Vector3d turned(const Pose& pose, const Eigen::Vector3d& v) {
  const Eigen::Quaterniond q(pose.orientation[0], pose.orientation[1], pose.orientation[2],
                             pose.orientation[3]);
  return q.normalized() * v;
}

/// Shapes of all composite kinds and their primitives.
class PartsWorld {
 public:
  PartsWorld() : pool_(convex_) {
    add_convex();
    for (const MeshData& data : {torus(7, 5), gear(4), degenerate_soup(30, 3)}) {
      ShapeId id = expect_ok(pool_.add_mesh(data.points(), data.indices()));
      add_mesh_pieces(data, {1, 1, 1});
      shapes_.push_back(id);
      const Vec3d scale{0.7, -1.2, 0.5};
      ShapeId scaled = expect_ok(pool_.add_scaled(id, scale));
      add_mesh_pieces(data, scale);
      shapes_.push_back(scaled);
    }
    add_field();
    add_compound();
    add_compound_of_all();
  }

  [[nodiscard]] const ShapePool& convex() const { return convex_; }
  [[nodiscard]] CompositePool& pool() { return pool_; }
  [[nodiscard]] std::size_t kinds() const { return shapes_.size(); }

  [[nodiscard]] BodyDefinition body(std::size_t kind, double side, Random& random) const {
    BodyDefinition body;
    body.shape = shapes_[kind];
    for (double& p : body.pose.position) p = random.uniform(0.0, side);
    for (double& q : body.pose.orientation) q = random.uniform(-1.0, 1.0);
    return body;
  }

  /// Finds every pair of primitives of two bodies that share a point.
  void touching(const BodyDefinition& a, const BodyDefinition& b, Parts& found) const {
    for (const Piece& one : pieces_[kind_of(a.shape)]) {
      for (const Piece& other : pieces_[kind_of(b.shape)]) {
        const TriangleShape triangles[2] = {one.triangle, other.triangle};
        ShapeTables tables = convex_.tables();
        tables.triangles = triangles;
        tables.count[static_cast<int>(ShapeKind::triangle)] = 2;
        const ShapeId first = id_in(one, 0);
        const ShapeId second = id_in(other, 1);
        SolverCounts counts;
        if (!solve_pair(tables, first, placed(one, a.pose), second, placed(other, b.pose),
                        ContactLevel::boolean, 0.0, counts)
                 .overlap) {
          continue;
        }
        if (a.data < b.data)
          found.insert({a.data, b.data, one.part, other.part});
        else
          found.insert({b.data, a.data, other.part, one.part});
      }
    }
  }

 private:
  void add_convex() {
    ShapeId id = expect_ok(convex_.add(SphereShape{0.4}));
    add_whole(id);
    id = expect_ok(convex_.add(BoxShape{{0.5, 0.3, 0.2}}));
    add_whole(id);
    id = expect_ok(convex_.add(CapsuleShape{0.2, 0.6}));
    add_whole(id);
  }

  void add_whole(ShapeId id) {
    shapes_.push_back(id);
    pieces_.push_back({{id, {}, {}, kWholeShape}});
  }

  void add_mesh_pieces(const MeshData& data, const Vec3d& scale) {
    std::vector<Piece> pieces;
    for (std::uint32_t t = 0; t < data.triangles(); ++t) {
      Piece piece{ShapeId::of(ShapeKind::triangle, 0), {}, {}, t};
      for (std::size_t c = 0; c < 3; ++c) {
        const Eigen::Vector3f& v = data.vertices[data.corners[3 * t + c]];
        for (std::size_t k = 0; k < 3; ++k) {
          piece.triangle.vertex[c][k] =
              static_cast<double>(v[static_cast<Eigen::Index>(k)]) * scale[k];
        }
      }
      pieces.push_back(piece);
    }
    pieces_.push_back(std::move(pieces));
  }

  void add_field() {
    std::vector<float> heights(30);
    Random random(41);
    for (float& h : heights) h = static_cast<float>(random.uniform(-0.4, 0.4));
    heights[8] = std::numeric_limits<float>::quiet_NaN();
    HeightSamples samples;
    samples.heights = heights;
    samples.columns = 6;
    samples.rows = 5;
    samples.spacing[0] = 0.5;
    samples.spacing[1] = 0.4;
    ShapeId id = expect_ok(pool_.add_height_field(samples));
    std::vector<Piece> pieces;
    for (std::uint32_t t = 0; t < pool_.height_field(id)->triangles(); ++t) {
      Piece piece{ShapeId::of(ShapeKind::triangle, 0), {}, {}, t};
      if (pool_.height_field(id)->triangle(t, piece.triangle)) pieces.push_back(piece);
    }
    EXPECT_LT(pieces.size(), 40U);
    shapes_.push_back(id);
    pieces_.push_back(std::move(pieces));
  }

  void add_compound() {
    std::vector<CompoundChild> children;
    std::vector<Piece> pieces;
    Random random(43);
    for (std::uint32_t i = 0; i < 20; ++i) {
      CompoundChild child{shapes_[i % 3], {}};
      for (double& p : child.pose.position) p = random.uniform(-1.0, 1.0);
      for (double& q : child.pose.orientation) q = random.uniform(-1.0, 1.0);
      children.push_back(child);
      pieces.push_back({child.shape, {}, child.pose, i});
    }
    ShapeId id = expect_ok(pool_.add_compound(children));
    shapes_.push_back(id);
    pieces_.push_back(std::move(pieces));
  }

  /// Adds a compound of all shapes except the compound before it.
  void add_compound_of_all() {
    std::vector<CompoundChild> children;
    std::vector<Piece> pieces;
    Random random(47);
    std::uint32_t first = 0;
    for (std::size_t kind = 0; kind + 1 < shapes_.size(); ++kind) {
      CompoundChild child{shapes_[kind], {}};
      for (double& p : child.pose.position) p = random.uniform(-1.0, 1.0);
      for (double& q : child.pose.orientation) q = random.uniform(-1.0, 1.0);
      children.push_back(child);
      for (Piece piece : pieces_[kind]) {
        piece.pose = child.pose;
        piece.part = first + (piece.part == kWholeShape ? 0 : piece.part);
        pieces.push_back(piece);
      }
      const HeightField* const field = pool_.height_field(child.shape);
      first +=
          field != nullptr ? field->triangles() : static_cast<std::uint32_t>(pieces_[kind].size());
    }
    ShapeId id = expect_ok(pool_.add_compound(children));
    shapes_.push_back(id);
    pieces_.push_back(std::move(pieces));
  }

  [[nodiscard]] std::size_t kind_of(ShapeId id) const {
    return static_cast<std::size_t>(std::find(shapes_.begin(), shapes_.end(), id) -
                                    shapes_.begin());
  }
  [[nodiscard]] static ShapeId id_in(const Piece& piece, std::uint32_t slot) {
    return piece.shape.kind() == ShapeKind::triangle ? ShapeId::of(ShapeKind::triangle, slot)
                                                     : piece.shape;
  }
  [[nodiscard]] static Pose placed(const Piece& piece, const Pose& body) {
    const Eigen::Vector3d at = turned(body, Eigen::Vector3d(piece.pose.position));
    const Eigen::Quaterniond q(body.orientation[0], body.orientation[1], body.orientation[2],
                               body.orientation[3]);
    const Eigen::Quaterniond p(piece.pose.orientation[0], piece.pose.orientation[1],
                               piece.pose.orientation[2], piece.pose.orientation[3]);
    const Eigen::Quaterniond r = q.normalized() * p.normalized();
    return {{body.position[0] + at.x(), body.position[1] + at.y(), body.position[2] + at.z()},
            {r.w(), r.x(), r.y(), r.z()}};
  }

  ShapePool convex_;
  CompositePool pool_;
  std::vector<ShapeId> shapes_;
  std::vector<std::vector<Piece>> pieces_;
};

[[nodiscard]] Parts parts_of(const Contacts& contacts) {
  Parts parts;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const ClientData a = contacts.data_a()[i];
    const ClientData b = contacts.data_b()[i];
    for (auto m = contacts.manifold_first()[i]; m < contacts.manifold_first()[i + 1]; ++m) {
      const std::uint32_t one = contacts.part_a()[m];
      const std::uint32_t other = contacts.part_b()[m];
      const bool is_new =
          a < b ? parts.insert({a, b, one, other}).second : parts.insert({b, a, other, one}).second;
      EXPECT_TRUE(is_new) << "duplicate pair of parts";
    }
  }
  return parts;
}

/// True if parts of the same two bodies are in the set.
[[nodiscard]] bool has_bodies_of(const Parts& parts, const Parts::value_type& pair) {
  const auto at = parts.lower_bound({std::get<0>(pair), std::get<1>(pair), 0, 0});
  return at != parts.end() && std::get<0>(*at) == std::get<0>(pair) &&
         std::get<1>(*at) == std::get<1>(pair);
}

/// Adds a floor of triangles at z = 0 over [-10, 10] x [-10, 10].
[[nodiscard]] ShapeId flat_floor(CompositePool& pool) {
  std::vector<Eigen::Vector3f> points;
  std::vector<std::uint32_t> corners;
  constexpr std::uint32_t kCells = 20;
  for (std::uint32_t y = 0; y <= kCells; ++y) {
    for (std::uint32_t x = 0; x <= kCells; ++x) {
      points.emplace_back(static_cast<float>(x) - 10, static_cast<float>(y) - 10, 0);
    }
  }
  for (std::uint32_t y = 0; y < kCells; ++y) {
    for (std::uint32_t x = 0; x < kCells; ++x) {
      const std::uint32_t a = y * (kCells + 1) + x;
      const std::uint32_t c = a + kCells + 1;
      corners.insert(corners.end(), {a, a + 1, c, a + 1, c + 1, c});
    }
  }
  ShapeId id = expect_ok(pool.add_mesh(std::span<const Eigen::Vector3f>(points),
                                       std::span<const std::uint32_t>(corners)));
  return id;
}

TEST(SceneParts, ball_on_flat_mesh_gets_only_floor_normals) {
  ShapePool convex;
  CompositePool pool(convex);
  ShapeId ball = expect_ok(convex.add(SphereShape{0.5}));
  Scene scene(convex, {.composites = &pool});
  Key floor;
  Key body;
  floor = expect_ok(scene.add({.shape = flat_floor(pool), .state = BodyState::fixed}));
  body = expect_ok(scene.add({.shape = ball}));
  Contacts contacts;
  for (int step = 0; step < 400; ++step) {
    const double way = 0.043 * step - 8.0;
    ASSERT_EQ(scene.move(body, Pose::at(way, 0.61 * way + 0.2, 0.48)), Status::ok);
    ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
    ASSERT_GT(contacts.manifolds(), 0U);
    double deepest = 0.0;
    for (std::size_t m = 0; m < contacts.manifolds(); ++m) {
      EXPECT_NEAR(contacts.normal(0)[m], 0.0, 1e-12);
      EXPECT_NEAR(contacts.normal(1)[m], 0.0, 1e-12);
      EXPECT_NEAR(contacts.normal(2)[m], -1.0, 1e-12);
      deepest = std::min(deepest, contacts.distance()[m]);
    }
    EXPECT_NEAR(deepest, -0.02, 1e-9);
  }
}

/// Returns the least distance of each first body, by its client data, over all its contacts.
[[nodiscard]] std::map<ClientData, double> least_distances(const Contacts& contacts) {
  std::map<ClientData, double> least;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    for (auto m = contacts.manifold_first()[i]; m < contacts.manifold_first()[i + 1]; ++m) {
      const auto at = least.try_emplace(contacts.data_a()[i], contacts.distance()[m]).first;
      at->second = std::min(at->second, contacts.distance()[m]);
    }
  }
  return least;
}

TEST(SceneParts, refitted_mesh_collides_at_new_position) {
  ShapePool convex;
  CompositePool pool(convex);
  ShapeId ball = expect_ok(convex.add(SphereShape{0.5}));
  const ShapeId floor = flat_floor(pool);
  Scene scene(convex, {.cache_tolerance = 0.01, .composites = &pool});
  Key keys[2];
  keys[0] = expect_ok(scene.add({.shape = floor, .state = BodyState::fixed}));
  keys[1] = expect_ok(scene.add({.shape = ball, .pose = Pose::at(0, 0, 3)}));
  Contacts contacts;
  ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
  EXPECT_EQ(contacts.size(), 0U);
  std::vector<Eigen::Vector3f> raised;
  for (std::uint32_t i = 0; i < pool.mesh(floor)->vertices(); ++i) {
    const MeshView& view = view_of(*pool.mesh(floor));
    raised.emplace_back(coordinate(view, i, 0), coordinate(view, i, 1), 2.6F);
  }
  ASSERT_EQ(pool.refit_mesh(floor, std::span<const Eigen::Vector3f>(raised)), Status::ok);
  ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
  EXPECT_EQ(contacts.size(), 1U);
}

/// Counts the calls of the support function of a user shape, which is a point.
struct CountedPoint {
  mutable int calls = 0;

  [[nodiscard]] SupportShape ball(double radius) const { return {support, this, 0.0, radius}; }
  static void support(const void* context, const double*, double* point) {
    ++static_cast<const CountedPoint*>(context)->calls;
    std::fill_n(point, 3, 0.0);
  }
};

TEST(SceneParts, queries_of_compound_test_only_near_children) {
  ShapePool convex;
  CompositePool pool(convex);
  const ShapeId ball = convex.add(SphereShape{0.5});
  std::array<CountedPoint, 60> counted;
  std::vector<CompoundChild> children;
  for (const CountedPoint& point : counted) {
    const double x = 3.0 * static_cast<double>(children.size());
    children.push_back({convex.add(point.ball(0.5)), Pose::at(x, 0, 0)});
  }
  ShapeId compound = expect_ok(pool.add_compound(children));
  Scene scene(convex, {.composites = &pool});
  const Key row = scene.add({.shape = compound});
  const Key body = scene.add({.shape = ball, .pose = Pose::at(30, 5, 0)});
  ASSERT_EQ(scene.refresh(), Status::ok);
  SceneQueries queries(scene);
  counted.fill({});
  SceneDistance distance = expect_ok(queries.distance(row, body));
  EXPECT_NEAR(distance.distance, 4.0, 1e-12);
  EXPECT_EQ(distance.part_a, 10U);
  distance = expect_ok(queries.distance(body, row));
  EXPECT_NEAR(distance.distance, 4.0, 1e-12);
  EXPECT_EQ(distance.part, 10U);
  std::span<const SceneDistance> nearest;
  const double point[3] = {6.0, 2.0, 0.0};
  nearest = expect_ok(queries.nearest(point, 1, 10.0));
  ASSERT_EQ(nearest.size(), 1U);
  EXPECT_EQ(nearest[0].part, 2U);
  std::span<const SceneOverlap> overlaps = expect_ok(queries.overlap(ball, Pose::at(9, 0.5, 0)));
  ASSERT_EQ(overlaps.size(), 1U);
  EXPECT_EQ(overlaps[0].part, 3U);
  SceneHit hit;
  const ShapeCast cast{ball, Pose::at(12, 5, 0), {0, -1, 0}, 10.0};
  hit = expect_ok(queries.closest(cast));
  EXPECT_EQ(hit.part, 4U);
  EXPECT_LE(
      std::ranges::count_if(counted, [](const CountedPoint& child) { return child.calls > 0; }), 8);
}

int mid_phase_stages = 0;

TEST(SceneParts, scene_of_balls_never_calls_mid_phase) {
  SceneWorld world(200, 59);
  for (BodyDefinition& body : world.bodies) body.shape = world.shapes[0];
  CompositePool pool(world.pool);
  (void)flat_floor(pool);
  mid_phase_stages = 0;
  const StageHook before = set_stage_hook(
      [](WorkStage stage, bool) { mid_phase_stages += stage == WorkStage::mid_phase ? 1 : 0; });
  for (const double cache_tolerance : {0.0, 0.01}) {
    Scene scene(world.pool, {.cache_tolerance = cache_tolerance, .composites = &pool});
    ASSERT_EQ(add_all(scene, world), Status::ok);
    Contacts contacts;
    for (int frame = 0; frame < 3; ++frame) {
      ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
      world.stir(0.01);
      ASSERT_EQ(move_all(scene, world), Status::ok);
    }
    EXPECT_GT(contacts.size(), 0U);
  }
  set_stage_hook(before);
  EXPECT_EQ(mid_phase_stages, 0);
}

TEST(SceneParts, unused_composite_pool_costs_no_bytes) {
  SceneFootprint bytes[2];
  for (const bool with_pool : {false, true}) {
    SceneWorld world(200, 59);
    for (BodyDefinition& body : world.bodies) body.shape = world.shapes[0];
    CompositePool pool(world.pool);
    (void)flat_floor(pool);
    CountingMemory memory;
    Scene scene(world.pool, {.memory = &memory, .composites = with_pool ? &pool : nullptr});
    ASSERT_EQ(add_all(scene, world), Status::ok);
    Contacts contacts;
    ASSERT_EQ(scene.collide(ContactLevel::manifold, contacts), Status::ok);
    EXPECT_GT(contacts.size(), 0U);
    bytes[with_pool] = scene.footprint();
    EXPECT_EQ(bytes[with_pool].mid_phase.reserved, 0U);
    EXPECT_EQ(scene.statistics().primitive_pairs, 0U);
  }
  EXPECT_EQ(bytes[0].total().reserved, bytes[1].total().reserved);
}

TEST(SceneParts, touching_parts_match_brute_force) {
  PartsWorld world;
  Random random(47);
  for (int round = 0; round < 3; ++round) {
    const std::size_t count = std::max<std::size_t>(10, scaled(40));
    std::vector<BodyDefinition> bodies;
    for (std::size_t i = 0; i < count; ++i) {
      bodies.push_back(
          world.body(i % world.kinds(), 1.0 * std::cbrt(8.0 * static_cast<double>(count)), random));
      bodies.back().data = i;
      if (i % 7 == 6) bodies.back().state = BodyState::fixed;
    }
    Parts truth;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = i + 1; j < count; ++j) {
        if (bodies[i].state == BodyState::fixed && bodies[j].state == BodyState::fixed) continue;
        world.touching(bodies[i], bodies[j], truth);
      }
    }
    EXPECT_GT(truth.size(), count / 2);
    for (const int threads : {1, 2}) {
      Threads arena(threads);
      arena.run([&] {
        Scene scene(world.convex(), {.composites = &world.pool()});
        std::vector<Key> keys(count);
        ASSERT_EQ(scene.add(bodies, keys), Status::ok);
        for (const ContactLevel level :
             {ContactLevel::boolean, ContactLevel::distance, ContactLevel::manifold}) {
          Contacts contacts;
          ASSERT_EQ(scene.collide(level, contacts), Status::ok);
          const Parts found = parts_of(contacts);
          if (level == ContactLevel::boolean) {
            EXPECT_EQ(found, truth);
            continue;
          }
          // Contacts of some parts stand for others of the same body, which are left out.
          for (const auto& pair : truth) EXPECT_TRUE(has_bodies_of(found, pair)) << "missed";
        }
      });
    }
  }
}

TEST(SceneParts, cached_mesh_contacts_miss_nothing_beyond_bound) {
  ShapePool convex;
  CompositePool pool(convex);
  ShapeId box = expect_ok(convex.add(BoxShape{{0.6, 0.4, 0.3}}));
  const MeshData data = terrain(24);
  ShapeId ground = expect_ok(pool.add_mesh(data.points(), data.indices()));
  const double cache_tolerance = 0.01;
  Scene cached(convex, {.cache_tolerance = cache_tolerance, .composites = &pool});
  Scene exact(convex, {.composites = &pool});
  std::vector<BodyDefinition> bodies{{.shape = ground, .state = BodyState::fixed, .data = 1000}};
  Random random(53);
  for (ClientData i = 0; i < 60; ++i) {
    const Eigen::Vector3f& v = data.vertices[random.below(data.vertices.size())];
    BodyDefinition body{.shape = box,
                        .pose = Pose::at(static_cast<double>(v.x()), static_cast<double>(v.y()),
                                         static_cast<double>(v.z()) + random.uniform(-0.1, 0.5)),
                        .data = i};
    for (double& q : body.pose.orientation) q = random.uniform(-1.0, 1.0);
    bodies.push_back(body);
  }
  std::vector<Key> keys(bodies.size());
  std::vector<Key> exact_keys(bodies.size());
  ASSERT_EQ(cached.add(bodies, keys), Status::ok);
  ASSERT_EQ(exact.add(bodies, exact_keys), Status::ok);
  Contacts contacts;
  std::size_t kept = 0;
  for (int frame = 0; frame < 15; ++frame) {
    Contacts truth;
    ASSERT_EQ(cached.collide(ContactLevel::manifold, contacts), Status::ok);
    ASSERT_EQ(exact.collide(ContactLevel::manifold, truth), Status::ok);
    kept += contacts.cached_pairs();
    const auto depths = least_distances(contacts);
    for (std::size_t i = 0; i < truth.size(); ++i) {
      if (truth.data_b()[i] != 1000) continue;
      const ClientData body = truth.data_a()[i];
      // A small motion may change the side to which a deep body is pushed out.
      const double distance = least_distances(truth).at(body);
      if (distance < -0.05) continue;
      EXPECT_LE(depths.at(body), distance + cache_tolerance);
      EXPECT_EQ(shown(contacts).count({truth.data_a()[i], 1000}), 1U) << "missed a pair";
    }
    for (std::size_t i = 1; i < bodies.size(); ++i) {
      for (double& p : bodies[i].pose.position) p += random.uniform(-0.001, 0.001);
      ASSERT_EQ(cached.move(keys[i], bodies[i].pose), Status::ok);
      ASSERT_EQ(exact.move(exact_keys[i], bodies[i].pose), Status::ok);
    }
  }
  EXPECT_GT(kept, bodies.size());
}

}  // namespace
}  // namespace winnow::test
