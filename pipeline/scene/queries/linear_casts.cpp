// LinearCast, RayCast and ConvexCast, and BodyContact, which finds a cast's first contact with a
// body. Most triangles are excluded by a separating plane before the exact cast (shape_cast.cpp).

#include "pipeline/scene/queries/linear_casts.h"

#include <winnow/core/eigen.h>
#include <winnow/core/pose.h>
#include "core/numbers/rotation.h"
#include "pipeline/shapes/extent.h"
#include "pipeline/shapes/triangle_direction.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace winnow {
namespace {

using Eigen::Vector3d;

CastContact contact_at(const ShapeRay& ray, double t, const Vec3d& normal) noexcept {
  CastContact contact;
  contact.t = t;
  for (int i = 0; i < 3; ++i) {
    contact.normal[i] = normal[i];
    contact.point[i] = ray.origin[i] + t * ray.direction[i];
  }
  return contact;
}

}  // namespace

MovingBox moving_box_from(const LinearCast& linear_cast, const double from[3], double limit,
                          double more) noexcept {
  const Vector3d start = Vector3d::Map(from);
  const mid::Box3& extent = linear_cast.extent();
  const double reach = start.cwiseAbs().maxCoeff() + extent.largest();
  MovingBox moving_box = stationary(extent.moved(start).grown(kCastBoxGrowth * reach + more));
  moving_box.direction = Vec3d(linear_cast.direction());
  moving_box.max_t = limit;
  return moving_box;
}

CastContact contact_of(const CastTouch& touch) noexcept {
  CastContact contact;
  contact.t = touch.t;
  contact.overlaps_at_start = touch.overlaps_at_start;
  contact.normal = touch.normal;
  return contact;
}

void describe_contact(const ShapeTables& tables, const CastPair& pair, const SubShape& part,
                      CastContact& contact) noexcept {
  CastTouch touch;
  touch.t = contact.t;
  touch.overlaps_at_start = contact.overlaps_at_start;
  touch.normal = contact.normal;
  describe_touch(tables, pair, touch);
  for (int i = 0; i < 3; ++i) {
    contact.normal[i] = touch.normal[i];
    contact.point[i] = part.pose.position[i] + touch.point[i];
  }
}

CastMotions::CastMotions(const CastPair& pair, double max_t) noexcept
    : moving_{pair.moving, RigidMotion::stationary(pair.from)},
      stationary_{pair.stationary, RigidMotion::stationary(pair.pose)} {
  for (int i = 0; i < 3; ++i) moving_.motion.travel[i] = max_t * pair.direction[i];
  is_finite_ = moving_.motion.is_valid();
}

void CastMotions::record(const ShapeTables& tables,
                         impact::RestingContacts& resting) const noexcept {
  if (is_finite_) resting.record(tables, moving_, stationary_);
}

bool CastMotions::part(const ShapeTables& tables,
                       const impact::RestingContacts& resting) const noexcept {
  return is_finite_ && resting.part(tables, moving_, stationary_);
}

void LinearCast::note_contact(const double[3], const SubShape&,
                              impact::RestingContacts&) const noexcept {}

RayCast::RayCast(const ShapePool& shapes, const ShapeRay& ray) noexcept
    : LinearCast(ray), shapes_(shapes), ray_(ray) {}

bool RayCast::find_contact(const double from[3], const SubShape& part, double limit,
                           const EarlierContacts& /*known*/, CastContact& contact) const noexcept {
  ShapeRay ray = ray_;
  ray.origin = Vec3d(from);
  ShapeHit hit;
  if (!enters(shapes_, ray, part, hit)) return false;
  contact = contact_at(ray, hit.t, hit.normal);
  return contact.t <= limit;
}

void RayCast::describe(const double[3], const SubShape&, CastContact&) const noexcept {}

