// C binding of ShapePool: convex shapes and rays against them (shapes.h).

#include <winnow/c/shapes.h>

#include "pipeline/c/binding/arguments.h"
#include "pipeline/c/binding/handles.h"
#include "pipeline/c/binding/layout_compatible.h"
#include "pipeline/c/binding/views.h"

#include <winnow/pipeline/shape_rays.h>

#include <algorithm>

namespace winnow::c {
namespace {

[[nodiscard]] SphereShape read(const decltype(winnow_shape::as.sphere)& s) noexcept {
  return {s.radius};
}
[[nodiscard]] CapsuleShape read(const decltype(winnow_shape::as.capsule)& s) noexcept {
  return {s.radius, s.half_length};
}
[[nodiscard]] BoxShape read(const decltype(winnow_shape::as.box)& s) noexcept {
  return {{s.half[0], s.half[1], s.half[2]}, s.rounding};
}
[[nodiscard]] CylinderShape read(const decltype(winnow_shape::as.cylinder)& s) noexcept {
  return {s.radius, s.half_length, s.rounding};
}
[[nodiscard]] ConeShape read(const decltype(winnow_shape::as.cone)& s) noexcept {
  return {s.radius, s.half_length, s.rounding};
}
[[nodiscard]] TriangleShape read(const decltype(winnow_shape::as.triangle)& s) noexcept {
  TriangleShape triangle;
  std::copy(&s.vertex[0][0], &s.vertex[0][0] + 9, &triangle.vertex[0][0]);
  triangle.rounding = s.rounding;
  return triangle;
}
[[nodiscard]] HalfSpaceShape read(const decltype(winnow_shape::as.half_space)& s) noexcept {
  return {{s.normal[0], s.normal[1], s.normal[2]}, s.offset};
}

[[nodiscard]] EllipsoidShape read(const decltype(winnow_shape::as.ellipsoid)& s) noexcept {
  return {{s.radius[0], s.radius[1], s.radius[2]}, s.rounding};
}
[[nodiscard]] TaperedCapsuleShape read(
    const decltype(winnow_shape::as.tapered_capsule)& s) noexcept {
  return {{s.radius[0], s.radius[1]}, s.half_length};
}
[[nodiscard]] SupportShape read(const decltype(winnow_shape::as.support)& s) noexcept {
  return {s.function, s.context, s.radius, s.rounding};
}

[[nodiscard]] Status add(ShapePool& pool, const winnow_shape& shape, ShapeId& id) {
  switch (shape.kind) {
    case WINNOW_SHAPE_SPHERE:
      return pool.add(read(shape.as.sphere), id);
    case WINNOW_SHAPE_CAPSULE:
      return pool.add(read(shape.as.capsule), id);
    case WINNOW_SHAPE_BOX:
      return pool.add(read(shape.as.box), id);
    case WINNOW_SHAPE_CYLINDER:
      return pool.add(read(shape.as.cylinder), id);
    case WINNOW_SHAPE_CONE:
      return pool.add(read(shape.as.cone), id);
    case WINNOW_SHAPE_TRIANGLE:
      return pool.add(read(shape.as.triangle), id);
    case WINNOW_SHAPE_HALF_SPACE:
      return pool.add(read(shape.as.half_space), id);
    case WINNOW_SHAPE_ELLIPSOID:
      return pool.add(read(shape.as.ellipsoid), id);
    case WINNOW_SHAPE_TAPERED_CAPSULE:
      return pool.add(read(shape.as.tapered_capsule), id);
    case WINNOW_SHAPE_SUPPORT:
      return pool.add(read(shape.as.support), id);
    default:
      return Status::invalid_argument;
  }
}

/// Copies a C++ shape to the C struct, which has the same members in the same order.
template <typename Shape, typename Member>
void write(const Shape& shape, Member& member) noexcept {
  static_assert(sizeof(Shape) == sizeof(Member));
  const auto* from = reinterpret_cast<const double*>(&shape);
  std::copy(from, from + sizeof(Shape) / sizeof(double), reinterpret_cast<double*>(&member));
}

[[nodiscard]] winnow_shape shape_at(const ShapeTables& tables, ShapeId id) noexcept {
  winnow_shape shape{};
  shape.kind = static_cast<winnow_shape_kind>(id.kind_index());
  const std::uint32_t i = id.index();
  switch (id.kind()) {
    case ShapeKind::sphere:
      write(tables.spheres[i], shape.as.sphere);
      break;
    case ShapeKind::capsule:
      write(tables.capsules[i], shape.as.capsule);
      break;
    case ShapeKind::box:
      write(tables.boxes[i], shape.as.box);
      break;
    case ShapeKind::cylinder:
      write(tables.cylinders[i], shape.as.cylinder);
      break;
    case ShapeKind::cone:
      write(tables.cones[i], shape.as.cone);
      break;
    case ShapeKind::triangle:
      write(tables.triangles[i], shape.as.triangle);
      break;
    case ShapeKind::half_space:
      write(tables.half_spaces[i], shape.as.half_space);
      break;
    case ShapeKind::ellipsoid:
      write(tables.ellipsoids[i], shape.as.ellipsoid);
      break;
    case ShapeKind::tapered_capsule:
      write(tables.tapered_capsules[i], shape.as.tapered_capsule);
      break;
    case ShapeKind::support: {
      const SupportShape& own = tables.supports[i];
      shape.as.support = {own.function, own.context, own.radius, own.rounding};
      break;
    }
    case ShapeKind::hull:
      break;
  }
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
  return read_choice(kind, winnow::ShapeKind::support, known) ? winnow::to_string(known) : "none";
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
  winnow::ShapeId added;
  const winnow::Status status = add(pool->value, *shape, added);
  if (status == winnow::Status::ok) *id = added.bits;
  return answer(status);
}

winnow_status winnow_shape_pool_add_hull(winnow_shape_pool* pool, const winnow_point_view* points,
                                         double rounding, winnow_shape_id* id) {
  if (!are_given(pool, points, id)) return WINNOW_INVALID_ARGUMENT;
  std::span<const Eigen::Vector3d> corners;
  winnow::ShapeId added;
  winnow::Status status = read_points(points, pool->room, corners);
  if (status == winnow::Status::ok) status = pool->value.add_hull(corners, rounding, added);
  if (status == winnow::Status::ok) *id = added.bits;
  return answer(status);
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
  winnow::ShapeId added;
  winnow::Status status = read_points(points, pool->room, corners);
  if (status == winnow::Status::ok) {
    status = pool->value.add_hull(corners, surface, rounding, added);
  }
  if (status == winnow::Status::ok) *id = added.bits;
  return answer(status);
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
  const bool is_composite = kind >= WINNOW_SHAPE_MESH && kind <= WINNOW_SHAPE_HEIGHT_FIELD;
  if (!are_given(pool, size) || is_composite ||
      !read_choice(kind, winnow::ShapeKind::support, which)) {
    return WINNOW_INVALID_ARGUMENT;
  }
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
  winnow::ShapeHit found;
  const winnow::Status status =
      winnow::cast_ray(pool->value.tables(), {shape}, *as_cpp(pose), *as_cpp(ray), found);
  if (status == winnow::Status::ok) {
    *hit = {found.hit, found.t, {found.normal[0], found.normal[1], found.normal[2]}};
  }
  return answer(status);
}
