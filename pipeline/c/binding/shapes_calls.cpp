// Generated from pipeline/interface/shapes.toml; do not edit.
// clang-format off

#include <winnow/c/shapes.h>

#include "pipeline/c/binding/results.h"

using namespace winnow;
using namespace winnow::c;

winnow_status winnow_shape_pool_create(const winnow_memory* memory, winnow_shape_pool** pool) {
  if (!(are_given(pool))) return WINNOW_INVALID_ARGUMENT;
  return create(memory, pool);
}

void winnow_shape_pool_destroy(winnow_shape_pool* pool) {
  destroy(pool);
}

winnow_status winnow_composite_pool_create(
    const winnow_shape_pool* shapes, const winnow_memory* memory, winnow_composite_pool** pool) {
  if (!(are_given(shapes, pool))) return WINNOW_INVALID_ARGUMENT;
  return create(memory, pool, of(shapes));
}

void winnow_composite_pool_destroy(winnow_composite_pool* pool) {
  destroy(pool);
}

winnow_status winnow_shape_pool_add(
    winnow_shape_pool* pool, const winnow_shape* shape, winnow_shape_id* id) {
  if (!(are_given(pool, shape, id))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (add(of(pool), *shape)); }, id);
}

winnow_status winnow_shape_pool_add_hull(
    winnow_shape_pool* pool, const winnow_point_view* points, double rounding,
    winnow_shape_id* id) {
  if (!(are_given(pool, points, id))) return WINNOW_INVALID_ARGUMENT;
  PointView own_points;
  if (const Status bad = read_view(*points, own_points); bad != Status::ok) {
    return answer(bad);
  }
  return give([&]() -> decltype(auto) { return (of(pool).add_hull(own_points, rounding)); }, id);
}

winnow_status winnow_shape_pool_add_hull_faces(
    winnow_shape_pool* pool, const winnow_point_view* points, const winnow_hull_faces* faces,
    double rounding, winnow_shape_id* id) {
  HullFaces own_faces{};
  if (!(are_given(pool, points, faces, id) && read(faces, own_faces))) return WINNOW_INVALID_ARGUMENT;
  PointView own_points;
  if (const Status bad = read_view(*points, own_points); bad != Status::ok) {
    return answer(bad);
  }
  return give([&]() -> decltype(auto) { return (of(pool).add_hull(own_points, own_faces, rounding)); }, id);
}

winnow_status winnow_shape_pool_add_built_hull(
    winnow_shape_pool* pool, const winnow_point_view* points, const winnow_hull_faces* faces,
    double rounding, winnow_shape_id* id) {
  HullFaces own_faces{};
  if (!(are_given(pool, points, faces, id) && read(faces, own_faces))) return WINNOW_INVALID_ARGUMENT;
  PointView own_points;
  if (const Status bad = read_view(*points, own_points); bad != Status::ok) {
    return answer(bad);
  }
  return give([&]() -> decltype(auto) { return (of(pool).add_built_hull(own_points, own_faces, rounding)); }, id);
}

winnow_status winnow_shape_pool_remove(winnow_shape_pool* pool, winnow_shape_id id) {
  if (!(are_given(pool))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(pool).remove(ShapeId{id})); });
}

winnow_status winnow_shape_pool_contains(
    const winnow_shape_pool* pool, winnow_shape_id id, bool* contains) {
  if (!(are_given(pool, contains))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(pool).contains(ShapeId{id})); }, contains);
}

winnow_status winnow_shape_pool_bounds(
    const winnow_shape_pool* pool, winnow_shape_id id, const winnow_pose* pose, winnow_aabb* box) {
  if (!(are_given(pool, pose, box))) return WINNOW_INVALID_ARGUMENT;
  if (!(of(pool).contains(ShapeId{id}))) return WINNOW_INVALID_KEY;
  if (!((*as_cpp(pose)).is_valid())) return WINNOW_INVALID_POSE;
  return give([&]() -> decltype(auto) { return (of(pool).bounds(ShapeId{id}, (*as_cpp(pose)))); }, box);
}

winnow_status winnow_shape_pool_shape(
    const winnow_shape_pool* pool, winnow_shape_id id, winnow_shape* shape) {
  if (!(are_given(pool, shape))) return WINNOW_INVALID_ARGUMENT;
  if (!(of(pool).contains(ShapeId{id}) && !is_hull(ShapeId{id}))) return WINNOW_INVALID_KEY;
  return give([&]() -> decltype(auto) { return (shape_at(of(pool).tables(), ShapeId{id})); }, shape);
}

winnow_status winnow_shape_pool_hull(
    const winnow_shape_pool* pool, winnow_shape_id id, winnow_hull* hull) {
  if (!(are_given(pool) && is_sized(hull))) return WINNOW_INVALID_ARGUMENT;
  if (!(of(pool).contains(ShapeId{id}) && is_hull(ShapeId{id}))) return WINNOW_INVALID_KEY;
  return give([&]() -> decltype(auto) { return (of(pool).tables().hulls[ShapeId{id}.index()]); }, hull);
}

