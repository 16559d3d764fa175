// C binding of the queries of Partition: pairs, casts, regions, nearest objects, debug drawing.

#include <winnow/c/partition.h>

#include "pipeline/c/binding/arguments.h"
#include "pipeline/c/binding/drawing.h"
#include "pipeline/c/binding/handles.h"
#include "pipeline/c/binding/layout_compatible.h"
#include "pipeline/c/binding/options.h"
#include "pipeline/c/binding/views.h"

#include <winnow/core/cast.h>
#include <winnow/core/region.h>

namespace winnow::c {

bool read_options(const winnow_pair_options* given, PairOptions& options) noexcept {
  winnow_pair_options own{};
  if (!read_sized(given, own) || !read_choice(own.order, Order::canonical, options.order)) {
    return false;
  }
  options.incremental = own.anew == 0;
  options.predicate = {own.accept, own.context};
  return true;
}

namespace {

[[nodiscard]] bool read_cast(const winnow_cast* given, Cast& cast) noexcept {
  if (given == nullptr) return false;
  const Eigen::Vector3f direction(given->direction);
  switch (given->kind) {
    case WINNOW_CAST_RAY:
      cast = Ray{Eigen::Vector3f(given->from.origin), direction, given->min_t, given->max_t};
      return true;
    case WINNOW_CAST_BOX:
      cast = BoxCast{*as_cpp(&given->from.box), direction, given->min_t, given->max_t};
      return true;
    case WINNOW_CAST_SPHERE:
      cast = SphereCast{*as_cpp(&given->from.sphere), direction, given->min_t, given->max_t};
      return true;
    case WINNOW_CAST_CAPSULE:
      cast = CapsuleCast{*as_cpp(&given->from.capsule), direction, given->min_t, given->max_t};
      return true;
    default:
      return false;
  }
}

[[nodiscard]] bool read_region(const winnow_region* given, Region& region) noexcept {
  if (given == nullptr) return false;
  switch (given->kind) {
    case WINNOW_REGION_POINT:
      region = Eigen::Vector3f(given->of.point);
      return true;
    case WINNOW_REGION_BOX:
      region = *as_cpp(&given->of.box);
      return true;
    case WINNOW_REGION_ORIENTED_BOX:
      region = oriented_box_of(given->of.oriented_box);
      return true;
    case WINNOW_REGION_SPHERE:
      region = *as_cpp(&given->of.sphere);
      return true;
    case WINNOW_REGION_CAPSULE:
      region = *as_cpp(&given->of.capsule);
      return true;
    case WINNOW_REGION_FRUSTUM:
      region = *as_cpp(&given->of.frustum);
      return true;
    case WINNOW_REGION_PLANES:
      if (!is_array(given->of.planes.planes, given->of.planes.count)) return false;
      region = std::span<const Plane>(as_cpp_span(given->of.planes.planes, given->of.planes.count));
      return true;
    default:
      return false;
  }
}

/// Converts the columns that receive hits.
[[nodiscard]] HitColumns columns_of(const winnow_hit_columns& given) noexcept {
  return {as_cpp(given.key), given.data, given.t};
}

[[nodiscard]] bool read_ray_batch(const winnow_ray_batch* given, RayBatch& rays) noexcept {
  if (given == nullptr) return false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!is_array(given->origin[axis], given->count) ||
        !is_array(given->direction[axis], given->count)) {
      return false;
    }
    rays.origin[axis] = given->origin[axis];
    rays.direction[axis] = given->direction[axis];
  }
  rays.min_t = given->min_t;
  rays.max_t = given->max_t;
  rays.count = given->count;
  rays.stride = given->stride != 0 ? given->stride : sizeof(float);
  return true;
}

}  // namespace
}  // namespace winnow::c

using namespace winnow::c;

