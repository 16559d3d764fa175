#include <gtest/gtest.h>
#include <winnow/core/pose_view.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/narrow_phase.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <set>
#include <tuple>
#include <vector>

#include "../support/config.h"
#include "../support/counting_memory.h"
#include "../support/random.h"

namespace winnow::test {
namespace {

using Point = Eigen::Vector3f;
using Corner = std::array<std::uint32_t, 3>;

struct Surface {
  std::vector<Point> vertices;
  std::vector<std::uint32_t> corners;
};

/// How the squares of a grid are cut into triangles.
enum class Cut { same, mirrored, alternating, random };

/// Heights over a grid of `n` x `n` squares of side `side`, centred on the origin.
template <typename Height>
Surface grid(int n, float side, Cut cut, Height&& height) {
  Surface surface;
  Random random(5);
  for (int y = 0; y <= n; ++y) {
    for (int x = 0; x <= n; ++x) {
      const float at[2] = {side * (static_cast<float>(x) - 0.5F * static_cast<float>(n)),
                           side * (static_cast<float>(y) - 0.5F * static_cast<float>(n))};
      surface.vertices.emplace_back(at[0], at[1], height(at[0], at[1]));
    }
  }
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const auto i = static_cast<std::uint32_t>(y * (n + 1) + x);
      const auto up = i + static_cast<std::uint32_t>(n) + 1;
      const bool other = cut == Cut::mirrored || (cut == Cut::alternating && (x + y) % 2 == 0) ||
                         (cut == Cut::random && random.chance(0.5));
      const std::vector<std::uint32_t> square =
          other ? std::vector<std::uint32_t>{i, i + 1, up, i + 1, up + 1, up}
                : std::vector<std::uint32_t>{i, i + 1, up + 1, i, up + 1, up};
      surface.corners.insert(surface.corners.end(), square.begin(), square.end());
    }
  }
  return surface;
}

Surface soup(Random& random, int triangles, double reach, double size) {
  Surface surface;
  for (int t = 0; t < triangles; ++t) {
    const Eigen::Vector3d at(random.uniform(-reach, reach), random.uniform(-reach, reach),
                             random.uniform(-reach, reach));
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d off(random.uniform(-size, size), random.uniform(-size, size),
                                random.uniform(-size, size));
      surface.vertices.push_back((at + off).cast<float>());
      surface.corners.push_back(static_cast<std::uint32_t>(surface.vertices.size() - 1));
    }
    // Now and then a segment, or a point.
    if (random.chance(0.05)) surface.corners.back() = surface.corners[surface.corners.size() - 2];
    if (random.chance(0.02)) {
      surface.corners[surface.corners.size() - 2] = surface.corners.back();
      surface.corners[surface.corners.size() - 3] = surface.corners.back();
    }
  }
  return surface;
}

ShapeId add(CompositePool& pool, const Surface& surface) {
  ShapeId id;
  EXPECT_EQ(pool.add_mesh(std::span<const Point>(surface.vertices),
                          std::span<const std::uint32_t>(surface.corners), id),
            Status::ok);
  return id;
}

template <typename Shape>
ShapeId add(ShapePool& pool, const Shape& shape) {
  ShapeId id;
  EXPECT_EQ(pool.add(shape, id), Status::ok);
  return id;
}

