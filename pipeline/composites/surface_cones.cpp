// Normal cones of touched surfaces (surface_cones.h). Called by surface_contacts.cpp.

#include "pipeline/composites/surface_cones.h"

#include "core/numbers/rotation.h"
#include "pipeline/composites/mid_phase.h"
#include "pipeline/composites/transformed_shape.h"
#include "pipeline/mesh/height_grid.h"
#include "pipeline/mesh/mesh_traversal.h"
#include "pipeline/shapes/extent.h"
#include "pipeline/solver/solver.h"

#include <algorithm>
#include <cmath>

namespace winnow::mid {
namespace {

// Heights of corners along the normal that differ by less than this share of the longest edge count
// as equal.
constexpr double kLevel = 1e-6;
// Relative distance by which rounded vertices may be beside the edge of a triangle that contains
// them.
constexpr double kBeside = 1e-5;
// Distance, relative to the radius of a part, up to which parts of compounds lie flush.
constexpr double kFlush = 1e-5;
// Triangles around a point that are tested.
constexpr std::uint64_t kMaxAround = 64;

/// True if a corner is higher than a point along `outward`.
[[nodiscard]] bool rises(const Vec (&corner)[3], const Vec& point, const Vec& outward,
                         double slack) noexcept {
  return std::ranges::any_of(corner, [&](const Vec& at) {
    const Vec to_corner = at - point;
    return outward.dot(to_corner) > kNearlyFace * to_corner.norm() + slack;
  });
}

}  // namespace

Facet::Facet(const TriangleShape& triangle, const Pose& pose) noexcept {
  const auto at = as_eigen(pose.position);
  const Quaternion& q = pose.orientation;
  const bool is_turned = q[1] != 0.0 || q[2] != 0.0 || q[3] != 0.0;
  const Mat rotation = is_turned ? Mat(rotation_of(scale_to_unit_max(q))) : Mat(Mat::Identity());
  for (int k = 0; k < 3; ++k) {
    const auto vertex = as_eigen(triangle.vertex[k]);
    corner[k] = at + (is_turned ? Vec(rotation * vertex) : Vec(vertex));
  }
  const Vec edge[3] = {corner[1] - corner[0], corner[2] - corner[1], corner[0] - corner[2]};
  size = std::sqrt(std::max({edge[0].squaredNorm(), edge[1].squaredNorm(), edge[2].squaredNorm()}));
  const Vec across = edge[0].cross(edge[1]);
  const double length = across.norm();
  // Also false for NaN.
  normal = length > 0.0 && length < kInfinity ? Vec(across / length) : Vec(Vec::Zero());
}

bool Facet::contains(const Vec& point, double slack) const noexcept {
  if (normal.isZero()) return false;
  if (!(std::abs(normal.dot(point - corner[0])) <= slack)) return false;
  for (int k = 0; k < 3; ++k) {
    const Vec edge = corner[(k + 1) % 3] - corner[k];
    if (normal.cross(edge).dot(point - corner[k]) < -slack * edge.norm()) return false;
  }
  return true;
}

double Facet::top(const Vec& direction) const noexcept {
  return std::max({direction.dot(corner[0]), direction.dot(corner[1]), direction.dot(corner[2])});
}

bool Facet::shares_corner(const Facet& other) const noexcept {
  const double slack = kBeside * size;
  for (const Vec& p : corner) {
    for (const Vec& q : other.corner) {
      if ((p - q).squaredNorm() <= slack * slack) return true;
    }
  }
  return false;
}

Facet SurfaceCones::facet(std::uint32_t primitive) const noexcept {
  return {tables_.triangles[pairs_.shapes[primitive].index()], pairs_.poses[primitive]};
}

Vec SurfaceCones::touched_point(std::size_t i) const noexcept {
  const auto from = as_eigen(pairs_.poses[primitive(i, false)].position);
  if (result_.level() != ContactLevel::manifold) {
    return from + Vec(result_.point(0)[i], result_.point(1)[i], result_.point(2)[i]);
  }
  const ContactPoint contact = result_.contact(result_.contact_first()[i]);
  return from + as_eigen(contact.position).cast<double>();
}

bool SurfaceCones::has_normal(std::size_t i, const AnswerGroup& group) const noexcept {
  return has_normal(i, group, false) && has_normal(i, group, true);
}

bool SurfaceCones::has_normal(std::size_t i, const AnswerGroup& group, bool second) const noexcept {
  const std::uint32_t own = primitive(i, second);
  if (!is_triangle(own)) return !is_covered(i, group, second);
  const Facet triangle = facet(own);
  if (triangle.normal.isZero()) return true;
  const Vec outward = second ? Vec(-normal(i)) : normal(i);
  const double top = triangle.top(outward);
  std::size_t highest = 0;
  std::size_t at[3];
  for (std::size_t k = 0; k < 3; ++k) {
    if (top - outward.dot(triangle.corner[k]) <= kLevel * triangle.size) at[highest++] = k;
  }
  if (highest == 3) return true;
  Vec touched = triangle.corner[at[0]];
  if (highest == 2) {
    const Vec edge = triangle.corner[at[1]] - touched;
    const double along = edge.dot(touched_point(i) - touched) / edge.squaredNorm();
    touched += std::clamp(along, 0.0, 1.0) * edge;
  }

  const double slack = kBeside * triangle.size;
  Blocker blocker;
  const Surroundings near =
      around(touched, outward, slack, own, second, group, result_.distance()[i], blocker);
  // The touched point of shapes that are apart is within the margin of the other body, and so are
  // all triangles around it.
  const bool is_known = near == Surroundings::above || result_.distance()[i] > 0.0;
  const Surroundings all =
      is_known ? near : around_in_surface(touched, outward, slack, second, group, blocker);
  switch (all == Surroundings::none ? near : all) {
    case Surroundings::above:
      return false;
    case Surroundings::below:
      return true;
    case Surroundings::none:
      break;
  }
  // A mesh in a compound, no other triangle of which is touched here: the flags of its edges
  // decide.
  const std::uint32_t active = pairs_.active_edges[pairs_.shapes[own].index()];
  if (highest == 1) return (active >> (3 + at[0]) & 1U) != 0;
  const std::size_t edge = at[1] == at[0] + 1 ? at[0] : 2;
  return (active >> edge & 1U) != 0;
}

bool SurfaceCones::find_blocker(const Vec& point, const Vec& outward, double slack, bool second,
                                const AnswerGroup& group, Blocker& blocker) const noexcept {
  return around(point, outward, slack, kNoPrimitive, second, group, 0.0, blocker) ==
             Surroundings::above ||
         around_in_surface(point, outward, slack, second, group, blocker) == Surroundings::above;
}

// True if the box of a triangle contains the point, and for all turned triangles.
bool SurfaceCones::is_near(std::uint32_t primitive, const Vec& point, double slack) const noexcept {
  const Pose& pose = pairs_.poses[primitive];
  const TriangleShape& triangle = tables_.triangles[pairs_.shapes[primitive].index()];
  const Vec at = point - as_eigen(pose.position);
  const Quaternion& q = pose.orientation;
  if (q[1] != 0.0 || q[2] != 0.0 || q[3] != 0.0) return true;
  for (int axis = 0; axis < 3; ++axis) {
    const double x[3] = {triangle.vertex[0][axis], triangle.vertex[1][axis],
                         triangle.vertex[2][axis]};
    if (at[axis] < std::min({x[0], x[1], x[2]}) - slack) return false;
    if (at[axis] > std::max({x[0], x[1], x[2]}) + slack) return false;
  }
  return true;
}

// Triangles around the point of a contact are at most as far from the other body as the contact.
// Others of the group are left out, because the group depends on the margin.
SurfaceCones::Surroundings SurfaceCones::around(const Vec& point, const Vec& outward, double slack,
                                                std::uint32_t own, bool second,
                                                const AnswerGroup& group, double distance,
                                                Blocker& blocker) const noexcept {
  Surroundings found = Surroundings::none;
  for (std::size_t k = group.first; k < group.end; ++k) {
    const std::uint32_t other = primitive(k, second);
    if (other == own || !is_triangle(other)) continue;
    if (result_.distance()[k] > std::max(distance, 0.0) + slack) continue;
    if (!is_near(other, point, slack)) continue;
    const Facet neighbour = facet(other);
    if (!neighbour.contains(point, slack)) continue;
    found = Surroundings::below;
    if (!rises(neighbour.corner, point, outward, slack)) continue;
    blocker = {neighbour, other};
    return Surroundings::above;
  }
  return found;
}

// Finds the triangles around the point in the mesh or height field; none for other shapes.
SurfaceCones::Surroundings SurfaceCones::around_in_surface(const Vec& point, const Vec& outward,
                                                           double slack, bool second,
                                                           const AnswerGroup& group,
                                                           Blocker& blocker) const noexcept {
  const BodyPair& pair = collided_.pairs[group.bodies];
  const std::uint32_t body = second ? pair.b : pair.a;
  const ShapeId shape = collided_.bodies.shapes[body];
  const Composites* const all = PoolAccess::composites(collided_.pool);
  if (!shape.is_composite() || all == nullptr || all->compound(shape) != nullptr) {
    return Surroundings::none;
  }
  const auto position = as_eigen(collided_.bodies.poses[body].position);
  const auto origin = as_eigen(collided_.bodies.poses[pair.a].position);
  const TransformedShape surface(*all, tables_, shape, collided_.bodies.poses[body],
                                 body == pair.a ? Vec(Vec::Zero()) : finite(position - origin));
  const Vec at = surface.to_local * (point - surface.position);
  const Vec out = slack * surface.to_local.rowwise().norm();
  const Vec low = at - out;
  const Vec high = at + out;
  std::uint32_t slots[kMaxAround];
  SlotSink sink{slots, kMaxAround, 0};
  if (surface.kind == TransformedShape::Kind::mesh) {
    mesh_overlap(*surface.mesh, low.data(), high.data(), sink);
  } else {
    height_overlap(grid_of(*surface.field), low.data(), high.data(), sink);
  }
  Surroundings found = Surroundings::none;
  for (std::uint64_t k = 0; k < std::min<std::uint64_t>(sink.size, kMaxAround); ++k) {
    Corners corners;
    if (!surface.corners(slots[k], corners)) continue;
    const Facet neighbour(corners.triangle(), pose_of(corners.first, {1.0, 0.0, 0.0, 0.0}));
    if (!neighbour.contains(point, slack)) continue;
    found = Surroundings::below;
    if (!rises(neighbour.corner, point, outward, slack)) continue;
    blocker = {neighbour, kNoPrimitive};
    return Surroundings::above;
  }
  return found;
}

bool SurfaceCones::parts(std::size_t s, std::size_t i) const noexcept {
  const Vec along = normal(s);
  return is_below(primitive(i, false), primitive(s, false), along) &&
         is_below(primitive(i, true), primitive(s, true), -along);
}

bool SurfaceCones::is_below(std::uint32_t primitive, std::uint32_t limit,
                            const Vec& direction) const noexcept {
  if (primitive == limit) return true;
  const double gap = top(limit, direction) - top(primitive, direction);
  if (gap >= 0.0) return true;
  const double slack = is_triangle(primitive)
                           ? kFlatSine * facet(primitive).size
                           : kFlush * radius_of(tables_, pairs_.shapes[primitive]);
  return gap >= -slack;
}

double SurfaceCones::top(std::uint32_t primitive, const Vec& direction) const noexcept {
  const Pose& pose = pairs_.poses[primitive];
  const Quaternion& q = pose.orientation;
  if (is_triangle(primitive) && q[1] == 0.0 && q[2] == 0.0 && q[3] == 0.0) {
    const TriangleShape& triangle = tables_.triangles[pairs_.shapes[primitive].index()];
    double top = -kInfinity;
    for (const auto& vertex : triangle.vertex) {
      top = std::max(top, direction.dot(as_eigen(vertex)));
    }
    return top + direction.dot(as_eigen(pose.position));
  }
  const Mat rotation = rotation_of(scale_to_unit_max(pose.orientation));
  return direction.dot(as_eigen(pose.position)) +
         extent(tables_, pairs_.shapes[primitive], rotation.transpose() * direction).high;
}

// Tests a convex part of a compound. A face is touched in the middle of its contact points.
bool SurfaceCones::is_covered(std::size_t i, const AnswerGroup& group, bool second) const noexcept {
  const std::uint32_t own = primitive(i, second);
  if (pairs_.part[own] == kWholeShape) return false;
  const Vec outward = second ? Vec(-normal(i)) : normal(i);
  const double slack = kFlush * radius_of(tables_, pairs_.shapes[own]);
  const Vec touched = middle_of_contact(i, second);
  const double height = outward.dot(touched);
  const double reach = std::max(result_.distance()[i], 0.0);
  for (std::size_t k = group.first; k < group.end; ++k) {
    const std::uint32_t other = primitive(k, second);
    if (other == own || pairs_.part[other] == pairs_.part[own]) continue;
    if (result_.distance()[k] > reach + slack) continue;
    if (top(other, outward) <= height + kFlatSine * slack / kFlush) continue;
    if (part_contains(other, touched, slack)) return true;
  }
  return false;
}

bool SurfaceCones::part_contains(std::uint32_t primitive, const Vec& point,
                                 double slack) const noexcept {
  if (is_triangle(primitive)) return facet(primitive).contains(point, slack);
  const SphereShape ball{slack};
  ShapeTables with_ball = tables_;
  with_ball.spheres = &ball;
  // The part may be a sphere itself.
  const ShapeId shape = pairs_.shapes[primitive];
  const Pose& pose = pairs_.poses[primitive];
  if (shape.kind() == ShapeKind::sphere) {
    const double reach = tables_.spheres[shape.index()].radius + slack;
    return (point - as_eigen(pose.position)).squaredNorm() <= reach * reach;
  }
  SolverCounts counts;
  const Pose at = pose_of(point, {1.0, 0.0, 0.0, 0.0});
  return solve_pair(with_ball, ShapeId::of(ShapeKind::sphere, 0), at, shape, pose,
                    ContactLevel::boolean, 0.0, counts)
      .overlap;
}

// The middle of all contact points, on the surface of one body.
Vec SurfaceCones::middle_of_contact(std::size_t i, bool second) const noexcept {
  const auto from = as_eigen(pairs_.poses[primitive(i, false)].position);
  const double distance = result_.distance()[i];
  if (result_.level() != ContactLevel::manifold) {
    const Vec on_a = from + Vec(result_.point(0)[i], result_.point(1)[i], result_.point(2)[i]);
    return second ? Vec(on_a + distance * normal(i)) : on_a;
  }
  const std::uint32_t count = result_.contact_count()[i];
  Vec sum = Vec::Zero();
  double depth = 0.0;
  for (std::uint32_t k = 0; k < count; ++k) {
    const ContactPoint contact = result_.contact(result_.contact_first()[i] + k);
    sum += as_eigen(contact.position).cast<double>();
    depth += static_cast<double>(contact.depth);
  }
  const Vec middle = from + sum / count;
  const double half = 0.5 * depth / count;
  return middle + (second ? -half : half) * normal(i);
}

bool SurfaceCones::are_neighbours(std::size_t i, std::size_t k) const noexcept {
  return share_corner(primitive(i, false), primitive(k, false)) &&
         share_corner(primitive(i, true), primitive(k, true));
}

// True for two equal primitives, too.
bool SurfaceCones::share_corner(std::uint32_t one, std::uint32_t two) const noexcept {
  if (one == two) return true;
  if (!is_triangle(one) || !is_triangle(two)) return false;
  return facet(one).shares_corner(facet(two));
}

}  // namespace winnow::mid
