// Traversal of the parts of shapes for queries; see parts.h.

#include "pipeline/composites/parts.h"

#include <winnow/core/pose.h>
#include <winnow/core/volumes.h>
#include "core/numbers/rotation.h"
#include "core/numbers/rounding.h"
#include "pipeline/composites/part_tables.h"
#include "pipeline/shapes/extent.h"
#include "pipeline/shapes/one_sided.h"

#include <algorithm>
#include <cmath>

namespace winnow {
namespace {

using Eigen::Vector3d;

/// Moves a float box about the origin of a shape to its position, rounded outward.
mid::Box3 placed_box(const Aabb& box, const double position[3]) noexcept {
  mid::Box3 result;
  for (int i = 0; i < 3; ++i) {
    const auto low = static_cast<double>(box.min[i]);
    const auto high = static_cast<double>(box.max[i]);
    result.min[i] = std::isinf(low) ? low : add_down(position[i], low);
    result.max[i] = std::isinf(high) ? high : add_up(position[i], high);
  }
  return result;
}

mid::Box3 triangle_box(const TriangleShape& triangle, const Pose& pose) noexcept {
  const Eigen::Matrix3d turn = rotation_of_unit(normalized(scale_to_unit_max(pose.orientation)));
  mid::Box3 box;
  double scale = 0.0;
  for (int k = 0; k < 3; ++k) {
    const Vector3d local = as_eigen(triangle.vertex[k]);
    const Vector3d corner = turn * local;
    scale = std::max(scale, local.cwiseAbs().sum());
    box.min = k == 0 ? corner : Vector3d(box.min.cwiseMin(corner));
    box.max = k == 0 ? corner : Vector3d(box.max.cwiseMax(corner));
  }
  // Rounding errors of the rotation and of the sums below.
  const Vector3d position = as_eigen(pose.position);
  const double slack = triangle.rounding +
                       mid::kSlack * (scale + triangle.rounding + position.cwiseAbs().maxCoeff());
  return box.moved(position).grown(slack);
}

mid::Box3 hull_box(const HullShape& hull, const Pose& pose) noexcept {
  ShapeTables tables;
  tables.hulls = &hull;
  tables.count[static_cast<std::size_t>(ShapeKind::hull)] = 1;
  return mid::box_under(tables, ShapeId::of(ShapeKind::hull, 0),
                        rotation_of_unit(normalized(scale_to_unit_max(pose.orientation))),
                        as_eigen(pose.position), 0.0);
}

/// True if the ray certainly misses a triangle, grown by `doubt`, of a body without rotation: the
/// signed volumes of the ray and each side have different signs (Platis, Theoharis, "Fast
/// ray-tetrahedron intersection using Pluecker coordinates", 2003), beyond their rounding.
[[nodiscard]] bool passes_by(const double from[3], const double direction[3], const SubShape& part,
                             double doubt) noexcept {
  if (!is_unrotated(part)) return false;
  const Vector3d d = Vector3d::Map(direction);
  const Vector3d first = as_eigen(part.pose.position) - Vector3d::Map(from);
  const Vector3d a = first + as_eigen(part.triangle->vertex[0]);
  const Vector3d b = first + as_eigen(part.triangle->vertex[1]);
  const Vector3d c = first + as_eigen(part.triangle->vertex[2]);
  const double far = a.cwiseAbs().sum() + b.cwiseAbs().sum() + c.cwiseAbs().sum();
  const double error = d.cwiseAbs().sum() * far * (0x1p-48 * far + 4.0 * doubt);
  const double volume[3] = {d.dot(c.cross(b)), d.dot(a.cross(c)), d.dot(b.cross(a))};
  const double low = std::min({volume[0], volume[1], volume[2]});
  const double high = std::max({volume[0], volume[1], volume[2]});
  return low < -error && high > error;
}

/// Computes the hit of the exact shape.
[[nodiscard]] ShapeHit cast_on(const ShapePool& shapes, const ShapeRay& ray,
                               const SubShape& part) noexcept {
  PartTables tables(shapes);
  const ShapeId shape = tables.put(0, part);
  return cast_ray(tables.tables(), shape, part.pose, ray);
}

}  // namespace

MovingBox stationary(const mid::Box3& box) noexcept {
  MovingBox moving_box;
  Vector3d::Map(moving_box.min) = box.min;
  Vector3d::Map(moving_box.max) = box.max;
  return moving_box;
}

PartTables::PartTables(const ShapePool& pool) noexcept
    : pool_(pool.tables()), tables_(pool.tables()) {
  tables_.triangles = triangles_;
  tables_.spheres = balls_;
  tables_.hulls = hulls_;
  tables_.count[static_cast<std::size_t>(ShapeKind::triangle)] = 2;
  tables_.count[static_cast<std::size_t>(ShapeKind::sphere)] = 2;
  tables_.count[static_cast<std::size_t>(ShapeKind::hull)] = 2;
}

ShapeId PartTables::put(std::size_t slot, const SubShape& part) noexcept {
  const ShapeKind kind = part.shape.kind();
  const auto index = static_cast<std::uint32_t>(slot);
  if (kind == ShapeKind::triangle) {
    triangles_[slot] =
        part.triangle != nullptr ? *part.triangle : pool_.triangles[part.shape.index()];
    triangles_[slot].rounding += part.thickness;
    return ShapeId::of(kind, index);
  }
  if (kind == ShapeKind::sphere) {
    balls_[slot] = part.ball != nullptr ? *part.ball : pool_.spheres[part.shape.index()];
    return ShapeId::of(kind, index);
  }
  if (kind == ShapeKind::hull) {
    std::construct_at(&hulls_[slot],
                      part.hull != nullptr ? *part.hull : pool_.hulls[part.shape.index()]);
    return ShapeId::of(kind, index);
  }
  return part.shape;
}

bool SubShapeQuery::contains(ShapeId shape) const noexcept {
  if (shape.is_composite())
    return composites_ != nullptr && mid_phase().contains(*composites_, shape);
  return shapes_.contains(shape);
}

mid::Box3 SubShapeQuery::box(const PlacedShape& placed) const noexcept {
  const Pose here = at_origin(placed.pose);
  const Aabb local = placed.shape.is_composite()
                         ? mid_phase().bounds(*composites_, placed.shape, here)
                         : shapes_.bounds(placed.shape, here);
  return placed_box(local, placed.pose.position.data());
}

mid::Box3 SubShapeQuery::box(const SubShape& part) const noexcept {
  if (part.triangle != nullptr) return triangle_box(*part.triangle, part.pose);
  if (part.ball != nullptr) {
    const Vector3d center = as_eigen(part.pose.position);
    return mid::Box3{center, center}.grown(part.ball->radius);
  }
  if (part.hull != nullptr) return hull_box(*part.hull, part.pose);
  return box(PlacedShape{part.shape, part.pose});
}

MovingBox SubShapeQuery::bounded(const PlacedShape& placed, MovingBox moving_box) const noexcept {
  const auto is_infinite = [](double end) { return std::isinf(end); };
  if (std::none_of(moving_box.min, moving_box.min + 3, is_infinite) &&
      std::none_of(moving_box.max, moving_box.max + 3, is_infinite)) {
    return moving_box;
  }
  // The box of the shape is computed only here, because for a compound this visits all children.
  const mid::Box3 own = box(placed);
  for (int i = 0; i < 3; ++i) {
    if (std::isinf(moving_box.min[i])) moving_box.min[i] = std::min(own.min[i], moving_box.max[i]);
    if (std::isinf(moving_box.max[i])) moving_box.max[i] = std::max(own.max[i], moving_box.min[i]);
  }
  return moving_box;
}

double corner_error(const SubShape& part) noexcept {
  if (part.triangle == nullptr) return 0.0;
  double size = as_eigen(part.pose.position).cwiseAbs().sum();
  for (const auto& corner : part.triangle->vertex) {
    size = std::max(size, as_eigen(corner).cwiseAbs().sum());
  }
  return 0x1p-48 * size;
}

bool enters(const ShapePool& shapes, const ShapeRay& ray, const SubShape& part,
            ShapeHit& hit) noexcept {
  const double thickness = corner_error(part);
  if (part.triangle != nullptr &&
      passes_by(ray.origin.data(), ray.direction.data(), part, thickness)) {
    return false;
  }
  if (part.front != 0) {
    const Vector3d start = as_eigen(ray.origin) + ray.min_t * as_eigen(ray.direction);
    if (is_behind_triangle({start, start}, part)) return false;
  }
  // Tests the whole ray: whether the thick triangle is used must not depend on a limit.
  hit = cast_on(shapes, ray, part);
  if (hit.hit || thickness == 0.0) return hit.hit;
  if (ray.min_t > 0.0) {
    // A triangle that the ray crosses before its start is not crossed again by being thick.
    ShapeRay whole = ray;
    whole.min_t = 0.0;
    if (cast_on(shapes, whole, part).hit) return false;
  }
  SubShape thick = part;
  thick.thickness = thickness;
  hit = cast_on(shapes, ray, thick);
  return hit.hit;
}

bool is_unrotated(const SubShape& part) noexcept {
  const double* const q = part.pose.orientation.data();
  return part.triangle->rounding == 0.0 && q[1] == 0.0 && q[2] == 0.0 && q[3] == 0.0;
}

bool is_behind_triangle(const mid::Box3& box, const SubShape& part) noexcept {
  if (part.front == 0) return false;
  const Eigen::Matrix3d turn =
      rotation_of_unit(normalized(scale_to_unit_max(part.pose.orientation)));
  const Vector3d first = as_eigen(part.triangle->vertex[0]);
  const Vector3d normal = (as_eigen(part.triangle->vertex[1]) - first)
                              .cross(as_eigen(part.triangle->vertex[2]) - first);
  const Vector3d corner = as_eigen(part.pose.position) + turn * first;
  return is_behind(turn * normal * part.front, corner, box.min, box.max);
}

Pose at_origin(const Pose& pose) noexcept {
  Pose result;
  result.orientation = pose.orientation;
  return result;
}

Pose relative(const Pose& pose, const double position[3]) noexcept {
  Pose result = pose;
  result.position = difference(pose.position.data(), position).difference;
  return result;
}

}  // namespace winnow