ShapeId add_octahedron(ShapePool& pool, double size) {
  std::vector<Eigen::Vector3d> points;
  for (int axis = 0; axis < 3; ++axis) {
    points.push_back(size * Eigen::Vector3d::Unit(axis));
    points.push_back(-size * Eigen::Vector3d::Unit(axis));
  }
  const std::vector<std::uint32_t> indices{0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4,
                                           2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
  const std::vector<std::uint32_t> sizes(8, 3);
  ShapeId id;
  EXPECT_EQ(pool.add_hull(points, {indices, sizes}, 0.0, id), Status::ok);
  return id;
}

Pose random_pose(Random& random, double reach) {
  Pose pose;
  for (double& x : pose.position) x = random.uniform(-reach, reach);
  for (double& q : pose.orientation) q = random.uniform(-1.0, 1.0);
  return pose;
}

/// Shapes of every kind.
struct World {
  explicit World(std::pmr::memory_resource* memory = std::pmr::get_default_resource())
      : shapes(memory), composites(shapes, memory) {}

  ShapePool shapes;
  CompositePool composites;
  std::vector<ShapeId> ids;
  std::vector<ShapeId> body;
  std::vector<Pose> pose;
  std::vector<BodyPair> pairs;

  [[nodiscard]] Bodies bodies() const { return {body, pose}; }

  void add_shapes(Random& random) {
    ids = {add(shapes, SphereShape{0.6}),
           add(shapes, CapsuleShape{0.3, 0.7}),
           add(shapes, BoxShape{{0.5, 0.3, 0.8}, 0.0}),
           add(shapes, CylinderShape{0.4, 0.6, 0.0}),
           add(shapes, ConeShape{0.5, 0.7, 0.05}),
           add_octahedron(shapes, 0.8),
           add(shapes, TriangleShape{{{0.0, 0.0, 0.0}, {1.0, 0.2, 0.0}, {0.1, 0.9, 0.3}}, 0.0}),
           add(shapes, HalfSpaceShape{{0.2, -0.5, 1.0}, 0.1})};
    const std::size_t convex = ids.size();
    for (const int children : {1, 3, 16, 17, 60}) {
      std::vector<CompoundChild> list;
      for (int i = 0; i < children; ++i) {
        list.push_back({ids[random.below(convex - 1)], random_pose(random, 1.5)});
      }
      ids.emplace_back();
      EXPECT_EQ(composites.add_compound(list, ids.back()), Status::ok);
    }
    const CompoundChild endless[] = {{ids[0], Pose{}}, {ids[7], random_pose(random, 0.5)}};
    ids.emplace_back();
    EXPECT_EQ(composites.add_compound(endless, ids.back()), Status::ok);
    const ShapeId mesh = add(composites, soup(random, 150, 2.0, 0.5));
    ids.push_back(mesh);
    ids.push_back(add(composites, grid(7, 0.5F, Cut::random, [](float x, float y) {
                        return 0.5F * std::sin(3.0F * x) * std::cos(2.0F * y);
                      })));
    for (const std::array<double, 3> scale :
         {std::array{-1.0, 1.0, 1.0}, std::array{0.3, 1.7, -0.9}, std::array{2.0, 2.0, 2.0}}) {
      ids.emplace_back();
      EXPECT_EQ(composites.add_scaled(mesh, scale, ids.back()), Status::ok);
    }
    std::vector<float> heights;
    for (int i = 0; i < 9 * 6; ++i)
      heights.push_back(static_cast<float>(random.uniform(-0.3, 0.5)));
    heights[17] = std::nanf("");
    ids.emplace_back();
    EXPECT_EQ(composites.add_height_field({heights, 9, 6, 0, {0.4, 0.6}}, ids.back()), Status::ok);
  }

  void add_pairs(Random& random, std::size_t count, double reach, const double (&at)[3]) {
    for (std::size_t i = 0; i < count; ++i) {
      ShapeId a = ids[random.below(ids.size())];
      ShapeId b = ids[random.below(ids.size())];
      if (!a.is_composite() && !b.is_composite()) b = ids[8 + random.below(ids.size() - 8)];
      for (const ShapeId id : {a, b}) {
        body.push_back(id);
        pose.push_back(random_pose(random, reach));
        for (int axis = 0; axis < 3; ++axis) pose.back().position[axis] += at[axis];
      }
      const auto n = static_cast<std::uint32_t>(body.size());
      pairs.push_back({n - 2, n - 1});
    }
  }
};

using Touch = std::tuple<std::size_t, std::uint32_t, std::uint32_t>;

/// All primitives of a body, shown by visit without a limit.
std::vector<Primitive> parts_of(const World& world, ShapeId id, const Pose& pose) {
  std::vector<Primitive> parts;
  if (!id.is_composite()) {
    Primitive whole;
    whole.shape = id;
    whole.pose = pose;
    if (id.kind() == ShapeKind::triangle) {
      whole.triangle = world.shapes.tables().triangles[id.index()];
    }
    return {whole};
  }
  BoxSweep all{{-1e30, -1e30, -1e30}, {1e30, 1e30, 1e30}};
  world.composites.visit(id, pose, all,
                         {[](void* context, const Primitive& primitive, double limit) {
                            static_cast<std::vector<Primitive>*>(context)->push_back(primitive);
                            return limit;
                          },
                          &parts});
  return parts;
}

/// Every part of a against every part of b, for all pairs.
void expand_all(const World& world, PrimitivePairs& out, std::vector<std::size_t>& owner) {
  for (std::size_t i = 0; i < world.pairs.size(); ++i) {
    const BodyPair& pair = world.pairs[i];
    std::vector<std::uint32_t> side[2];
    for (int s = 0; s < 2; ++s) {
      const std::uint32_t body = s == 0 ? pair.a : pair.b;
      for (const Primitive& part : parts_of(world, world.body[body], world.pose[body])) {
        side[s].push_back(static_cast<std::uint32_t>(out.shapes.size()));
        ShapeId shape = part.shape;
        if (shape.kind() == ShapeKind::triangle) {
          shape =
              ShapeId::of(ShapeKind::triangle, static_cast<std::uint32_t>(out.triangles.size()));
          ASSERT_TRUE(out.triangles.push_back(part.triangle));
        }
        Pose pose = part.pose;
        for (int axis = 0; axis < 3; ++axis) {
          pose.position[axis] -= world.pose[pair.a].position[axis];
        }
        ASSERT_TRUE(out.shapes.push_back(shape) && out.poses.push_back(pose) &&
                    out.part.push_back(part.part));
      }
    }
    for (const std::uint32_t a : side[0]) {
      for (const std::uint32_t b : side[1]) {
        ASSERT_TRUE(out.pairs.push_back({a, b}));
        owner.push_back(i);
      }
    }
  }
}

/// Pairs of parts that are no farther apart than `near`.
std::set<Touch> touching(const World& world, const PrimitivePairs& pairs,
                         const std::vector<std::size_t>& owner, double near) {
  NarrowPhase narrow;
  NarrowResult result;
  EXPECT_EQ(
      narrow.collide(
          pairs.tables(world.shapes),
          {{pairs.shapes.data(), pairs.shapes.size()}, {pairs.poses.data(), pairs.poses.size()}},
          {pairs.pairs.data(), pairs.pairs.size()}, {.level = NarrowLevel::distance}, result),
      Status::ok);
  std::set<Touch> found;
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (!(result.distance()[i] <= near)) continue;
    const std::uint32_t at = result.pair_of(i);
    const BodyPair& pair = pairs.pairs[at];
    found.emplace(owner[at], pairs.part[pair.a], pairs.part[pair.b]);
  }
  return found;
}

