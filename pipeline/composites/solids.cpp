// Tests whether points are inside solid meshes; see solids.h.

#include "pipeline/composites/solids.h"

#include "pipeline/mesh/mesh_rays.kernel.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace winnow::mid {
namespace {

/// Computes the winding number of a mesh about a point: 1 inside, 0 outside, larger in regions in
/// which the mesh overlaps itself. The point is in the frame of the mesh.
class Winding {
 public:
  Winding(const TransformedShape& body, const Vec& at) noexcept : body_(body), at_(at) {
    const Vec corner = body.bounds.min.cwiseAbs().cwiseMax(body.bounds.max.cwiseAbs());
    slack_ = kRaySlack * (at.cwiseAbs().maxCoeff() + corner.maxCoeff());
  }

  /// A ray from an inside point leaves the solid once more than it enters it. A ray is inconclusive
  /// if it hits an edge, or if rounding errors decide whether it hits a triangle: then the next
  /// direction is tried. If all directions are inconclusive, as for points on the surface, the
  /// solid angle decides.
  [[nodiscard]] bool is_inside() noexcept {
    // Directions that are unlikely to be parallel to edges. The largest component is in [1/2, 1).
    static constexpr double kDirections[][3] = {
        {0.2718, 0.5312, 0.8147},    {-0.6180, 0.9134, -0.3090}, {0.9058, -0.1270, -0.4142},
        {-0.3219, -0.7321, 0.6324},  {0.0975, 0.2785, -0.5469},  {-0.9575, -0.2113, 0.1576},
        {0.4853, -0.8003, -0.14189}, {-0.1419, 0.4218, 0.9157}};
    for (const double(&direction)[3] : kDirections) {
      crossings_ = 0;
      is_uncertain_ = false;
      shoot(direction);
      if (!is_uncertain_) return crossings_ > 0;
    }
    return solid_angle() > 2.0 * std::numbers::pi;
  }

  /// Solid angle of the mesh: 4 pi times the winding number (van Oosterom, Strackee, "The solid
  /// angle of a plane triangle", 1983). O(n).
  [[nodiscard]] double solid_angle() const noexcept {
    double sum = 0.0;
    for (std::uint32_t slot = 0; slot < body_.mesh->triangle_count; ++slot) {
      double corner[3][3];
      (void)body_.own_corners(slot, corner);
      const Vec a = Vec::Map(corner[0]) - at_;
      const Vec b = Vec::Map(corner[1]) - at_;
      const Vec c = Vec::Map(corner[2]) - at_;
      const double lengths[3] = {a.norm(), b.norm(), c.norm()};
      const double under = lengths[0] * lengths[1] * lengths[2] + a.dot(b) * lengths[2] +
                           b.dot(c) * lengths[0] + c.dot(a) * lengths[1];
      sum += 2.0 * std::atan2(a.dot(b.cross(c)), under);
    }
    return sum;
  }