winnow_status winnow_partition_reserve_pairs(const winnow_partition* partition,
                                             winnow_pair_buffer* out, size_t pairs,
                                             winnow_pages pages) {
  winnow::Pages touch{};
  if (!are_given(partition, out) || !read_choice(pages, winnow::Pages::prefaulted, touch)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  return answer(partition->target->reserve_pairs(out->value, pairs, touch));
}

winnow_status winnow_partition_reserve_events(const winnow_partition* partition,
                                              winnow_pair_events* out, size_t pairs,
                                              bool with_pairs, winnow_pages pages) {
  winnow::Pages touch{};
  if (!are_given(partition, out) || !read_choice(pages, winnow::Pages::prefaulted, touch)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  return answer(partition->target->reserve_events(out->value, pairs, with_pairs, touch));
}

winnow_status winnow_partition_refresh(const winnow_partition* partition) {
  if (partition == nullptr) return WINNOW_INVALID_ARGUMENT;
  return answer(partition->target->refresh());
}

winnow_status winnow_partition_self_pairs(const winnow_partition* partition,
                                          winnow_pair_buffer* out, winnow_pair_events* events,
                                          const winnow_pair_options* options) {
  winnow::PairOptions read;
  if (partition == nullptr || (out == nullptr && events == nullptr) ||
      !read_options(options, read)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  if (events == nullptr) return answer(partition->target->self_pairs(out->value, read));
  if (out == nullptr) return answer(partition->target->self_pairs(events->value, read));
  return answer(partition->target->self_pairs(out->value, events->value, read));
}

winnow_status winnow_partition_pairs_with(const winnow_partition* partition,
                                          const winnow_partition* other, winnow_pair_buffer* out,
                                          const winnow_pair_options* options) {
  winnow::PairOptions read;
  if (!are_given(partition, other, out) || !read_options(options, read)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  return answer(partition->target->pairs_with(*other->target, out->value, read));
}

winnow_status winnow_partition_closest(const winnow_partition* partition, const winnow_cast* cast,
                                       const winnow_filter* filter, winnow_hit* hit) {
  winnow::Cast read;
  if (!are_given(partition, hit) || !read_cast(cast, read)) return WINNOW_INVALID_ARGUMENT;
  return answer(partition->target->closest(read, filter_of(filter)), as_cpp(hit));
}

winnow_status winnow_partition_any(const winnow_partition* partition, const winnow_cast* cast,
                                   const winnow_filter* filter, winnow_hit* hit) {
  winnow::Cast read;
  if (!are_given(partition, hit) || !read_cast(cast, read)) return WINNOW_INVALID_ARGUMENT;
  return answer(partition->target->any(read, filter_of(filter)), as_cpp(hit));
}

winnow_status winnow_partition_all(const winnow_partition* partition, const winnow_cast* cast,
                                   const winnow_filter* filter, winnow_hit_buffer* hits) {
  winnow::Cast read;
  if (!are_given(partition, hits) || !read_cast(cast, read)) return WINNOW_INVALID_ARGUMENT;
  return answer(partition->target->all(read, hits->value, filter_of(filter)));
}

winnow_status winnow_partition_closest_rays(const winnow_partition* partition,
                                            const winnow_ray_batch* rays,
                                            const winnow_filter* filter,
                                            const winnow_hit_columns* hits) {
  winnow::RayBatch read;
  if (!are_given(partition, hits) || !read_ray_batch(rays, read)) return WINNOW_INVALID_ARGUMENT;
  return answer(partition->target->closest(read, columns_of(*hits), filter_of(filter)));
}

winnow_status winnow_partition_any_rays(const winnow_partition* partition,
                                        const winnow_ray_batch* rays, const winnow_filter* filter,
                                        const winnow_hit_columns* hits) {
  winnow::RayBatch read;
  if (!are_given(partition, hits) || !read_ray_batch(rays, read)) return WINNOW_INVALID_ARGUMENT;
  return answer(partition->target->any(read, columns_of(*hits), filter_of(filter)));
}

winnow_status winnow_partition_all_rays(const winnow_partition* partition,
                                        const winnow_ray_batch* rays, const winnow_filter* filter,
                                        winnow_hit_buffer* hits) {
  winnow::RayBatch read;
  if (!are_given(partition, hits) || !read_ray_batch(rays, read)) return WINNOW_INVALID_ARGUMENT;
  return answer(partition->target->all(read, hits->value, filter_of(filter)));
}

winnow_status winnow_partition_overlap(const winnow_partition* partition,
                                       const winnow_region* region, const winnow_filter* filter,
                                       winnow_order order, winnow_overlap_buffer* objects) {
  winnow::Region read;
  winnow::Order sorted{};
  if (!are_given(partition, objects) || !read_region(region, read) ||
      !read_choice(order, winnow::Order::canonical, sorted)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  return answer(partition->target->overlap(read, objects->value, filter_of(filter), sorted));
}

winnow_status winnow_partition_overlap_boxes(const winnow_partition* partition,
                                             const winnow_box_view* boxes,
                                             const winnow_filter* filter, winnow_order order,
                                             winnow_pair_buffer* out) {
  winnow::Order sorted{};
  if (!are_given(partition, out) || !read_choice(order, winnow::Order::canonical, sorted)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  winnow::BoxView read;
  const winnow::Status status = read_boxes(boxes, nullptr, out->room, read);
  if (status != winnow::Status::ok) return answer(status);
  return answer(partition->target->overlap(read, out->value, filter_of(filter), sorted));
}

winnow_status winnow_partition_nearest(const winnow_partition* partition, const winnow_aabb* from,
                                       size_t count, float radius, const winnow_filter* filter,
                                       winnow_hit_buffer* hits) {
  if (!are_given(partition, from, hits)) return WINNOW_INVALID_ARGUMENT;
  return answer(
      partition->target->nearest(*as_cpp(from), count, radius, hits->value, filter_of(filter)));
}

winnow_status winnow_partition_debug_draw(const winnow_partition* partition,
                                          const winnow_debug_draw* draw,
                                          const winnow_debug_draw_options* options) {
  winnow::DebugDrawOptions read;
  if (!are_given(partition, draw) || !read_options(options, read)) return WINNOW_INVALID_ARGUMENT;
  CallbackDraw drawing(*draw);
  return answer(partition->target->debug_draw(drawing, read));
}
