#pragma once

#include "pipeline/composites/parts.h"
#include "pipeline/motion/moving_pair.h"

namespace winnow::impact {

/// Any shape that moves with a body.
struct MovingShape {
  /// In the body's frame; a whole shape may be composite.
  SubShape shape;
  const RigidMotion& motion;
  /// `radius` and `own_radius` are upper bounds on the distance of the shape's points from the
  /// body's position and from the shape's own position. `arm` is the distance between these two
  /// positions.
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

/// A moving shape relative to a moving frame. In the frame, the path of each point of the shape has
/// a bounded second derivative, due to the rotation of the shape and of the frame, and to the
/// travel in the rotating frame. So during an interval, a point leaves its chord by at most an
/// eighth of the bound times the squared duration. Boxes are grown by this amount. If the growth
/// for rotation is not less than the radius of the shape, the box of a ball about the shape is
/// used; if the growth for the path exceeds the distance from the frame, the box of a ball about
/// the frame.
class RelativeMotionBounds {
 public:
  /// The arguments must outlive the object.
  RelativeMotionBounds(const SubShapeQuery& parts, const RigidMotion& frame,
                       const MovingShape& shape) noexcept;

  /// A moving box that contains the shape at all times of an interval; its t from 0 to 1 spans the
  /// interval.
  [[nodiscard]] MovingBox moving_box(const Interval& within) const noexcept;
  /// The amount by which the box of an interval is grown for curved paths.
  [[nodiscard]] double bend(const Interval& within) const noexcept;
  /// A fixed box that contains the shape at all times of an interval: the union of the moving boxes
  /// of up to 256 equal parts of the interval. Unless more parts would be necessary, the rotations
  /// of the shape and of the frame sum to at most half a radian in each part.
  [[nodiscard]] mid::Box3 box(const Interval& within) const noexcept;
  /// The number of pieces, at most 8, into which to cut the motion before boxes are put around it.
  /// Unless more than 8 are necessary, the shape moves by more than its diameter along at most one
  /// axis in each piece.
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
  [[nodiscard]] mid::Box3 about(const Quaternion& turn) const noexcept;
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
