#pragma once

// Traversal of the convex parts of any shape for the queries (scene queries, sensors, times of
// impact): a convex shape has itself as its only part; for a composite shape it calls
// mid::MidPhase.

#include <winnow/core/pose.h>
#include <winnow/pipeline/shape_pool.h>
#include "pipeline/composites/mid_phase.h"
#include "pipeline/shapes/extent.h"
#include "pipeline/shapes/frame.h"
#include "pipeline/shapes/two_diff.h"

#include <cmath>
#include <cstdint>
#include <span>
#include <type_traits>

namespace winnow {

/// Returns a box that does not move.
[[nodiscard]] MovingBox stationary(const mid::Box3& box) noexcept;

/// Any shape at a pose.
struct PlacedShape {
  ShapeId shape;
  Pose pose;
};

/// A convex shape in a query: a whole body, a primitive of a body, or a point.
struct SubShape {
  ShapeId shape;
  Pose pose;
  std::uint32_t part = kWholeShape;
  /// Null, or the shape itself if it is not in the pool.
  /// @{
  const TriangleShape* triangle = nullptr;
  const SphereShape* ball = nullptr;
  const HullShape* hull = nullptr;
  /// @}
  /// Added to the rounding of `triangle`.
  double thickness = 0.0;
  /// Facing of `triangle`; see Primitive.
  /// @{
  int front = 0;
  bool is_mirrored = false;
  /// @}
};

[[nodiscard]] inline SubShape part_of(const Primitive& primitive) noexcept {
  SubShape part{primitive.shape, primitive.pose, primitive.part};
  if (primitive.shape.kind() == ShapeKind::triangle) part.triangle = &primitive.triangle;
  part.front = primitive.front;
  part.is_mirrored = primitive.is_mirrored;
  part.hull = primitive.hull;
  return part;
}

/// Traverses the parts of shapes; a convex shape is its own only part.
class SubShapeQuery {
 public:
  SubShapeQuery(const ShapePool& shapes, const CompositePool* composites) noexcept
      : shapes_(shapes), composites_(composites) {}

  [[nodiscard]] const ShapePool& shapes() const noexcept { return shapes_; }
  [[nodiscard]] bool contains(ShapeId shape) const noexcept;
  /// Upper bound on the distance of points of the shape from its origin; infinite for a half-space.
  [[nodiscard]] double radius(ShapeId shape) const noexcept {
    // Inline, so that scenes that use only this function do not link composite shapes.
    return shape.is_composite() ? mid_phase().radius(*composites_, shape)
                                : mid::radius_of(shapes_.tables(), shape);
  }
  /// True if a solid contains a point of the other shape; see mid::solid_contains_shape.
  [[nodiscard]] bool solid_contains(const PlacedShape& solid, const PlacedShape& other) const {
    return solid.shape.is_composite() &&
           mid_phase().solid_contains_shape(*composites_, solid.shape, solid.pose, other.shape,
                                            other.pose);
  }
  [[nodiscard]] bool solid_contains(const PlacedShape& solid, const Vec3d& point) const {
    return solid.shape.is_composite() &&
           mid_phase().solid_contains_point(*composites_, solid.shape, solid.pose, point);
  }
  /// See mid::has_solids.
  [[nodiscard]] bool has_solids(ShapeId shape) const noexcept {
    return shape.is_composite() && mid_phase().has_solids(*composites_, shape);
  }
  /// Returns a box that contains the shape.
  [[nodiscard]] mid::Box3 box(const PlacedShape& placed) const noexcept;
  [[nodiscard]] mid::Box3 box(const SubShape& part) const noexcept;

