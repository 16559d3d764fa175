// Generated from pipeline/interface/scene_queries.toml; do not edit.
// clang-format off

#include <winnow/c/scene_queries.h>

#include "pipeline/c/binding/results.h"

using namespace winnow;
using namespace winnow::c;

winnow_status winnow_scene_queries_create(
    const winnow_scene* scene, const winnow_memory* memory, winnow_scene_queries** queries) {
  if (!(are_given(scene, queries))) return WINNOW_INVALID_ARGUMENT;
  return create(memory, queries, of(scene));
}

void winnow_scene_queries_destroy(winnow_scene_queries* queries) {
  destroy(queries);
}

winnow_status winnow_scene_queries_closest(
    winnow_scene_queries* queries, const winnow_shape_ray* ray, const winnow_scene_filter* filter,
    winnow_scene_hit* hit) {
  SceneFilter own_filter{};
  if (!(are_given(queries, ray, hit) && read(filter, own_filter))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(queries).closest((*as_cpp(ray)), own_filter)); }, hit);
}

winnow_status winnow_scene_queries_any(
    winnow_scene_queries* queries, const winnow_shape_ray* ray, const winnow_scene_filter* filter,
    winnow_scene_hit* hit) {
  SceneFilter own_filter{};
  if (!(are_given(queries, ray, hit) && read(filter, own_filter))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(queries).any((*as_cpp(ray)), own_filter)); }, hit);
}

winnow_status winnow_scene_queries_all(
    winnow_scene_queries* queries, const winnow_shape_ray* ray, const winnow_scene_filter* filter,
    const winnow_scene_hit** hits, size_t* count) {
  SceneFilter own_filter{};
  if (!(are_given(queries, ray, hits, count) && read(filter, own_filter))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(queries).all((*as_cpp(ray)), own_filter)); }, hits, count);
}

winnow_status winnow_scene_queries_closest_rays(
    winnow_scene_queries* queries, const winnow_shape_ray_batch* rays,
    const winnow_scene_filter* filter, const winnow_scene_hit_columns* hits) {
  SceneFilter own_filter{};
  SceneHitColumns own_hits{};
  if (!(are_given(queries, rays, hits) && read(filter, own_filter) && read(hits, own_hits))) return WINNOW_INVALID_ARGUMENT;
  ShapeRayBatch own_rays;
  if (const Status bad = read_view(*rays, queries->room, own_rays); bad != Status::ok) {
    return answer(bad);
  }
  return give([&]() -> decltype(auto) { return (of(queries).closest(own_rays, own_hits, own_filter)); });
}

winnow_status winnow_scene_queries_any_rays(
    winnow_scene_queries* queries, const winnow_shape_ray_batch* rays,
    const winnow_scene_filter* filter, const winnow_scene_hit_columns* hits) {
  SceneFilter own_filter{};
  SceneHitColumns own_hits{};
  if (!(are_given(queries, rays, hits) && read(filter, own_filter) && read(hits, own_hits))) return WINNOW_INVALID_ARGUMENT;
  ShapeRayBatch own_rays;
  if (const Status bad = read_view(*rays, queries->room, own_rays); bad != Status::ok) {
    return answer(bad);
  }
  return give([&]() -> decltype(auto) { return (of(queries).any(own_rays, own_hits, own_filter)); });
}

winnow_status winnow_scene_queries_all_rays(
    winnow_scene_queries* queries, const winnow_shape_ray_batch* rays,
    const winnow_scene_filter* filter, const winnow_scene_hit** hits, const size_t** first) {
  SceneFilter own_filter{};
  if (!(are_given(queries, rays, hits, first) && read(filter, own_filter))) return WINNOW_INVALID_ARGUMENT;
  ShapeRayBatch own_rays;
  if (const Status bad = read_view(*rays, queries->room, own_rays); bad != Status::ok) {
    return answer(bad);
  }
  return give([&]() -> decltype(auto) { return (of(queries).all(own_rays, own_filter)); }, hits, first);
}

winnow_status winnow_scene_queries_crossings(
    winnow_scene_queries* queries, const winnow_shape_ray* ray, const winnow_scene_filter* filter,
    const winnow_scene_crossing** points, size_t* count) {
  SceneFilter own_filter{};
  if (!(are_given(queries, ray, points, count) && read(filter, own_filter))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(queries).crossings((*as_cpp(ray)), own_filter)); }, points, count);
}

winnow_status winnow_scene_queries_closest_cast(
    winnow_scene_queries* queries, const winnow_shape_cast* cast, const winnow_scene_filter* filter,
    double tolerance, winnow_scene_hit* hit) {
  ShapeCast own_cast{};
  SceneFilter own_filter{};
  if (!(are_given(queries, cast, hit) && read(cast, own_cast) && read(filter, own_filter))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(queries).closest(own_cast, own_filter, tolerance)); }, hit);
}

winnow_status winnow_scene_queries_all_cast(
    winnow_scene_queries* queries, const winnow_shape_cast* cast, const winnow_scene_filter* filter,
    double tolerance, const winnow_scene_hit** hits, size_t* count) {
  ShapeCast own_cast{};
  SceneFilter own_filter{};
  if (!(are_given(queries, cast, hits, count) && read(cast, own_cast) && read(filter, own_filter))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(queries).all(own_cast, own_filter, tolerance)); }, hits, count);
}

winnow_status winnow_scene_queries_closest_cast_from_touch(
    winnow_scene_queries* queries, const winnow_shape_cast* cast, const winnow_scene_filter* filter,
    double tolerance, winnow_scene_hit* hit) {
  ShapeCast own_cast{};
  SceneFilter own_filter{};
  if (!(are_given(queries, cast, hit) && read(cast, own_cast) && read(filter, own_filter))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(queries).closest(from_touch(own_cast), own_filter, tolerance)); }, hit);
}

