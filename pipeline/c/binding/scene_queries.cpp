// C binding of SceneQueries (scene_queries.h).

#include <winnow/c/scene_queries.h>

#include "pipeline/c/binding/arguments.h"
#include "pipeline/c/binding/handles.h"
#include "pipeline/c/binding/layout_compatible.h"
#include "pipeline/c/binding/views.h"

namespace winnow::c {
namespace {

[[nodiscard]] SceneHitColumns columns_of(const winnow_scene_hit_columns& given) noexcept {
  return {as_cpp(given.key),
          given.data,
          given.part,
          given.t,
          {given.normal[0], given.normal[1], given.normal[2]},
          {given.point[0], given.point[1], given.point[2]}};
}

/// Writes the list that an answer contains, unless it is an error.
template <typename OfCpp, typename OfC>
[[nodiscard]] winnow_status answer_list(const Answer<std::span<const OfCpp>>& list,
                                        const OfC** first, std::size_t* count) noexcept {
  if (list.status == Status::ok) return_array<OfCpp>(list, first, count);
  return answer(list.status);
}

/// Runs a query with a batch of rays, if the batch is valid.
template <typename Query>
[[nodiscard]] winnow_status query_rays(winnow_scene_queries* queries,
                                       const winnow_shape_ray_batch* rays, Query&& query) noexcept {
  ShapeRayBatch batch;
  const Status status = read_rays(rays, queries->room, batch);
  return answer(status == Status::ok ? query(batch) : status);
}

[[nodiscard]] bool read_rules(winnow_pair_rules given, PairRules& rules) noexcept {
  return read_choice(given, PairRules::none, rules);
}

[[nodiscard]] ShapeCast cast_of(const winnow_shape_cast& given, bool touching) noexcept {
  const double(&direction)[3] = given.direction;
  return {{given.shape},
          *as_cpp(&given.pose),
          {direction[0], direction[1], direction[2]},
          given.max_t,
          touching};
}

[[nodiscard]] winnow_status closest_cast(winnow_scene_queries* queries,
                                         const winnow_shape_cast* cast, bool touching,
                                         const winnow_filter* filter, double tolerance,
                                         winnow_scene_hit* hit) noexcept {
  if (!are_given(queries, cast, hit)) return WINNOW_INVALID_ARGUMENT;
  return answer(queries->value.closest(cast_of(*cast, touching), filter_of(filter), tolerance),
                as_cpp(hit));
}

[[nodiscard]] winnow_status all_cast(winnow_scene_queries* queries, const winnow_shape_cast* cast,
                                     bool touching, const winnow_filter* filter, double tolerance,
                                     const winnow_scene_hit** hits, std::size_t* count) noexcept {
  if (!are_given(queries, cast, hits, count)) return WINNOW_INVALID_ARGUMENT;
  return answer_list(queries->value.all(cast_of(*cast, touching), filter_of(filter), tolerance),
                     hits, count);
}

}  // namespace
}  // namespace winnow::c

using namespace winnow::c;

winnow_status winnow_scene_queries_create(const winnow_scene* scene, const winnow_memory* memory,
                                          winnow_scene_queries** queries) {
  if (!are_given(scene, queries)) return WINNOW_INVALID_ARGUMENT;
  winnow_scene_queries* made = nullptr;
  const winnow_status status = create(memory, &made, scene->value);
  if (status != WINNOW_OK) return status;
  if (made->value.footprint().structure.used == 0) {
    destroy(made);
    return WINNOW_OUT_OF_MEMORY;
  }
  *queries = made;
  return WINNOW_OK;
}

void winnow_scene_queries_destroy(winnow_scene_queries* queries) {
  destroy(queries);
}

winnow_status winnow_scene_queries_closest(winnow_scene_queries* queries,
                                           const winnow_shape_ray* ray, const winnow_filter* filter,
                                           winnow_scene_hit* hit) {
  if (!are_given(queries, ray, hit)) return WINNOW_INVALID_ARGUMENT;
  return answer(queries->value.closest(*as_cpp(ray), filter_of(filter)), as_cpp(hit));
}