ConvexCast::ConvexCast(const SubShapeQuery& parts, const ShapeCast& cast, double tolerance) noexcept
    : LinearCast(parts.box(PlacedShape{cast.shape, at_origin(cast.pose)}), cast, tolerance),
      shapes_(parts.shapes()),
      cast_(cast),
      to_shape_(as_eigen(rotation_of(scale_to_unit_max(cast.pose.orientation))).transpose()),
      middle_(0.5 * (extent().min + extent().max)) {}

// Tests the plane of the triangle, and planes along the motion through its sides. These separate
// most triangles that are beside the path or beyond the first hit.
bool ConvexCast::passes_by(const double from[3], const SubShape& part, double limit,
                           double& free_until) const noexcept {
  if (!is_unrotated(part)) return false;
  Vector3d corner[3];
  Vector3d side[3];
  for (int k = 0; k < 3; ++k) corner[k] = as_eigen(part.triangle->vertex[k]);
  for (int k = 0; k < 3; ++k) side[k] = corner[(k + 1) % 3] - corner[k];
  const Vector3d start = Vector3d::Map(from) - as_eigen(part.pose.position);
  const Vector3d way = Vector3d::Map(direction());
  const double size = start.cwiseAbs().sum() + extent().min.cwiseAbs().sum() +
                      extent().max.cwiseAbs().sum() + corner[0].cwiseAbs().sum() +
                      corner[1].cwiseAbs().sum() + corner[2].cwiseAbs().sum();
  const double doubt_of_all = mid::kSlack * size + 4.0 * corner_error(part);
  // Returns how far the shape is above or below the whole triangle along an axis, at the start.
  const auto gap = [&](const Vector3d& axis, double& side_of) {
    const mid::SupportExtent own = mid::extent(shapes_.tables(), cast_.shape, to_shape_ * axis);
    const double at = axis.dot(start);
    const double heights[3] = {axis.dot(corner[0]), axis.dot(corner[1]), axis.dot(corner[2])};
    const double above = at + own.low - *std::max_element(heights, heights + 3);
    const double below = *std::min_element(heights, heights + 3) - at - own.high;
    side_of = above >= below ? 1.0 : -1.0;
    return std::max(above, below) - doubt_of_all * axis.cwiseAbs().sum();
  };
  double side_of = 1.0;
  const Vector3d normal = side[0].cross(side[1]);
  const double rest = gap(normal, side_of);
  if (rest > 0.0) {
    const double closing = -side_of * normal.dot(way);
    const double noise = mid::kSlack * normal.cwiseAbs().sum() * way.cwiseAbs().sum();
    // An infinite path is not decided by this plane.
    const double most = limit + tolerance() / way.norm();
    const double closing_at_most = std::max(closing, 0.0) + noise;
    if (rest > closing_at_most * most) return true;
    free_until = std::min(rest / closing_at_most * (1.0 - mid::kSlack), limit);
  }
  for (const Vector3d& along : side) {
    if (gap(way.cross(along), side_of) > 0.0) return true;
  }
  return false;
}

CastPair ConvexCast::pair(PartTables& tables, const double from[3],
                          const SubShape& part) const noexcept {
  CastPair pair;
  pair.moving = tables.put(0, {cast_.shape, cast_.pose});
  pair.from = cast_.pose;
  pair.from.position = Vec3d(from);
  pair.direction = cast_.direction;
  SubShape thick = part;
  thick.thickness = corner_error(part);
  pair.stationary = tables.put(1, thick);
  pair.pose = part.pose;
  return pair;
}

mid::Box3 ConvexCast::box_at(const double from[3]) const noexcept {
  return extent().moved(Vector3d::Map(from));
}

// The plane of an earlier contact bounds the shape at t = limit. The shape approaches this plane,
// so it is in front of the plane at all earlier times too and does not reach a triangle behind it.
bool ConvexCast::is_beyond(const SubShape& part, const CastContact& before) const noexcept {
  const Vector3d normal = as_eigen(before.normal);
  if (!is_unrotated(part)) return false;
  const Vector3d position = as_eigen(part.pose.position);
  double top = -mid::kInfinity;
  double size = 0.0;
  for (const auto& corner : part.triangle->vertex) {
    const Vector3d at = position + as_eigen(corner);
    top = std::max(top, normal.dot(at));
    size = std::max(size, at.cwiseAbs().sum());
  }
  return top + mid::kSlack * size + 4.0 * corner_error(part) < before.height;
}

