// cast_ray: moves a ray into a shape's frame, scales both into the range of double, calls `enter`
// (shape_entries.h) and transforms the hit back. find_exit casts the reversed ray.

#include <winnow/core/pose.h>
#include <winnow/pipeline/shape_rays.h>
#include "core/numbers/rotation.h"
#include "core/threads/float_environment.h"
#include "pipeline/rays/shape_entries.h"
#include "pipeline/shapes/extent.h"
#include "pipeline/shapes/two_diff.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow {
namespace {

using Eigen::Vector3d;

/// The exponent e such that length * 2^-e is in [1/2, 1); 0 if the length is 0.
[[nodiscard]] int exponent_of(double length) noexcept {
  int exponent = 0;
  if (length > 0.0) std::frexp(length, &exponent);
  // Keeps 2^-exponent within the range of double.
  return std::clamp(exponent, -1000, 1000);
}

/// A ray relative to a body's position, in world axes, scaled. The caller's t is (shift + local t *
/// 2^t_exponent) * 2^exponent.
struct RelativeRay {
  Vector3d origin;
  Vector3d direction;
  double shift = 0.0;
  int t_exponent = 0;
  int exponent = 0;
  int lengths = 0;  // the shape's lengths are multiplied by 2^-lengths
};

/// Scales the ray by powers of two. If it begins far from the shape, its origin is first moved to
/// the point of the ray nearest to the shape's origin. The rounding errors of this step are
/// computed and added, so that the result is as accurate as for a ray that begins at that point.
[[nodiscard]] RelativeRay approach(const ShapeRay& ray, const Pose& pose, double size,
                                   bool may_move) noexcept {
  constexpr double kFar = 8.0;
  const Vector3d direction = as_eigen(ray.direction);
  // Lengths are multiplied by this, because the difference of two doubles may overflow.
  constexpr double kQuarter = 0.25;
  const Vector3d from = kQuarter * as_eigen(pose.position);
  const Vector3d to = kQuarter * as_eigen(ray.origin);
  const Vector3d between = to - from;
  const double reach = between.cwiseAbs().maxCoeff();
  RelativeRay result;
  const int distance = exponent_of(std::max(reach, kQuarter * size));
  const int speed = exponent_of(direction.cwiseAbs().maxCoeff());
  result.direction = std::ldexp(1.0, -speed) * direction;
  const double unit = std::ldexp(1.0, -distance);
  result.origin = unit * between;
  result.exponent = distance + 2 - speed;
  if (may_move && reach > kFar * kQuarter * size) {
    const double nearest = -result.origin.dot(result.direction) / result.direction.squaredNorm();
    for (int k = 0; k < 3; ++k) {
      const double back = between[k] - to[k];
      const double lost = (to[k] - (between[k] - back)) + (-from[k] - back);
      result.origin[k] = moved(result.origin[k], unit * lost, nearest, result.direction[k]);
    }
    result.shift = nearest;
  }
  const double scaled_size = unit * kQuarter * size;
  result.t_exponent = exponent_of(std::max(result.origin.cwiseAbs().maxCoeff(), scaled_size));
  result.origin *= std::ldexp(1.0, -result.t_exponent);
  result.lengths = distance + 2 + result.t_exponent;
  return result;
}

/// Returns the local t of a t of the caller, limited to the largest double.
[[nodiscard, gnu::noinline]] double local_time(const RelativeRay& relative, double t) noexcept {
  return std::min(
      std::ldexp(std::ldexp(t, -relative.exponent) - relative.shift, -relative.t_exponent),
      std::numeric_limits<double>::max());
}

template <typename Shape>
void cast(const Shape& shape, const Pose& pose, const ShapeRay& ray, ShapeHit& hit,
          bool& starts_inside) noexcept {
  constexpr bool kBounded = !std::is_same_v<Shape, HalfSpaceShape>;
  const RelativeRay relative = approach(ray, pose, size_of(shape), kBounded);
  const Eigen::Matrix3d turn = rotation_of_unit(normalized(scale_to_unit_max(pose.orientation)));
  LocalRay local;
  local.origin = turn.transpose() * relative.origin;
  local.direction = turn.transpose() * relative.direction;
  local.speed = local.direction.norm();
  local.low = std::ldexp(-relative.shift, -relative.t_exponent);
  if (ray.min_t > 0.0) [[unlikely]]
    local.low = local_time(relative, ray.min_t);
  const FirstEntry entry = enter(local, shape, std::ldexp(1.0, -relative.lengths));
  starts_inside = entry.found && entry.inside;
  hit = {};
  if (!entry.found) return;
  const double t = entry.inside
                       ? ray.min_t
                       : std::ldexp(relative.shift + std::ldexp(entry.t, relative.t_exponent),
                                    relative.exponent);
  if (!(t <= ray.max_t) || t < 0.0 || std::isinf(t)) return;
  hit.hit = true;
  hit.t = std::max(t, ray.min_t);
  Vector3d normal = turn * entry.normal;
  if (entry.inside || normal.isZero(0.0)) normal = -relative.direction;
  as_eigen(hit.normal) = normal.normalized();
}

/// Returns the ray from a point behind the shape, which is at the origin, back to the start of a
/// ray. `end` is the parameter of that point: t of the reversed ray is `end` - t.
[[nodiscard]] ShapeRay reversed(const ShapeRay& ray, const Vec3d& position, double radius,
                                double& end) noexcept {
  const TwoDiff from = difference(ray.origin.data(), position.data());
  const Vector3d start = Vector3d::Map(from.difference);
  const double speed = as_eigen(ray.direction).stableNorm();
  const Vector3d way = as_eigen(ray.direction) / speed;
  // The shape is not beyond this point, whose rounding the slack covers.
  constexpr double kSlack = 1e-12;
  end = (radius - way.dot(start)) / speed + kSlack * (radius + start.norm()) / speed;
  ShapeRay back;
  for (int i = 0; i < 3; ++i) {
    back.origin[i] = moved(from.difference[i], from.rest[i], end, ray.direction[i]);
    back.direction[i] = -ray.direction[i];
  }
  back.max_t = end - ray.min_t;
  return back;
}

}  // namespace