std::vector<std::size_t> owners(const PrimitivePairs& pairs) {
  std::vector<std::size_t> owner;
  for (std::size_t i = 0; i + 1 < pairs.first.size(); ++i) {
    owner.insert(owner.end(), pairs.first[i + 1] - pairs.first[i], i);
  }
  return owner;
}

template <typename T>
bool same(const Column<T>& a, const Column<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

TEST(MidPhase, finds_every_pair_of_primitives_that_all_against_all_finds) {
  Random random(1);
  World world;
  world.add_shapes(random);
  world.add_pairs(random, scaled(150), 1.2, {0.0, 0.0, 0.0});
  world.add_pairs(random, scaled(60), 4.0, {1e5, -3e4, 2e5});
  PrimitivePairs all;
  std::vector<std::size_t> owner;
  expand_all(world, all, owner);
  for (const double margin : {0.0, 0.25}) {
    PrimitivePairs pairs;
    ASSERT_EQ(world.composites.expand(world.shapes, world.bodies(), world.pairs, margin,
                                      Execution::serial(), pairs),
              Status::ok);
    // Poses far from the origin differ by rounding.
    const double slack = 1e-9;
    const std::set<Touch> sure = touching(world, all, owner, margin - slack);
    const std::set<Touch> perhaps = touching(world, all, owner, margin + slack);
    const std::set<Touch> found = touching(world, pairs, owners(pairs), margin);
    EXPECT_GT(sure.size(), 100U);
    EXPECT_TRUE(std::includes(found.begin(), found.end(), sure.begin(), sure.end()));
    EXPECT_TRUE(std::includes(perhaps.begin(), perhaps.end(), found.begin(), found.end()));
    EXPECT_LT(pairs.pairs.size(), all.pairs.size() / 2);
  }
}

TEST(MidPhase, is_the_same_on_any_number_of_threads_and_any_instruction_set) {
  Random random(2);
  World world;
  world.add_shapes(random);
  world.add_pairs(random, scaled(300), 1.5, {0.0, 0.0, 0.0});
  PrimitivePairs one;
  ASSERT_EQ(world.composites.expand(world.shapes, world.bodies(), world.pairs, 0.1,
                                    Execution::serial(), one),
            Status::ok);
  for (const Isa isa : available_isas()) {
    const IsaScope scope(isa);
    for (const int count : {1, 2, 8}) {
      PrimitivePairs many;
      ASSERT_EQ(Threads(count).run([&] {
        return world.composites.expand(world.shapes, world.bodies(), world.pairs, 0.1,
                                       Execution::parallel(), many);
      }),
                Status::ok);
      EXPECT_TRUE(same(one.shapes, many.shapes) && same(one.poses, many.poses) &&
                  same(one.part, many.part) && same(one.triangles, many.triangles) &&
                  same(one.active_edges, many.active_edges) && same(one.pairs, many.pairs) &&
                  same(one.first, many.first));
    }
  }
}

TEST(MidPhase, allocates_nothing_the_second_time_and_counts_every_byte) {
  CountingMemory memory;
  {
    Random random(3);
    World world(&memory);
    EXPECT_EQ(world.composites.footprint().total().reserved, 0U);
    EXPECT_EQ(memory.outstanding(), 0U);
    world.add_shapes(random);
    world.add_pairs(random, 200, 1.5, {0.0, 0.0, 0.0});
    EXPECT_EQ(
        world.composites.footprint().total().reserved + world.shapes.footprint().total().reserved,
        memory.outstanding());
    CountingMemory scratch;
    PrimitivePairs pairs(&scratch);
    for (const Execution execution : {Execution::serial(), Execution::parallel()}) {
      std::size_t before = scratch.requests();
      for (int call = 0; call < 2; ++call) {
        before = scratch.requests();
        ASSERT_EQ(world.composites.expand(world.shapes, world.bodies(), world.pairs, 0.1, execution,
                                          pairs),
                  Status::ok);
      }
      EXPECT_EQ(scratch.requests(), before);
      EXPECT_EQ(scratch.outstanding(), pairs.footprint().total().reserved);
    }
    EXPECT_EQ(scratch.requests_from_elsewhere(), 0U);
    for (const ShapeId id : world.ids) {
      if (id.is_composite()) {
        EXPECT_EQ(world.composites.remove(id), Status::ok);
        EXPECT_EQ(world.composites.remove(id), Status::invalid_key);
      }
    }
    EXPECT_EQ(
        world.composites.footprint().total().reserved + world.shapes.footprint().total().reserved,
        memory.outstanding());
  }
}

TEST(MidPhase, a_refused_request_for_memory_changes_nothing) {
  Random random(4);
  World world;
  world.add_shapes(random);
  world.add_pairs(random, 40, 1.0, {0.0, 0.0, 0.0});
  for (std::size_t grants = 0;; ++grants) {
    CountingMemory memory;
    memory.refuse_after(grants);
    PrimitivePairs pairs(&memory);
    const Status status = world.composites.expand(world.shapes, world.bodies(), world.pairs, 0.1,
                                                  Execution::serial(), pairs);
    if (status == Status::ok) break;
    ASSERT_EQ(status, Status::out_of_memory);
    EXPECT_EQ(pairs.pairs.size(), 0U);
    memory.grant_all();
    EXPECT_EQ(world.composites.expand(world.shapes, world.bodies(), world.pairs, 0.1,
                                      Execution::serial(), pairs),
              Status::ok);
  }
  const Surface surface = soup(random, 40, 2.0, 0.5);
  std::vector<CompoundChild> children;
  for (int i = 0; i < 20; ++i) children.push_back({world.ids[0], random_pose(random, 3.0)});
  const std::vector<float> heights(12, 1.0F);
  for (int kind = 0; kind < 3; ++kind) {
    CountingMemory memory;
    for (std::size_t grants = 0;; ++grants) {
      CompositePool pool(world.shapes, &memory);
      memory.refuse_after(grants);
      ShapeId id;
      Status status = Status::ok;
      if (kind == 0) {
        status = pool.add_mesh(std::span<const Point>(surface.vertices),
                               std::span<const std::uint32_t>(surface.corners), id);
      } else if (kind == 1) {
        status = pool.add_compound(children, id);
      } else {
        status = pool.add_height_field({heights, 4, 3, 0, {1.0, 1.0}}, id);
      }
      EXPECT_EQ(memory.outstanding(), pool.footprint().total().reserved);
      memory.grant_all();
      if (status == Status::ok) break;
      ASSERT_EQ(status, Status::out_of_memory);
      EXPECT_FALSE(pool.contains(id));
      EXPECT_EQ(pool.size(CompositeKind::mesh) + pool.size(CompositeKind::compound) +
                    pool.size(CompositeKind::height_field),
                0U);
    }
  }
}

TEST(CompositePool, refuses_what_it_cannot_hold) {
  Random random(5);
  World world;
  world.add_shapes(random);
  CompositePool& pool = world.composites;
  const ShapeId mesh = world.ids[14];
  ASSERT_EQ(mesh.composite_kind(), CompositeKind::mesh);
  ShapeId id;
  const double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, inf, -inf, std::nan(""), 1e-200, 1e200}) {
    EXPECT_EQ(pool.add_scaled(mesh, {1.0, bad, 1.0}, id), Status::invalid_argument);
  }
  EXPECT_EQ(pool.add_scaled(world.ids[0], {1.0, 1.0, 1.0}, id), Status::invalid_key);
  EXPECT_EQ(pool.add_scaled({}, {1.0, 1.0, 1.0}, id), Status::invalid_key);
  EXPECT_EQ(pool.add_compound({}, id), Status::invalid_shape);
  Pose bad;
  bad.position[1] = std::nan("");
  const CompoundChild nowhere[] = {{world.ids[0], bad}};
  EXPECT_EQ(pool.add_compound(nowhere, id), Status::invalid_pose);
  const CompoundChild nested[] = {{mesh, Pose{}}};
  EXPECT_EQ(pool.add_compound(nested, id), Status::invalid_key);
  EXPECT_EQ(pool.remove(world.ids[0]), Status::invalid_key);
  EXPECT_FALSE(pool.contains({}));
  EXPECT_FALSE(pool.contains(id));
  EXPECT_EQ(pool.bounds(id, Pose{}), Aabb{});
}