bool ConvexCast::is_beside(const double from[3], const SubShape& part,
                           double limit) const noexcept {
  if (!is_unrotated(part)) return false;
  const Vector3d way = Vector3d::Map(direction());
  // Relative to the shape's position at t = limit.
  const Vector3d to_part = as_eigen(part.pose.position) - Vector3d::Map(from) - limit * way;
  Vector3d corner[3];
  double size = extent().min.cwiseAbs().sum() + extent().max.cwiseAbs().sum() +
                Vector3d::Map(from).cwiseAbs().sum() + limit * way.cwiseAbs().sum();
  for (int k = 0; k < 3; ++k) {
    corner[k] = to_part + as_eigen(part.triangle->vertex[k]);
    size = std::max(size, corner[k].cwiseAbs().sum());
  }
  const Vector3d axis =
      mid::direction_to(middle_ - corner[0], corner[1] - corner[0], corner[2] - corner[0]);
  if (!(axis.dot(way) < -mid::kSlack * axis.cwiseAbs().sum() * way.cwiseAbs().sum())) return false;
  const double low = mid::extent(shapes_.tables(), cast_.shape, to_shape_ * axis).low;
  const double top = std::max({axis.dot(corner[0]), axis.dot(corner[1]), axis.dot(corner[2])});
  return low - top > (4.0 * mid::kSlack * size + 4.0 * corner_error(part)) * axis.cwiseAbs().sum();
}

void ConvexCast::set_height(const double from[3], CastContact& contact) const noexcept {
  const Vector3d normal = as_eigen(contact.normal);
  const Vector3d way = Vector3d::Map(direction());
  const Vector3d start = Vector3d::Map(from);
  const double closing = -normal.dot(way);
  contact.height = -mid::kInfinity;
  if (!(closing > mid::kSlack * way.cwiseAbs().sum()) || contact.overlaps_at_start) return;
  const double low = mid::extent(shapes_.tables(), cast_.shape, to_shape_ * normal).low;
  const double sizes = start.cwiseAbs().sum() + contact.t * way.cwiseAbs().sum() +
                       extent().min.cwiseAbs().sum() + extent().max.cwiseAbs().sum();
  contact.height = normal.dot(start) - contact.t * closing + low - mid::kSlack * sizes;
}

void ConvexCast::note_contact(const double from[3], const SubShape& part,
                              impact::RestingContacts& resting) const noexcept {
  PartTables tables(shapes_);
  CastMotions(pair(tables, from, part), max_t()).record(tables.tables(), resting);
}

bool ConvexCast::find_contact(const double from[3], const SubShape& part, double limit,
                              const EarlierContacts& known, CastContact& contact) const noexcept {
  const CastContact* const before = known.before;
  double free_until = 0.0;
  if (part.triangle != nullptr) {
    if (before != nullptr && is_beyond(part, *before)) return false;
    if (passes_by(from, part, limit, free_until)) return false;
    if (before != nullptr && is_beside(from, part, limit)) return false;
    if (part.front != 0 && is_behind_triangle(box_at(from), part)) return false;
  }
  PartTables tables(shapes_);
  CastPair cast_pair = pair(tables, from, part);
  cast_pair.max_t = limit;
  cast_pair.free_until = free_until;
  if (before != nullptr && !before->overlaps_at_start)
    cast_pair.separating_direction = before->normal;
  if (known.resting != nullptr &&
      CastMotions(cast_pair, max_t()).part(tables.tables(), *known.resting)) {
    return false;
  }
  CastTouch touch;
  if (!cast_shape(tables.tables(), cast_pair, tolerance(), touch)) return false;
  contact = contact_of(touch);
  set_height(from, contact);
  return true;
}

