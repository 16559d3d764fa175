// Finds the pairs of primitives of two bodies that may touch (see primitive_pair_search.h):
// children of compounds, triangles of meshes and height fields. Called by find_primitive_pairs.cpp;
// the tree traversals are in pipeline/mesh.

#include "pipeline/composites/primitive_pair_search.h"

#include "pipeline/composites/solids.h"
#include "pipeline/mesh/height_grid.h"
#include "pipeline/mesh/mesh_traversal.h"
#include "pipeline/shapes/extent.h"
#include "pipeline/shapes/triangle_direction.h"

#include <algorithm>
#include <cmath>

namespace winnow::mid {
namespace {

// Number of the only part of a convex shape.
constexpr std::uint32_t kOnly[1] = {0};

/// Finds the triangles of a mesh that are within `margin` of a half-space.
void find_below(const HalfSpaceShape& shape, const PlacedPart& part,
                const TransformedShape& surface, double margin, SlotSink& out) noexcept {
  const Vec normal = part.rotation * as_eigen(shape.normal);
  const Vec from = surface.position - part.position;
  const double base = normal.dot(from);
  const double noise = kSlack * (from.lpNorm<1>() + std::abs(shape.offset));
  const Vec own_normal = surface.to_world.transpose() * normal;
  mesh_below(*surface.mesh, own_normal.data(), shape.offset - base + margin + noise, out);
}

/// Transform from the frame of a mesh to the frame of a part.
[[nodiscard]] MeshPlacement mesh_in(const PlacedPart& part,
                                    const TransformedShape& surface) noexcept {
  MeshPlacement placement;
  const Mat linear = part.rotation.transpose() * surface.to_world;
  const Vec offset = part.rotation.transpose() * finite(surface.position - part.position);
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) placement.matrix[i][k] = linear(i, k);
    placement.offset[i] = offset[i];
  }
  return placement;
}

/// Plane of a triangle: its normal (not normalised), and the rounding error of heights above it,
/// per unit of length of the tested points.
struct TrianglePlane {
  explicit TrianglePlane(const Corners& t) noexcept
      : normal(t.edge[0].cross(t.edge[1])),
        length(normal.norm()),
        noise(kSlack * t.edge[0].lpNorm<1>() * t.edge[1].lpNorm<1>()) {}

  Vec normal;
  double length;
  double noise;
};

// True if the heights from `low` to `high` are all above or all below the plane by more than
// `margin`. Heights are multiplied by the length of the normal.
[[nodiscard]] bool is_beyond(const TrianglePlane& plane, double low, double high, double scale,
                             double margin) noexcept {
  return std::max(low, -high) > margin * plane.length + plane.noise * scale;
}

[[nodiscard]] bool half_space_apart(const HalfSpaceShape& shape, const PlacedPart& part,
                                    const Corners& t, double margin) noexcept {
  const Vec normal = part.rotation * as_eigen(shape.normal);
  const Vec from = t.first - part.position;
  const double base = normal.dot(from);
  const double rise[2] = {normal.dot(t.edge[0]), normal.dot(t.edge[1])};
  const double scale = from.lpNorm<1>() + t.edge[0].lpNorm<1>() + t.edge[1].lpNorm<1>();
  return base + std::min({0.0, rise[0], rise[1]}) - shape.offset >
         margin + kSlack * (scale + std::abs(shape.offset));
}

[[nodiscard]] bool corners_beyond(const Corners& plane_of, const Corners& t,
                                  double margin) noexcept {
  const TrianglePlane plane(plane_of);
  const Vec from = t.first - plane_of.first;
  const double base = plane.normal.dot(from);
  const double one = plane.normal.dot(t.edge[0]);
  const double two = plane.normal.dot(t.edge[1]);
  return is_beyond(
      plane, base + std::min({0.0, one, two}), base + std::max({0.0, one, two}),
      from.lpNorm<1>() + t.edge[0].lpNorm<1>() + t.edge[1].lpNorm<1>() + plane_of.first.lpNorm<1>(),
      margin);
}

