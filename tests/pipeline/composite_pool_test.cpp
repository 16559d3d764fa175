// Meshes, height fields and compounds in a CompositePool: input checks, lifetimes, bounds, part
// numbers, and the correction of normals at internal edges
// (CompositePool::correct_surface_contacts).

#include <winnow/core/eigen.h>
#include <winnow/pipeline/scene.h>
#include "tests/pipeline/composite_world.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>
#include <set>
#include <span>
#include <vector>

#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/counting_memory.h"

namespace winnow::test {
namespace {

TEST(CompositePool, bad_input_is_refused) {
  Random random(5);
  CompositeWorld world;
  world.add_shapes(random);
  CompositePool& pool = world.composites;
  const ShapeId mesh = world.ids[14];
  ASSERT_EQ(mesh.composite_kind(), CompositeKind::mesh);
  const double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, inf, -inf, std::nan(""), 1e-200, 1e200}) {
    expect_error(pool.add_scaled(mesh, {1.0, bad, 1.0}), Status::invalid_argument);
  }
  expect_error(pool.add_scaled(world.ids[0], {1.0, 1.0, 1.0}), Status::invalid_key);
  expect_error(pool.add_scaled({}, {1.0, 1.0, 1.0}), Status::invalid_key);
  expect_error(pool.add_compound({}), Status::invalid_shape);
  Pose bad;
  bad.position[1] = std::nan("");
  const CompoundChild nowhere[] = {{world.ids[0], bad}};
  expect_error(pool.add_compound(nowhere), Status::invalid_pose);
  ASSERT_EQ(world.ids[8].composite_kind(), CompositeKind::compound);
  const CompoundChild nested[] = {{world.ids[8], Pose{}}};
  expect_error(pool.add_compound(nested), Status::invalid_key);
  const CompoundChild gone[] = {{ShapeId::of(CompositeKind::mesh, 1000), Pose{}}};
  expect_error(pool.add_compound(gone), Status::invalid_key);
  EXPECT_EQ(pool.remove(world.ids[0]), Status::invalid_key);
  EXPECT_FALSE(pool.contains({}));
  EXPECT_EQ(pool.bounds({}, Pose{}), Aabb{});
}