void ConvexCast::describe(const double from[3], const SubShape& part,
                          CastContact& contact) const noexcept {
  PartTables tables(shapes_);
  const CastPair cast_pair = pair(tables, from, part);
  describe_contact(tables.tables(), cast_pair, part, contact);
}

void BodyContact::take(const SubShape& part, const CastContact& contact) noexcept {
  contact_ = contact;
  part_ = part;
  if (part.triangle != nullptr) triangle_ = *part.triangle;
}

void BodyContact::note_contacts(const SubShapeQuery& parts, const LinearCast& linear_cast,
                                const PlacedShape& placed,
                                impact::RestingContacts& resting) const noexcept {
  auto record = [&](const SubShape& part, double most) {
    linear_cast.note_contact(from_.data(), part, resting);
    return most;
  };
  parts.visit_parts(
      placed, moving_box_from(linear_cast, from_.data(), 0.0, linear_cast.tolerance()), record);
}

bool BodyContact::find(const SubShapeQuery& parts, const ShapeRay& ray, const PlacedShape& body,
                       double limit, bool any) noexcept {
  PartHit hit;
  parts.cast_rays(body, {&ray, 1}, &limit, any, nullptr, &hit);
  if (!hit.found) return false;
  ShapeRay own = ray;
  own.origin = from_;
  take({body.shape, body.pose, hit.part}, contact_at(own, hit.t, hit.normal));
  return true;
}

bool BodyContact::find(const SubShapeQuery& parts, const LinearCast& linear_cast,
                       const PlacedShape& body, double limit, bool any) noexcept {
  CastContact contact;
  impact::RestingContacts resting(0.0, linear_cast.tolerance(),
                                  impact::StartTouch::impact_unless_sliding);
  const impact::RestingContacts* const at_rest = linear_cast.hits_at_start() ? nullptr : &resting;
  if (!body.shape.is_composite()) {
    from_ = Vec3d(linear_cast.start());
    base_ = {};
    const SubShape whole{body.shape, body.pose};
    if (at_rest != nullptr) linear_cast.note_contact(from_.data(), whole, resting);
    if (!linear_cast.find_contact(from_.data(), whole, limit, {nullptr, at_rest}, contact))
      return false;
    take(whole, contact);
    return true;
  }
  // The sweep is computed relative to the body, so that parts keep full precision far from the
  // origin. The rounding error of the difference is added to the pose, where it is small.
  base_ = body.pose.position;
  const TwoDiff start = difference(linear_cast.start(), base_.data());
  from_ = start.difference;
  if (linear_cast.ray() != nullptr) return find(parts, *linear_cast.ray(), body, limit, any);
  PlacedShape placed = body;
  for (int i = 0; i < 3; ++i) placed.pose.position[i] = -start.rest[i];
  if (at_rest != nullptr) note_contacts(parts, linear_cast, placed, resting);
  bool found = false;
  const auto improve = [&](const SubShape& part) {
    if (found && contact.t == contact_.t && part_.part < part.part) return limit;
    found = true;
    limit = contact.t;
    take(part, contact);
    return any ? -1.0 : limit;
  };
  auto test_part = [&](const SubShape& part, double most) {
    most = std::min(most, limit);
    const LinearCast::EarlierContacts known{found ? &contact_ : nullptr, at_rest};
    return linear_cast.find_contact(from_.data(), part, most, known, contact) ? improve(part)
                                                                              : most;
  };
  parts.visit_parts(placed, moving_box_from(linear_cast, from_.data(), limit), test_part);
  return found;
}

SceneHit BodyContact::hit(const LinearCast& linear_cast) const noexcept {
  SubShape part = part_;
  if (part.triangle != nullptr) part.triangle = &triangle_;
  CastContact contact = contact_;
  linear_cast.describe(from_.data(), part, contact);
  SceneHit hit;
  hit.t = contact.t;
  hit.part = part.part;
  for (int i = 0; i < 3; ++i) {
    hit.normal[i] = contact.normal[i];
    hit.point[i] = base_[i] + contact.point[i];
  }
  return hit;
}

}  // namespace winnow
