// C binding of ShapePool: convex shapes and rays against them (shapes.h).

#include <winnow/c/shapes.h>

#include "pipeline/c/binding/arguments.h"
#include "pipeline/c/binding/handles.h"
#include "pipeline/c/binding/layout_compatible.h"
#include "pipeline/c/binding/views.h"
#include "pipeline/kinds/with_shape.h"

#include <winnow/pipeline/shape_rays.h>

#include <cstring>
#include <type_traits>

namespace winnow::c {
namespace {

/// Returns false unless the number is of a convex kind.
[[nodiscard]] bool read_kind(winnow_shape_kind number, ShapeKind& kind) noexcept {
  return read_choice(number, kLastConvexKind, kind) && !ShapeId::of(kind, 0).is_composite();
}

// The C structs of all kinds but hulls have the same members as the C++ structs, in the same order.

[[nodiscard]] Answer<ShapeId> add(ShapePool& pool, const winnow_shape& shape) {
  ShapeKind kind{};
  if (!read_kind(shape.kind, kind)) return Status::invalid_argument;
  return with_kind(kind, [&](auto of) -> Answer<ShapeId> {
    using Shape = typename decltype(of)::Shape;
    if constexpr (std::is_same_v<Shape, HullShape>) {
      return Status::invalid_argument;
    } else {
      Shape one;
      static_assert(sizeof one <= sizeof shape.as);
      std::memcpy(static_cast<void*>(&one), &shape.as, sizeof one);
      return pool.add(one);
    }
  });
}

/// Leaves `as` empty for hulls.
[[nodiscard]] winnow_shape shape_at(const ShapeTables& tables, ShapeId id) noexcept {
  winnow_shape shape{};
  shape.kind = static_cast<winnow_shape_kind>(id.kind_index());
  if (id.kind() == ShapeKind::hull) return shape;
  with_shape(tables, id, [&](const auto& one) {
    if constexpr (sizeof one <= sizeof shape.as) std::memcpy(&shape.as, &one, sizeof one);
  });
  return shape;
}

[[nodiscard]] winnow_hull hull_of(const HullShape& hull) noexcept {
  return {0,
          hull.vertex_count,
          hull.face_count,
          hull.dimension,
          hull.rounding,
          {hull.center[0], hull.center[1], hull.center[2]},
          hull.radius,
          {hull.vertex[0], hull.vertex[1], hull.vertex[2]},
          reinterpret_cast<const winnow_hull_face*>(hull.faces),
          hull.loop};
}

}  // namespace
}  // namespace winnow::c

using namespace winnow::c;

const char* winnow_shape_kind_name(winnow_shape_kind kind) {
  switch (kind) {
    case WINNOW_SHAPE_MESH:
      return "mesh";
    case WINNOW_SHAPE_COMPOUND:
      return "compound";
    case WINNOW_SHAPE_HEIGHT_FIELD:
      return "height_field";
    default:
      break;
  }
  winnow::ShapeKind known{};
  return read_kind(kind, known) ? winnow::to_string(known) : "none";
}

winnow_status winnow_shape_pool_create(const winnow_memory* memory, winnow_shape_pool** pool) {
  return create(memory, pool);
}

void winnow_shape_pool_destroy(winnow_shape_pool* pool) {
  destroy(pool);
}

winnow_status winnow_shape_pool_add(winnow_shape_pool* pool, const winnow_shape* shape,
                                    winnow_shape_id* id) {
  if (!are_given(pool, shape, id)) return WINNOW_INVALID_ARGUMENT;
  return answer(add(pool->value, *shape), id);
}

winnow_status winnow_shape_pool_add_hull(winnow_shape_pool* pool, const winnow_point_view* points,
                                         double rounding, winnow_shape_id* id) {
  if (!are_given(pool, points, id)) return WINNOW_INVALID_ARGUMENT;
  std::span<const Eigen::Vector3d> corners;
  const winnow::Status status = read_points(points, pool->room, corners);
  if (status != winnow::Status::ok) return answer(status);
  return answer(pool->value.add_hull(corners, rounding), id);
}