/// True if one well-chosen axis shows that a part is farther from a triangle than `margin`. Exact
/// for spheres and half-spaces; conservative for other shapes: false proves nothing.
[[nodiscard]] bool is_apart(const PlacedPart& part, const Corners& triangle,
                            double margin) noexcept {
  const ShapeTables& tables = *part.tables;
  if (part.shape.kind() == ShapeKind::half_space) {
    return half_space_apart(tables.half_spaces[part.shape.index()], part, triangle, margin);
  }
  // The direction from the triangle's closest point to the middle of the part: the normal of the
  // triangle if the middle is above its inside, and a better axis otherwise.
  const Vec from = part.position - triangle.first;
  const Vec axis = direction_to(from + part.middle, triangle.edge[0], triangle.edge[1]);
  const double length = axis.norm();
  const double scale = from.lpNorm<1>() + triangle.first.lpNorm<1>() + part.radius +
                       triangle.edge[0].lpNorm<1>() + triangle.edge[1].lpNorm<1>();
  const double enough = (margin + kSlack * scale) * length;
  const double top = std::max({0.0, axis.dot(triangle.edge[0]), axis.dot(triangle.edge[1])});
  const double middle = axis.dot(from + part.middle) - top;
  if (middle - part.reach * length > enough) return true;
  if (middle - part.inner * length <= enough) return false;
  return axis.dot(from) - top + lowest(tables, part.shape, part.rotation.transpose() * axis) >
         enough;
}

/// As above for two triangles: tests their boxes and both planes.
[[nodiscard]] bool is_apart(const Corners& a, const Corners& b, double margin) noexcept {
  for (int i = 0; i < 3; ++i) {
    const double low = std::min({0.0, a.edge[0][i], a.edge[1][i]});
    const double high = std::max({0.0, a.edge[0][i], a.edge[1][i]});
    const double low_b = std::min({0.0, b.edge[0][i], b.edge[1][i]});
    const double high_b = std::max({0.0, b.edge[0][i], b.edge[1][i]});
    const double out =
        margin +
        4.0 * kSlack * (std::abs(a.first[i]) + std::abs(b.first[i]) + high - low + high_b - low_b);
    const double from = b.first[i] - a.first[i];
    if (from + low_b - high > out || low - high_b - from > out) return true;
  }
  return corners_beyond(a, b, margin) || corners_beyond(b, a, margin);
}

}  // namespace

PrimitivePairSearch::PrimitivePairSearch(BumpAllocator& arena) noexcept
    : arena_(arena), primitives_(arena), pairs_(arena) {}

void PrimitivePairSearch::run(const TransformedShape& a, const TransformedShape& b,
                              double margin) noexcept {
  margin_ = margin;
  before_ = primitives_.size();
  if (!a.has_surfaces() && !b.has_surfaces()) {
    run(a, b);
    if (primitives_.size() == before_ && is_either_inside(a, b)) add_any(a, b);
    return;
  }
  for (const std::uint32_t of_a : bodies_near(a, b.box_in(a, margin), children_[0])) {
    const TransformedShape child_a = a.has_surfaces() ? a.child(of_a) : a;
    for (const std::uint32_t of_b : bodies_near(b, child_a.box_in(b, margin), children_[1])) {
      run(child_a, b.has_surfaces() ? b.child(of_b) : b);
    }
  }
  if (primitives_.size() != before_ || !is_either_inside(a, b)) return;
  add_any(a.has_surfaces() ? a.child(0) : a, b.has_surfaces() ? b.child(0) : b);
}

// A body within a solid is near none of its triangles. Its contact, which replaces that of the
// first primitives, is found by correct_solid_contacts.
void PrimitivePairSearch::add_any(const TransformedShape& a, const TransformedShape& b) noexcept {
  const auto first_of = [](const TransformedShape& body) {
    std::uint32_t number = 0;
    Corners corners;
    while (body.kind == TransformedShape::Kind::field && !body.corners(number, corners)) ++number;
    return number;
  };
  add(a, first_of(a), b, first_of(b));
}

/// Returns the nearby children of a compound that has surfaces; any other body is its own only
/// child.
std::span<const std::uint32_t> PrimitivePairSearch::bodies_near(const TransformedShape& body,
                                                                const Box3& box,
                                                                Room& room) noexcept {
  if (!body.has_surfaces()) return kOnly;
  return children_near(body, box, room);
}

void PrimitivePairSearch::run(const TransformedShape& a, const TransformedShape& b) noexcept {
  if (!a.is_surface() && !b.is_surface()) {
    parts_parts(a, b);
  } else if (!a.is_surface()) {
    parts_surface(a, b, false);
  } else if (!b.is_surface()) {
    parts_surface(b, a, true);
  } else if (a.kind == TransformedShape::Kind::mesh && b.kind == TransformedShape::Kind::mesh) {
    mesh_mesh(a, b);
  } else {
    surfaces(a, b);
  }
}