TEST(CompositePool, triangles_live_until_the_last_scaled_id_is_removed) {
  Random random(6);
  const Surface surface = soup(random, 30, 2.0, 0.5);
  ShapePool shapes;
  CountingMemory memory;
  CompositePool pool(shapes, &memory);
  const ShapeId first = add(pool, surface);
  ShapeId second;
  ASSERT_EQ(pool.add_scaled(first, {2.0, -1.0, 3.0}, second), Status::ok);
  ShapeId third;
  ASSERT_EQ(pool.add_scaled(second, {0.5, 1.0, 1.0}, third), Status::ok);
  EXPECT_EQ(pool.mesh(first), pool.mesh(third));
  const std::uint64_t revision = pool.revision();
  EXPECT_EQ(pool.remove(first), Status::ok);
  EXPECT_EQ(pool.remove(second), Status::ok);
  EXPECT_GT(pool.revision(), revision);
  ASSERT_NE(pool.mesh(third), nullptr);
  EXPECT_EQ(pool.mesh(first), nullptr);
  EXPECT_EQ(pool.mesh(third)->triangles(), 30U);
  EXPECT_EQ(pool.size(CompositeKind::mesh), 1U);
  EXPECT_EQ(memory.outstanding(), pool.footprint().total().reserved);
  EXPECT_EQ(add(pool, surface), second);
}

