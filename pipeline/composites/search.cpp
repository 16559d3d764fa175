#include "pipeline/composites/search.h"
#include "pipeline/composites/separation.h"
#include "pipeline/mesh/mesh_walks.h"
#include "pipeline/shapes/extent.h"

namespace winnow::mid {
namespace {

constexpr std::uint32_t kNumberMask = (1U << kActiveEdgeShift) - 1U;

// A convex shape is its own only part.
constexpr std::uint32_t kOnly[1] = {0};

void put(SlotSink& out, std::uint32_t number) noexcept {
  if (out.size < out.capacity) out.slot[out.size] = number;
  ++out.size;
}

/// What a half-space is in the frame of a mesh.
void walk_below(const HalfSpaceShape& shape, const Part& part, const Side& surface, double margin,
                SlotSink& out) noexcept {
  const Vec normal = part.rotation * Eigen::Map<const Vec>(shape.normal);
  const Vec from = surface.position - part.position;
  const double base = normal.dot(from);
  const double noise = kSlack * (from.lpNorm<1>() + std::abs(shape.offset));
  mesh_below(*surface.mesh, surface.to_world.transpose() * normal,
             shape.offset - base + margin + noise, out);
}

}  // namespace

Search::Search(const ShapeTables& tables, double margin, WordArena& arena) noexcept
    : tables_(tables), margin_(margin), arena_(arena), primitives_(arena), pairs_(arena) {}

void Search::run(const Side& a, const Side& b) noexcept {
  before_ = primitives_.size();
  if (!a.is_surface() && !b.is_surface()) {
    parts_parts(a, b);
  } else if (!a.is_surface()) {
    parts_surface(a, b, false);
  } else if (!b.is_surface()) {
    parts_surface(b, a, true);
  } else if (a.kind == Side::Kind::mesh && b.kind == Side::Kind::mesh) {
    mesh_mesh(a, b);
  } else {
    surfaces(a, b);
  }
}

void Search::parts_parts(const Side& a, const Side& b) noexcept {
  for (const std::uint32_t of_a : children_near(a, b.box_in(a, margin_), outer_)) {
    const Box box = box_of(a.part(of_a), b, margin_);
    for (const std::uint32_t of_b : children_near(b, box, inner_)) add(a, of_a, b, of_b);
  }
}

void Search::parts_surface(const Side& parts, const Side& surface, bool swapped) noexcept {
  const bool is_one = parts.kind == Side::Kind::convex;
  for (const std::uint32_t number :
       is_one ? std::span<const std::uint32_t>(kOnly)
              : children_near(parts, surface.box_in(parts, margin_), outer_)) {
    const Part part = parts.part(number);
    for (const std::uint32_t triangle : triangles_near(part, surface)) {
      Corners corners;
      if (!surface.corners(triangle, corners)) continue;
      if (is_apart(tables_, part, corners, margin_)) continue;
      if (swapped) {
        add(surface, triangle, parts, number);
      } else {
        add(parts, number, surface, triangle);
      }
    }
  }
}

void Search::mesh_mesh(const Side& a, const Side& b) noexcept {
  MeshPlacement placement;
  const Mat linear = a.to_local * b.to_world;
  const Vec offset = a.to_local * finite(b.position - a.position);
  const Vec noise = kSlack * (a.to_local.cwiseAbs() * b.position.cwiseAbs() + offset.cwiseAbs());
  double margin[3];
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) placement.matrix[i][k] = linear(i, k);
    placement.offset[i] = offset[i];
    margin[i] = margin_ * a.to_local.row(i).norm() + noise[i];
  }
  PairOfSides sides{*this, a, b};
  SlotPairSink found{outer_.data(), inner_.data(), kRoom, 0, &take_slots, &sides};
  mesh_overlap_pairs(*a.mesh, *b.mesh, placement, margin, found);
  take_slots(found.context, found);
}

void Search::take_slots(void* context, SlotPairSink& found) noexcept {
  const PairOfSides& sides = *static_cast<const PairOfSides*>(context);
  // The walk has seen to boxes and planes of both: a second look would drop nothing.
  for (std::uint64_t i = 0; i < found.size; ++i) {
    sides.search.add(sides.a, found.first[i], sides.b, found.second[i]);
  }
  found.size = 0;
}

