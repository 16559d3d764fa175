// A ray and the triangles of a surface, in the surface's own frame: neither the surface nor its
// triangles are moved.

#include "pipeline/composites/composites.h"
#include "pipeline/composites/placed_body.h"
#include "pipeline/mesh/height_grid.h"
#include "pipeline/mesh/mesh_rays.h"

#include <algorithm>
#include <cmath>

namespace winnow::mid {
namespace {

/// Beyond this, products of lengths may leave the range of double.
constexpr double kMostLength = 1e150;
/// Of coordinates: some roundings of a ray on its way into a surface's frame, and of triangles on
/// theirs into the world.
constexpr double kRaySlack = 0x1p-46;

/// A ray in the frame of a surface: the caller's t is shift + own t * stretch.
struct OwnRay {
  SurfaceRay ray;
  double shift = 0.0;
  double stretch = 1.0;

  [[nodiscard]] double own(double t) const noexcept { return (t - shift) / stretch; }
  /// Not less than what rounding makes of it.
  [[nodiscard]] double own_limit(double t) const noexcept {
    return own(t) + 0x1p-51 * (std::abs(t) + std::abs(shift)) / stretch;
  }
};

/// a - b + t * d, whose rounding is that of the result and not of the terms.
[[nodiscard]] double moved(double a, double b, double t, double d) noexcept {
  const double between = a - b;
  const double back = between - a;
  const double lost = (a - (between - back)) + (-b - back);
  const double step = t * d;
  const double step_error = std::fma(t, d, -step);
  const double sum = between + step;
  const double half = sum - step;
  const double sum_error = (between - half) + (step - (sum - half));
  return sum + (sum_error + step_error + lost);
}

/// A ray that begins far away is moved to where it comes near the surface. False for one whose
/// numbers are too large or too small for that.
[[nodiscard]] bool to_own(const PlacedBody& body, const ShapeRay& ray, OwnRay& out) noexcept {
  const Eigen::Map<const Vec> origin(ray.origin);
  const Eigen::Map<const Vec> direction(ray.direction);
  const Vec between = origin - body.position;
  const Vec reach = body.bounds.min.cwiseAbs().cwiseMax(body.bounds.max.cwiseAbs());
  const double size = (body.to_world.cwiseAbs() * reach).sum();
  const double fastest = direction.cwiseAbs().maxCoeff();
  if (!(between.cwiseAbs().maxCoeff() < kMostLength && size < kMostLength &&
        fastest < kMostLength && fastest > 1.0 / kMostLength)) {
    return false;
  }
  const double nearest = -between.dot(direction) / direction.squaredNorm();
  out.shift = std::max(0.0, nearest - 4.0 * size / fastest);
  Vec start = between;
  if (out.shift > 0.0) {
    for (int i = 0; i < 3; ++i) {
      start[i] = moved(origin[i], body.position[i], out.shift, direction[i]);
    }
  }
  const Vec own_direction = body.to_local * direction;
  int exponent = 0;
  std::frexp(own_direction.cwiseAbs().maxCoeff(), &exponent);
  out.stretch = std::ldexp(1.0, -exponent);
  Vec::Map(out.ray.direction) = own_direction * out.stretch;
  Vec::Map(out.ray.origin) = body.to_local * start;
  const Vec coordinates = body.to_local.cwiseAbs() * (start.cwiseAbs() + body.position.cwiseAbs());
  out.ray.slack = kRaySlack * (coordinates.maxCoeff() + reach.maxCoeff());
  return true;
}

/// Tells of the numbers that a traversal finds.
struct RayGuide {
  const PlacedBody& body;
  const OwnRay& own;
  const RayVisitor& visitor;
  /// In the caller's t.
  double limit;
  /// Between which the ray is there, in own t.
  double first = own.own(0.0);
  double last = own.own(limit);

  [[nodiscard]] double show(std::uint32_t number) const {
    double corner[3][3];
    if (!body.own_corners(number, corner)) return limit;
    SurfaceHit found;
    switch (cross_triangle(own.ray, corner, first, last, found)) {
      case Crossing::none:
        return limit;
      case Crossing::found: {
        ShapeHit hit;
        hit.hit = true;
        hit.t = own.shift + found.t * own.stretch;
        if (!(hit.t <= limit)) return limit;
        Vec::Map(hit.normal) =
            (body.to_local.transpose() * Vec::Map(found.normal).stableNormalized()).normalized();
        return visitor.meet(visitor.context, body.shown_number(number), hit, limit);
      }
      case Crossing::doubtful:
        break;
    }
    Primitive primitive;
    if (!body.primitive(number, primitive)) return limit;
    return visitor.look(visitor.context, primitive, limit);
  }

  static double show_slots(void* context, const std::uint32_t* slots, std::uint32_t count,
                           double own_limit) {
    RayGuide& guide = *static_cast<RayGuide*>(context);
    const double before = guide.limit;
    for (std::uint32_t i = 0; i < count && guide.limit >= 0.0; ++i) {
      guide.limit = guide.show(slots[i]);
    }
    if (guide.limit < 0.0) return -1.0;
    return guide.limit < before ? guide.own.own_limit(guide.limit) : own_limit;
  }
};

/// Shows all that the ray's box meets.
void look_at_all(const Composites& all, ShapeId id, const Pose& pose, const ShapeRay& ray,
                 const RayVisitor& visitor) {
  // By this much of its coordinates a box is grown before the tests of boxes, which round them.
  constexpr double kGrowth = 0x1p-47;
  BoxSweep sweep;
  const double grow = kGrowth * Eigen::Map<const Vec>(ray.origin).cwiseAbs().maxCoeff();
  for (int i = 0; i < 3; ++i) {
    sweep.min[i] = ray.origin[i] - grow;
    sweep.max[i] = ray.origin[i] + grow;
    sweep.direction[i] = ray.direction[i];
  }
  sweep.max_t = ray.max_t;
  visit(all, id, pose, sweep, {visitor.look, visitor.context});
}

}  // namespace

void visit_ray(const Composites& all, ShapeId id, const Pose& pose, const ShapeRay& ray,
               const RayVisitor& visitor) {
  const PlacedBody body = PlacedBody::at(all, id, pose);
  OwnRay own;
  if (!body.is_surface() || !to_own(body, ray, own)) {
    look_at_all(all, id, pose, ray, visitor);
    return;
  }
  RayGuide guide{body, own, visitor, ray.max_t};
  const SlotVisitor slots{&RayGuide::show_slots, &guide};
  const double limit = own.own_limit(ray.max_t);
  if (body.kind == PlacedBody::Kind::mesh) {
    mesh_ray(*body.mesh, own.ray, limit, slots);
    return;
  }
  const Vec start = Vec::Map(own.ray.origin);
  const Vec low = start.array() - own.ray.slack;
  const Vec high = start.array() + own.ray.slack;
  height_sweep(grid_of(*body.field), low.data(), high.data(), own.ray.direction, limit, slots);
}

}  // namespace winnow::mid