TEST(CompositePool, boxes_and_radii_hold_every_part) {
  Random random(7);
  World world;
  world.add_shapes(random);
  for (const ShapeId id : world.ids) {
    if (!id.is_composite()) continue;
    for (int i = 0; i < 5; ++i) {
      const Pose pose = random_pose(random, i < 3 ? 2.0 : 1e6);
      const Aabb box = world.composites.bounds(id, pose);
      const double radius = world.composites.radius(id);
      ASSERT_TRUE(box.is_valid());
      const Eigen::Map<const Eigen::Vector3d> at(pose.position);
      for (const Primitive& part : parts_of(world, id, pose)) {
        Aabb inner;
        double reach = 0.0;
        if (part.shape.kind() == ShapeKind::triangle) {
          ShapePool one;
          inner = one.bounds(add(one, part.triangle), part.pose);
          for (const auto& corner : part.triangle.vertex) {
            const Eigen::Map<const Eigen::Vector3d> from(part.pose.position);
            if (world.composites.mesh(id) != nullptr) {
              reach = (Eigen::Map<const Eigen::Vector3d>(corner) + from - at).norm();
            }
          }
        } else {
          inner = world.shapes.bounds(part.shape, part.pose);
        }
        // Both are rounded outward to float.
        const float slack = 1e-6F * inner.max.cwiseAbs().maxCoeff();
        for (int axis = 0; axis < 3; ++axis) {
          if (!std::isfinite(inner.max[axis])) continue;
          EXPECT_LE(box.min[axis], inner.min[axis] + slack);
          EXPECT_GE(box.max[axis], inner.max[axis] - slack);
        }
        EXPECT_LE(reach, radius * (1.0 + 1e-9) + 1e-9);
      }
    }
  }
}

/// A body on a surface: what its contacts are, smoothed.
struct Landing {
  std::vector<Eigen::Vector3d> normals;  ///< from the body to the surface
  double deepest = std::numeric_limits<double>::infinity();
  std::size_t points = 0;
};

