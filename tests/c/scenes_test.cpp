// Scenes, their contacts, groups, queries and snapshots in C, compared with C++ calls on the same
// objects.

#include "tests/c/world_of_c.h"

#include <winnow/pipeline/contact_groups.h>
#include <winnow/pipeline/scene_queries.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace winnow::test {
namespace {

constexpr std::size_t kBodies = SceneOfC::kBodies;
constexpr winnow_scene_filter* kAll = nullptr;
const SceneFilter kEven{.predicate = {[](void*, Key key, ClientData) { return key.id % 2 == 0; }}};

void expect_columns(const winnow_contact_columns& of_c, const Contacts& of_cpp) {
  EXPECT_EQ(of_c.level, static_cast<winnow_contact_level>(of_cpp.level()));
  EXPECT_EQ(of_c.pairs, of_cpp.size());
  EXPECT_TRUE(is_column_of(of_c.a, of_cpp.a()));
  EXPECT_TRUE(is_column_of(of_c.b, of_cpp.b()));
  for (std::size_t i = 0; i < of_c.pairs; ++i) {
    EXPECT_EQ(of_c.data_a[i], of_cpp.data_a()[i]);
    EXPECT_EQ(of_c.data_b[i], of_cpp.data_b()[i]);
  }
  EXPECT_TRUE(is_column_of(of_c.event, of_cpp.event()));
  EXPECT_TRUE(is_column_of(of_c.runs, of_cpp.runs()));
  EXPECT_EQ(of_c.run_count, of_cpp.runs().size());
  EXPECT_TRUE(is_column_of(of_c.ended, of_cpp.ended()));
  EXPECT_EQ(of_c.ended_count, of_cpp.ended().size());
  EXPECT_EQ(of_c.cached_pairs, of_cpp.cached_pairs());
  EXPECT_TRUE(is_column_of(of_c.manifold_first, of_cpp.manifold_first()));
  EXPECT_EQ(of_c.manifolds, of_cpp.manifolds());
  for (std::size_t m = 0; m < of_c.manifolds; ++m) {
    EXPECT_EQ(of_c.part_a[m], of_cpp.part_a()[m]);
    EXPECT_EQ(of_c.part_b[m], of_cpp.part_b()[m]);
  }
  EXPECT_TRUE(is_column_of(of_c.distance, of_cpp.distance()));
  EXPECT_TRUE(is_column_of(of_c.error_bound, of_cpp.error_bound()));
  EXPECT_TRUE(is_column_of(of_c.point_first, of_cpp.point_first()));
  EXPECT_EQ(of_c.points, of_cpp.points());
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_TRUE(is_column_of(of_c.normal[axis], of_cpp.normal(axis)));
    EXPECT_TRUE(is_column_of(of_c.point[axis], of_cpp.point(axis)));
  }
  for (std::uint32_t p = 0; p < of_c.points; ++p) {
    EXPECT_EQ(of_c.position[1][p], of_cpp.contact(p).position[1]);
    EXPECT_EQ(of_c.depth[p], of_cpp.contact(p).depth);
    EXPECT_EQ(of_c.feature[p], of_cpp.contact(p).feature);
  }
}

[[nodiscard]] winnow_contact_columns columns_of(const SceneOfC& world) {
  return got<winnow_contact_columns>(winnow_contacts_columns, world.contacts);
}

