// Traversals of composite shapes for queries (mid::visit, visit_pairs, visit_near_pairs and
// visit_near): the primitives that a moving box may hit, or that are near a box. Rays are in
// rays.cpp; the tree traversals are in pipeline/mesh.

#include "pipeline/composites/composites.h"
#include "pipeline/composites/transformed_shape.h"
#include "pipeline/mesh/box_measures.h"
#include "pipeline/mesh/height_grid.h"
#include "pipeline/mesh/mesh_traversal.h"
#include "pipeline/shapes/extent.h"

#include <algorithm>
#include <cmath>

namespace winnow::mid {
namespace {

/// Converts the numbers that a traversal finds to primitives in the world, and visits them.
struct Guide {
  const TransformedShape& body;
  const PrimitiveVisitor& visitor;
  /// Called in place of `visitor` if the body is a compound that has surfaces.
  ChildVisitor children;

  [[nodiscard]] double show(std::uint32_t number, double limit) const {
    if (body.has_surfaces()) return children.visit(children.context, number, limit);
    Primitive primitive;
    if (!body.primitive(number, primitive)) return limit;
    return visitor.visit(visitor.context, primitive, limit);
  }

  // The triangles of a compound's tree stand for its children.
  static double show_slots(void* context, const std::uint32_t* slots, std::uint32_t count,
                           double limit) {
    const Guide& guide = *static_cast<const Guide*>(context);
    const Compound* const compound = guide.body.compound;
    for (std::uint32_t i = 0; i < count && limit >= 0.0; ++i) {
      const std::uint32_t number =
          compound != nullptr ? view_of(*compound->tree).triangle[slots[i]] & kTriangleNumberMask
                              : slots[i];
      limit = guide.show(number, limit);
    }
    return limit;
  }
  [[nodiscard]] SlotVisitor slots() const noexcept {
    return {&show_slots, const_cast<Guide*>(this)};
  }
};

/// Forwards primitives to a visitor and stores the last limit that it returned.
struct LimitKeeper {
  const PrimitiveVisitor& to;
  double limit;

  [[nodiscard]] PrimitiveVisitor visitor() noexcept {
    return {[](void* context, const Primitive& primitive, double most) {
              LimitKeeper& keeper = *static_cast<LimitKeeper*>(context);
              return keeper.limit = keeper.to.visit(keeper.to.context, primitive, most);
            },
            this};
  }
};

/// As Guide, for pairs.
struct PairGuide {
  const TransformedShape& a;
  const TransformedShape& b;
  const PrimitivePairVisitor& visitor;

  static void show_slots(void* context, SlotPairSink& found) {
    const PairGuide& guide = *static_cast<const PairGuide*>(context);
    for (std::uint64_t i = 0; i < found.size && !found.is_done; ++i) {
      Primitive first;
      Primitive second;
      const bool are_there =
          guide.a.primitive(found.first[i], first) && guide.b.primitive(found.second[i], second);
      found.is_done = are_there && !guide.visitor.visit(guide.visitor.context, first, second);
    }
    found.size = 0;
  }
};

/// As PairGuide, nearest pairs first. Limits are lengths in the frame of mesh a.
struct NearPairGuide {
  const TransformedShape& a;
  const TransformedShape& b;
  const NearPairVisitor& visitor;
  /// In world units.
  double limit;
  float direction[3] = {0.0F, 0.0F, 0.0F};

  [[nodiscard]] double own_limit() const noexcept { return limit * a.max_inverse_scale; }