void PrimitivePairSearch::parts_parts(const TransformedShape& a,
                                      const TransformedShape& b) noexcept {
  for (const std::uint32_t of_a : children_near(a, b.box_in(a, margin_), outer_)) {
    const Box3 box = box_of(a.part(of_a), b, margin_);
    for (const std::uint32_t of_b : children_near(b, box, inner_)) add(a, of_a, b, of_b);
  }
}

void PrimitivePairSearch::parts_surface(const TransformedShape& parts,
                                        const TransformedShape& surface, bool mirrored) noexcept {
  const bool is_one = parts.kind == TransformedShape::Kind::convex;
  for (const std::uint32_t number :
       is_one ? std::span<const std::uint32_t>(kOnly)
              : children_near(parts, surface.box_in(parts, margin_), outer_)) {
    const PlacedPart part = parts.part(number);
    Box3 about;
    if (surface.front != 0)
      about = box_under(*part.tables, part.shape, part.rotation, part.position, 0.0);
    for (const std::uint32_t triangle : triangles_near(part, surface)) {
      if (is_left_out(part, about, surface, triangle)) continue;
      if (mirrored) {
        add(surface, triangle, parts, number);
      } else {
        add(parts, number, surface, triangle);
      }
    }
  }
}

// For hulls against meshes, the traversal has already tested each triangle against the hull.
bool PrimitivePairSearch::is_left_out(const PlacedPart& part, const Box3& about,
                                      const TransformedShape& surface,
                                      std::uint32_t triangle) const noexcept {
  const bool is_tested =
      part.shape.kind() == ShapeKind::hull && surface.kind == TransformedShape::Kind::mesh;
  if (is_tested && surface.front == 0) return false;
  Corners corners;
  if (!surface.corners(triangle, corners)) return true;
  if (!is_tested && is_apart(part, corners, margin_)) return true;
  return surface.is_behind(corners, about);
}

void PrimitivePairSearch::mesh_mesh(const TransformedShape& a, const TransformedShape& b) noexcept {
  const PlacedMesh placed(a, b, margin_);
  PairOfBodies sides{*this, a, b};
  SlotPairSink found{outer_.data(), inner_.data(), kRoom, 0, &take_slots, &sides};
  mesh_overlap_pairs(*a.mesh, *b.mesh, placed.b_in_a, placed.margin, found);
  take_slots(found.context, found);
}

void PrimitivePairSearch::take_slots(void* context, SlotPairSink& found) noexcept {
  const PairOfBodies& sides = *static_cast<const PairOfBodies*>(context);
  // The traversal has already tested boxes and both planes: only facing remains to be tested.
  const bool has_front = sides.a.front != 0 || sides.b.front != 0;
  for (std::uint64_t i = 0; i < found.size; ++i) {
    Corners corners[2];
    if (has_front && sides.a.corners(found.first[i], corners[0]) &&
        sides.b.corners(found.second[i], corners[1]) &&
        any_is_behind(sides.a, corners[0], sides.b, corners[1])) {
      continue;
    }
    sides.search.add(sides.a, found.first[i], sides.b, found.second[i]);
  }
  found.size = 0;
}

// At least one body is a height field. A box query of a height field is so cheap that a
// simultaneous traversal of both trees would gain little.
void PrimitivePairSearch::surfaces(const TransformedShape& a, const TransformedShape& b) noexcept {
  for (const std::uint32_t of_a : triangles_near(b.box_in(a, margin_), a, outer_)) {
    Corners corners[2];
    if (!a.corners(of_a, corners[0])) continue;
    Box3 box{Vec::Zero(), Vec::Zero()};
    for (const Vec& edge : corners[0].edge) box.merge({edge, edge});
    const Vec at = b.to_local * (corners[0].first - b.position);
    for (const std::uint32_t of_b :
         triangles_near(box_under(box, b.to_local, at, margin_), b, inner_)) {
      if (!b.corners(of_b, corners[1])) continue;
      if (is_apart(corners[0], corners[1], margin_)) continue;
      if (!any_is_behind(a, corners[0], b, corners[1])) add(a, of_a, b, of_b);
    }
  }
}

bool PrimitivePairSearch::any_is_behind(const TransformedShape& a, const Corners& of_a,
                                        const TransformedShape& b, const Corners& of_b) noexcept {
  return a.is_behind(of_a, of_b.box()) || b.is_behind(of_b, of_a.box());
}