TEST(CInterface, contacts_are_columns_of_cpp) {
  const SceneOfC world;
  const winnow_scene_room room = {
      sizeof room, {3, kBodies, 0}, 500, WINNOW_LEVEL_MANIFOLD, 200, 300, 1000};
  EXPECT_EQ(winnow_scene_reserve(world.scene, &room, WINNOW_PAGES_UNTOUCHED), WINNOW_OK);
  EXPECT_EQ(winnow_scene_reserve_contacts(world.scene, world.contacts, &room, WINNOW_PAGES_TOUCHED),
            WINNOW_OK);
  for (winnow_contact_level level = WINNOW_LEVEL_PAIRS; level <= WINNOW_LEVEL_MANIFOLD; ++level) {
    world.collide(level);
    const winnow_contact_columns columns = columns_of(world);
    EXPECT_EQ(columns.level, level);
    EXPECT_GT(columns.pairs, 0U);
    expect_columns(columns, *world.contacts);
  }
  EXPECT_GT(columns_of(world).points, 0U);
  EXPECT_EQ(winnow_scene_remove(world.scene, &world.keys[14], 2), WINNOW_OK);
  world.collide();
  EXPECT_GT(columns_of(world).ended_count, 0U);
  EXPECT_GT(columns_of(world).cached_pairs, 0U);
  expect_columns(columns_of(world), *world.contacts);
  const auto bytes = got<winnow_scene_bytes>(winnow_scene_footprint, world.scene);
  std::size_t reserved =
      bytes.bodies.reserved + bytes.pairs.reserved + bytes.mid_phase.reserved +
      bytes.narrow_phase.reserved +
      reserved_of(got<winnow_footprint>(winnow_contacts_footprint, world.contacts));
  for (const winnow_bytes& set : bytes.partitions) reserved += set.reserved;
  EXPECT_EQ(reserved, world.counted.outstanding);
  EXPECT_EQ(winnow_contacts_clear(world.contacts), WINNOW_OK);
  EXPECT_EQ(columns_of(world).pairs, 0U);
}

TEST(CInterface, bodies_of_a_scene_are_returned) {
  const SceneOfC world;
  const OwnedScene& scene = world.scene;
  world.collide();
  EXPECT_EQ(got<std::size_t>(winnow_scene_size, scene), kBodies);
  EXPECT_EQ(got<std::size_t>(winnow_scene_size_of, scene, WINNOW_BODY_STATE_FIXED), 3U);
  EXPECT_TRUE(got<bool>(winnow_scene_contains, scene, world.keys[3]));
  const auto body = got<winnow_body_definition>(winnow_scene_body, scene, world.keys[5]);
  const BodyDefinition expected = scene->body(world.key(5));
  EXPECT_EQ(body.shape, expected.shape.bits);
  EXPECT_TRUE(same(body.pose, expected.pose));
  EXPECT_EQ(body.state, WINNOW_BODY_STATE_DYNAMIC);
  EXPECT_EQ(body.data, 1015U);
  EXPECT_TRUE(same(got<winnow_key>(winnow_scene_key_of, scene, world.keys[3].id), world.key(3)));
  double origin[3] = {7, 7, 7};
  EXPECT_EQ(winnow_scene_origin(scene, origin), WINNOW_OK);
  EXPECT_EQ(Vec3d(origin), scene->origin());
  const auto set = [&](std::uint8_t state) {
    return got<const winnow_partition*>(winnow_scene_partition, scene, state);
  };
  EXPECT_EQ(got<std::size_t>(winnow_partition_size, set(WINNOW_BODY_STATE_DYNAMIC)), kBodies - 3);
  EXPECT_EQ(set(WINNOW_BODY_STATE_SLEEPING), nullptr);
  std::size_t drawn = 0;
  const winnow_debug_draw draw = {&drawn,
                                  [](void* context, const winnow_aabb*, winnow_colour) {
                                    ++*static_cast<std::size_t*>(context);
                                  },
                                  nullptr, nullptr, nullptr};
  EXPECT_EQ(winnow_scene_debug_draw(scene, &draw, nullptr), WINNOW_OK);
  EXPECT_GE(drawn, kBodies);
  const auto counts = got<winnow_scene_counts>(winnow_scene_statistics, scene);
  const SceneStatistics& own = scene->statistics();
  EXPECT_EQ(counts.body_pairs, own.body_pairs);
  EXPECT_EQ(counts.rejected_by_spheres, own.rejected_by_spheres);
  EXPECT_EQ(counts.convex_pairs, own.convex.pairs);
  EXPECT_EQ(counts.part_recomputed, own.parts.recomputed);
  EXPECT_EQ(counts.part_bounded, own.parts.bounded);
  EXPECT_EQ(winnow_scene_clear(scene), WINNOW_OK);
  EXPECT_EQ(scene->size(), 0U);
}