  static double show(void* context, std::uint32_t slot_a, std::uint32_t slot_b, double) {
    NearPairGuide& guide = *static_cast<NearPairGuide*>(context);
    Primitive first;
    Primitive second;
    if (!guide.a.primitive(slot_a, first) || !guide.b.primitive(slot_b, second)) {
      return guide.own_limit();
    }
    guide.limit = guide.visitor.visit(guide.visitor.context, first, second, guide.limit);
    const Vec normal = guide.a.to_local * Eigen::Map<const Vec>(guide.visitor.normal);
    Eigen::Vector3f::Map(guide.direction) = normal.stableNormalized().cast<float>();
    return guide.own_limit();
  }
};

/// Visits children in ascending order of a measure. Skips children whose measure is infinite.
template <typename Measure>
void visit_nearest_first(const Guide& guide, double limit, Measure&& measure) {
  const Compound& compound = *guide.body.compound;
  double last = -1.0;
  std::uint32_t last_child = 0;
  while (limit >= 0.0) {
    // Find the next child by measure, then number. This needs no memory for a sorted list.
    double best = kInfinity;
    std::uint32_t child = compound.count;
    for (std::uint32_t i = 0; i < compound.count; ++i) {
      const double value = measure(Box3::of(compound.boxes[i]));
      if (value < last || (value == last && i <= last_child) || !(value < best)) continue;
      best = value;
      child = i;
    }
    if (child == compound.count || best > limit) return;
    limit = guide.show(child, limit);
    last = best;
    last_child = child;
  }
}

/// Returns a world box in a frame at the position of the body, grown by the rounding errors.
[[nodiscard]] Box3 box_in(const TransformedShape& body, const MovingBox& moving_box,
                          const Mat& to_local) noexcept {
  const Eigen::Map<const Vec> min(moving_box.min);
  const Eigen::Map<const Vec> max(moving_box.max);
  const Box3 box{finite(min - body.position), finite(max - body.position)};
  return box_under(box, to_local, Vec::Zero(), 0.0);
}

/// Visits a child of a compound: calls `go` with a visitor for the primitives of a surface, or
/// visits the primitive of a convex child. Returns the new limit.
template <typename Go>
[[nodiscard]] double visit_child(const TransformedShape& child, double limit,
                                 const PrimitiveVisitor& visitor, Go&& go) {
  if (child.is_surface()) {
    LimitKeeper keeper{visitor, limit};
    go(keeper.visitor());
    return keeper.limit;
  }
  Primitive primitive;
  return child.primitive(0, primitive) ? visitor.visit(visitor.context, primitive, limit) : limit;
}

}  // namespace

void visit(const TransformedShape& body, const MovingBox& moving_box,
           const PrimitiveVisitor& visitor, const ChildVisitor& children) {
  const Guide guide{body, visitor, children};
  if (body.is_solid_hull()) return static_cast<void>(guide.show(0, moving_box.max_t));
  // A box that is never hit has time infinity, which must be later than any limit.
  const double max_t = std::min(moving_box.max_t, std::numeric_limits<double>::max());
  Box3 box = box_in(body, moving_box, body.to_local);
  const Vec direction = body.to_local * as_eigen(moving_box.direction);
  // Rounding of the direction moves the box by a share of the distance that it travels.
  if (body.bounds.is_finite()) {
    const Vec noise = Vec::Constant(4.0 * kSlack *
                                    (body.bounds.min.cwiseAbs() + body.bounds.max.cwiseAbs() +
                                     box.min.cwiseAbs().cwiseMax(box.max.cwiseAbs()))
                                        .sum());
    box = {box.min - noise, box.max + noise};
  }
  if (body.kind == TransformedShape::Kind::mesh) {
    mesh_cast(*body.mesh, box.min.data(), box.max.data(), direction.data(), max_t, guide.slots());
  } else if (body.kind == TransformedShape::Kind::field) {
    height_cast(grid_of(*body.field), box.min.data(), box.max.data(), direction.data(), max_t,
                guide.slots());
  } else if (body.compound->tree != nullptr) {
    mesh_cast(view_of(*body.compound->tree), box.min.data(), box.max.data(), direction.data(),
              max_t, guide.slots());
  } else {
    visit_nearest_first(guide, max_t, [&](const Box3& child) {
      return moving_box_time(box.min.data(), box.max.data(), direction.data(), max_t,
                             child.min.data(), child.max.data());
    });
  }
}

void visit(const CompositePool& pool, ShapeId id, const Pose& pose, const MovingBox& moving_box,
           Solids solids, const PrimitiveVisitor& visitor) {
  const Composites* const all = composites_with(pool, id);
  if (all == nullptr) return;
  const TransformedShape body = TransformedShape::at(*all, id, pose, solids);
  auto show_child = [&](std::uint32_t number, double limit) {
    const TransformedShape child = body.child(number);
    return visit_child(child, limit, visitor, [&](const PrimitiveVisitor& keeping) {
      MovingBox rest = moving_box;
      rest.max_t = limit;
      visit(child, rest, keeping, {});
    });
  };
  visit(body, moving_box, visitor, ChildVisitor::of(show_child));
}

bool visit_pairs(const CompositePool& pool, ShapeId a, const Pose& pose_a, ShapeId b,
                 const Pose& pose_b, const PrimitivePairVisitor& visitor) {
  const Composites* const all = composites_with(pool, a);
  if (all == nullptr || !all->contains(b)) return false;
  const TransformedShape first = TransformedShape::at(*all, a, pose_a);
  const TransformedShape second = TransformedShape::at(*all, b, pose_b);
  if (first.kind != TransformedShape::Kind::mesh || second.kind != TransformedShape::Kind::mesh)
    return false;
  PairGuide guide{first, second, visitor};
  const PlacedMesh placed(first, second, 0.0);
  // The visitor is called when the buffer is nearly full. The buffer is small, so that at most this
  // number of pairs are found in vain if the visitor ends the traversal.
  constexpr std::uint32_t kRoom = 2 * kMeshFanout;
  std::uint32_t slots[2][kRoom];
  SlotPairSink found{slots[0], slots[1], kRoom, 0, &PairGuide::show_slots, &guide};
  mesh_overlap_pairs(*first.mesh, *second.mesh, placed.b_in_a, placed.margin, found);
  if (!found.is_done) PairGuide::show_slots(found.context, found);
  return true;
}

bool visit_near_pairs(const CompositePool& pool, ShapeId a, const Pose& pose_a, ShapeId b,
                      const Pose& pose_b, double limit, const NearPairVisitor& visitor) {
  const Composites* const all = composites_with(pool, a);
  if (all == nullptr || !all->contains(b)) return false;
  const TransformedShape first = TransformedShape::at(*all, a, pose_a);
  const TransformedShape second = TransformedShape::at(*all, b, pose_b);
  if (first.kind != TransformedShape::Kind::mesh || second.kind != TransformedShape::Kind::mesh)
    return false;
  const double(&scale)[3] = all->mesh(a)->scale;
  if (std::abs(scale[0]) != std::abs(scale[1]) || std::abs(scale[0]) != std::abs(scale[2])) {
    return false;
  }
  NearPairGuide guide{first, second, visitor, limit};
  const bool has_front = first.front != 0 || second.front != 0;
  const PlacedMesh placed(first, second, 0.0);
  mesh_near_pairs(*first.mesh, *second.mesh, placed.b_in_a, placed.margin, guide.own_limit(),
                  {&NearPairGuide::show, &guide, guide.direction, has_front});
  return true;
}

namespace {

void visit_near(const TransformedShape& body, const MovingBox& from, double limit,
                const PrimitiveVisitor& visitor, const ChildVisitor& children) {
  const Guide guide{body, visitor, children};
  if (body.is_solid_hull()) return static_cast<void>(guide.show(0, limit));
  // Rotated to the frame of the body, but in world lengths.
  const Box3 box = box_in(body, from, body.rotation.transpose());
  if (body.kind == TransformedShape::Kind::mesh) {
    mesh_near(*body.mesh, body.all.mesh(body.id)->scale, box.min.data(), box.max.data(), limit,
              guide.slots());
  } else if (body.kind == TransformedShape::Kind::field) {
    height_near(grid_of(*body.field), box.min.data(), box.max.data(), limit, guide.slots());
  } else if (body.compound->tree != nullptr) {
    constexpr double kUnscaled[3] = {1.0, 1.0, 1.0};
    mesh_near(view_of(*body.compound->tree), kUnscaled, box.min.data(), box.max.data(), limit,
              guide.slots());
  } else {
    visit_nearest_first(guide, limit, [&](const Box3& child) {
      return box_gap(box.min.data(), box.max.data(), child.min.data(), child.max.data());
    });
  }
}

}  // namespace

void visit_near(const CompositePool& pool, ShapeId id, const Pose& pose, const MovingBox& from,
                double limit, const PrimitiveVisitor& visitor) {
  const Composites* const all = composites_with(pool, id);
  if (all == nullptr) return;
  const TransformedShape body = TransformedShape::at(*all, id, pose);
  auto show_child = [&](std::uint32_t number, double most) {
    const TransformedShape child = body.child(number);
    return visit_child(child, most, visitor, [&](const PrimitiveVisitor& keeping) {
      visit_near(child, from, most, keeping, {});
    });
  };
  visit_near(body, from, limit, visitor, ChildVisitor::of(show_child));
}

}  // namespace winnow::mid