Landing land(const ShapePool& shapes, const CompositePool& pool, ShapeId body, const Pose& at,
             ShapeId surface, const Pose& ground, NarrowLevel level, double margin,
             bool ground_first = false) {
  const ShapeId ids[2] = {ground_first ? surface : body, ground_first ? body : surface};
  const Pose poses[2] = {ground_first ? ground : at, ground_first ? at : ground};
  const BodyPair pair[] = {{0, 1}};
  PrimitivePairs pairs;
  EXPECT_EQ(pool.expand(shapes, {ids, poses}, pair, margin, Execution::serial(), pairs),
            Status::ok);
  NarrowPhase narrow;
  NarrowResult result;
  EXPECT_EQ(
      narrow.collide(
          pairs.tables(shapes),
          {{pairs.shapes.data(), pairs.shapes.size()}, {pairs.poses.data(), pairs.poses.size()}},
          {pairs.pairs.data(), pairs.pairs.size()}, {.level = level, .margin = margin}, result),
      Status::ok);
  std::size_t before = 0;
  for (const double distance : result.distance()) before += distance <= margin ? 1 : 0;
  pool.smooth(shapes, pairs, Execution::serial(), result);
  Landing landing;
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (!(result.distance()[i] <= margin)) continue;
    const double sign = ground_first ? -1.0 : 1.0;
    landing.normals.emplace_back(sign * result.normal(0)[i], sign * result.normal(1)[i],
                                 sign * result.normal(2)[i]);
    landing.deepest = std::min(landing.deepest, result.distance()[i]);
    if (level != NarrowLevel::manifold) continue;
    EXPECT_GE(result.contact_count()[i], 1U);
    landing.points += result.contact_count()[i];
    const ContactPoint first = result.contact(result.contact_first()[i]);
    EXPECT_NEAR(static_cast<double>(first.depth), -result.distance()[i], 1e-5);
  }
  EXPECT_EQ(landing.normals.size(), before);
  return landing;
}

const Cut kCuts[] = {Cut::same, Cut::mirrored, Cut::alternating, Cut::random};

TEST(InnerEdges, what_slides_over_a_flat_floor_feels_only_its_normal) {
  Random random(8);
  ShapePool shapes;
  CompositePool pool(shapes);
  const ShapeId bodies[] = {add(shapes, SphereShape{0.5}),
                            add(shapes, BoxShape{{0.4, 0.6, 0.5}, 0.0}),
                            add_octahedron(shapes, 0.5), add(shapes, CapsuleShape{0.3, 0.2}),
                            add(shapes, CylinderShape{0.4, 0.5, 0.0})};
  for (const Cut cut : kCuts) {
    const ShapeId floor = add(pool, grid(12, 0.7F, cut, [](float, float) { return 0.0F; }));
    ShapeId scaled_floor;
    ASSERT_EQ(pool.add_scaled(floor, {1.3, -0.8, 2.0}, scaled_floor), Status::ok);
    for (int i = 0; i < static_cast<int>(scaled(150)); ++i) {
      const ShapeId body = bodies[random.below(5)];
      // Over corners, over edges and elsewhere; about its own height above the floor.
      Pose at = Pose::at(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), 0.0);
      if (random.chance(0.3)) at.position[0] = 0.7 * std::round(at.position[0] / 0.7);
      if (random.chance(0.3)) at.position[1] = 0.7 * std::round(at.position[1] / 0.7);
      const double turn = random.chance(0.3) ? 0.0 : random.uniform(-3.0, 3.0);
      at.orientation[0] = std::cos(turn);
      at.orientation[3] = std::sin(turn);
      at.position[2] = 0.5 + random.uniform(-0.05, 0.009);
      for (const NarrowLevel level : {NarrowLevel::distance, NarrowLevel::manifold}) {
        const ShapeId ground = random.chance(0.3) ? scaled_floor : floor;
        const Landing landing =
            land(shapes, pool, body, at, ground, Pose{}, level, 0.01, random.chance(0.5));
        EXPECT_NEAR(landing.deepest, at.position[2] - 0.5, 1e-6);
        for (const Eigen::Vector3d& normal : landing.normals) {
          EXPECT_LT((normal + Eigen::Vector3d::UnitZ()).norm(), 1e-12)
              << normal.transpose() << " kind " << body.kind_index() << " at " << at.position[0]
              << " " << at.position[1] << " " << at.position[2];
        }
      }
    }
  }
}