bool is_valid(const ShapeRay& ray) noexcept {
  double rest = 0.0;
  bool moves = false;
  for (int axis = 0; axis < 3; ++axis) {
    // x - x is zero only if x is finite.
    rest += (ray.origin[axis] - ray.origin[axis]) + (ray.direction[axis] - ray.direction[axis]);
    moves |= ray.direction[axis] != 0.0;
  }
  rest += ray.min_t - ray.min_t;
  return rest == 0.0 && moves && ray.min_t >= 0.0 && ray.max_t >= ray.min_t;
}

Answer<ShapeHit> cast_ray(const ShapeTables& tables, ShapeId shape, const Pose& pose,
                          const ShapeRay& ray) noexcept {
  const DefaultFloatEnvironment environment;
  if (shape.kind_index() >= kShapeKinds || shape.index() >= tables.count[shape.kind_index()]) {
    return Status::invalid_key;
  }
  if (!is_valid(ray)) return Status::invalid_argument;
  if (!pose.is_valid()) return Status::invalid_pose;
  ShapeHit hit;
  bool starts_inside = false;
  with_shape(tables, shape, [&](const auto& one) { cast(one, pose, ray, hit, starts_inside); });
  return hit;
}

ShapeHit find_entry(const ShapeTables& tables, ShapeId shape, const Pose& pose, const ShapeRay& ray,
                    bool& starts_inside) noexcept {
  ShapeHit hit;
  with_shape(tables, shape, [&](const auto& one) { cast(one, pose, ray, hit, starts_inside); });
  return hit;
}

ShapeHit find_exit(const ShapeTables& tables, ShapeId shape, const Pose& pose,
                   const ShapeRay& ray) noexcept {
  bool starts_inside = false;
  if (shape.kind() == ShapeKind::half_space) {
    // The ray leaves the half-space where it enters the opposite one.
    HalfSpaceShape opposite = tables.half_spaces[shape.index()];
    opposite.normal = -opposite.normal;
    opposite.offset = -opposite.offset;
    ShapeHit hit;
    cast(opposite, pose, ray, hit, starts_inside);
    if (starts_inside) return {};
    hit.normal = -hit.normal;
    return hit;
  }
  double end = 0.0;
  const ShapeRay back = reversed(ray, pose.position, mid::radius_of(tables, shape), end);
  if (!is_valid(back)) return {};
  ShapeHit hit = find_entry(tables, shape, {.orientation = pose.orientation}, back, starts_inside);
  hit.t = std::max(end - hit.t, ray.min_t);
  return hit.hit && hit.t <= ray.max_t ? hit : ShapeHit{};
}

}  // namespace winnow