winnow_status winnow_scene_queries_any(winnow_scene_queries* queries, const winnow_shape_ray* ray,
                                       const winnow_filter* filter, winnow_scene_hit* hit) {
  if (!are_given(queries, ray, hit)) return WINNOW_INVALID_ARGUMENT;
  return answer(queries->value.any(*as_cpp(ray), filter_of(filter)), as_cpp(hit));
}

winnow_status winnow_scene_queries_all(winnow_scene_queries* queries, const winnow_shape_ray* ray,
                                       const winnow_filter* filter, const winnow_scene_hit** hits,
                                       size_t* count) {
  if (!are_given(queries, ray, hits, count)) return WINNOW_INVALID_ARGUMENT;
  return answer_list(queries->value.all(*as_cpp(ray), filter_of(filter)), hits, count);
}

winnow_status winnow_scene_queries_closest_rays(winnow_scene_queries* queries,
                                                const winnow_shape_ray_batch* rays,
                                                const winnow_filter* filter,
                                                const winnow_scene_hit_columns* hits) {
  if (!are_given(queries, hits)) return WINNOW_INVALID_ARGUMENT;
  return query_rays(queries, rays, [&](const winnow::ShapeRayBatch& batch) {
    return queries->value.closest(batch, columns_of(*hits), filter_of(filter));
  });
}

winnow_status winnow_scene_queries_any_rays(winnow_scene_queries* queries,
                                            const winnow_shape_ray_batch* rays,
                                            const winnow_filter* filter,
                                            const winnow_scene_hit_columns* hits) {
  if (!are_given(queries, hits)) return WINNOW_INVALID_ARGUMENT;
  return query_rays(queries, rays, [&](const winnow::ShapeRayBatch& batch) {
    return queries->value.any(batch, columns_of(*hits), filter_of(filter));
  });
}

winnow_status winnow_scene_queries_all_rays(winnow_scene_queries* queries,
                                            const winnow_shape_ray_batch* rays,
                                            const winnow_filter* filter,
                                            const winnow_scene_hit** hits, const size_t** first) {
  if (!are_given(queries, hits, first)) return WINNOW_INVALID_ARGUMENT;
  winnow::Answer<winnow::SceneHitLists> lists;
  const winnow_status status = query_rays(queries, rays, [&](const winnow::ShapeRayBatch& batch) {
    lists = queries->value.all(batch, filter_of(filter));
    return lists.status;
  });
  if (status != WINNOW_OK) return status;
  std::size_t count = 0;
  return_array(lists.hits, hits, &count);
  return_array(lists.first, first, &count);
  return WINNOW_OK;
}

winnow_status winnow_scene_queries_closest_cast(winnow_scene_queries* queries,
                                                const winnow_shape_cast* cast,
                                                const winnow_filter* filter, double tolerance,
                                                winnow_scene_hit* hit) {
  return closest_cast(queries, cast, true, filter, tolerance, hit);
}

winnow_status winnow_scene_queries_closest_cast_from_touch(winnow_scene_queries* queries,
                                                           const winnow_shape_cast* cast,
                                                           const winnow_filter* filter,
                                                           double tolerance,
                                                           winnow_scene_hit* hit) {
  return closest_cast(queries, cast, false, filter, tolerance, hit);
}

winnow_status winnow_scene_queries_all_cast(winnow_scene_queries* queries,
                                            const winnow_shape_cast* cast,
                                            const winnow_filter* filter, double tolerance,
                                            const winnow_scene_hit** hits, size_t* count) {
  return all_cast(queries, cast, true, filter, tolerance, hits, count);
}

winnow_status winnow_scene_queries_all_cast_from_touch(
    winnow_scene_queries* queries, const winnow_shape_cast* cast, const winnow_filter* filter,
    double tolerance, const winnow_scene_hit** hits, size_t* count) {
  return all_cast(queries, cast, false, filter, tolerance, hits, count);
}