TEST(CompositePool, triangles_live_until_last_scaled_id_is_removed) {
  Random random(6);
  const Surface surface = soup(random, 30, 2.0, 0.5);
  ShapePool shapes;
  CountingMemory memory;
  CompositePool pool(shapes, &memory);
  const ShapeId first = add(pool, surface);
  ShapeId second = expect_ok(pool.add_scaled(first, {2.0, -1.0, 3.0}));
  ShapeId third = expect_ok(pool.add_scaled(second, {0.5, 1.0, 1.0}));
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

/// Compounds that contain surfaces number their parts child by child.
TEST(CompositePool, part_number_maps_to_child) {
  Random random(8);
  ShapePool shapes;
  CompositePool pool(shapes);
  const ShapeId ball = add(shapes, SphereShape{0.5});
  const ShapeId mesh = add(pool, soup(random, 30, 2.0, 0.5));
  const std::vector<float> heights(12, 1.0F);
  ShapeId field = expect_ok(pool.add_height_field({.heights = heights, .columns = 4, .rows = 3}));
  const CompoundChild children[] = {{ball, {}}, {mesh, {}}, {field, {}}, {mesh, {}}, {ball, {}}};
  ShapeId compound = expect_ok(pool.add_compound(children));
  std::uint32_t number = 0;
  for (std::uint32_t child = 0; child < 5; ++child) {
    const std::uint32_t parts = child % 4 == 0 ? 1 : (child == 2 ? 12 : 30);
    for (std::uint32_t i = 0; i < parts; ++i, ++number) {
      const CompoundPart part = pool.part(compound, number);
      EXPECT_EQ(part.child, child);
      EXPECT_EQ(part.part, parts == 1 ? kWholeShape : i);
    }
  }
  EXPECT_EQ(pool.part(compound, number).child, kWholeShape);
  EXPECT_EQ(pool.part(compound, kWholeShape).child, kWholeShape);
  EXPECT_EQ(pool.part(mesh, 0).child, kWholeShape);
  ShapeId plain = expect_ok(pool.add_compound(std::span(children, 1)));
  EXPECT_EQ(pool.part(plain, 0).child, 0U);
  EXPECT_EQ(pool.part(plain, 1).child, kWholeShape);
}

TEST(CompositePool, child_of_compound_cannot_be_removed) {
  Random random(9);
  ShapePool shapes;
  CompositePool pool(shapes);
  const ShapeId mesh = add(pool, soup(random, 30, 2.0, 0.5));
  ShapeId scaled_mesh = expect_ok(pool.add_scaled(mesh, {2.0, 2.0, 2.0}));
  const CompoundChild child[] = {{scaled_mesh, Pose::at(1, 0, 0)}};
  ShapeId compound = expect_ok(pool.add_compound(child));
  EXPECT_EQ(pool.remove(scaled_mesh), Status::invalid_argument);
  EXPECT_EQ(pool.remove(mesh), Status::ok);
  EXPECT_EQ(pool.remove(compound), Status::ok);
  EXPECT_EQ(pool.remove(scaled_mesh), Status::ok);
}

/// The compounds have 2 children, or 20, which are stored in a tree.
TEST(CompositePool, edited_surface_updates_its_compounds) {
  Random random(10);
  for (const std::size_t children : {2U, 20U}) {
    ShapePool shapes;
    CompositePool pool(shapes);
    Surface surface = soup(random, 30, 2.0, 0.5);
    const ShapeId mesh = add(pool, surface);
    std::vector<float> heights(12, 1.0F);
    ShapeId field = expect_ok(pool.add_height_field({.heights = heights, .columns = 4, .rows = 3}));
    const ShapeId ball = add(shapes, SphereShape{0.1});
    std::vector<CompoundChild> list(children, {ball, {}});
    list[0] = {mesh, Pose::at(5, 0, 0)};
    list[1] = {field, Pose::at(-5, 0, 0)};
    ShapeId compound = expect_ok(pool.add_compound(list));
    const double radius = pool.radius(compound);
    for (Point& vertex : surface.vertices) vertex *= 3.0F;
    ASSERT_EQ(pool.refit_mesh(mesh, std::span<const Point>(surface.vertices)), Status::ok);
    EXPECT_GT(pool.radius(compound), radius + 2.0);
    EXPECT_GE(pool.bounds(compound, {}).max[0], 5.0F + pool.bounds(mesh, {}).max[0]);
    heights[5] = 90.0F;
    ASSERT_EQ(pool.update_height_field(field, 0, 0, {.heights = heights, .columns = 4, .rows = 3}),
              Status::ok);
    EXPECT_GE(pool.bounds(compound, {}).max[2], 90.0F);
    // The compound's tree is updated too: a cast finds the highest sample.
    int visited = 0;
    const MovingBox high{{-10, -10, 89}, {10, 10, 91}};
    mid::visit(pool, compound, {}, high, mid::Solids::hulls,
               {[](void* context, const Primitive&, double limit) {
                  ++*static_cast<int*>(context);
                  return limit;
                },
                &visited});
    EXPECT_GT(visited, 0);
  }
}

TEST(CompositePool, bounds_and_radius_contain_every_part) {
  Random random(7);
  CompositeWorld world;
  world.add_shapes(random);
  for (const ShapeId id : world.ids) {
    if (!id.is_composite()) continue;
    for (int i = 0; i < 5; ++i) {
      const Pose pose = random_pose(random, i < 3 ? 2.0 : 1e6);
      const Aabb box = world.composites.bounds(id, pose);
      const double radius = world.composites.radius(id);
      ASSERT_TRUE(box.is_valid());
      const auto at = as_eigen(pose.position);
      for (const Primitive& part : parts_of(world, id, pose)) {
        Aabb inner;
        double reach = 0.0;
        if (part.shape.kind() == ShapeKind::triangle) {
          ShapePool one;
          inner = one.bounds(add(one, part.triangle), part.pose);
          for (const auto& corner : part.triangle.vertex) {
            const auto from = as_eigen(part.pose.position);
            if (world.composites.mesh(id) != nullptr) {
              reach = (as_eigen(corner) + from - at).norm();
            }
          }
        } else {
          inner = world.shapes.bounds(part.shape, part.pose);
        }
        // Both boxes are rounded outward to float.
        const float slack = 1e-6F * as_eigen(inner.max).cwiseAbs().maxCoeff();
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

/// Contacts of a body with a surface after `correct_surface_contacts`.
struct Landing {
  std::vector<Eigen::Vector3d> normals;  ///< from the body to the surface
  double deepest = std::numeric_limits<double>::infinity();
  std::size_t points = 0;
};

Landing land(const ShapePool& shapes, const CompositePool& pool, ShapeId body, const Pose& at,
             ShapeId surface, const Pose& ground, ContactLevel level, double margin,
             bool ground_first = false) {
  const ShapeId ids[2] = {ground_first ? surface : body, ground_first ? body : surface};
  const Pose poses[2] = {ground_first ? ground : at, ground_first ? at : ground};
  const BodyPair pair[] = {{0, 1}};
  PrimitivePairs pairs;
  EXPECT_EQ(mid::find_primitive_pairs(pool, shapes, {ids, poses}, pair, margin, Execution::serial(),
                                      pairs),
            Status::ok);
  NarrowPhase narrow;
  NarrowResult result;
  EXPECT_EQ(narrow.collide(pairs.tables(shapes),
                           {{pairs.shapes.data(), pairs.shapes.size()},
                            {pairs.poses.data(), pairs.poses.size()}},
                           {pairs.pairs.data(), pairs.pairs.size()},
                           {.level = level, .contact_margin = margin}, result),
            Status::ok);
  std::size_t before = 0;
  for (const double distance : result.distance()) before += distance <= margin ? 1 : 0;
  EXPECT_EQ(mid::correct_surface_contacts({pool, shapes, {ids, poses}, pair}, pairs, margin,
                                          Execution::serial(), result),
            Status::ok);
  Landing landing;
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (!(result.distance()[i] <= margin)) continue;
    const double sign = ground_first ? -1.0 : 1.0;
    landing.normals.emplace_back(sign * result.normal(0)[i], sign * result.normal(1)[i],
                                 sign * result.normal(2)[i]);
    landing.deepest = std::min(landing.deepest, result.distance()[i]);
    if (level != ContactLevel::manifold) continue;
    EXPECT_GE(result.contact_count()[i], 1U);
    landing.points += result.contact_count()[i];
    const ContactPoint first = result.contact(result.contact_first()[i]);
    EXPECT_NEAR(static_cast<double>(first.depth), -result.distance()[i], 1e-5);
  }
  EXPECT_LE(landing.normals.size(), before);
  EXPECT_EQ(landing.normals.empty(), before == 0);
  return landing;
}

const Cut kCuts[] = {Cut::same, Cut::mirrored, Cut::alternating, Cut::random};

TEST(InternalEdges, flat_mesh_gives_only_floor_normals) {
  Random random(8);
  ShapePool shapes;
  CompositePool pool(shapes);
  const ShapeId bodies[] = {add(shapes, SphereShape{0.5}),
                            add(shapes, BoxShape{{0.4, 0.6, 0.5}, 0.0}),
                            add_octahedron(shapes, 0.5), add(shapes, CapsuleShape{0.3, 0.2}),
                            add(shapes, CylinderShape{0.4, 0.5, 0.0})};
  for (const Cut cut : kCuts) {
    const ShapeId floor = add(pool, grid(12, 0.7F, cut, [](float, float) { return 0.0F; }));
    ShapeId scaled_floor = expect_ok(pool.add_scaled(floor, {1.3, -0.8, 2.0}));
    for (int i = 0; i < static_cast<int>(scaled(150)); ++i) {
      const ShapeId body = bodies[random.below(5)];
      // Above vertices, above edges and elsewhere, at about the height at which it rests.
      Pose at = Pose::at(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), 0.0);
      if (random.chance(0.3)) at.position[0] = 0.7 * std::round(at.position[0] / 0.7);
      if (random.chance(0.3)) at.position[1] = 0.7 * std::round(at.position[1] / 0.7);
      const double turn = random.chance(0.3) ? 0.0 : random.uniform(-3.0, 3.0);
      at.orientation[0] = std::cos(turn);
      at.orientation[3] = std::sin(turn);
      at.position[2] = 0.5 + random.uniform(-0.05, 0.009);
      for (const ContactLevel level : {ContactLevel::distance, ContactLevel::manifold}) {
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

TEST(InternalEdges, flat_height_field_gives_only_floor_normals) {
  ShapePool shapes;
  CompositePool pool(shapes);
  const std::vector<float> heights(100, 2.0F);
  ShapeId field = expect_ok(pool.add_height_field({heights, 10, 10, 0, {0.5, 0.5}}));
  const ShapeId ball = add(shapes, SphereShape{0.5});
  for (int i = 0; i < 40; ++i) {
    const Pose at = Pose::at(1.5 + 0.05 * i, 2.0 + 0.013 * i, 2.48);
    const Landing landing =
        land(shapes, pool, ball, at, field, Pose{}, ContactLevel::manifold, 0.01);
    EXPECT_FALSE(landing.normals.empty());
    for (const Eigen::Vector3d& normal : landing.normals) {
      EXPECT_LT((normal + Eigen::Vector3d::UnitZ()).norm(), 1e-12);
    }
  }
}

TEST(InternalEdges, ridges_and_borders_keep_their_normals) {
  ShapePool shapes;
  CompositePool pool(shapes);
  const ShapeId ball = add(shapes, SphereShape{0.5});
  // A roof with its ridge along y at x = 0.
  const ShapeId roof =
      add(pool, grid(8, 0.5F, Cut::same, [](float x, float) { return -std::abs(x); }));
  const Landing on_ridge =
      land(shapes, pool, ball, Pose::at(0.0, 0.1, 0.49), roof, Pose{}, ContactLevel::manifold, 0.0);
  ASSERT_FALSE(on_ridge.normals.empty());
  for (const Eigen::Vector3d& normal : on_ridge.normals) {
    EXPECT_LT((normal + Eigen::Vector3d::UnitZ()).norm(), 1e-9);
  }
  // Beyond the border of a floor the normal points from the ball to the edge.
  const ShapeId floor = add(pool, grid(4, 0.5F, Cut::same, [](float, float) { return 0.0F; }));
  const Landing off = land(shapes, pool, ball, Pose::at(1.3, 0.1, 0.35), floor, Pose{},
                           ContactLevel::manifold, 0.0);
  ASSERT_FALSE(off.normals.empty());
  const Eigen::Vector3d to_edge = Eigen::Vector3d(-0.3, 0.0, -0.35).normalized();
  double nearest = 1.0;
  for (const Eigen::Vector3d& normal : off.normals) {
    nearest = std::min(nearest, (normal - to_edge).norm());
  }
  EXPECT_LT(nearest, 1e-9);
}

TEST(InternalEdges, box_at_corner_of_border_keeps_contact) {
  // The middle one of three triangles touches the border of the surface only with a corner.
  Surface rim;
  rim.vertices = {{0.76816994F, 2.86684918F, -14.9698315F},
                  {0.544054806F, 4.13250637F, -13.4728489F},
                  {1.07880068F, 4.02613926F, -13.4728489F},
                  {0.0F, 2.967F, -14.9698315F},
                  {1.484F, 2.57F, -14.9698315F}};
  rim.corners = {0, 1, 2, 0, 3, 1, 0, 2, 4};
  ShapePool shapes;
  CompositePool pool(shapes);
  const ShapeId mesh = add(pool, rim);
  const ShapeId box = add(shapes, BoxShape{{0.3687, 0.3869, 0.3775}, 0.0});
  const Pose at{{0.361353813885254, 2.5491864294867814, -15.141072528878972},
                {0.448063999, 0.477745563, -0.596184433, 0.464286506}};
  const Landing landing = land(shapes, pool, box, at, mesh, Pose{}, ContactLevel::manifold, 0.0);
  ASSERT_FALSE(landing.normals.empty());
  EXPECT_GT(landing.deepest, -0.01);
}

TEST(InternalEdges, ball_in_valley_gets_both_face_normals) {
  ShapePool shapes;
  CompositePool pool(shapes);
  const ShapeId ball = add(shapes, SphereShape{0.5});
  const ShapeId valley =
      add(pool, grid(8, 0.5F, Cut::alternating, [](float x, float) { return std::abs(x); }));
  const double rest = 0.5 * std::sqrt(2.0) - 0.02;
  for (int i = 0; i < 30; ++i) {
    const Landing landing = land(shapes, pool, ball, Pose::at(0.0005 * i, -0.5 + 0.03 * i, rest),
                                 valley, Pose{}, ContactLevel::manifold, 0.0);
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

TEST(InternalEdges, smoothing_matches_on_threads_and_without_memory) {
  WINNOW_TEST_NEEDS_EXCEPTIONS();
  Random random(9);
  CompositeWorld world;
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
  ASSERT_EQ(mid::find_primitive_pairs(world.composites, world.shapes, world.bodies(), world.pairs,
                                      0.0, Execution::serial(), pairs),
            Status::ok);
  const auto answer = [&](std::pmr::memory_resource* memory, Execution execution,
                          CountingMemory* refusing) {
    auto result = std::make_unique<NarrowResult>(memory);
    winnow::test::answer(world.shapes, pairs, {}, *result);
    if (refusing != nullptr) refusing->refuse_after(0);
    EXPECT_EQ(
        mid::correct_surface_contacts({world.composites, world.shapes, world.bodies(), world.pairs},
                                      pairs, 0.0, execution, *result),
        Status::ok);
    if (refusing != nullptr) refusing->grant_all();
    return result;
  };
  const auto one = answer(std::pmr::get_default_resource(), Execution::serial(), nullptr);
  for (const Workers& workers : all_workers()) {
    const auto other = Threads(workers.threads).run([&] {
      return answer(std::pmr::get_default_resource(), workers.execution(), nullptr);
    });
    ASSERT_EQ(one->size(), other->size());
    ASSERT_EQ(one->contacts(), other->contacts());
    for (std::size_t i = 0; i < one->size(); ++i) {
      EXPECT_EQ(one->distance()[i], other->distance()[i]);
      EXPECT_EQ(one->contact_first()[i], other->contact_first()[i]);
      EXPECT_EQ(one->contact_count()[i], other->contact_count()[i]);
    }
    for (std::size_t i = 0; i < one->contacts(); ++i) {
      EXPECT_EQ(one->contact(i).position[0], other->contact(i).position[0]);
      EXPECT_EQ(one->contact(i).depth, other->contact(i).depth);
    }
  }
  CountingMemory memory;
  const auto refused = answer(&memory, Execution::serial(), &memory);
  for (std::size_t i = 0; i < one->size(); ++i) {
    EXPECT_EQ(one->distance()[i], refused->distance()[i]);
    EXPECT_EQ(one->contact_count()[i] == 0, refused->contact_count()[i] == 0);
  }
}

/// Returns the contacts of the first body, which touches only the ground. Before the points of each
/// manifold, one point has the distance of the manifold as its depth.
std::vector<ContactPoint> points_of_first(const CompositeWorld& world, ShapeId first,
                                          ShapeId ground, std::span<const ShapeId> others,
                                          ContactLevel level) {
  Scene scene(world.shapes, {.structures = {n_squared(), n_squared(), n_squared()},
                             .part_manifolds = true,
                             .composites = &world.composites});
  std::vector<BodyDefinition> bodies(2);
  bodies[0] = {.shape = ground, .state = BodyState::fixed, .data = 1};
  bodies[1] = {.shape = first, .pose = Pose::at(0.01, 0.02, -0.3), .data = 0};
  Random random(10);
  for (std::size_t i = 0; i < 60 && !others.empty(); ++i) {
    BodyDefinition body{.shape = others[i % others.size()], .data = 2 + i};
    // Each other body gets its own ground, far away.
    body.pose = Pose::at(1000.0 * static_cast<double>(i + 1), 0, random.uniform(-0.4, 0.1));
    bodies.push_back(body);
    body = {.shape = ground, .state = BodyState::fixed, .data = 100 + i};
    body.pose = Pose::at(1000.0 * static_cast<double>(i + 1), 0, 0);
    bodies.push_back(body);
  }
  // Move the first body to the end, so that results for the others come before its own.
  std::ranges::rotate(bodies, bodies.begin() + 2);
  std::vector<Key> keys(bodies.size());
  EXPECT_EQ(scene.add(bodies, keys), Status::ok);
  Contacts contacts;
  EXPECT_EQ(scene.collide(level, contacts), Status::ok);
  std::vector<ContactPoint> points;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (contacts.data_a()[i] != 0 && contacts.data_b()[i] != 0) continue;
    for (auto m = contacts.manifold_first()[i]; m < contacts.manifold_first()[i + 1]; ++m) {
      ContactPoint distance{};
      distance.depth = static_cast<float>(contacts.distance()[m]);
      points.push_back(distance);
      if (level != ContactLevel::manifold) continue;
      for (auto p = contacts.point_first()[m]; p < contacts.point_first()[m + 1]; ++p) {
        points.push_back(contacts.contact(p));
      }
    }
  }
  return points;
}

TEST(InternalEdges, smoothing_ignores_other_bodies) {
  CompositeWorld world;
  const ShapeId ground =
      add(world.composites, grid(70, 0.2F, Cut::random, [](float, float) { return 0.0F; }));
  const ShapeId box = add(world.shapes, BoxShape{{6.5, 6.5, 0.5}, 0.0});
  const ShapeId needle = add(world.shapes, CapsuleShape{0.05, 0.6});
  const ShapeId hull = add_octahedron(world.shapes, 0.7);
  // The shortest way out for a needle is sideways, over an internal edge. It is pushed out along
  // the face unless that is several times as far as the deepest contact of its own kind. The
  // contacts of the box must not affect this.
  std::vector<CompoundChild> parts{{box, Pose{}}, {hull, Pose::at(0.05, 3, 0.4)}};
  for (int i = 0; i < 12; ++i) parts.push_back({needle, Pose::at(0.037 * i, -0.41 * i, 0.35)});
  ShapeId first = expect_ok(world.composites.add_compound(parts));
  const ShapeId others[] = {needle, hull, box};
  for (const ContactLevel level : {ContactLevel::distance, ContactLevel::manifold}) {
    const auto single = points_of_first(world, first, ground, {}, level);
    const auto among = points_of_first(world, first, ground, others, level);
    ASSERT_GT(single.size(), 4096U);
    ASSERT_EQ(single.size(), among.size());
    std::size_t differ = 0;
    for (std::size_t i = 0; i < single.size(); ++i) {
      differ += std::memcmp(&single[i], &among[i], sizeof single[i]) == 0 ? 0 : 1;
    }
    EXPECT_EQ(differ, 0U);
  }
}

}  // namespace
}  // namespace winnow::test
