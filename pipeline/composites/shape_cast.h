#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/shapes.h>

#include <cstdint>

namespace winnow {

/// A convex shape that moves along a line without rotation, and a fixed convex shape.
struct CastPair {
  ShapeId moving;
  Pose from;
  /// Finite, not zero, of any length.
  Vec3d direction = {1.0, 0.0, 0.0};
  /// Not negative; may be infinite.
  double max_t = 1.0;
  ShapeId stationary;
  Pose pose;
  /// A time until which the shapes certainly do not touch.
  double free_until = 0.0;
  /// A candidate for a separating direction, or zero: the normal of the plane that separates the
  /// moving shape at max_t from another part that it touches there. If a plane with this normal
  /// separates the pair at max_t, and they approach along it, they do not touch before.
  Vec3d separating_direction{};
};

struct CastTouch {
  /// In units of the direction.
  double t = 0.0;
  /// Unit vector from the fixed shape to the moving one. Before `describe_touch`: the normal of a
  /// plane that separated the shapes shortly before the touch, or zero.
  Vec3d normal{};
  /// On the fixed shape, relative to its position, in world axes. Set by `describe_touch`.
  Vec3d point{};
  /// The shapes overlap at the start.
  bool overlaps_at_start = false;
  /// Number of distance computations.
  std::uint32_t steps = 0;
};

/// Finds where the moving shape first touches the fixed one; returns false if it does not. Uses
/// conservative advancement (Mirtich, "Impulse-based dynamic simulation of rigid body systems",
/// 1996) on separating planes: see shape_cast.cpp.
///
/// t is never later than the true time of impact. It is earlier by at most `tolerance`, a length
/// along the path, or by the rounding error: about 1e-14 of the shapes' sizes over the sine of the
/// angle of impact, and 1e-15 of the path. Shapes that pass each other by less than rounding count
/// as touching. If the shapes touch at the start, t is 0 and the normal is the direction of least
/// penetration. Shapes and poses must be valid; the moving shape must not be a half-space.
[[nodiscard]] bool cast_shape(const ShapeTables& tables, const CastPair& pair, double tolerance,
                              CastTouch& touch) noexcept;

/// Computes the normal and point of a touch that `cast_shape` found; for shapes that overlap at the
/// start, the normal is the direction of least penetration.
void describe_touch(const ShapeTables& tables, const CastPair& pair, CastTouch& touch) noexcept;

}  // namespace winnow