// At least one of them is a height field, which answers boxes so cheaply that a walk of two trees
// would gain little.
void Search::surfaces(const Side& a, const Side& b) noexcept {
  for (const std::uint32_t of_a : triangles_near(b.box_in(a, margin_), a, outer_)) {
    Corners corners[2];
    if (!a.corners(of_a, corners[0])) continue;
    Box box{Vec::Zero(), Vec::Zero()};
    for (const Vec& edge : corners[0].edge) box.merge({edge, edge});
    const Vec at = b.to_local * (corners[0].first - b.position);
    for (const std::uint32_t of_b :
         triangles_near(box_under(box, b.to_local, at, margin_), b, inner_)) {
      if (!b.corners(of_b, corners[1])) continue;
      if (!is_apart(corners[0], corners[1], margin_)) add(a, of_a, b, of_b);
    }
  }
}

template <typename Walk>
std::span<const std::uint32_t> Search::collect(Room& room, Walk&& walk) noexcept {
  SlotSink found{room.data(), kRoom, 0};
  walk(found);
  if (found.size <= kRoom) return {room.data(), found.size};
  // The room that all tasks share: not given back before the next call.
  std::uint32_t* const more = arena_.take(found.size);
  if (more == nullptr) return {};
  found = {more, found.size, 0};
  walk(found);
  return {more, found.size};
}

std::span<const std::uint32_t> Search::children_near(const Side& side, const Box& box,
                                                     Room& room) noexcept {
  if (side.kind == Side::Kind::convex) return kOnly;
  const Compound& compound = *side.compound;
  if (compound.tree == nullptr) {
    return collect(room, [&](SlotSink& out) {
      for (std::uint32_t i = 0; i < compound.count; ++i) {
        if (Box::of(compound.boxes[i]).meets(box)) put(out, i);
      }
    });
  }
  const MeshView& tree = compound.tree->view();
  const std::span<const std::uint32_t> slots = collect(
      room, [&](SlotSink& out) { mesh_overlap(tree, box.min.data(), box.max.data(), out); });
  // The room is this search's own.
  auto* const children = const_cast<std::uint32_t*>(slots.data());
  for (std::size_t i = 0; i < slots.size(); ++i) {
    children[i] = tree.triangle[slots[i]] & kNumberMask;
  }
  return slots;
}

std::span<const std::uint32_t> Search::triangles_near(const Part& part,
                                                      const Side& surface) noexcept {
  if (part.shape.kind() == ShapeKind::half_space && surface.kind == Side::Kind::mesh) {
    return collect(inner_, [&](SlotSink& out) {
      walk_below(tables_.half_spaces[part.shape.index()], part, surface, margin_, out);
    });
  }
  const Box box = box_of(part, surface, margin_);
  if (surface.kind != Side::Kind::mesh) return triangles_near(box, surface, inner_);
  // A ball about the part as well: of most shapes' boxes it leaves half of the triangles.
  const Vec center = surface.to_local * finite(part.position + part.middle - surface.position);
  const double noise = kSlack * (center.lpNorm<1>() + surface.to_local.cwiseAbs().maxCoeff() *
                                                          surface.position.lpNorm<1>());
  const double radius = (part.reach + margin_) * surface.most_shrunk + noise;
  return collect(inner_, [&](SlotSink& out) {
    mesh_overlap(*surface.mesh, box.min.data(), box.max.data(), center.data(), radius, out);
  });
}

std::span<const std::uint32_t> Search::triangles_near(const Box& box, const Side& surface,
                                                      Room& room) noexcept {
  return collect(room, [&](SlotSink& out) {
    if (surface.kind == Side::Kind::mesh) {
      mesh_overlap(*surface.mesh, box.min.data(), box.max.data(), out);
    } else {
      surface.field->overlap(box.min.data(), box.max.data(), out);
    }
  });
}

void Search::add(const Side& a, std::uint32_t of_a, const Side& b, std::uint32_t of_b) noexcept {
  const std::uint32_t first = primitive(a, of_a, 0);
  const std::uint32_t second = primitive(b, of_b, kSecond);
  pairs_.put(first);
  pairs_.put(second);
}

std::uint32_t Search::primitive(const Side& side, std::uint32_t number,
                                std::uint32_t flag) noexcept {
  Memory& seen = memory_[flag != 0 ? 1 : 0][number % kRemembered];
  if (seen.number != number || seen.primitive < before_) {
    seen = {number, primitives_.size()};
    primitives_.put(number | flag);
    const ShapeId shape =
        side.kind == Side::Kind::compound ? side.compound->children[number].shape : side.id;
    if (side.is_surface() || shape.kind() == ShapeKind::triangle) ++triangles_;
  }
  return static_cast<std::uint32_t>(seen.primitive);
}

}  // namespace winnow::mid