TEST(CInterface, changed_bodies_have_their_new_values) {
  const SceneOfC world;
  const OwnedScene& scene = world.scene;
  std::array<winnow_pose, 20> poses;
  std::array<std::array<float, 20>, 3> place;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    poses[i] = pose_of_c(4 + i, 1);
    for (std::size_t k = 0; k < 3; ++k) place[k][i] = static_cast<float>(poses[i].position[k]);
  }
  winnow_pose_view view = winnow_poses(poses.data(), poses.size());
  EXPECT_EQ(winnow_scene_move(scene, &world.keys[4], 20, &view), WINNOW_OK);
  EXPECT_TRUE(same(poses[6], scene->body(world.key(10)).pose));
  // Positions only, in float and in double: no body rotates.
  const winnow_pose_view rounded = {{place[0].data(), place[1].data(), place[2].data()},
                                    {},
                                    0,
                                    0,
                                    20,
                                    WINNOW_FLOAT,
                                    WINNOW_FLOAT};
  EXPECT_EQ(winnow_scene_move(scene, &world.keys[4], 20, &rounded), WINNOW_OK);
  EXPECT_EQ(scene->body(world.key(10)).pose.position[0], static_cast<double>(place[0][6]));
  EXPECT_EQ(scene->body(world.key(10)).pose.orientation, c::as_cpp(&poses[6])->orientation);
  for (const void*& column : view.orientation) column = nullptr;
  EXPECT_EQ(winnow_scene_move(scene, &world.keys[4], 20, &view), WINNOW_OK);
  EXPECT_TRUE(same(poses[6], scene->body(world.key(10)).pose));
  EXPECT_EQ(winnow_scene_move(scene, &world.keys[4], 19, &view), WINNOW_SIZE_MISMATCH);
  EXPECT_EQ(winnow_scene_set_body_state(scene, &world.keys[10], 2, WINNOW_BODY_STATE_SLEEPING),
            WINNOW_OK);
  EXPECT_EQ(scene->size(BodyState::sleeping), 2U);
  EXPECT_EQ(winnow_scene_set_shape(scene, world.keys[12], world.shapes.convex[0]), WINNOW_OK);
  EXPECT_EQ(scene->body(world.key(12)).shape.bits, world.shapes.convex[0]);
  const winnow_object_filter ghost = {0, 0, 0};
  EXPECT_EQ(winnow_scene_set_filter(scene, world.keys[13], &ghost), WINNOW_OK);
  EXPECT_EQ(scene->body(world.key(13)).filter, (ObjectFilter{0, 0, 0}));
  const std::array<winnow_key_pair, 2> strangers{
      {{world.keys[10], world.keys[11]}, {world.keys[9], world.keys[8]}}};
  EXPECT_EQ(winnow_scene_set_ignored(scene, strangers.data(), 2, true), WINNOW_OK);
  EXPECT_EQ(winnow_scene_set_ignored(scene, &strangers[1], 1, false), WINNOW_OK);
  EXPECT_TRUE(got<bool>(winnow_scene_is_ignored, scene, world.keys[11], world.keys[10]));
  EXPECT_FALSE(got<bool>(winnow_scene_is_ignored, scene, world.keys[8], world.keys[9]));
}

TEST(CInterface, groups_of_contacts_equal_cpp) {
  const SceneOfC world;
  world.collide(WINNOW_LEVEL_BOOLEAN);
  const OwnedGroups groups(winnow_contact_groups_create, nullptr);
  for (const auto make : {winnow_scene_islands, winnow_scene_colours}) {
    EXPECT_EQ(make(world.scene, world.contacts, groups), WINNOW_OK);
    EXPECT_GT(groups->size(), 0U);
    EXPECT_EQ(got<std::size_t>(winnow_contact_groups_size, groups), groups->size());
    EXPECT_TRUE(
        is_array_of(got_all<std::uint32_t>(winnow_contact_groups_group, groups), groups->group()));
    for (std::size_t group = 0; group < groups->size(); ++group) {
      EXPECT_TRUE(is_array_of(got_all<std::uint32_t>(winnow_contact_groups_pairs, groups, group),
                              groups->pairs(group)));
    }
  }
  const std::uint32_t* pairs = nullptr;
  std::size_t count = 0;
  EXPECT_EQ(winnow_contact_groups_pairs(groups, groups->size(), &pairs, &count),
            WINNOW_INVALID_ARGUMENT);
  EXPECT_GT(got<winnow_footprint>(winnow_contact_groups_footprint, groups).results.reserved, 0U);
  EXPECT_EQ(winnow_contact_groups_clear(groups), WINNOW_OK);
  EXPECT_EQ(groups->size(), 0U);
}

