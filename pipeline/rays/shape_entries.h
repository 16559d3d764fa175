#pragma once

// Finds the point at which a ray enters a shape. The shape is a union of convex sets; the ray
// enters the shape when it enters the first of these sets. shape_rays.cpp calls `enter` for one
// shape, after scaling the ray.

#include <winnow/pipeline/shape_rays.h>
#include <winnow/pipeline/shapes.h>
#include "pipeline/kinds/kinds.h"

#include <Eigen/Core>
#include <limits>
#include <span>

namespace winnow {

/// Returns whether the ray satisfies the constraints of ShapeRay.
[[nodiscard]] bool is_valid(const ShapeRay& ray) noexcept;

/// As cast_ray, for a valid ray and pose of a shape of the tables. Sets whether the ray starts
/// inside the shape, not on its surface.
[[nodiscard]] ShapeHit find_entry(const ShapeTables& tables, ShapeId shape, const Pose& pose,
                                  const ShapeRay& ray, bool& starts_inside) noexcept;
/// Finds the point at which the ray leaves the shape for the last time; its normal points out of
/// the shape. Arguments as above. The exit is the entry of the reversed ray, with the same errors.
[[nodiscard]] ShapeHit find_exit(const ShapeTables& tables, ShapeId shape, const Pose& pose,
                                 const ShapeRay& ray) noexcept;

/// A ray in the frame of a shape, scaled by a power of two: the larger of the shape's size and the
/// largest coordinate of `origin` (in world axes) is in [1/2, 1). `origin` may have been moved
/// along the ray: the ray begins at t = low.
struct LocalRay {
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;
  double speed = 1.0;  // length of the direction
  double low = 0.0;

  [[nodiscard]] Eigen::Vector3d at(double t) const noexcept { return origin + t * direction; }
};

/// A ray that passes a set at no more than this distance counts as grazing it: a few roundings of a
/// length of 1.
inline constexpr double kGrazing = 1e-15;

/// The part of a ray within a convex set. Empty if in > out.
struct RaySpan {
  double in = std::numeric_limits<double>::infinity();
  double out = -std::numeric_limits<double>::infinity();
  /// Outward normal at the entry; zero if it is undefined.
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();

  [[nodiscard]] bool is_empty() const noexcept { return !(in <= out); }
};

/// The first entry into a union of convex sets.
struct FirstEntry {
  bool found = false;
  /// True if the ray begins inside one of the sets (then t = low); false if it enters exactly at
  /// its beginning.
  bool inside = false;
  double t = std::numeric_limits<double>::infinity();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();

  void merge_span(const LocalRay& ray, const RaySpan& span) noexcept;
};

/// Clips a ray by half-spaces. Exits are moved out by the grazing distance, so that rays through
/// edges or in a face are not lost to rounding.
class PlaneClip {
 public:
  explicit PlaneClip(const LocalRay& ray) noexcept : ray_(ray) {
    span_.in = -std::numeric_limits<double>::infinity();
    span_.out = std::numeric_limits<double>::infinity();
  }
  /// Intersects with normal . x <= offset; `normal` is a unit vector.
  void below(const Eigen::Vector3d& normal, double offset) noexcept;
  [[nodiscard]] const RaySpan& span() const noexcept { return span_; }

 private:
  const LocalRay& ray_;
  RaySpan span_;
};

[[nodiscard]] RaySpan ball_span(const LocalRay& ray, const Eigen::Vector3d& center,
                                double radius) noexcept;
/// The set of points within `radius` of the segment from a to b.
[[nodiscard]] RaySpan capsule_span(const LocalRay& ray, const Eigen::Vector3d& a,
                                   const Eigen::Vector3d& b, double radius) noexcept;
/// The infinite cylinder about the z axis.
[[nodiscard]] RaySpan tube_span(const LocalRay& ray, double radius) noexcept;
/// The intersection; its normal is the normal of the later entry.
[[nodiscard]] RaySpan common(const RaySpan& a, const RaySpan& b) noexcept;

/// The set of points that project into a convex polygon, at heights between `bottom` and `top` over
/// it. `vertices` are counter-clockwise about the unit vector `normal`. O(vertices).
[[nodiscard]] RaySpan prism_span(const LocalRay& ray, std::span<const Eigen::Vector3d> vertices,
                                 const Eigen::Vector3d& normal, double bottom, double top) noexcept;

// Entry of a ray into a shape, in the shape's frame. The shape's lengths are multiplied by `scale`
// (a power of two); the ray's already are.

[[nodiscard]] FirstEntry enter(const LocalRay& ray, const SphereShape& sphere,
                               double scale) noexcept;
[[nodiscard]] FirstEntry enter(const LocalRay& ray, const CapsuleShape& capsule,
                               double scale) noexcept;
[[nodiscard]] FirstEntry enter(const LocalRay& ray, const BoxShape& box, double scale) noexcept;
[[nodiscard]] FirstEntry enter(const LocalRay& ray, const CylinderShape& cylinder,
                               double scale) noexcept;
[[nodiscard]] FirstEntry enter(const LocalRay& ray, const ConeShape& cone, double scale) noexcept;
/// O(faces + edges).
[[nodiscard]] FirstEntry enter(const LocalRay& ray, const HullShape& hull, double scale) noexcept;
[[nodiscard]] FirstEntry enter(const LocalRay& ray, const TriangleShape& triangle,
                               double scale) noexcept;
[[nodiscard]] FirstEntry enter(const LocalRay& ray, const HalfSpaceShape& half_space,
                               double scale) noexcept;
[[nodiscard]] FirstEntry enter(const LocalRay& ray, const TaperedCapsuleShape& taper,
                               double scale) noexcept;
/// Without rounding, and if all scaled radii exceed 1e-12: intersects the ray with a unit ball in
/// the space scaled by the radii. Else: conservative advancement.
[[nodiscard]] FirstEntry enter(const LocalRay& ray, const EllipsoidShape& ellipsoid,
                               double scale) noexcept;
/// By conservative advancement to a core that is given by its support function or its corners.
[[nodiscard]] FirstEntry enter_core(const LocalRay& ray, const ShapeCore& core,
                                    double scale) noexcept;
/// All other shapes have such a core.
template <typename Shape>
[[nodiscard]] FirstEntry enter(const LocalRay& ray, const Shape& shape, double scale) noexcept {
  return enter_core(ray, core_of(shape), scale);
}

}  // namespace winnow
