// C binding of CompositePool: meshes, height fields, compounds (shapes.h).

#include <winnow/c/shapes.h>

#include "pipeline/c/binding/arguments.h"
#include "pipeline/c/binding/handles.h"
#include "pipeline/c/binding/layout_compatible.h"
#include "pipeline/c/binding/options.h"
#include "pipeline/c/binding/views.h"

#include <winnow/pipeline/height_field.h>
#include <winnow/pipeline/triangle_mesh.h>

namespace winnow::c {

bool read_options(const winnow_mesh_options* given, MeshOptions& options) noexcept {
  winnow_mesh_options own{};
  if (!read_sized(given, own)) return false;
  take_given(own.active_edge_angle, options.active_edge_angle);
  return true;
}

namespace {

[[nodiscard]] bool read_samples(const winnow_height_samples* given,
                                HeightSamples& samples) noexcept {
  if (given == nullptr || !is_array(given->heights, given->count)) return false;
  samples = {{given->heights, given->count},
             given->columns,
             given->rows,
             given->row_stride,
             {given->spacing[0], given->spacing[1]}};
  return true;
}

}  // namespace
}  // namespace winnow::c

using namespace winnow::c;

winnow_status winnow_composite_pool_create(const winnow_shape_pool* shapes,
                                           const winnow_memory* memory,
                                           winnow_composite_pool** pool) {
  if (shapes == nullptr) return WINNOW_INVALID_ARGUMENT;
  return create(memory, pool, shapes->value);
}

void winnow_composite_pool_destroy(winnow_composite_pool* pool) {
  destroy(pool);
}

winnow_status winnow_composite_pool_add_mesh(winnow_composite_pool* pool,
                                             const winnow_point_view* vertices,
                                             const winnow_index_view* triangles,
                                             const winnow_mesh_options* options,
                                             const winnow_execution* execution,
                                             winnow_shape_id* id) {
  winnow::MeshOptions read;
  winnow::Execution run = winnow::Execution::parallel();
  winnow::PointView points;
  winnow::IndexView corners;
  if (!are_given(pool, id) || !read_options(options, read) || !read_execution(execution, run) ||
      read_points(vertices, points) != winnow::Status::ok ||
      read_triangles(triangles, corners) != winnow::Status::ok) {
    return WINNOW_INVALID_ARGUMENT;
  }
  return answer(pool->value.add_mesh(points, corners, read, run), id);
}

winnow_status winnow_composite_pool_add_scaled(winnow_composite_pool* pool, winnow_shape_id mesh,
                                               const double scale[3], winnow_shape_id* id) {
  if (!are_given(pool, scale, id)) return WINNOW_INVALID_ARGUMENT;
  return answer(pool->value.add_scaled({mesh}, {scale[0], scale[1], scale[2]}), id);
}

winnow_status winnow_composite_pool_refit_mesh(winnow_composite_pool* pool, winnow_shape_id mesh,
                                               const winnow_point_view* vertices,
                                               const winnow_execution* execution) {
  winnow::Execution run = winnow::Execution::parallel();
  winnow::PointView points;
  if (pool == nullptr || !read_execution(execution, run) ||
      read_points(vertices, points) != winnow::Status::ok) {
    return WINNOW_INVALID_ARGUMENT;
  }
  return answer(pool->value.refit_mesh({mesh}, points, run));
}

winnow_status winnow_composite_pool_add_height_field(winnow_composite_pool* pool,
                                                     const winnow_height_samples* samples,
                                                     winnow_shape_id* id) {
  winnow::HeightSamples read;
  if (!are_given(pool, id) || !read_samples(samples, read)) return WINNOW_INVALID_ARGUMENT;
  return answer(pool->value.add_height_field(read), id);
}

winnow_status winnow_composite_pool_update_height_field(winnow_composite_pool* pool,
                                                        winnow_shape_id field, uint32_t column,
                                                        uint32_t row,
                                                        const winnow_height_samples* samples) {
  winnow::HeightSamples read;
  if (pool == nullptr || !read_samples(samples, read)) return WINNOW_INVALID_ARGUMENT;
  return answer(pool->value.update_height_field({field}, column, row, read));
}

winnow_status winnow_composite_pool_add_compound(winnow_composite_pool* pool,
                                                 const winnow_compound_child* children,
                                                 size_t count, winnow_shape_id* id) {
  if (!are_given(pool, id) || !is_array(children, count)) return WINNOW_INVALID_ARGUMENT;
  return answer(pool->value.add_compound(as_cpp_span(children, count)), id);
}

