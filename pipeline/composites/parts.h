#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/mid_phase.h>
#include <winnow/pipeline/shape_pool.h>
#include "pipeline/shapes/difference.h"
#include "pipeline/shapes/extent.h"

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <span>
#include <type_traits>

namespace winnow {

/// A box in double, in the axes of the world.
struct PreciseBox {
  Eigen::Vector3d min;
  Eigen::Vector3d max;

  /// Grown by `by` to all sides.
  [[nodiscard]] PreciseBox grown(double by) const noexcept;
  [[nodiscard]] BoxSweep standing() const noexcept;
};

/// Any shape where it stands.
struct PlacedShape {
  ShapeId shape;
  Pose pose;
};

/// A convex shape that a question is about: of a body, of a part of one, or a point.
struct ConvexPart {
  ShapeId shape;
  Pose pose;
  std::uint32_t part = kWholeShape;
  /// Triangles and balls that are not in the pool.
  const TriangleShape* triangle = nullptr;
  const SphereShape* ball = nullptr;
  /// Added to the rounding of `triangle`.
  double thickness = 0.0;
  /// Of `triangle`: see Primitive::front.
  int front = 0;
};

/// The tables of a pool in which two parts are to be found, wherever they came from.
class PartTables {
 public:
  explicit PartTables(const ShapePool& pool) noexcept;
  PartTables(const PartTables&) = delete;
  PartTables& operator=(const PartTables&) = delete;

  /// The id in `tables` of the part that is number `slot`, 0 or 1.
  [[nodiscard]] ShapeId put(std::size_t slot, const ConvexPart& part) noexcept;
  [[nodiscard]] const ShapeTables& tables() const noexcept { return tables_; }

 private:
  const ShapeTables& pool_;
  ShapeTables tables_;
  TriangleShape triangles_[2];
  SphereShape balls_[2];
};

/// Traverses the parts of shapes, be they composite or their own only part.
class PartTraversal {
 public:
  PartTraversal(const ShapePool& shapes, const MidPhase* composites) noexcept
      : shapes_(shapes), composites_(composites) {}

  [[nodiscard]] const ShapePool& shapes() const noexcept { return shapes_; }
  [[nodiscard]] bool contains(ShapeId shape) const noexcept;
  /// No point of the shape is farther from its own origin; infinite for a half-space.
  [[nodiscard]] double radius(ShapeId shape) const noexcept {
    // In place, so that scenes which ask for this alone link no composite shapes.
    return shape.is_composite() ? composites_->radius(shape)
                                : mid::radius_of(shapes_.tables(), shape);
  }
  /// True if a solid holds a point of the other; see MidPhase::holds.
  [[nodiscard]] bool holds(const PlacedShape& solid, const PlacedShape& other) const {
    return solid.shape.is_composite() &&
           composites_->holds(solid.shape, solid.pose, other.shape, other.pose);
  }
  [[nodiscard]] bool holds(const PlacedShape& solid, const double point[3]) const {
    return solid.shape.is_composite() && composites_->holds(solid.shape, solid.pose, point);
  }
  /// Contains the shape where it stands.
  [[nodiscard]] PreciseBox box(const PlacedShape& placed) const noexcept;
  [[nodiscard]] PreciseBox box(const ConvexPart& part) const noexcept;

