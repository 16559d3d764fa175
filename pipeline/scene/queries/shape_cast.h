#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/shapes.h>

#include <cstdint>

namespace winnow {

/// A convex shape that moves along a line without turning, and one that stands.
struct CastPair {
  ShapeId moving;
  Pose from;
  /// Finite, not zero, of any length.
  double direction[3] = {1.0, 0.0, 0.0};
  /// Not negative; may be infinite.
  double max_t = 1.0;
  ShapeId standing;
  Pose pose;
  /// They surely do not touch before.
  double free_until = 0.0;
  /// At max_t the moving shape touches something else that stands, and a plane at right angles to
  /// this parts the two; zero if nothing is known. Whoever is parted there by any plane that they
  /// are nearing is not touched before.
  double parting[3] = {0.0, 0.0, 0.0};
};

struct CastTouch {
  /// In units of the direction.
  double t = 0.0;
  /// Unit, from the standing shape to the moving one. Before `describe_touch` that of a plane that
  /// parted them shortly before; zero if there was none.
  double normal[3] = {0.0, 0.0, 0.0};
  /// On the standing shape, relative to its position, in the axes of the world. By
  /// `describe_touch`.
  double point[3] = {0.0, 0.0, 0.0};
  /// They share points at the start.
  bool overlaps_at_start = false;
  /// How often distances were computed.
  std::uint32_t steps = 0;
};

/// Where the moving shape first touches the standing one; false if it does not. Conservative
/// advancement (Mirtich, "Impulse-based dynamic simulation of rigid body systems", 1996) on
/// separating planes: see shape_cast.cpp. t is never later than the true time of impact, and
/// earlier by at most `tolerance`, a length along the path, or by what rounding makes of it: about
/// 1e-14 of the shapes' sizes over the sine of the angle at which they meet, and 1e-15 of the path.
/// Shapes that pass each other by less than rounding touch. t = 0 for shapes that touch at the
/// start, with the normal along which they are parted the soonest. Shapes and poses are valid, the
/// moving shape is no half-space.
[[nodiscard]] bool cast_shape(const ShapeTables& tables, const CastPair& pair, double tolerance,
                              CastTouch& touch) noexcept;

/// Normal and point of what `cast_shape` found; of shapes that overlap at the start the normal
/// along which they are parted the soonest.
void describe_touch(const ShapeTables& tables, const CastPair& pair, CastTouch& touch) noexcept;

}  // namespace winnow