winnow_status winnow_composite_pool_remove(winnow_composite_pool* pool, winnow_shape_id id) {
  if (pool == nullptr) return WINNOW_INVALID_ARGUMENT;
  return answer(pool->value.remove({id}));
}

winnow_status winnow_composite_pool_contains(const winnow_composite_pool* pool, winnow_shape_id id,
                                             bool* contains) {
  if (!are_given(pool, contains)) return WINNOW_INVALID_ARGUMENT;
  *contains = pool->value.contains({id});
  return WINNOW_OK;
}

winnow_status winnow_composite_pool_size(const winnow_composite_pool* pool, winnow_shape_kind kind,
                                         size_t* size) {
  if (!are_given(pool, size) || kind < WINNOW_SHAPE_MESH || kind > WINNOW_SHAPE_HEIGHT_FIELD) {
    return WINNOW_INVALID_ARGUMENT;
  }
  *size = pool->value.size(static_cast<winnow::CompositeKind>(kind));
  return WINNOW_OK;
}

winnow_status winnow_composite_pool_bounds(const winnow_composite_pool* pool, winnow_shape_id id,
                                           const winnow_pose* pose, winnow_aabb* box) {
  if (!are_given(pool, pose, box)) return WINNOW_INVALID_ARGUMENT;
  if (!pool->value.contains({id})) return WINNOW_INVALID_KEY;
  if (!as_cpp(pose)->is_valid()) return WINNOW_INVALID_POSE;
  *as_cpp(box) = pool->value.bounds({id}, *as_cpp(pose));
  return WINNOW_OK;
}

winnow_status winnow_composite_pool_radius(const winnow_composite_pool* pool, winnow_shape_id id,
                                           double* radius) {
  if (!are_given(pool, radius)) return WINNOW_INVALID_ARGUMENT;
  if (!pool->value.contains({id})) return WINNOW_INVALID_KEY;
  *radius = pool->value.radius({id});
  return WINNOW_OK;
}

winnow_status winnow_composite_pool_parts(const winnow_composite_pool* pool, winnow_shape_id id,
                                          size_t* parts) {
  if (!are_given(pool, parts)) return WINNOW_INVALID_ARGUMENT;
  if (!pool->value.contains({id})) return WINNOW_INVALID_KEY;
  *parts = pool->value.parts({id});
  return WINNOW_OK;
}

winnow_status winnow_composite_pool_set_solid(winnow_composite_pool* pool, winnow_shape_id mesh,
                                              bool solid) {
  if (pool == nullptr) return WINNOW_INVALID_ARGUMENT;
  return answer(pool->value.set_solid({mesh}, solid));
}

winnow_status winnow_composite_pool_is_solid(const winnow_composite_pool* pool,
                                             winnow_shape_id mesh, bool* solid) {
  if (!are_given(pool, solid)) return WINNOW_INVALID_ARGUMENT;
  *solid = pool->value.is_solid({mesh});
  return WINNOW_OK;
}

winnow_status winnow_composite_pool_part(const winnow_composite_pool* pool,
                                         winnow_shape_id compound, uint32_t part, uint32_t* child,
                                         uint32_t* child_part) {
  if (!are_given(pool, child) || child_part == nullptr) return WINNOW_INVALID_ARGUMENT;
  const winnow::CompoundPart found = pool->value.part({compound}, part);
  if (found.child == winnow::kWholeShape) return WINNOW_INVALID_KEY;
  *child = found.child;
  *child_part = found.part;
  return WINNOW_OK;
}

winnow_status winnow_composite_pool_children(const winnow_composite_pool* pool, winnow_shape_id id,
                                             const winnow_compound_child** children,
                                             size_t* count) {
  if (!are_given(pool, children, count)) return WINNOW_INVALID_ARGUMENT;
  const winnow::ShapeId shape_id{id};
  if (!pool->value.contains(shape_id) ||
      shape_id.composite_kind() != winnow::CompositeKind::compound) {
    return WINNOW_INVALID_KEY;
  }
  return_array(pool->value.children(shape_id), children, count);
  return WINNOW_OK;
}

winnow_status winnow_composite_pool_footprint(const winnow_composite_pool* pool,
                                              winnow_footprint* footprint) {
  if (pool == nullptr) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(pool, pool->value.footprint(), {}, footprint);
}