 private:
  void shoot(const Vec3d& direction) noexcept {
    SingleSurfaceRay single;
    for (int axis = 0; axis < 3; ++axis) {
      single.ray.origin[axis][0] = at_[axis];
      single.ray.direction[axis][0] = direction[axis];
    }
    single.slack[0] = slack_;
    single.shift[0] = 0.0;
    single.t_scale[0] = 1.0;
    single.low[0] = 0.0;
    single.high[0] = std::numeric_limits<double>::infinity();
    mesh_ray_kernels().all(*body_.mesh, single, single.high[0],
                           {[](void* context, std::uint32_t, const SurfaceHit& hit, double limit) {
                              static_cast<Winding*>(context)->crossings_ +=
                                  hit.from_behind ? 1 : -1;
                              return limit;
                            },
                            [](void* context, std::uint32_t, double) {
                              static_cast<Winding*>(context)->is_uncertain_ = true;
                              return -1.0;
                            },
                            this});
  }
  const TransformedShape& body_;
  const Vec at_;
  double slack_;
  int crossings_ = 0;
  bool is_uncertain_ = false;
};

/// `body` is a solid mesh; `point` is in world coordinates.
[[nodiscard]] bool is_in_mesh(const TransformedShape& body, const Vec& point) noexcept {
  const Vec own = body.to_local * (point - body.position);
  const bool in_box = (own.array() >= body.bounds.min.array()).all() &&
                      (own.array() <= body.bounds.max.array()).all();
  return in_box && Winding(body, own).is_inside();
}

/// Calls visit(body) for each child of a compound that has surfaces, or for the body itself, until
/// it returns true. Returns whether it did.
template <typename Visit>
[[nodiscard]] bool any_body(const TransformedShape& body, Visit&& visit) {
  if (!body.has_surfaces()) return visit(body);
  for (std::uint32_t i = 0; i < body.compound->count; ++i) {
    if (visit(body.child(i))) return true;
  }
  return false;
}

[[nodiscard]] bool is_in_solid(const TransformedShape& body, const Vec& point) noexcept {
  return any_body(body, [&](const TransformedShape& one) {
    return one.kind == TransformedShape::Kind::mesh && one.all.is_solid(one.id) &&
           is_in_mesh(one, point);
  });
}

/// Finds a point of part `number`. `body` must not be a compound that has surfaces. Returns false
/// for shapes that no solid can contain: half-spaces, and triangles of holes.
[[nodiscard]] bool find_point(const TransformedShape& body, std::uint32_t number,
                              Vec& point) noexcept {
  if (body.is_surface()) {
    Corners corners{};
    const bool found = body.corners(number, corners);
    point = corners.first;
    return found;
  }
  const PlacedPart part = body.part(number);
  point = part.position + part.middle;
  if (part.shape.kind() == ShapeKind::triangle) {
    const TriangleShape& triangle = body.tables.triangles[part.shape.index()];
    point = part.position + part.rotation * as_eigen(triangle.vertex[0]);
  }
  return part.shape.kind() != ShapeKind::half_space;
}

/// Calls visit(point) until it returns true, for a corner of the first triangle of each surface and
/// a point of each convex part. Returns whether a call returned true.
template <typename Visit>
[[nodiscard]] bool any_point(const TransformedShape& body, Visit&& visit) {
  return any_body(body, [&](const TransformedShape& one) {
    const std::uint32_t points =
        one.kind == TransformedShape::Kind::compound ? one.compound->count : 1;
    for (std::uint32_t i = 0; i < points; ++i) {
      Vec point;
      if (find_point(one, i, point) && visit(point)) return true;
    }
    return false;
  });
}

/// True if a solid contains one of the points of another shape.
[[nodiscard]] bool contains_any(const TransformedShape& solid,
                                const TransformedShape& other) noexcept {
  return any_point(other, [&](const Vec& point) { return is_in_solid(solid, point); });
}

}  // namespace

double winding_number(const Composites& all, ShapeId mesh, const Vec3d& point) noexcept {
  const TransformedShape body = TransformedShape::at(all, mesh, {}, Solids::triangles);
  const Vec own = body.to_local * as_eigen(point);
  return Winding(body, own).solid_angle() / (4.0 * std::numbers::pi);
}

bool has_solids(const CompositePool& pool, ShapeId id) noexcept {
  const Composites* const all = composites_with(pool, id);
  if (all == nullptr || all->solid.empty()) return false;
  return any_body(TransformedShape::at(*all, id, {}), [](const TransformedShape& one) {
    return one.kind == TransformedShape::Kind::mesh && one.all.is_solid(one.id);
  });
}

bool solid_contains_point(const CompositePool& pool, ShapeId id, const Pose& pose,
                          const Vec3d& point) noexcept {
  const Composites* const all = composites_with(pool, id);
  return all != nullptr && !all->solid.empty() &&
         is_in_solid(TransformedShape::at(*all, id, pose, Solids::triangles), as_eigen(point));
}

bool solid_contains_shape(const CompositePool& pool, ShapeId id, const Pose& pose, ShapeId other,
                          const Pose& other_pose) noexcept {
  const Composites* const all = composites_with(pool, id);
  if (all == nullptr || all->solid.empty()) return false;
  return contains_any(TransformedShape::at(*all, id, pose),
                      TransformedShape::at(*all, other, other_pose));
}

bool is_either_inside(const TransformedShape& a, const TransformedShape& b) noexcept {
  return !a.all.solid.empty() && (contains_any(a, b) || contains_any(b, a));
}

}  // namespace winnow::mid
