// Transforms and primitives of a TransformedShape; see transformed_shape.h.

#include "pipeline/composites/transformed_shape.h"

#include "core/numbers/rotation.h"
#include "pipeline/kinds/kinds.h"
#include "pipeline/shapes/extent.h"

#include <algorithm>
#include <type_traits>

namespace winnow::mid {
namespace {

/// Most surfaces are not rotated, and computing a rotation would be a large part of the cost of a
/// ray.
bool is_identity(const Quaternion& turn) noexcept {
  return turn[0] == 1.0 && turn[1] == 0.0 && turn[2] == 0.0 && turn[3] == 0.0;
}

}  // namespace

TriangleShape Corners::triangle() const noexcept {
  TriangleShape shape{};
  for (int k = 0; k < 2; ++k) as_eigen(shape.vertex[k + 1]) = finite(edge[k]);
  return shape;
}

Box3 Corners::box() const noexcept {
  Box3 box{first, first};
  for (const Vec& e : edge) box.merge({first + e, first + e});
  return box;
}

PlacedPart::PlacedPart(const ShapeTables& of, ShapeId id, std::uint32_t of_body, const Mat& turned,
                       const Vec& at) noexcept
    : tables(&of), shape(id), number(of_body), rotation(turned), position(at) {
  with_shape(of, id, [&](const auto& one) {
    radius = winnow::radius_of(one) * (1.0 + kSlack);
    reach = radius;
    inner = inner_radius_of(one);
    if constexpr (std::is_same_v<decltype(one), const HullShape&>) {
      middle = rotation * as_eigen(one.center);
      reach = (one.radius + one.rounding) * (1.0 + kSlack);
    }
  });
}

TransformedShape::TransformedShape(const Composites& composites, const ShapeTables& pool,
                                   ShapeId shape, const Pose& pose, const Vec& at,
                                   Solids form) noexcept
    : TransformedShape(composites, pool, shape, Turned(pose.orientation), at, form) {}

TransformedShape::Turned::Turned(const Quaternion& orientation) noexcept
    : turn(scale_to_unit_max(orientation)),
      rotation(is_identity(turn) ? Mat(Mat::Identity()) : Mat(rotation_of(turn))) {}

TransformedShape::TransformedShape(const Composites& composites, const ShapeTables& pool,
                                   ShapeId shape, const Turned& turned, const Vec& at,
                                   Solids form) noexcept
    : all(composites),
      tables(form == Solids::hulls ? composites.tables_of(shape, pool) : pool),
      solids(form),
      id(shape),
      turn(turned.turn),
      rotation(turned.rotation),
      position(at) {
  to_world = rotation;
  to_local = rotation.transpose();
  if (!shape.is_composite()) return;
  if (is_solid_hull()) {
    id = ShapeId::of(ShapeKind::hull, all.mesh(shape)->hull);
    return;
  }
  if (all.is_one_sided(shape)) front = 1;
  if (const MeshEntry* const entry = all.mesh(shape)) {
    kind = Kind::mesh;
    shared = entry->shared;
    mesh = &view_of(shared->mesh);
    bounds = Box3::of(entry->shared->mesh.bounds());
    const Eigen::Map<const Vec> scale(entry->scale);
    is_mirrored = scale.prod() < 0.0;
    if (is_mirrored) front = -front;
    max_inverse_scale = 1.0 + kSlack;
    if (scale == Vec::Ones()) return;
    to_world = rotation * scale.asDiagonal();
    to_local = scale.cwiseInverse().asDiagonal() * rotation.transpose();
    max_inverse_scale *= scale.cwiseInverse().cwiseAbs().maxCoeff();
  } else if (const HeightField* const heights = all.field(shape)) {
    kind = Kind::field;
    field = heights;
    bounds = Box3::of(heights->bounds());
  } else {
    kind = Kind::compound;
    compound = all.compound(shape);
    bounds = Box3::of(compound->bounds);
  }
}

TransformedShape TransformedShape::child(std::uint32_t number) const noexcept {
  const CompoundChild& one = compound->children[number];
  const Mat turned = rotation_of(scale_to_unit_max(one.pose.orientation));
  TransformedShape body(all, tables, one.shape, Turned(part_turn(number), rotation * turned),
                        position + rotation * as_eigen(one.pose.position), solids);
  body.is_child = true;
  body.first_number = compound->first_part[number];
  return body;
}

TransformedShape TransformedShape::at(const Composites& all, ShapeId shape, const Pose& pose,
                                      Solids solids) noexcept {
  return {all, all.shapes.tables(), shape, pose, as_eigen(pose.position), solids};
}

Box3 TransformedShape::box_in(const TransformedShape& other, double margin) const noexcept {
  if (kind == Kind::convex) return box_of(part(0), other, margin);
  const Vec offset = other.to_local * finite(position - other.position);
  if (!bounds.is_finite()) {
    // A rotation can make a box that is unbounded along one axis unbounded along all axes.
    return {Vec::Constant(-kInfinity), Vec::Constant(kInfinity)};
  }
  const Box3 box = box_under(bounds, other.to_local * to_world, offset, 0.0);
  const Vec out = margin * other.to_local.rowwise().norm();
  return {box.min - out, box.max + out};
}

PlacedPart TransformedShape::part(std::uint32_t number) const noexcept {
  if (kind == Kind::convex) return {tables, id, 0, rotation, position};
  const CompoundChild& child = compound->children[number];
  const auto at = as_eigen(child.pose.position);
  const Mat turned = rotation_of(scale_to_unit_max(child.pose.orientation));
  return {tables, child.shape, number, rotation * turned, position + rotation * at};
}

Quaternion TransformedShape::part_turn(std::uint32_t number) const noexcept {
  if (kind == Kind::convex) return turn;
  return turn * scale_to_unit_max(compound->children[number].pose.orientation);
}

bool TransformedShape::own_corners(std::uint32_t number, double (&corner)[3][3]) const noexcept {
  if (kind == Kind::field) {
    TriangleShape triangle;
    if (!field->triangle(number, triangle)) return false;
    std::copy_n(&triangle.vertex[0][0], 9, &corner[0][0]);
    return true;
  }
  put_corners(*mesh, number, corner);
  return true;
}

bool TransformedShape::corners(std::uint32_t number, Corners& out) const noexcept {
  double corner[3][3];
  if (!own_corners(number, corner)) return false;
  const Vec first = Vec::Map(corner[0]);
  out.first = to_world * first + position;
  for (int k = 0; k < 2; ++k) out.edge[k] = to_world * (Vec::Map(corner[k + 1]) - first);
  return true;
}

bool TransformedShape::primitive(std::uint32_t number, Primitive& out) const noexcept {
  out.part = shown_number(number);
  if (is_surface()) {
    Corners placed;
    if (!corners(number, placed)) return false;
    out.shape = ShapeId::of(ShapeKind::triangle, 0);
    out.pose = pose_of(placed.first, {1.0, 0.0, 0.0, 0.0});
    out.triangle = placed.triangle();
    out.front = front;
    out.is_mirrored = is_mirrored;
    return true;
  }
  const PlacedPart child = part(number);
  out.shape = child.shape;
  out.pose = pose_of(child.position, part_turn(number));
  if (child.shape.kind() == ShapeKind::triangle) {
    out.triangle = tables.triangles[child.shape.index()];
  }
  if (is_solid_hull()) out.hull = &tables.hulls[child.shape.index()];
  return true;
}

std::uint32_t TransformedShape::shown_number(std::uint32_t number) const noexcept {
  if (kind == Kind::convex) return is_child ? first_number : kWholeShape;
  const bool is_slot = kind == Kind::mesh;
  return first_number + (is_slot ? mesh->triangle[number] & kTriangleNumberMask : number);
}

std::uint8_t TransformedShape::active(std::uint32_t number) const noexcept {
  std::uint32_t bits = 0;
  if (kind == Kind::mesh) {
    bits = mesh->triangle[number] >> kActiveEdgeShift & 7U;
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (shared->is_active(corner_of(*mesh, k, number))) bits |= 8U << k;
    }
    return static_cast<std::uint8_t>(bits);
  }
  // A corner of a height field is active if it is on an active edge of this triangle or on the
  // border of the field. Active edges of other triangles that end at the corner, for example at a
  // hole, are not detected.
  bits = field->active_edges(number);
  for (std::uint32_t k = 0; k < 3; ++k) {
    if ((bits & (1U << k | 1U << (k + 2) % 3)) != 0) bits |= 8U << k;
  }
  const std::uint32_t column = number / 2 % (field->columns() - 1);
  const std::uint32_t row = number / 2 / (field->columns() - 1);
  const bool at_side[2][2] = {{column == 0, column + 2 == field->columns()},
                              {row == 0, row + 2 == field->rows()}};
  TriangleShape triangle;
  if (!(at_side[0][0] || at_side[0][1] || at_side[1][0] || at_side[1][1]) ||
      !field->triangle(number, triangle)) {
    return static_cast<std::uint8_t>(bits);
  }
  const auto& v = triangle.vertex;
  for (std::uint32_t k = 0; k < 3; ++k) {
    for (int axis = 0; axis < 2; ++axis) {
      const bool is_low = v[k][axis] == std::min({v[0][axis], v[1][axis], v[2][axis]});
      if (at_side[axis][is_low ? 0 : 1]) bits |= 8U << k;
    }
  }
  return static_cast<std::uint8_t>(bits);
}

PlacedMesh::PlacedMesh(const TransformedShape& a, const TransformedShape& b,
                       double world_margin) noexcept {
  const Mat linear = a.to_local * b.to_world;
  const Vec offset = a.to_local * finite(b.position - a.position);
  const Vec noise = kSlack * (a.to_local.cwiseAbs() * b.position.cwiseAbs() + offset.cwiseAbs());
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) b_in_a.matrix[i][k] = linear(i, k);
    b_in_a.offset[i] = offset[i];
    margin[i] = world_margin * a.to_local.row(i).norm() + noise[i];
  }
}

Box3 box_of(const PlacedPart& part, const TransformedShape& other, double margin) noexcept {
  const Vec offset = other.to_local * finite(part.position - other.position);
  return box_under(*part.tables, part.shape, other.to_local * part.rotation, offset, margin);
}

}  // namespace winnow::mid