TEST(InnerEdges, ridges_and_borders_are_felt) {
  ShapePool shapes;
  CompositePool pool(shapes);
  const ShapeId ball = add(shapes, SphereShape{0.5});
  // A roof whose ridge runs along y at x = 0.
  const ShapeId roof =
      add(pool, grid(8, 0.5F, Cut::same, [](float x, float) { return -std::abs(x); }));
  const Landing on_ridge =
      land(shapes, pool, ball, Pose::at(0.0, 0.1, 0.49), roof, Pose{}, NarrowLevel::manifold, 0.0);
  ASSERT_FALSE(on_ridge.normals.empty());
  for (const Eigen::Vector3d& normal : on_ridge.normals) {
    EXPECT_LT((normal + Eigen::Vector3d::UnitZ()).norm(), 1e-9);
  }
  // Off the border of a floor: from the ball straight to the edge.
  const ShapeId floor = add(pool, grid(4, 0.5F, Cut::same, [](float, float) { return 0.0F; }));
  const Landing off =
      land(shapes, pool, ball, Pose::at(1.3, 0.1, 0.35), floor, Pose{}, NarrowLevel::manifold, 0.0);
  ASSERT_FALSE(off.normals.empty());
  const Eigen::Vector3d to_edge = Eigen::Vector3d(-0.3, 0.0, -0.35).normalized();
  double nearest = 1.0;
  for (const Eigen::Vector3d& normal : off.normals) {
    nearest = std::min(nearest, (normal - to_edge).norm());
  }
  EXPECT_LT(nearest, 1e-9);
}

TEST(InnerEdges, a_valley_holds_a_ball_by_its_faces) {
  ShapePool shapes;
  CompositePool pool(shapes);
  const ShapeId ball = add(shapes, SphereShape{0.5});
  const ShapeId valley =
      add(pool, grid(8, 0.5F, Cut::alternating, [](float x, float) { return std::abs(x); }));
  const double rest = 0.5 * std::sqrt(2.0) - 0.02;
  for (int i = 0; i < 30; ++i) {
    const Landing landing = land(shapes, pool, ball, Pose::at(0.0005 * i, -0.5 + 0.03 * i, rest),
                                 valley, Pose{}, NarrowLevel::manifold, 0.0);
    const Eigen::Vector3d left = Eigen::Vector3d(-1.0, 0.0, -1.0).normalized();
    const Eigen::Vector3d right = Eigen::Vector3d(1.0, 0.0, -1.0).normalized();
    bool both[2] = {false, false};
    for (const Eigen::Vector3d& normal : landing.normals) {
      const double off[2] = {(normal - left).norm(), (normal - right).norm()};
      EXPECT_LT(std::min(off[0], off[1]), 1e-12);
      both[off[0] < off[1] ? 0 : 1] = true;
    }
    EXPECT_TRUE(both[0] && both[1]);
  }
}

TEST(InnerEdges, smoothing_is_the_same_on_any_number_of_threads_and_survives_refused_memory) {
  Random random(9);
  World world;
  world.ids = {add(world.shapes, BoxShape{{0.4, 0.6, 0.5}, 0.0}), add_octahedron(world.shapes, 0.5),
               add(world.shapes, SphereShape{0.5})};
  const ShapeId floor = add(world.composites, grid(20, 0.4F, Cut::random, [](float x, float y) {
                              return 0.05F * std::sin(x) * std::cos(y);
                            }));
  world.body.push_back(floor);
  world.pose.emplace_back();
  for (std::uint32_t i = 1; i < 400; ++i) {
    world.body.push_back(world.ids[random.below(3)]);
    world.pose.push_back(
        Pose::at(random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0), random.uniform(0.3, 0.5)));
    world.pairs.push_back({i, 0});
  }
  PrimitivePairs pairs;
  ASSERT_EQ(world.composites.expand(world.shapes, world.bodies(), world.pairs, 0.0,
                                    Execution::serial(), pairs),
            Status::ok);
  const auto answer = [&](std::pmr::memory_resource* memory, Execution execution,
                          CountingMemory* refusing) {
    auto result = std::make_unique<NarrowResult>(memory);
    NarrowPhase narrow;
    EXPECT_EQ(narrow.collide(pairs.tables(world.shapes),
                             {{pairs.shapes.data(), pairs.shapes.size()},
                              {pairs.poses.data(), pairs.poses.size()}},
                             {pairs.pairs.data(), pairs.pairs.size()}, {}, *result),
              Status::ok);
    if (refusing != nullptr) refusing->refuse_after(0);
    world.composites.smooth(world.shapes, pairs, execution, *result);
    if (refusing != nullptr) refusing->grant_all();
    return result;
  };
  const auto one = answer(std::pmr::get_default_resource(), Execution::serial(), nullptr);
  const auto two = Threads(2).run(
      [&] { return answer(std::pmr::get_default_resource(), Execution::parallel(), nullptr); });
  ASSERT_EQ(one->size(), two->size());
  ASSERT_EQ(one->contacts(), two->contacts());
  for (std::size_t i = 0; i < one->size(); ++i) {
    EXPECT_EQ(one->distance()[i], two->distance()[i]);
    EXPECT_EQ(one->contact_first()[i], two->contact_first()[i]);
    EXPECT_EQ(one->contact_count()[i], two->contact_count()[i]);
  }
  for (std::size_t i = 0; i < one->contacts(); ++i) {
    EXPECT_EQ(one->contact(i).position[0], two->contact(i).position[0]);
    EXPECT_EQ(one->contact(i).depth, two->contact(i).depth);
  }
  CountingMemory memory;
  const auto refused = answer(&memory, Execution::serial(), &memory);
  for (std::size_t i = 0; i < one->size(); ++i) {
    EXPECT_EQ(one->distance()[i], refused->distance()[i]);
    EXPECT_EQ(one->contact_count()[i] == 0, refused->contact_count()[i] == 0);
  }
}