winnow_status winnow_shape_pool_add_hull_faces(winnow_shape_pool* pool,
                                               const winnow_point_view* points,
                                               const winnow_hull_faces* faces, double rounding,
                                               winnow_shape_id* id) {
  if (!are_given(pool, points, faces, id) || !is_array(faces->indices, faces->index_count) ||
      !is_array(faces->sizes, faces->face_count)) {
    return WINNOW_INVALID_ARGUMENT;
  }
  const winnow::HullFaces surface{{faces->indices, faces->index_count},
                                  {faces->sizes, faces->face_count}};
  std::span<const Eigen::Vector3d> corners;
  const winnow::Status status = read_points(points, pool->room, corners);
  if (status != winnow::Status::ok) return answer(status);
  return answer(pool->value.add_hull(corners, surface, rounding), id);
}

winnow_status winnow_shape_pool_remove(winnow_shape_pool* pool, winnow_shape_id id) {
  if (pool == nullptr) return WINNOW_INVALID_ARGUMENT;
  return answer(pool->value.remove({id}));
}

winnow_status winnow_shape_pool_contains(const winnow_shape_pool* pool, winnow_shape_id id,
                                         bool* contains) {
  if (!are_given(pool, contains)) return WINNOW_INVALID_ARGUMENT;
  *contains = pool->value.contains({id});
  return WINNOW_OK;
}

winnow_status winnow_shape_pool_size(const winnow_shape_pool* pool, winnow_shape_kind kind,
                                     size_t* size) {
  winnow::ShapeKind which{};
  if (!are_given(pool, size) || !read_kind(kind, which)) return WINNOW_INVALID_ARGUMENT;
  *size = pool->value.size(which);
  return WINNOW_OK;
}

winnow_status winnow_shape_pool_bounds(const winnow_shape_pool* pool, winnow_shape_id id,
                                       const winnow_pose* pose, winnow_aabb* box) {
  if (!are_given(pool, pose, box)) return WINNOW_INVALID_ARGUMENT;
  if (!pool->value.contains({id})) return WINNOW_INVALID_KEY;
  if (!as_cpp(pose)->is_valid()) return WINNOW_INVALID_POSE;
  *as_cpp(box) = pool->value.bounds({id}, *as_cpp(pose));
  return WINNOW_OK;
}

winnow_status winnow_shape_pool_shape(const winnow_shape_pool* pool, winnow_shape_id id,
                                      winnow_shape* shape) {
  if (!are_given(pool, shape)) return WINNOW_INVALID_ARGUMENT;
  const winnow::ShapeId shape_id{id};
  if (!pool->value.contains(shape_id) || shape_id.kind() == winnow::ShapeKind::hull) {
    return WINNOW_INVALID_KEY;
  }
  *shape = shape_at(pool->value.tables(), shape_id);
  return WINNOW_OK;
}

winnow_status winnow_shape_pool_hull(const winnow_shape_pool* pool, winnow_shape_id id,
                                     winnow_hull* hull) {
  if (pool == nullptr || !is_sized(hull)) return WINNOW_INVALID_ARGUMENT;
  const winnow::ShapeId shape_id{id};
  if (!pool->value.contains(shape_id) || shape_id.kind() != winnow::ShapeKind::hull) {
    return WINNOW_INVALID_KEY;
  }
  write_sized(hull_of(pool->value.tables().hulls[shape_id.index()]), *hull);
  return WINNOW_OK;
}

winnow_status winnow_shape_pool_footprint(const winnow_shape_pool* pool,
                                          winnow_footprint* footprint) {
  if (pool == nullptr) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(pool, pool->value.footprint(), pool->room.bytes(), footprint);
}

winnow_status winnow_cast_ray(const winnow_shape_pool* pool, winnow_shape_id shape,
                              const winnow_pose* pose, const winnow_shape_ray* ray,
                              winnow_shape_hit* hit) {
  if (!are_given(pool, pose, ray, hit)) return WINNOW_INVALID_ARGUMENT;
  if (!pool->value.contains({shape})) return WINNOW_INVALID_KEY;
  const auto found = winnow::cast_ray(pool->value.tables(), {shape}, *as_cpp(pose), *as_cpp(ray));
  if (found.status == winnow::Status::ok) {
    *hit = {found.hit, found.t, {found.normal[0], found.normal[1], found.normal[2]}};
  }
  return answer(found.status);
}