TEST(CInterface, loaded_scene_collides_as_the_saved_one) {
  const SceneOfC world;
  const SceneOfC other;
  // Pools with user shapes cannot be saved.
  const OwnedSnapshot none(winnow_snapshot_create, nullptr);
  EXPECT_EQ(winnow_shape_pool_save(world.shapes.pool, none), WINNOW_UNSUPPORTED);
  EXPECT_EQ(winnow_shape_pool_remove(world.shapes.pool, world.shapes.convex[9]), WINNOW_OK);
  world.collide();
  EXPECT_EQ(winnow_scene_remove(world.scene, &world.keys[20], 3), WINNOW_OK);
  world.collide();
  const auto saved = [](auto save, const auto&... given) {
    const OwnedSnapshot snapshot(winnow_snapshot_create, nullptr);
    EXPECT_EQ(save(given..., snapshot), WINNOW_OK);
    const auto bytes = got_all<std::uint8_t>(winnow_snapshot_bytes, snapshot);
    return std::vector<std::uint8_t>(bytes.begin(), bytes.end());
  };
  const auto shapes = saved(winnow_shape_pool_save, world.shapes.pool);
  const auto composites = saved(winnow_composite_pool_save, world.shapes.composites);
  const auto scene = saved(winnow_scene_save, world.scene);
  const auto contacts = saved(winnow_scene_save_contacts, world.scene, world.contacts);
  EXPECT_EQ(winnow_shape_pool_load(other.shapes.pool, shapes.data(), shapes.size()), WINNOW_OK);
  EXPECT_EQ(
      winnow_composite_pool_load(other.shapes.composites, composites.data(), composites.size()),
      WINNOW_OK);
  EXPECT_EQ(winnow_scene_load(other.scene, scene.data(), scene.size() - 1),
            WINNOW_INVALID_ARGUMENT);
  EXPECT_EQ(winnow_scene_load(other.scene, scene.data(), scene.size()), WINNOW_OK);
  EXPECT_EQ(
      winnow_scene_load_contacts(other.scene, contacts.data(), contacts.size(), other.contacts),
      WINNOW_OK);
  EXPECT_EQ(columns_of(other).pairs, columns_of(world).pairs);
  world.collide();
  other.collide();
  expect_columns(columns_of(other), *other.contacts);
  EXPECT_TRUE(same_all(other.contacts->distance(), world.contacts->distance()));
  EXPECT_EQ(other.contacts->cached_pairs(), world.contacts->cached_pairs());
}

/// A refreshed scene, queries in C, and others in C++ for comparison.
struct QueriesOfC {
  QueriesOfC()
      : queries(winnow_scene_queries_create, static_cast<const winnow_scene*>(world.scene),
                nullptr),
        others(*world.scene) {
    EXPECT_EQ(winnow_scene_refresh(world.scene), WINNOW_OK);
  }

  SceneOfC world;
  OwnedQueries queries;
  SceneQueries others;
};

TEST(CInterface, rays_hit_the_bodies_of_cpp) {
  QueriesOfC all;
  const OwnedQueries& queries = all.queries;
  const winnow_shape_ray ray = {{3.2, 1.3, 5}, {0.1, 0.2, -1}, 0.5, 20};
  const ShapeRay& same_ray = *c::as_cpp(&ray);
  winnow_scene_filter even = WINNOW_SCENE_FILTER;
  even.accept = [](void*, winnow_key key, std::uint64_t) { return key.id % 2 == 0; };
  EXPECT_TRUE(same(got<winnow_scene_hit>(winnow_scene_queries_closest, queries, &ray, &even),
                   all.others.closest(same_ray, kEven)));
  EXPECT_TRUE(same(got<winnow_scene_hit>(winnow_scene_queries_any, queries, &ray, kAll),
                   all.others.any(same_ray)));
  const std::span<const SceneHit> expected = all.others.all(same_ray);
  EXPECT_TRUE(
      same_all(got_all<winnow_scene_hit>(winnow_scene_queries_all, queries, &ray, kAll), expected));
  ASSERT_FALSE(expected.empty());
  const Key first = expected[0].key;
  EXPECT_TRUE(
      same_all(got_all<winnow_scene_crossing>(winnow_scene_queries_crossings, queries, &ray, kAll),
               std::span<const SceneCrossing>(all.others.crossings(same_ray))));
  winnow_scene_filter others = WINNOW_SCENE_FILTER;
  others.layer = 5;
  others.ignored = {first.id, first.stamp};
  const SceneFilter same_others{.layer = 5, .ignored = first};
  EXPECT_TRUE(same(got<winnow_scene_hit>(winnow_scene_queries_closest, queries, &ray, &others),
                   all.others.closest(same_ray, same_others)));
  EXPECT_GT(got<winnow_footprint>(winnow_scene_queries_footprint, queries).structure.used, 0U);
}

