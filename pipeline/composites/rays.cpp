// A ray and the triangles of a surface, in the surface's own frame: neither the surface nor its
// triangles are moved.

#include "pipeline/composites/composites.h"
#include "pipeline/composites/placed_body.h"
#include "pipeline/mesh/height_grid.h"
#include "pipeline/mesh/mesh_rays.h"
#include "pipeline/shapes/difference.h"

#include <algorithm>
#include <bit>
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
  double shift;
  double stretch;

  [[nodiscard]] double own(double t) const noexcept { return (t - shift) / stretch; }
  /// Not less than what rounding makes of it.
  [[nodiscard]] double own_limit(double t) const noexcept {
    return own(t) + 0x1p-51 * (std::abs(t) + std::abs(shift)) / stretch;
  }
};

/// matrix * v in one piece: a ray has time for no calls.
[[nodiscard]] inline Vec times(const Mat& matrix, const Vec& v) noexcept {
  return matrix.col(0) * v[0] + matrix.col(1) * v[1] + matrix.col(2) * v[2];
}

/// A vector, transformed, of length 1.
[[nodiscard]] Vec unit_under(const Mat& matrix, const Vec& v) noexcept {
  const Vec plain = matrix * v;
  const double square = plain.squaredNorm();
  constexpr double kSafe = 1e200;
  if (square > 1.0 / kSafe && square < kSafe) return plain * (1.0 / std::sqrt(square));
  return (matrix * v.stableNormalized()).stableNormalized();
}

/// The power of two that brings x, which is positive, into [1/2, 1).
[[nodiscard]] double scale_to_one(double x) noexcept {
  constexpr std::uint64_t kMostExponent = 2045;
  const std::uint64_t exponent = std::bit_cast<std::uint64_t>(x) >> 52;
  if (exponent != 0 && exponent < kMostExponent) {
    return std::bit_cast<double>((kMostExponent - exponent) << 52);
  }
  int power = 0;
  std::frexp(x, &power);
  return std::ldexp(1.0, -power);
}

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

/// A surface that rays come to, all about its position: its own is zero.
struct RayTarget {
  RayTarget(const Composites& all, ShapeId id, const Pose& pose) noexcept
      : body(all, all.shapes.tables(), id, pose, Vec::Zero()), position(Vec::Map(pose.position)) {
    const Vec corner = body.bounds.min.cwiseAbs().cwiseMax(body.bounds.max.cwiseAbs());
    reach = corner.maxCoeff();
    size = (body.to_world.cwiseAbs() * corner).sum();
  }

  PlacedBody body;
  /// Where it is in the world.
  Vec position;
  /// Of its coordinates, in its own lengths and in the world's.
  double reach;
  double size;
};

/// A ray that begins far away is moved to where it comes near the surface. False for one whose
/// numbers are too large or too small for that.
[[nodiscard]] bool to_own(const RayTarget& target, const ShapeRay& ray, OwnRay& out) noexcept {
  const PlacedBody& body = target.body;
  const Eigen::Map<const Vec> origin(ray.origin);
  const Eigen::Map<const Vec> direction(ray.direction);
  Vec start = origin - target.position;
  const double fastest = direction.cwiseAbs().maxCoeff();
  if (!(start.cwiseAbs().maxCoeff() < kMostLength && target.size < kMostLength &&
        fastest < kMostLength && fastest > 1.0 / kMostLength)) {
    return false;
  }
  // Where it is nearest comes after this much of the way.
  const double towards = -start.dot(direction);
  const double square = direction.squaredNorm();
  out.shift = 0.0;
  if (towards > 4.0 * target.size * (square / fastest)) {
    out.shift = std::max(0.0, towards / square - 4.0 * target.size / fastest);
    for (int i = 0; i < 3; ++i) {
      start[i] = moved(origin[i], target.position[i], out.shift, direction[i]);
    }
  }
  const Vec own_direction = times(body.to_local, direction);
  out.stretch = scale_to_one(own_direction.cwiseAbs().maxCoeff());
  Vec::Map(out.ray.direction) = own_direction * out.stretch;
  Vec::Map(out.ray.origin) = times(body.to_local, start);
  const Vec coordinates = times(body.to_local.cwiseAbs(), start.cwiseAbs());
  out.ray.slack = kRaySlack * (coordinates.maxCoeff() + target.reach);
  return true;
}

/// Takes a ray through a surface, and tells of the triangles that it meets.
struct RayGuide {
  const RayTarget* target;
  const ShapeRay* ray;
  /// As the visitor knows it.
  std::size_t number;
  const RayVisitor* visitor;
  OwnRay own;
  /// In the caller's t.
  double limit;
  /// Between which the ray is there, in own t.
  double first;
  double last;

  /// False if that takes other ways.
  [[nodiscard]] bool start(const RayTarget& to, const ShapeRay& asked, std::size_t as,
                           const RayVisitor& tells) noexcept {
    target = &to;
    ray = &asked;
    number = as;
    visitor = &tells;
    if (!to_own(to, asked, own)) return false;
    limit = asked.max_t;
    first = own.own(0.0);
    last = own.own(limit);
    return true;
  }