  /// Calls visit(part, limit) for every part that the moving box may hit, roughly in order of time.
  /// `visit` returns the limit of t for the rest of the traversal; a negative limit ends it.
  template <typename Visit>
  void visit_parts(const PlacedShape& placed, const MovingBox& moving_box, Visit&& visit,
                   mid::Solids solids = mid::Solids::hulls) const {
    if (!placed.shape.is_composite()) {
      static_cast<void>(visit(SubShape{placed.shape, placed.pose}, moving_box.max_t));
      return;
    }
    const PrimitiveVisitor visitor = primitive_visitor(visit);
    mid_phase().visit(*composites_, placed.shape, placed.pose, bounded(placed, moving_box), solids,
                      visitor);
  }
  /// See mid::cast_rays; the shape is composite.
  void cast_rays(const PlacedShape& placed, std::span<const ShapeRay> rays, const double* limits,
                 bool any, RaySurface* prepared, PartHit* hits) const {
    mid_phase().cast_rays(*composites_, placed.shape, placed.pose, rays, limits, any, prepared,
                          hits);
  }
  /// Calls visit(a, b) for pairs of parts of two meshes that may share a point, until it returns
  /// false. Returns false, without a call, if the shapes are not two meshes.
  template <typename Visit>
  bool pairs(const PlacedShape& a, const PlacedShape& b, Visit&& visit) const {
    using Visitor = std::remove_reference_t<Visit>;
    if (!a.shape.is_composite() || !b.shape.is_composite()) return false;
    return mid_phase().visit_pairs(
        *composites_, a.shape, a.pose, b.shape, b.pose,
        {[](void* context, const Primitive& first, const Primitive& second) {
           return (*static_cast<Visitor*>(context))(part_of(first), part_of(second));
         },
         &visit});
  }
  /// Calls visit(a, b, limit) for pairs of parts of two meshes that may be within `limit` of each
  /// other. `visit` returns the new limit, as in `visit_parts`; for `normal` see NearPairVisitor.
  /// Returns false, without a call, if the shapes are not two meshes or the mid phase does not
  /// support them.
  template <typename Visit>
  bool near_pairs(const PlacedShape& a, const PlacedShape& b, double limit, const double* normal,
                  Visit&& visit) const {
    using Visitor = std::remove_reference_t<Visit>;
    if (!a.shape.is_composite() || !b.shape.is_composite()) return false;
    return mid_phase().visit_near_pairs(
        *composites_, a.shape, a.pose, b.shape, b.pose, limit,
        {[](void* context, const Primitive& first, const Primitive& second, double most) {
           return (*static_cast<Visitor*>(context))(part_of(first), part_of(second), most);
         },
         &visit, normal});
  }
  /// Calls visit(part, limit) for every part that may be within `limit` of a box; `visit` returns
  /// the new limit, as in `visit_parts`.
  template <typename Visit>
  void near(const PlacedShape& placed, const mid::Box3& from, double limit, Visit&& visit) const {
    if (!placed.shape.is_composite()) {
      static_cast<void>(visit(SubShape{placed.shape, placed.pose}, limit));
      return;
    }
    const PrimitiveVisitor visitor = primitive_visitor(visit);
    mid_phase().visit_near(*composites_, placed.shape, placed.pose,
                           bounded(placed, stationary(from)), limit, visitor);
  }

 private:
  template <typename Visit>
  static PrimitiveVisitor primitive_visitor(Visit& visit) noexcept {
    return {
        [](void* context, const Primitive& primitive, double limit) {
          return static_cast<double>((*static_cast<Visit*>(context))(part_of(primitive), limit));
        },
        &visit};
  }
  /// Returns the box, clipped to the box of the shape where it is unbounded.
  [[nodiscard]] MovingBox bounded(const PlacedShape& placed, MovingBox moving_box) const noexcept;

  [[nodiscard]] const mid::MidPhase& mid_phase() const noexcept {
    return mid::PoolAccess::mid_phase(*composites_);
  }

  const ShapePool& shapes_;
  const CompositePool* composites_;
};

/// Upper bound on the distance between copies of a common corner of adjacent triangles, which are
/// rounded separately. Triangles that are this thick leave no gaps between them.
[[nodiscard]] double corner_error(const SubShape& part) noexcept;

/// Finds where a ray enters a part, at any t up to its max_t. Returns false if it does not, or if
/// it begins behind a one-sided triangle. A ray that misses a triangle by no more than
/// `corner_error` enters it.
[[nodiscard]] bool enters(const ShapePool& shapes, const ShapeRay& ray, const SubShape& part,
                          ShapeHit& hit) noexcept;

/// True if `triangle` has no rounding and its pose has no rotation.
[[nodiscard]] bool is_unrotated(const SubShape& part) noexcept;

/// True if the part is a one-sided triangle and the centre of the box is behind it.
[[nodiscard]] bool is_behind_triangle(const mid::Box3& box, const SubShape& part) noexcept;

[[nodiscard]] inline bool is_finite(const Vec3d& point) noexcept {
  return std::isfinite(point[0]) && std::isfinite(point[1]) && std::isfinite(point[2]);
}

/// Returns the pose with its position set to the origin.
[[nodiscard]] Pose at_origin(const Pose& pose) noexcept;

/// Returns the pose relative to a position.
[[nodiscard]] Pose relative(const Pose& pose, const double position[3]) noexcept;

}  // namespace winnow