TEST(CInterface, columns_of_float_rays_hit_bodies) {
  QueriesOfC all;
  constexpr std::size_t kRays = 16;
  std::array<std::array<float, kRays>, 8> rays{};
  std::vector<ShapeRay> single;
  for (std::size_t i = 0; i < kRays; ++i) {
    const auto x = static_cast<double>(i);
    single.push_back({{0.5 * x, 0.25 * x, 4}, {0.125, 0, -1}, 0.25, 10});
    for (std::size_t k = 0; k < 3; ++k) {
      rays[k][i] = static_cast<float>(single[i].origin[k]);
      rays[3 + k][i] = static_cast<float>(single[i].direction[k]);
    }
    rays[6][i] = 0.25F;
    rays[7][i] = 10.0F;
  }
  const winnow_shape_ray_batch batch = {{rays[0].data(), rays[1].data(), rays[2].data()},
                                        {rays[3].data(), rays[4].data(), rays[5].data()},
                                        rays[6].data(),
                                        rays[7].data(),
                                        kRays,
                                        0,
                                        WINNOW_FLOAT};
  std::array<winnow_key, kRays> key;
  std::array<std::uint64_t, kRays> data;
  std::array<std::uint32_t, kRays> part;
  std::array<std::array<double, kRays>, 7> numbers;
  const winnow_scene_hit_columns columns = {
      key.data(),
      data.data(),
      part.data(),
      numbers[0].data(),
      {numbers[1].data(), numbers[2].data(), numbers[3].data()},
      {numbers[4].data(), numbers[5].data(), numbers[6].data()}};
  EXPECT_EQ(winnow_scene_queries_closest_rays(all.queries, &batch, kAll, &columns), WINNOW_OK);
  for (std::size_t i = 0; i < kRays; ++i) {
    SceneHit expected = all.others.closest(single[i]);
    if (!expected) expected.t = std::numeric_limits<double>::infinity();
    const winnow_scene_hit hit = {key[i],
                                  data[i],
                                  part[i],
                                  numbers[0][i],
                                  {numbers[1][i], numbers[2][i], numbers[3][i]},
                                  {numbers[4][i], numbers[5][i], numbers[6][i]}};
    EXPECT_TRUE(same(hit, expected)) << i;
  }
  EXPECT_EQ(winnow_scene_queries_any_rays(all.queries, &batch, kAll, &columns), WINNOW_OK);
  for (std::size_t i = 0; i < kRays; ++i) {
    EXPECT_EQ(key[i].id == WINNOW_NO_OBJECT, !all.others.any(single[i]));
  }
  const winnow_scene_hit* hits = nullptr;
  const std::size_t* first = nullptr;
  EXPECT_EQ(winnow_scene_queries_all_rays(all.queries, &batch, kAll, &hits, &first), WINNOW_OK);
  const SceneHitLists lists = all.others.all(ShapeRayBatch(single));
  EXPECT_TRUE(same_all(std::span(hits, first[kRays]), lists.hits));
  EXPECT_TRUE(same_all(std::span(first, kRays + 1), lists.first));
}