winnow_status winnow_composite_pool_add_mesh(
    winnow_composite_pool* pool, const winnow_point_view* vertices,
    const winnow_index_view* triangles, const winnow_mesh_options* options,
    const winnow_execution* execution, winnow_shape_id* id) {
  MeshOptions own_options{};
  Execution own_execution{Execution::parallel()};
  if (!(are_given(pool, vertices, triangles, id) && read(options, own_options) && read(execution, own_execution))) return WINNOW_INVALID_ARGUMENT;
  PointView own_vertices;
  if (const Status bad = read_view(*vertices, own_vertices); bad != Status::ok) {
    return answer(bad);
  }
  IndexView own_triangles;
  if (const Status bad = read_view(*triangles, own_triangles); bad != Status::ok) {
    return answer(bad);
  }
  return give([&]() -> decltype(auto) { return (of(pool).add_mesh(own_vertices, own_triangles, own_options, own_execution)); }, id);
}

winnow_status winnow_composite_pool_add_scaled(
    winnow_composite_pool* pool, winnow_shape_id mesh, const double scale[3], winnow_shape_id* id) {
  if (!(are_given(pool, scale, id))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(pool).add_scaled(ShapeId{mesh}, Vec3d(scale))); }, id);
}

winnow_status winnow_composite_pool_add_saved_mesh(
    winnow_composite_pool* pool, const uint8_t* bytes, size_t count, const double scale[3],
    const winnow_execution* execution, winnow_shape_id* id) {
  Execution own_execution{Execution::parallel()};
  if (!(are_given(pool, scale, id) && is_array(bytes, count) && read(execution, own_execution))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(pool).add_saved_mesh(std::as_bytes(span_of(bytes, count)), {scale[0], scale[1], scale[2]}, own_execution)); }, id);
}

winnow_status winnow_composite_pool_add_saved_height_field(
    winnow_composite_pool* pool, const uint8_t* bytes, size_t count, winnow_shape_id* id) {
  if (!(are_given(pool, id) && is_array(bytes, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(pool).add_saved_height_field(std::as_bytes(span_of(bytes, count)))); }, id);
}

winnow_status winnow_composite_pool_refit_mesh(
    winnow_composite_pool* pool, winnow_shape_id mesh, const winnow_point_view* vertices,
    const winnow_execution* execution) {
  Execution own_execution{Execution::parallel()};
  if (!(are_given(pool, vertices) && read(execution, own_execution))) return WINNOW_INVALID_ARGUMENT;
  PointView own_vertices;
  if (const Status bad = read_view(*vertices, own_vertices); bad != Status::ok) {
    return answer(bad);
  }
  return give([&]() -> decltype(auto) { return (of(pool).refit_mesh(ShapeId{mesh}, own_vertices, own_execution)); });
}

winnow_status winnow_composite_pool_add_height_field(
    winnow_composite_pool* pool, const winnow_height_samples* samples, winnow_shape_id* id) {
  HeightSamples own_samples{};
  if (!(are_given(pool, samples, id) && read(samples, own_samples))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(pool).add_height_field(own_samples)); }, id);
}

winnow_status winnow_composite_pool_update_height_field(
    winnow_composite_pool* pool, winnow_shape_id field, uint32_t column, uint32_t row,
    const winnow_height_samples* samples) {
  HeightSamples own_samples{};
  if (!(are_given(pool, samples) && read(samples, own_samples))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(pool).update_height_field(ShapeId{field}, column, row, own_samples)); });
}

winnow_status winnow_composite_pool_add_compound(
    winnow_composite_pool* pool, const winnow_compound_child* children, size_t count,
    winnow_shape_id* id) {
  if (!(are_given(pool, id) && is_array(children, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(pool).add_compound(as_cpp_span(children, count))); }, id);
}

winnow_status winnow_composite_pool_set_one_sided(
    winnow_composite_pool* pool, winnow_shape_id surface, bool one_sided) {
  if (!(are_given(pool))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(pool).set_one_sided(ShapeId{surface}, one_sided)); });
}

winnow_status winnow_composite_pool_is_one_sided(
    const winnow_composite_pool* pool, winnow_shape_id surface, bool* one_sided) {
  if (!(are_given(pool, one_sided))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(pool).is_one_sided(ShapeId{surface})); }, one_sided);
}

winnow_status winnow_composite_pool_set_solid(
    winnow_composite_pool* pool, winnow_shape_id mesh, bool solid) {
  if (!(are_given(pool))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(pool).set_solid(ShapeId{mesh}, solid)); });
}

winnow_status winnow_composite_pool_is_solid(
    const winnow_composite_pool* pool, winnow_shape_id mesh, bool* solid) {
  if (!(are_given(pool, solid))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(pool).is_solid(ShapeId{mesh})); }, solid);
}

