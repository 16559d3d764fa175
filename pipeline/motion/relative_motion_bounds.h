#pragma once

#include "pipeline/composites/parts.h"
#include "pipeline/motion/moving_pair.h"

namespace winnow::impact {

/// Any shape that moves with a body.
struct MovingShape {
  /// In the body's frame; a whole shape may be composite.
  SubShape shape;
  const RigidMotion& motion;
  /// Upper bounds on the distance of points from the body's position and from the shape's own
  /// position; and the distance between these positions.
  double radius;
  double own_radius;
  double arm;
};

/// The body's own shape, at the body's pose.
[[nodiscard]] MovingShape whole_shape(const SubShapeQuery& parts, ShapeId shape,
                                      const RigidMotion& motion) noexcept;
/// A part of a moving body.
[[nodiscard]] MovingShape moving_part(const SubShapeQuery& parts, const SubShape& part,
                                      const RigidMotion& motion) noexcept;

/// Piece i of a motion that is cut into `pieces` equal pieces.
[[nodiscard]] inline Interval piece_of(std::uint32_t i, std::uint32_t pieces) noexcept {
  return {static_cast<double>(i) / pieces, static_cast<double>(i + 1) / pieces};
}

/// A moving shape relative to a moving frame. The path of each of its points has a bounded second
/// derivative there, due to the rotation of the shape and the frame, and to travel in a rotating
/// frame. So between two times a point leaves the chord by at most an eighth of the bound times the
/// squared time between. Boxes are grown by this amount; if it is too large, a ball about the shape
/// is used.
class RelativeMotionBounds {
 public:
  /// The arguments must outlive the object.
  RelativeMotionBounds(const SubShapeQuery& parts, const RigidMotion& frame,
                       const MovingShape& shape) noexcept;

  /// A moving box that contains the shape at all times of an interval; its t from 0 to 1 spans the
  /// interval.
  [[nodiscard]] BoxSweep sweep(const Interval& within) const noexcept;
  /// The amount by which the box of an interval is grown for curved paths.
  [[nodiscard]] double bend(const Interval& within) const noexcept;
  /// A fixed box that contains the shape at all times of an interval: the union of the boxes of its
  /// parts, which are short enough that curvature adds only a few hundredths of the radius.
  [[nodiscard]] PreciseBox box(const Interval& within) const noexcept;
  /// The number of pieces, at most 8, into which to cut the motion before boxes are put around it.
  /// With enough pieces, the shape moves by more than its diameter along at most one axis in each.
  [[nodiscard]] std::uint32_t piece_count() const noexcept;
  /// The times at which the shape may overlap a ball about the frame's position.
  [[nodiscard]] Interval window(double frame_radius) const noexcept {
    return ball_window(apart_, travel_, frame_radius + shape_.radius);
  }

 private:
  struct RelativePose {
    Vec position;
    Quaternion turn;
  };
  [[nodiscard]] RelativePose place(double time) const noexcept;
  [[nodiscard]] PreciseBox about(const Quaternion& turn) const noexcept;
  /// The growth due to rotation of orientations, and due to the path of the position.
  [[nodiscard]] double turning_bend(double width) const noexcept;
  [[nodiscard]] double path_bend(double far, double width) const noexcept;
  /// From the frame's position to the shape's, in world axes.
  [[nodiscard]] Vec between(double time) const noexcept;
  /// Upper bound on the distance of the shape's position from the frame's.
  [[nodiscard]] double farthest(const Interval& within) const noexcept;

  const SubShapeQuery& parts_;
  const RigidMotion& frame_;
  const MovingShape& shape_;
  Vec apart_;
  Vec travel_;
  double frame_rate_;
  double shape_rate_;
  /// At the start; of length 1.
  Quaternion frame_from_;
  Quaternion shape_from_;
};

}  // namespace winnow::impact