  /// Calls visit(part, limit) for every part that the sweep may meet, roughly in order; it gives
  /// back the limit of t to go on with, below zero to end.
  template <typename Visit>
  void met(const PlacedShape& placed, const BoxSweep& sweep, Visit&& visit) const {
    traverse(placed, sweep, sweep.max_t, false, visitor(visit));
  }
  /// Calls meet(ray, part, hit, limit) for triangles that a ray meets for certain, and
  /// look(ray, part, limit) for all other parts that it may meet up to its limit, of a composite
  /// shape. See RayVisitor.
  template <typename Meet, typename Look>
  void met_by_rays(const PlacedShape& placed, std::span<const ShapeRay> rays, const double* limits,
                   Meet&& meet, Look&& look) const {
    using Meeting = RayMeeting<std::remove_reference_t<Meet>, std::remove_reference_t<Look>>;
    Meeting meeting{meet, look};
    composites_->visit_rays(placed.shape, placed.pose, rays, limits,
                            {&Meeting::call_meet, &Meeting::call_look, &meeting});
  }
  /// The same of one ray, and a mesh that `place` made ready.
  template <typename Meet, typename Look>
  void met_by_ray(const RaySurface& surface, const ShapeRay& ray, double limit, Meet&& meet,
                  Look&& look) const {
    using Meeting = RayMeeting<std::remove_reference_t<Meet>, std::remove_reference_t<Look>>;
    Meeting meeting{meet, look};
    composites_->visit_ray(surface, ray, limit,
                           {&Meeting::call_meet, &Meeting::call_look, &meeting});
  }
  /// See MidPhase::place.
  [[nodiscard]] bool place(const PlacedShape& placed, RaySurface& surface) const {
    return composites_->place(placed.shape, placed.pose, surface);
  }
  /// Calls visit(a, b) for pairs of parts of two meshes that may share a point, until it says
  /// false. False, and nothing is shown, if these are no two meshes.
  template <typename Visit>
  bool pairs(const PlacedShape& a, const PlacedShape& b, Visit&& visit) const {
    using Visitor = std::remove_reference_t<Visit>;
    if (!a.shape.is_composite() || !b.shape.is_composite()) return false;
    return composites_->visit_pairs(
        a.shape, a.pose, b.shape, b.pose,
        {[](void* context, const Primitive& first, const Primitive& second) {
           return (*static_cast<Visitor*>(context))(part_of(first), part_of(second));
         },
         &visit});
  }
  /// Calls visit(a, b, limit) for pairs of parts of two meshes that may be within `limit` of each
  /// other, as `met` does; `normal` is that of a NearPairVisitor. False, and nothing is shown, if
  /// they cannot be taken so.
  template <typename Visit>
  bool near_pairs(const PlacedShape& a, const PlacedShape& b, double limit, const double* normal,
                  Visit&& visit) const {
    using Visitor = std::remove_reference_t<Visit>;
    if (!a.shape.is_composite() || !b.shape.is_composite()) return false;
    return composites_->visit_near_pairs(
        a.shape, a.pose, b.shape, b.pose, limit,
        {[](void* context, const Primitive& first, const Primitive& second, double most) {
           return (*static_cast<Visitor*>(context))(part_of(first), part_of(second), most);
         },
         &visit, normal});
  }
  /// Calls visit(part, limit) for every part that may be within `limit` of a box, as `met` does.
  template <typename Visit>
  void near(const PlacedShape& placed, const PreciseBox& from, double limit, Visit&& visit) const {
    traverse(placed, from.standing(), limit, true, visitor(visit));
  }

 private:
  [[nodiscard]] static ConvexPart part_of(const Primitive& primitive) noexcept {
    ConvexPart part{primitive.shape, primitive.pose, primitive.part};
    if (primitive.shape.kind() == ShapeKind::triangle) part.triangle = &primitive.triangle;
    part.front = primitive.front;
    return part;
  }
  template <typename Meet, typename Look>
  struct RayMeeting {
    Meet& meet;
    Look& look;

    static double call_meet(void* context, std::size_t ray, std::uint32_t part, const ShapeHit& hit,
                            double limit) {
      return static_cast<RayMeeting*>(context)->meet(ray, part, hit, limit);
    }
    static double call_look(void* context, std::size_t ray, const Primitive& primitive,
                            double limit) {
      return static_cast<RayMeeting*>(context)->look(ray, part_of(primitive), limit);
    }
  };
  struct PartVisitor {
    double (*visit)(void* context, const ConvexPart& part, double limit);
    void* context;
  };
  template <typename Visit>
  static PartVisitor visitor(Visit& visit) noexcept {
    return {[](void* context, const ConvexPart& part, double limit) {
              return (*static_cast<Visit*>(context))(part, limit);
            },
            &visit};
  }
  void traverse(const PlacedShape& placed, BoxSweep sweep, double limit, bool near,
                PartVisitor visitor) const;

  const ShapePool& shapes_;
  const MidPhase* composites_;
};

/// True of a triangle that lies as it is given, about the part's position.
[[nodiscard]] bool stands_unturned(const ConvexPart& part) noexcept;

/// True if what the box is about stands behind a part, which is a one-sided triangle.
[[nodiscard]] bool stands_behind(const PreciseBox& box, const ConvexPart& part) noexcept;

[[nodiscard]] inline bool is_finite(const double point[3]) noexcept {
  return std::isfinite(point[0]) && std::isfinite(point[1]) && std::isfinite(point[2]);
}

/// A shape's pose at the origin.
[[nodiscard]] Pose at_origin(const Pose& pose) noexcept;

/// A shape's pose as seen from a position.
[[nodiscard]] Pose relative(const Pose& pose, const double position[3]) noexcept;

}  // namespace winnow
