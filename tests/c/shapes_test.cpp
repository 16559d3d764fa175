// Shape pools, the narrow phase and times of impact in C, compared with C++ calls on the same
// objects.

#include "tests/c/world_of_c.h"

#include <winnow/pipeline/impacts.h>
#include <winnow/pipeline/narrow_phase.h>

#include <array>
#include <limits>
#include <vector>

namespace winnow::test {
namespace {

TEST(CInterface, convex_shapes_are_stored_as_given) {
  CountedMemory counted;
  const winnow_memory memory = counted.functions();
  const ShapesOfC world(&memory);
  const OwnedShapes& pool = world.pool;
  const ShapeTables& tables = pool->tables();
  EXPECT_EQ(tables.spheres[0].radius, 0.5);
  EXPECT_EQ(tables.capsules[0].half_length, 0.4);
  EXPECT_EQ(tables.boxes[0].half[2], 0.3);
  EXPECT_EQ(tables.cylinders[0].half_length, 0.5);
  EXPECT_EQ(tables.cones[0].radius, 0.5);
  EXPECT_EQ(tables.triangles[0].rounding, 0.1);
  EXPECT_EQ(tables.half_spaces[0].normal[2], 1.0);
  EXPECT_EQ(tables.ellipsoids[0].radius[1], 0.4);
  EXPECT_EQ(tables.tapered_capsules[0].radius[1], 0.2);
  EXPECT_EQ(tables.hulls[1].vertex_count, 4U);
  const auto shape = [&](std::size_t i) {
    return got<winnow_shape>(winnow_shape_pool_shape, pool, world.convex[i]);
  };
  EXPECT_EQ(shape(2).as.box.half[1], 0.4);
  EXPECT_EQ(shape(6).as.half_space.normal[2], 1.0);
  EXPECT_EQ(shape(8).as.tapered_capsule.radius[0], 0.4);
  EXPECT_EQ(shape(9).as.support.function, &farthest_of_cube);
  winnow_shape none;
  EXPECT_EQ(winnow_shape_pool_shape(pool, world.convex[10], &none), WINNOW_INVALID_KEY);

  const winnow_pose pose = pose_of_c(13);
  const winnow_shape_ray ray = {{8, 1, 9}, {-0.2, 0.1, -1}, 0.5, 30};
  for (const winnow_shape_id id : world.convex) {
    EXPECT_TRUE(same(got<winnow_aabb>(winnow_shape_pool_bounds, pool, id, &pose),
                     pool->bounds({id}, *c::as_cpp(&pose))));
    const auto hit = got<winnow_shape_hit>(winnow_cast_ray, pool, id, &pose, &ray);
    const ShapeHit expected = cast_ray(tables, {id}, *c::as_cpp(&pose), *c::as_cpp(&ray));
    EXPECT_EQ(hit.hit, expected.hit);
    EXPECT_EQ(hit.t, expected.t);
    EXPECT_EQ(Vec3d(hit.normal), expected.normal);
  }
  const std::size_t reserved =
      reserved_of(got<winnow_footprint>(winnow_shape_pool_footprint, pool)) +
      reserved_of(got<winnow_footprint>(winnow_composite_pool_footprint, world.composites));
  EXPECT_EQ(reserved, counted.outstanding);
}

TEST(CInterface, removed_shapes_are_not_contained) {
  const ShapesOfC world;
  EXPECT_EQ(winnow_composite_pool_remove(world.composites, world.composite[1]), WINNOW_OK);
  EXPECT_FALSE(got<bool>(winnow_composite_pool_contains, world.composites, world.composite[1]));
  EXPECT_EQ(winnow_shape_pool_remove(world.pool, world.convex[1]), WINNOW_OK);
  EXPECT_FALSE(got<bool>(winnow_shape_pool_contains, world.pool, world.convex[1]));
  EXPECT_EQ(got<std::size_t>(winnow_shape_pool_size, world.pool, WINNOW_SHAPE_CAPSULE), 0U);
  EXPECT_EQ(got<std::size_t>(winnow_shape_pool_size, world.pool, WINNOW_SHAPE_HULL), 2U);
  EXPECT_STREQ(winnow_shape_kind_name(WINNOW_SHAPE_HALF_SPACE), "half_space");
  EXPECT_STREQ(winnow_shape_kind_name(WINNOW_SHAPE_MESH), "mesh");
}

TEST(CInterface, composite_shapes_equal_cpp) {
  const ShapesOfC world;
  const OwnedComposites& pool = world.composites;
  const winnow_pose pose = pose_of_c(13);
  for (const winnow_shape_id id : world.composite) {
    EXPECT_TRUE(same(got<winnow_aabb>(winnow_composite_pool_bounds, pool, id, &pose),
                     pool->bounds({id}, *c::as_cpp(&pose))));
    EXPECT_EQ(got<double>(winnow_composite_pool_radius, pool, id), pool->radius({id}));
    EXPECT_EQ(got<std::size_t>(winnow_composite_pool_parts, pool, id), pool->parts({id}));
    EXPECT_NE(winnow_composite_pool_set_solid(pool, id, true), WINNOW_OK);
    EXPECT_FALSE(got<bool>(winnow_composite_pool_is_solid, pool, id));
  }
  EXPECT_EQ(pool->scale({world.composite[1]})[0], 2.0);
  const winnow_shape_id compound = world.composite[3];
  EXPECT_TRUE(
      is_array_of(got_all<winnow_compound_child>(winnow_composite_pool_children, pool, compound),
                  pool->children({compound})));
  const std::uint32_t parts = pool->parts({compound});
  EXPECT_EQ(parts, 4U);
  for (std::uint32_t part = 0; part < parts; ++part) {
    std::uint32_t child = 0;
    std::uint32_t of_child = 0;
    EXPECT_EQ(winnow_composite_pool_part(pool, compound, part, &child, &of_child), WINNOW_OK);
    EXPECT_EQ(child, pool->part({compound}, part).child);
    EXPECT_EQ(of_child, pool->part({compound}, part).part);
  }
  EXPECT_EQ(got<std::size_t>(winnow_composite_pool_size, pool, WINNOW_SHAPE_MESH), 2U);
}

/// Bodies with all convex shapes, each touching the next.
struct PairsOfBodies {
  static constexpr std::size_t kBodies = 24;