winnow_status winnow_scene_queries_all_cast_from_touch(
    winnow_scene_queries* queries, const winnow_shape_cast* cast, const winnow_scene_filter* filter,
    double tolerance, const winnow_scene_hit** hits, size_t* count) {
  ShapeCast own_cast{};
  SceneFilter own_filter{};
  if (!(are_given(queries, cast, hits, count) && read(cast, own_cast) && read(filter, own_filter))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(queries).all(from_touch(own_cast), own_filter, tolerance)); }, hits, count);
}

winnow_status winnow_scene_queries_closest_motion(
    winnow_scene_queries* queries, const winnow_motion_cast* cast,
    const winnow_scene_filter* filter, double tolerance, winnow_scene_hit* hit) {
  MotionCast own_cast{};
  SceneFilter own_filter{};
  if (!(are_given(queries, cast, hit) && read(cast, own_cast) && read(filter, own_filter))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(queries).closest(own_cast, own_filter, tolerance)); }, hit);
}

winnow_status winnow_scene_queries_all_motion(
    winnow_scene_queries* queries, const winnow_motion_cast* cast,
    const winnow_scene_filter* filter, double tolerance, const winnow_scene_hit** hits,
    size_t* count) {
  MotionCast own_cast{};
  SceneFilter own_filter{};
  if (!(are_given(queries, cast, hits, count) && read(cast, own_cast) && read(filter, own_filter))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(queries).all(own_cast, own_filter, tolerance)); }, hits, count);
}

winnow_status winnow_scene_queries_overlap(
    winnow_scene_queries* queries, winnow_shape_id shape, const winnow_pose* pose,
    const winnow_scene_filter* filter, const winnow_scene_overlap** bodies, size_t* count) {
  SceneFilter own_filter{};
  if (!(are_given(queries, pose, bodies, count) && read(filter, own_filter))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(queries).overlap(ShapeId{shape}, (*as_cpp(pose)), own_filter)); }, bodies, count);
}

winnow_status winnow_scene_queries_distances(
    winnow_scene_queries* queries, winnow_shape_id shape, const winnow_pose* pose, double limit,
    const winnow_scene_filter* filter, const winnow_scene_distance** bodies, size_t* count) {
  SceneFilter own_filter{};
  if (!(are_given(queries, pose, bodies, count) && read(filter, own_filter))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(queries).distances(ShapeId{shape}, (*as_cpp(pose)), limit, own_filter)); }, bodies, count);
}

winnow_status winnow_scene_queries_distance(
    winnow_scene_queries* queries, winnow_key a, winnow_key b, double limit,
    winnow_pair_rules rules, winnow_scene_distance* answer) {
  PairRules own_rules{};
  if (!(are_given(queries, answer) && read(rules, own_rules))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(queries).distance(to_cpp(a), to_cpp(b), limit, own_rules)); }, answer);
}

winnow_status winnow_scene_queries_nearest(
    winnow_scene_queries* queries, const double point[3], size_t count, double radius,
    const winnow_scene_filter* filter, const winnow_scene_distance** bodies, size_t* found) {
  SceneFilter own_filter{};
  if (!(are_given(queries, point, bodies, found) && read(filter, own_filter))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(queries).nearest(Vec3d(point), count, radius, own_filter)); }, bodies, found);
}

winnow_status winnow_scene_queries_least_distance(
    winnow_scene_queries* queries, const winnow_key* a, size_t count_a, const winnow_key* b,
    size_t count_b, double limit, winnow_pair_rules rules, winnow_set_distance* answer) {
  PairRules own_rules{};
  if (!(are_given(queries, answer) && is_array(a, count_a) && is_array(b, count_b) && read(rules, own_rules))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(queries).least_distance(as_cpp_span(a, count_a), as_cpp_span(b, count_b), limit, own_rules)); }, answer);
}

winnow_status winnow_scene_queries_overlaps(
    winnow_scene_queries* queries, const winnow_key* a, size_t count_a, const winnow_key* b,
    size_t count_b, size_t most, winnow_pair_rules rules, const winnow_key_pair** pairs,
    size_t* count) {
  PairRules own_rules{};
  if (!(are_given(queries, pairs, count) && is_array(a, count_a) && is_array(b, count_b) && read(rules, own_rules))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(queries).overlaps(as_cpp_span(a, count_a), as_cpp_span(b, count_b), most, own_rules)); }, pairs, count);
}

winnow_status winnow_scene_queries_any_contact(
    winnow_scene_queries* queries, const winnow_key* a, size_t count_a, const winnow_key* b,
    size_t count_b, double contact_margin, winnow_pair_rules rules, winnow_key_pair* pair) {
  PairRules own_rules{};
  if (!(are_given(queries, pair) && is_array(a, count_a) && is_array(b, count_b) && read(rules, own_rules))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(queries).any_contact(as_cpp_span(a, count_a), as_cpp_span(b, count_b), contact_margin, own_rules)); }, pair);
}

winnow_status winnow_scene_queries_any_contact_in_scene(
    winnow_scene_queries* queries, double contact_margin, winnow_pair_rules rules,
    winnow_key_pair* pair) {
  PairRules own_rules{};
  if (!(are_given(queries, pair) && read(rules, own_rules))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(queries).any_contact(contact_margin, own_rules)); }, pair);
}

winnow_status winnow_scene_queries_footprint(
    const winnow_scene_queries* queries, winnow_footprint* footprint) {
  if (!(are_given(queries) && is_sized(footprint))) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(queries, footprint);
}