TEST(CInterface, shapes_cast_and_overlap_as_in_cpp) {
  QueriesOfC all;
  const OwnedQueries& queries = all.queries;
  const winnow_shape_id ball = all.world.shapes.convex[0];
  winnow_shape_cast cast = WINNOW_SHAPE_CAST;
  cast.shape = ball;
  cast.pose.position[0] = 0.2;
  cast.pose.position[1] = 1.3;
  cast.pose.position[2] = 0.8;
  cast.direction[1] = 0.1;
  cast.max_t = 20.0;
  constexpr double kTolerance = WINNOW_CAST_TOLERANCE;
  for (const bool touching : {true, false}) {
    const ShapeCast same_cast{
        {ball}, *c::as_cpp(&cast.pose), Vec3d(cast.direction), 20.0, touching};
    const auto closest =
        touching ? winnow_scene_queries_closest_cast : winnow_scene_queries_closest_cast_from_touch;
    const auto every =
        touching ? winnow_scene_queries_all_cast : winnow_scene_queries_all_cast_from_touch;
    EXPECT_TRUE(same(got<winnow_scene_hit>(closest, queries, &cast, kAll, kTolerance),
                     all.others.closest(same_cast)));
    const std::span<const SceneHit> expected = all.others.all(same_cast);
    EXPECT_TRUE(
        same_all(got_all<winnow_scene_hit>(every, queries, &cast, kAll, kTolerance), expected));
  }
  const std::span<const SceneOverlap> expected = all.others.overlap({ball}, *c::as_cpp(&cast.pose));
  EXPECT_TRUE(same_all(
      got_all<winnow_scene_overlap>(winnow_scene_queries_overlap, queries, ball, &cast.pose, kAll),
      expected));
  const std::span<const SceneDistance> near =
      all.others.distances({ball}, *c::as_cpp(&cast.pose), 0.5);
  EXPECT_TRUE(same_all(got_all<winnow_scene_distance>(winnow_scene_queries_distances, queries, ball,
                                                      &cast.pose, 0.5, kAll),
                       near));
}

TEST(CInterface, distances_and_sets_of_bodies_equal_cpp) {
  QueriesOfC all;
  const OwnedQueries& queries = all.queries;
  SceneQueries& others = all.others;
  const winnow_key* const keys = all.world.keys.data();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(
      same(got<winnow_scene_distance>(winnow_scene_queries_distance, queries, keys[1], keys[30],
                                      infinity, WINNOW_PAIR_RULES_NONE),
           others.distance(all.world.key(1), all.world.key(30), infinity, PairRules::none)));
  const double point[3] = {2.0, 0.0, 0.6};
  const std::span<const SceneDistance> near = others.nearest(Vec3d(point), 5, 10.0);
  EXPECT_TRUE(same_all(
      got_all<winnow_scene_distance>(winnow_scene_queries_nearest, queries, point, 5U, 10.0, kAll),
      near));
  const std::span<const Key> a = c::as_cpp_span(keys + 4, 6);
  const std::span<const Key> b = c::as_cpp_span(keys + 10, 18);
  for (const winnow_pair_rules rules : {WINNOW_PAIR_RULES_SCENE, WINNOW_PAIR_RULES_NONE}) {
    const auto same_rules = static_cast<PairRules>(rules);
    EXPECT_TRUE(same(got<winnow_set_distance>(winnow_scene_queries_least_distance, queries,
                                              keys + 4, 6U, keys + 10, 18U, 1e9, rules),
                     others.least_distance(a, b, 1e9, same_rules)));
    const std::span<const KeyPair> pairs = others.overlaps(a, b, 7, same_rules);
    EXPECT_TRUE(same_all(got_all<winnow_key_pair>(winnow_scene_queries_overlaps, queries, keys + 4,
                                                  6U, keys + 10, 18U, 7U, rules),
                         pairs));
    EXPECT_TRUE(same(got<winnow_key_pair>(winnow_scene_queries_any_contact, queries, keys + 4, 6U,
                                          keys + 10, 18U, 0.25, rules),
                     others.any_contact(a, b, 0.25, same_rules)));
    EXPECT_TRUE(
        same(got<winnow_key_pair>(winnow_scene_queries_any_contact_in_scene, queries, 0.25, rules),
             others.any_contact(0.25, same_rules)));
  }
}

}  // namespace
}  // namespace winnow::test