  PairsOfBodies() {
    for (std::size_t i = 0; i < kBodies; ++i) {
      shapes[i] = world.convex[i % world.convex.size()];
      poses[i] = pose_of_c(i);
      if (i > 0) pairs[i - 1] = {static_cast<std::uint32_t>(i - 1), static_cast<std::uint32_t>(i)};
    }
  }

  ShapesOfC world;
  std::array<winnow_shape_id, kBodies> shapes{};
  std::array<winnow_pose, kBodies> poses{};
  std::array<winnow_body_pair, kBodies - 1> pairs{};
};

void expect_columns(const winnow_narrow_columns& of_c, const NarrowResult& of_cpp) {
  EXPECT_EQ(of_c.level, static_cast<winnow_contact_level>(of_cpp.level()));
  EXPECT_EQ(of_c.answers, of_cpp.size());
  EXPECT_TRUE(is_column_of(of_c.pair_of, of_cpp.order()));
  EXPECT_TRUE(is_array_of(std::span(of_c.runs, of_c.run_count), of_cpp.runs()));
  EXPECT_TRUE(is_column_of(of_c.overlap, of_cpp.overlap()));
  EXPECT_TRUE(is_column_of(of_c.distance, of_cpp.distance()));
  EXPECT_TRUE(is_column_of(of_c.error_bound, of_cpp.error_bound()));
  EXPECT_TRUE(is_column_of(of_c.contact_first, of_cpp.contact_first()));
  EXPECT_TRUE(is_column_of(of_c.contact_count, of_cpp.contact_count()));
  EXPECT_EQ(of_c.contacts, of_cpp.contacts());
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_TRUE(is_column_of(of_c.normal[axis], of_cpp.normal(axis)));
    EXPECT_TRUE(is_column_of(of_c.point[axis], of_cpp.point(axis)));
  }
  if (of_cpp.contacts() == 0) return;
  EXPECT_EQ(of_c.position[2], of_cpp.contact_columns().position[2].data());
  EXPECT_EQ(of_c.depth, of_cpp.contact_columns().depth.data());
  EXPECT_EQ(of_c.feature, of_cpp.contact_columns().feature.data());
}

TEST(CInterface, narrow_phase_returns_columns_of_cpp) {
  CountedMemory counted;
  const winnow_memory memory = counted.functions();
  PairsOfBodies bodies;
  const OwnedShapes& pool = bodies.world.pool;
  const OwnedNarrowPhase narrow(winnow_narrow_phase_create, &memory);
  const OwnedNarrowResult result(winnow_narrow_result_create, &memory);
  const winnow_bodies all = {bodies.shapes.data(), bodies.shapes.size(),
                             winnow_poses(bodies.poses.data(), bodies.poses.size())};
  winnow_narrow_options options = WINNOW_NARROW_OPTIONS;
  options.contact_margin = 0.1;
  for (options.level = WINNOW_LEVEL_BOOLEAN; options.level <= WINNOW_LEVEL_MANIFOLD;
       ++options.level) {
    EXPECT_EQ(winnow_narrow_phase_collide(narrow, pool, &all, bodies.pairs.data(),
                                          bodies.pairs.size(), &options, result),
              WINNOW_OK);
    const auto columns = got<winnow_narrow_columns>(winnow_narrow_result_columns, result);
    EXPECT_EQ(columns.level, options.level);
    expect_columns(columns, *result);
    for (std::size_t i = 0; i < columns.answers; ++i) {
      const winnow_body_pair pair = bodies.pairs[columns.pair_of[i]];
      const auto one = got<winnow_pair_answer>(winnow_collide, pool, bodies.shapes[pair.a],
                                               &bodies.poses[pair.a], bodies.shapes[pair.b],
                                               &bodies.poses[pair.b], &options);
      EXPECT_EQ(one.overlap, result->overlaps(i));
      if (options.level == WINNOW_LEVEL_BOOLEAN) continue;
      EXPECT_EQ(one.distance > options.contact_margin,
                columns.distance[i] > options.contact_margin);
    }
  }
  const auto counters = got<winnow_narrow_statistics>(winnow_narrow_phase_statistics, narrow);
  EXPECT_EQ(counters.pairs, bodies.pairs.size());
  EXPECT_EQ(counters.without_lanes, narrow->statistics().without_lanes);
  EXPECT_EQ(reserved_of(got<winnow_footprint>(winnow_narrow_phase_footprint, narrow)) +
                reserved_of(got<winnow_footprint>(winnow_narrow_result_footprint, result)),
            counted.outstanding);
}

TEST(CInterface, narrow_phase_reads_poses_of_float) {
  PairsOfBodies bodies;
  const OwnedNarrowPhase narrow(winnow_narrow_phase_create, nullptr);
  const OwnedNarrowResult result(winnow_narrow_result_create, nullptr);
  struct Place {
    float position[3];
    float orientation[4];
  };
  std::array<Place, PairsOfBodies::kBodies> places;
  std::vector<Pose> rounded;
  for (std::size_t i = 0; i < places.size(); ++i) {
    Pose pose;
    for (std::size_t k = 0; k < 3; ++k) {
      places[i].position[k] = static_cast<float>(bodies.poses[i].position[k]);
      pose.position[k] = static_cast<double>(places[i].position[k]);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      places[i].orientation[k] = static_cast<float>(bodies.poses[i].orientation[k]);
      pose.orientation[k] = static_cast<double>(places[i].orientation[k]);
    }
    rounded.push_back(pose);
  }
  winnow_bodies all = {bodies.shapes.data(), bodies.shapes.size(), {}};
  for (std::size_t k = 0; k < 3; ++k) all.poses.position[k] = &places[0].position[k];
  for (std::size_t k = 0; k < 4; ++k) all.poses.orientation[k] = &places[0].orientation[k];
  all.poses.position_stride = all.poses.orientation_stride = sizeof(Place);
  all.poses.count = places.size();
  const auto collide = [&] {
    return winnow_narrow_phase_collide(narrow, bodies.world.pool, &all, bodies.pairs.data(),
                                       bodies.pairs.size(), nullptr, result);
  };
  EXPECT_EQ(collide(), WINNOW_OK);
  NarrowPhase own;
  NarrowResult expected;
  EXPECT_EQ(own.collide(*bodies.world.pool, {c::shape_ids(all.shapes, all.count), rounded},
                        c::as_cpp_span(bodies.pairs.data(), bodies.pairs.size()), {}, expected),
            Status::ok);
  EXPECT_TRUE(same_all(result->distance(), expected.distance()));
  places[2].position[0] = std::numeric_limits<float>::infinity();
  EXPECT_EQ(collide(), WINNOW_INVALID_POSE);
  EXPECT_EQ(got<std::uint32_t>(winnow_narrow_phase_bad_body, narrow), 2U);
}

TEST(CInterface, motions_equal_cpp) {
  const winnow_pose start = pose_of_c(3);
  winnow_pose end = pose_of_c(11);
  const double linear[3] = {0, 0, -2};
  const double angular[3] = {1, 2, 3};
  const auto between = got<winnow_rigid_motion>(winnow_rigid_motion_between, &start, &end);
  EXPECT_TRUE(same(between, RigidMotion::between(*c::as_cpp(&start), *c::as_cpp(&end))));
  const auto moving =
      got<winnow_rigid_motion>(winnow_rigid_motion_by_velocities, &start, linear, angular, 1.5);
  EXPECT_TRUE(same(
      moving, RigidMotion::by_velocities(*c::as_cpp(&start), Vec3d(linear), Vec3d(angular), 1.5)));
  EXPECT_TRUE(
      same(got<winnow_pose>(winnow_rigid_motion_at, &moving, 0.75), c::as_cpp(&moving)->at(0.75)));
  EXPECT_EQ(winnow_rigid_motion_at(&moving, 2.0, &end), WINNOW_INVALID_ARGUMENT);
  for (double& x : end.orientation) x = 0.0;
  winnow_rigid_motion none;
  EXPECT_EQ(winnow_rigid_motion_between(&start, &end, &none), WINNOW_INVALID_POSE);
}

TEST(CInterface, times_of_impact_are_columns_of_cpp) {
  const ShapesOfC world;
  const std::array<winnow_shape_id, 3> shapes{world.convex[0], world.convex[2], world.composite[3]};
  std::array<winnow_rigid_motion, 3> motions;
  motions.fill(WINNOW_RIGID_MOTION);
  motions[0].travel[0] = 4.0;
  motions[1].start.position[0] = 3.0;
  motions[1].turn[2] = 1.0;
  motions[2].start.position[1] = 9.0;
  const std::array<winnow_body_pair, 3> pairs{{{0, 1}, {1, 2}, {0, 0}}};
  const winnow_moving_bodies bodies = {shapes.data(), motions.data(), 3};
  const OwnedImpactResult result(winnow_impact_result_create, nullptr);
  winnow_impact_options options = WINNOW_IMPACT_OPTIONS;
  const auto find = [&](const winnow_impact_options* given) {
    EXPECT_EQ(winnow_time_of_impact(world.pool, &bodies, pairs.data(), 3, given, result),
              WINNOW_OK);
    return got<winnow_impact_columns>(winnow_impact_result_columns, result);
  };
  EXPECT_EQ(find(nullptr).status[1], WINNOW_UNSUPPORTED);
  options.tolerance = 1e-3;
  options.composites = world.composites;
  const winnow_impact_columns found = find(&options);
  EXPECT_EQ(found.answers, 3U);
  EXPECT_EQ(found.status[1], WINNOW_OK);
  EXPECT_TRUE(is_column_of(found.hit, result->hit()));
  EXPECT_TRUE(is_column_of(found.time, result->time()));
  EXPECT_TRUE(is_column_of(found.gap, result->gap()));
  EXPECT_TRUE(is_column_of(found.error_bound, result->error_bound()));
  EXPECT_TRUE(is_column_of(found.part_a, result->part_a()));
  EXPECT_TRUE(is_column_of(found.part_b, result->part_b()));
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_TRUE(is_column_of(found.normal[axis], result->normal(axis)));
    EXPECT_TRUE(is_column_of(found.point[axis], result->point(axis)));
  }
  ImpactResult expected;
  EXPECT_EQ(time_of_impact(*world.pool,
                           {c::shape_ids(shapes.data(), 3), c::as_cpp_span(motions.data(), 3)},
                           c::as_cpp_span(pairs.data(), 3),
                           {.tolerance = 1e-3, .composites = &*world.composites}, expected),
            Status::ok);
  EXPECT_TRUE(same_all(result->time(), expected.time()));
  EXPECT_TRUE(result->hits(0));
  EXPECT_GT(got<winnow_footprint>(winnow_impact_result_footprint, result).results.used, 0U);
}

}  // namespace
}  // namespace winnow::test