template <typename Find>
std::span<const std::uint32_t> PrimitivePairSearch::collect(Room& room, Find&& find) noexcept {
  SlotSink found{room.data(), kRoom, 0};
  find(found);
  const auto count = static_cast<std::size_t>(found.size);
  if (count <= kRoom) return {room.data(), count};
  // Take memory from the arena of all tasks. It is freed only with the arena.
  std::uint32_t* const more = arena_.take(count);
  if (more == nullptr) return {};
  found = {more, count, 0};
  find(found);
  return {more, count};
}

std::span<const std::uint32_t> PrimitivePairSearch::children_near(const TransformedShape& body,
                                                                  const Box3& box,
                                                                  Room& room) noexcept {
  if (body.kind == TransformedShape::Kind::convex) return kOnly;
  const Compound& compound = *body.compound;
  if (compound.tree == nullptr) {
    return collect(room, [&](SlotSink& out) {
      for (std::uint32_t i = 0; i < compound.count; ++i) {
        if (Box3::of(compound.boxes[i]).overlaps(box)) put_slot(out, i);
      }
    });
  }
  const MeshView& tree = view_of(*compound.tree);
  const std::span<const std::uint32_t> slots = collect(
      room, [&](SlotSink& out) { mesh_overlap(tree, box.min.data(), box.max.data(), out); });
  // The slots are in memory of this search, so they can be replaced in place.
  auto* const children = const_cast<std::uint32_t*>(slots.data());
  for (std::size_t i = 0; i < slots.size(); ++i) {
    children[i] = tree.triangle[slots[i]] & kTriangleNumberMask;
  }
  return slots;
}

std::span<const std::uint32_t> PrimitivePairSearch::triangles_near(
    const PlacedPart& part, const TransformedShape& surface) noexcept {
  if (part.shape.kind() == ShapeKind::half_space && surface.kind == TransformedShape::Kind::mesh) {
    return collect(inner_, [&](SlotSink& out) {
      find_below(part.tables->half_spaces[part.shape.index()], part, surface, margin_, out);
    });
  }
  const Box3 box = box_of(part, surface, margin_);
  if (surface.kind != TransformedShape::Kind::mesh) return triangles_near(box, surface, inner_);
  // Also tests the bounding sphere of the part or, for a hull, the hull: many triangles that
  // overlap the box do not overlap these.
  const Vec center = surface.to_local * finite(part.position + part.middle - surface.position);
  const double noise = kSlack * (center.lpNorm<1>() + surface.to_local.cwiseAbs().maxCoeff() *
                                                          surface.position.lpNorm<1>());
  const double radius = (part.reach + margin_) * surface.max_inverse_scale + noise;
  const auto find = [&](const MeshHull* hull) {
    return collect(inner_, [&](SlotSink& out) {
      mesh_overlap(*surface.mesh, box.min.data(), box.max.data(), center.data(), radius, hull, out);
    });
  };
  if (part.shape.kind() != ShapeKind::hull) return find(nullptr);
  const HullShape& shape = part.tables->hulls[part.shape.index()];
  const MeshHull hull{shape, mesh_in(part, surface), margin_ + shape.rounding};
  return find(&hull);
}

std::span<const std::uint32_t> PrimitivePairSearch::triangles_near(const Box3& box,
                                                                   const TransformedShape& surface,
                                                                   Room& room) noexcept {
  return collect(room, [&](SlotSink& out) {
    if (surface.kind == TransformedShape::Kind::mesh) {
      mesh_overlap(*surface.mesh, box.min.data(), box.max.data(), out);
    } else {
      height_overlap(grid_of(*surface.field), box.min.data(), box.max.data(), out);
    }
  });
}

void PrimitivePairSearch::add(const TransformedShape& a, std::uint32_t of_a,
                              const TransformedShape& b, std::uint32_t of_b) noexcept {
  const std::uint32_t first = primitive(a, of_a, 0);
  const std::uint32_t second = primitive(b, of_b, kSecond);
  pairs_.put(first);
  pairs_.put(second);
}

std::uint32_t PrimitivePairSearch::primitive(const TransformedShape& body, std::uint32_t number,
                                             std::uint32_t flag) noexcept {
  const std::uint32_t whole = body.first_number + number;
  FoundPrimitive& seen = memory_[flag != 0 ? 1 : 0][whole % kRemembered];
  if (seen.number != whole || seen.primitive < before_) {
    seen = {whole, primitives_.size()};
    primitives_.put(whole | flag);
    const ShapeId shape = body.kind == TransformedShape::Kind::compound
                              ? body.compound->children[number].shape
                              : body.id;
    if (body.is_surface() || shape.kind() == ShapeKind::triangle) ++triangles_;
  }
  return static_cast<std::uint32_t>(seen.primitive);
}

}  // namespace winnow::mid