  [[nodiscard]] double show(std::uint32_t slot) const {
    const PlacedBody& body = target->body;
    double corner[3][3];
    if (!body.own_corners(slot, corner)) return limit;
    SurfaceHit found;
    switch (cross_triangle(own.ray, corner, first, last, found)) {
      case Crossing::none:
        return limit;
      case Crossing::found: {
        ShapeHit hit;
        hit.hit = true;
        hit.t = own.shift + found.t * own.stretch;
        if (!(hit.t <= limit) || comes_from_behind(corner)) return limit;
        Vec::Map(hit.normal) = unit_under(body.to_local.transpose(), Vec::Map(found.normal));
        return visitor->meet(visitor->context, number, body.shown_number(slot), hit, limit);
      }
      case Crossing::doubtful:
        return look(slot);
    }
    return limit;
  }

  /// The front is that of the surface's own frame.
  [[nodiscard]] bool comes_from_behind(const double (&corner)[3][3]) const noexcept {
    if (target->body.front == 0) return false;
    const Vec at = Vec::Map(corner[0]);
    const Vec normal = (Vec::Map(corner[1]) - at).cross(Vec::Map(corner[2]) - at);
    return normal.dot(Vec::Map(own.ray.direction)) > 0.0;
  }

  /// What is lost of where the ray begins by being made relative to the body is put into where the
  /// body is, where it is small.
  [[nodiscard]] double look(std::uint32_t slot) const {
    PlacedBody body = target->body;
    body.position = -Vec::Map(difference(ray->origin, target->position.data()).rest);
    Primitive primitive;
    if (!body.primitive(slot, primitive)) return limit;
    return visitor->look(visitor->context, number, primitive, limit);
  }

  double show_slots(const std::uint32_t* slots, std::uint32_t count, double own_limit) {
    const double before = limit;
    for (std::uint32_t i = 0; i < count && limit >= 0.0; ++i) limit = show(slots[i]);
    if (limit < 0.0) return -1.0;
    return limit < before ? own.own_limit(limit) : own_limit;
  }
};

void take_through_mesh(const MeshView& mesh, RayGuide* guides, std::uint32_t count) {
  SurfaceRay rays[kRaysAtOnce];
  double limits[kRaysAtOnce];
  for (std::uint32_t i = 0; i < count; ++i) {
    rays[i] = guides[i].own.ray;
    limits[i] = guides[i].own.own_limit(guides[i].limit);
  }
  mesh_rays(mesh, {rays, count}, limits,
            {[](void* context, std::uint32_t ray, const std::uint32_t* slots, std::uint32_t found,
                double limit) {
               return static_cast<RayGuide*>(context)[ray].show_slots(slots, found, limit);
             },
             guides});
}

void take_through_field(const HeightField& field, RayGuide& guide) {
  const OwnRay& own = guide.own;
  const Vec start = Vec::Map(own.ray.origin);
  const Vec low = start.array() - own.ray.slack;
  const Vec high = start.array() + own.ray.slack;
  height_sweep(grid_of(field), low.data(), high.data(), own.ray.direction,
               own.own_limit(guide.limit),
               {[](void* context, const std::uint32_t* slots, std::uint32_t count, double limit) {
                  return static_cast<RayGuide*>(context)->show_slots(slots, count, limit);
                },
                &guide});
}

/// Shows all that the ray's box meets.
void look_at_all(const Composites& all, ShapeId id, const Pose& pose, const RayGuide& guide) {
  // By this much of its coordinates a box is grown before the tests of boxes, which round them.
  constexpr double kGrowth = 0x1p-47;
  const ShapeRay& ray = *guide.ray;
  Pose near = pose;
  const Difference between = difference(ray.origin, pose.position);
  Vec::Map(near.position) = -Vec::Map(between.rest);
  const Eigen::Map<const Vec> from(between.difference);
  const double grow = kGrowth * from.cwiseAbs().maxCoeff();
  BoxSweep sweep;
  for (int i = 0; i < 3; ++i) {
    sweep.min[i] = from[i] - grow;
    sweep.max[i] = from[i] + grow;
    sweep.direction[i] = ray.direction[i];
  }
  sweep.max_t = ray.max_t;
  visit(all, id, near, sweep,
        {[](void* context, const Primitive& primitive, double limit) {
           const RayGuide& to = *static_cast<const RayGuide*>(context);
           return to.visitor->look(to.visitor->context, to.number, primitive, limit);
         },
         const_cast<RayGuide*>(&guide)});
}

}  // namespace

void visit_rays(const Composites& all, ShapeId id, const Pose& pose, std::span<const ShapeRay> rays,
                const RayVisitor& visitor) {
  const RayTarget target(all, id, pose);
  const PlacedBody& body = target.body;
  RayGuide guides[kRaysAtOnce];
  std::uint32_t count = 0;
  const auto go = [&] {
    if (count != 0) take_through_mesh(*body.mesh, guides, count);
    count = 0;
  };
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!(rays[i].max_t >= 0.0)) continue;
    RayGuide& guide = guides[count];
    const bool starts = guide.start(target, rays[i], i, visitor);
    if (!body.is_surface() || !starts) {
      look_at_all(all, id, pose, guide);
    } else if (body.kind == PlacedBody::Kind::field) {
      take_through_field(*body.field, guide);
    } else if (++count == kRaysAtOnce) {
      go();
    }
  }
  go();
}

}  // namespace winnow::mid
