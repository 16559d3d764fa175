#pragma once

// Where a ray enters a shape: of the convex sets that the shape is made of, the spans of the ray
// within each, and the first of these.

#include <winnow/pipeline/shape_rays.h>
#include <winnow/pipeline/shapes.h>

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <span>

namespace winnow {

/// As ShapeRay says.
[[nodiscard]] bool is_valid(const ShapeRay& ray) noexcept;

/// A ray in the frame of a shape, scaled so that neither the shape nor the distance of `origin` is
/// much above 1, and one of them is near it. `origin` may have been moved along the ray: the ray
/// begins at t = low.
struct LocalRay {
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;
  double speed = 1.0;  // length of the direction
  double low = 0.0;

  [[nodiscard]] Eigen::Vector3d at(double t) const noexcept { return origin + t * direction; }
};

/// Rays that pass by no farther than this count as grazing: some roundings of a length of 1.
inline constexpr double kGrazing = 1e-15;

/// The part of a ray within a convex set. Empty if in > out.
struct RaySpan {
  double in = std::numeric_limits<double>::infinity();
  double out = -std::numeric_limits<double>::infinity();
  /// Outward where it enters; zero if there is no such direction.
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();

  [[nodiscard]] bool is_empty() const noexcept { return !(in <= out); }
};

/// The first entry into a union of convex sets.
struct FirstEntry {
  bool found = false;
  /// The ray begins in one of the sets, t = low; not if it enters right there.
  bool inside = false;
  double t = std::numeric_limits<double>::infinity();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();

  void meet(const LocalRay& ray, const RaySpan& span) noexcept;
};

/// Clips a ray by planes. Exits are a grazing distance late, so that rays through edges, or in a
/// face, are not lost to rounding.
class PlaneClip {
 public:
  explicit PlaneClip(const LocalRay& ray) noexcept : ray_(ray) {
    span_.in = -std::numeric_limits<double>::infinity();
    span_.out = std::numeric_limits<double>::infinity();
  }
  /// Keeps normal . x <= offset; `normal` is a unit vector.
  void below(const Eigen::Vector3d& normal, double offset) noexcept;
  [[nodiscard]] const RaySpan& span() const noexcept { return span_; }

 private:
  const LocalRay& ray_;
  RaySpan span_;
};

[[nodiscard]] RaySpan ball_span(const LocalRay& ray, const Eigen::Vector3d& center,
                                double radius) noexcept;
/// Points within `radius` of the segment.
[[nodiscard]] RaySpan capsule_span(const LocalRay& ray, const Eigen::Vector3d& a,
                                   const Eigen::Vector3d& b, double radius) noexcept;
/// The infinite cylinder about the z axis.
[[nodiscard]] RaySpan tube_span(const LocalRay& ray, double radius) noexcept;
/// Points of both; the normal is that of the later entry.
[[nodiscard]] RaySpan common(const RaySpan& a, const RaySpan& b) noexcept;

/// Points that project into a convex polygon, `vertices` counter-clockwise about the unit vector
/// `normal`, at heights between `bottom` and `top` over the polygon. O(vertices).
[[nodiscard]] RaySpan prism_span(const LocalRay& ray, std::span<const Eigen::Vector3d> vertices,
                                 const Eigen::Vector3d& normal, double bottom, double top) noexcept;

// Where a ray in a shape's frame enters it. Lengths of the shape count `scale` times (a power of
// two), as those of the ray already do.

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
/// Without rounding as a ray at the unit ball that the ellipsoid is stretched from.
[[nodiscard]] FirstEntry enter(const LocalRay& ray, const EllipsoidShape& ellipsoid,
                               double scale) noexcept;
[[nodiscard]] FirstEntry enter(const LocalRay& ray, const SupportShape& shape,
                               double scale) noexcept;

}  // namespace winnow