winnow_status winnow_scene_queries_overlap(winnow_scene_queries* queries, winnow_shape_id shape,
                                           const winnow_pose* pose, const winnow_filter* filter,
                                           const winnow_scene_overlap** bodies, size_t* count) {
  if (!are_given(queries, pose, bodies, count)) return WINNOW_INVALID_ARGUMENT;
  return answer_list(queries->value.overlap({shape}, *as_cpp(pose), filter_of(filter)), bodies,
                     count);
}

winnow_status winnow_scene_queries_distance(winnow_scene_queries* queries, winnow_key a,
                                            winnow_key b, double limit, winnow_pair_rules rules,
                                            winnow_scene_distance* answer) {
  winnow::PairRules taken{};
  if (!are_given(queries, answer) || !read_rules(rules, taken)) return WINNOW_INVALID_ARGUMENT;
  return winnow::c::answer(queries->value.distance(*as_cpp(&a), *as_cpp(&b), limit, taken),
                           as_cpp(answer));
}

winnow_status winnow_scene_queries_nearest(winnow_scene_queries* queries, const double point[3],
                                           size_t count, double radius, const winnow_filter* filter,
                                           const winnow_scene_distance** bodies, size_t* found) {
  if (!are_given(queries, point, bodies, found)) return WINNOW_INVALID_ARGUMENT;
  return answer_list(queries->value.nearest(winnow::Vec3d(point), count, radius, filter_of(filter)),
                     bodies, found);
}

winnow_status winnow_scene_queries_least_distance(winnow_scene_queries* queries,
                                                  const winnow_key* a, size_t count_a,
                                                  const winnow_key* b, size_t count_b, double limit,
                                                  winnow_pair_rules rules,
                                                  winnow_set_distance* answer) {
  winnow::PairRules taken{};
  if (!are_given(queries, answer) || !read_rules(rules, taken)) return WINNOW_INVALID_ARGUMENT;
  if (!is_array(a, count_a) || !is_array(b, count_b)) return WINNOW_INVALID_ARGUMENT;
  return winnow::c::answer(
      queries->value.least_distance(as_cpp_span(a, count_a), as_cpp_span(b, count_b), limit, taken),
      as_cpp(answer));
}

winnow_status winnow_scene_queries_overlaps(winnow_scene_queries* queries, const winnow_key* a,
                                            size_t count_a, const winnow_key* b, size_t count_b,
                                            size_t most, winnow_pair_rules rules,
                                            const winnow_key_pair** pairs, size_t* count) {
  winnow::PairRules taken{};
  if (!are_given(queries, pairs, count) || !read_rules(rules, taken)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  if (!is_array(a, count_a) || !is_array(b, count_b)) return WINNOW_INVALID_ARGUMENT;
  return answer_list(
      queries->value.overlaps(as_cpp_span(a, count_a), as_cpp_span(b, count_b), most, taken), pairs,
      count);
}

winnow_status winnow_scene_queries_any_contact(winnow_scene_queries* queries, const winnow_key* a,
                                               size_t count_a, const winnow_key* b, size_t count_b,
                                               double contact_margin, winnow_pair_rules rules,
                                               winnow_key_pair* pair) {
  winnow::PairRules taken{};
  if (!are_given(queries, pair) || !read_rules(rules, taken)) return WINNOW_INVALID_ARGUMENT;
  if (!is_array(a, count_a) || !is_array(b, count_b)) return WINNOW_INVALID_ARGUMENT;
  return answer(queries->value.any_contact(as_cpp_span(a, count_a), as_cpp_span(b, count_b),
                                           contact_margin, taken),
                as_cpp(pair));
}

winnow_status winnow_scene_queries_any_contact_in_scene(winnow_scene_queries* queries,
                                                        double contact_margin,
                                                        winnow_pair_rules rules,
                                                        winnow_key_pair* pair) {
  winnow::PairRules taken{};
  if (!are_given(queries, pair) || !read_rules(rules, taken)) return WINNOW_INVALID_ARGUMENT;
  return answer(queries->value.any_contact(contact_margin, taken), as_cpp(pair));
}

winnow_status winnow_scene_queries_footprint(const winnow_scene_queries* queries,
                                             winnow_footprint* footprint) {
  if (queries == nullptr) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(queries, queries->value.footprint(), queries->room.bytes(), footprint);
}