winnow_status winnow_composite_pool_remove(winnow_composite_pool* pool, winnow_shape_id id) {
  if (!(are_given(pool))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(pool).remove(ShapeId{id})); });
}

winnow_status winnow_composite_pool_contains(
    const winnow_composite_pool* pool, winnow_shape_id id, bool* contains) {
  if (!(are_given(pool, contains))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(pool).contains(ShapeId{id})); }, contains);
}

winnow_status winnow_composite_pool_size(
    const winnow_composite_pool* pool, winnow_shape_kind kind, size_t* size) {
  if (!(are_given(pool, size))) return WINNOW_INVALID_ARGUMENT;
  if (!(kind >= WINNOW_SHAPE_MESH && kind <= WINNOW_SHAPE_HEIGHT_FIELD)) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(pool).size(static_cast<CompositeKind>(kind))); }, size);
}

winnow_status winnow_composite_pool_scale(
    const winnow_composite_pool* pool, winnow_shape_id mesh, double scale[3]) {
  if (!(are_given(pool, scale))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(pool).scale(ShapeId{mesh})); }, scale);
}

winnow_status winnow_composite_pool_bounds(
    const winnow_composite_pool* pool, winnow_shape_id id, const winnow_pose* pose,
    winnow_aabb* box) {
  if (!(are_given(pool, pose, box))) return WINNOW_INVALID_ARGUMENT;
  if (!(of(pool).contains(ShapeId{id}))) return WINNOW_INVALID_KEY;
  if (!((*as_cpp(pose)).is_valid())) return WINNOW_INVALID_POSE;
  return give([&]() -> decltype(auto) { return (of(pool).bounds(ShapeId{id}, (*as_cpp(pose)))); }, box);
}

winnow_status winnow_composite_pool_radius(
    const winnow_composite_pool* pool, winnow_shape_id id, double* radius) {
  if (!(are_given(pool, radius))) return WINNOW_INVALID_ARGUMENT;
  if (!(of(pool).contains(ShapeId{id}))) return WINNOW_INVALID_KEY;
  return give([&]() -> decltype(auto) { return (of(pool).radius(ShapeId{id})); }, radius);
}

winnow_status winnow_composite_pool_parts(
    const winnow_composite_pool* pool, winnow_shape_id id, size_t* parts) {
  if (!(are_given(pool, parts))) return WINNOW_INVALID_ARGUMENT;
  if (!(of(pool).contains(ShapeId{id}))) return WINNOW_INVALID_KEY;
  return give([&]() -> decltype(auto) { return (of(pool).parts(ShapeId{id})); }, parts);
}

winnow_status winnow_composite_pool_part(
    const winnow_composite_pool* pool, winnow_shape_id compound, uint32_t part, uint32_t* child,
    uint32_t* child_part) {
  if (!(are_given(pool, child, child_part))) return WINNOW_INVALID_ARGUMENT;
  if (!(of(pool).part(ShapeId{compound}, part).child != kWholeShape)) return WINNOW_INVALID_KEY;
  return give([&]() -> decltype(auto) { return (of(pool).part(ShapeId{compound}, part)); }, child, child_part);
}

winnow_status winnow_composite_pool_children(
    const winnow_composite_pool* pool, winnow_shape_id id, const winnow_compound_child** children,
    size_t* count) {
  if (!(are_given(pool, children, count))) return WINNOW_INVALID_ARGUMENT;
  if (!(of(pool).contains(ShapeId{id}) && is_compound(ShapeId{id}))) return WINNOW_INVALID_KEY;
  return give([&]() -> decltype(auto) { return (of(pool).children(ShapeId{id})); }, children, count);
}

winnow_status winnow_composite_pool_revision(
    const winnow_composite_pool* pool, uint64_t* revision) {
  if (!(are_given(pool, revision))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(pool).revision()); }, revision);
}

winnow_status winnow_shape_pool_footprint(
    const winnow_shape_pool* pool, winnow_footprint* footprint) {
  if (!(are_given(pool) && is_sized(footprint))) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(pool, footprint);
}

winnow_status winnow_composite_pool_footprint(
    const winnow_composite_pool* pool, winnow_footprint* footprint) {
  if (!(are_given(pool) && is_sized(footprint))) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(pool, footprint);
}

winnow_status winnow_cast_ray(
    const winnow_shape_pool* pool, winnow_shape_id shape, const winnow_pose* pose,
    const winnow_shape_ray* ray, winnow_shape_hit* hit) {
  if (!(are_given(pool, pose, ray, hit))) return WINNOW_INVALID_ARGUMENT;
  if (!(of(pool).contains(ShapeId{shape}))) return WINNOW_INVALID_KEY;
  return give([&]() -> decltype(auto) { return (cast_ray(of(pool).tables(), ShapeId{shape}, (*as_cpp(pose)), (*as_cpp(ray)))); }, hit);
}