TEST(Visits, show_what_all_boxes_would_and_the_nearest_first) {
  Random random(10);
  World world;
  world.add_shapes(random);
  for (const ShapeId id : world.ids) {
    if (!id.is_composite()) continue;
    for (int i = 0; i < 12; ++i) {
      const Pose pose = random_pose(random, i < 6 ? 2.0 : 1e4);
      BoxSweep box{};
      for (int axis = 0; axis < 3; ++axis) {
        const double middle = pose.position[axis] + random.uniform(-2.0, 2.0);
        const double half = random.chance(0.3) ? 0.0 : random.uniform(0.0, 0.5);
        box.min[axis] = middle - half;
        box.max[axis] = middle + half;
        box.direction[axis] = random.uniform(-1.0, 1.0);
      }
      box.max_t = random.uniform(0.0, 3.0);
      std::set<std::uint32_t> swept;
      std::set<std::uint32_t> near;
      const auto note = [](void* context, const Primitive& primitive, double limit) {
        static_cast<std::set<std::uint32_t>*>(context)->insert(primitive.part);
        return limit;
      };
      world.composites.visit(id, pose, box, {note, &swept});
      world.composites.visit_near(id, pose, box, 0.7, {note, &near});
      // A box against parts that are seen as shapes: answered by the narrow phase.
      World probe;
      ShapeId cube = add(probe.shapes,
                         BoxShape{{0.5 * (box.max[0] - box.min[0]), 0.5 * (box.max[1] - box.min[1]),
                                   0.5 * (box.max[2] - box.min[2])},
                                  0.0});
      SolverCounts counts;
      for (const Primitive& part : parts_of(world, id, pose)) {
        const bool is_triangle = part.shape.kind() == ShapeKind::triangle;
        const BoxShape& half = probe.shapes.tables().boxes[cube.index()];
        for (const double t : {0.0, 0.25, 0.5, 0.75, 1.0}) {
          Pose at;
          for (int axis = 0; axis < 3; ++axis) {
            at.position[axis] =
                0.5 * (box.min[axis] + box.max[axis]) + t * box.max_t * box.direction[axis];
          }
          ShapeTables tables = world.shapes.tables();
          tables.boxes = &half;
          ShapeId shape = part.shape;
          if (is_triangle) {
            tables.triangles = &part.triangle;
            shape = ShapeId::of(ShapeKind::triangle, 0);
          } else if (shape.kind() == ShapeKind::box) {
            continue;
          }
          const double distance = solve_pair(tables, ShapeId::of(ShapeKind::box, 0), at, shape,
                                             part.pose, NarrowLevel::distance, 0.0, counts)
                                      .distance;
          if (distance <= 0.0) {
            EXPECT_TRUE(swept.contains(part.part)) << id.kind_index();
          }
          if (t == 0.0 && distance <= 0.7) {
            EXPECT_TRUE(near.contains(part.part)) << id.kind_index();
          }
        }
      }
    }
  }
}

TEST(Visits, end_when_told_to) {
  Random random(11);
  World world;
  world.add_shapes(random);
  for (const ShapeId id : world.ids) {
    if (!id.is_composite()) continue;
    int shown = 0;
    const auto once = [](void* context, const Primitive&, double) {
      ++*static_cast<int*>(context);
      return -1.0;
    };
    const BoxSweep all{{-1e9, -1e9, -1e9}, {1e9, 1e9, 1e9}};
    world.composites.visit(id, Pose{}, all, {once, &shown});
    EXPECT_EQ(shown, 1);
    world.composites.visit_near(id, Pose{}, all, 1.0, {once, &shown});
    EXPECT_EQ(shown, 2);
  }
}

}  // namespace
}  // namespace winnow::test
