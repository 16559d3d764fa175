#pragma once

#include "pipeline/composites/parts.h"
#include "pipeline/motion/moving_pair.h"

namespace winnow::impact {

/// Any shape that moves with a body.
struct MovingShape {
  /// In the frame of the body; the whole shape may be composite.
  ConvexPart shape;
  const RigidMotion& motion;
  /// No point is farther from the position of the body; none from the shape's own, which is about
  /// `arm` from it.
  double radius;
  double own_radius;
  double arm;
};

/// `shape` is the body's own, at its pose.
[[nodiscard]] MovingShape whole_shape(const PartTraversal& parts, ShapeId shape,
                                      const RigidMotion& motion) noexcept;
/// A part of a body that moves.
[[nodiscard]] MovingShape moving_part(const PartTraversal& parts, const ConvexPart& part,
                                      const RigidMotion& motion) noexcept;

/// Piece i of a motion that is cut into so many.
[[nodiscard]] inline Interval piece_of(std::uint32_t i, std::uint32_t pieces) noexcept {
  return {static_cast<double>(i) / pieces, static_cast<double>(i + 1) / pieces};
}

/// A moving shape as a moving frame sees it. A point of it has there a path whose second derivative
/// has a bound: that of turning, of the shape and of the frame, and of travelling through what
/// turns. So it leaves the chord between two times by no more than an eighth of the bound times the
/// square of the time between, which boxes are
/// grown by; where that is more, the shape stays in a ball.
class Passage {
 public:
  /// Both must outlive it.
  Passage(const PartTraversal& parts, const RigidMotion& frame, const MovingShape& shape) noexcept;

  /// A box that contains the shape at all times of an interval, which are t = 0 to 1.
  [[nodiscard]] BoxSweep sweep(const Interval& within) const noexcept;
  /// By how much the box of an interval is grown because paths are bent.
  [[nodiscard]] double bend(const Interval& within) const noexcept;
  /// The box that contains the shape at all times of an interval: the union of the boxes of as many
  /// parts of it as it takes for bends of a few hundredths of the radius.
  [[nodiscard]] PreciseBox box(const Interval& within) const noexcept;
  /// Into how many pieces of the motion a way is best cut, at most 8, before boxes are put around
  /// them: each piece runs across at most two axes by more than the shape measures.
  [[nodiscard]] std::uint32_t piece_count() const noexcept;
  /// When the shape may come into a ball about the frame's position.
  [[nodiscard]] Interval window(double frame_radius) const noexcept {
    return ball_window(apart_, travel_, frame_radius + shape_.radius);
  }

 private:
  struct Place {
    Vec position;
    Quaternion turn;
  };
  [[nodiscard]] Place place(double time) const noexcept;
  [[nodiscard]] PreciseBox about(const Quaternion& turn) const noexcept;
  /// What of the bend is of orientations, and what of the position.
  [[nodiscard]] double turning_bend(double width) const noexcept;
  [[nodiscard]] double path_bend(double far, double width) const noexcept;
  /// Of the shape from the frame's position, in the axes of the world.
  [[nodiscard]] Vec between(double time) const noexcept;
  /// No farther from the frame's position does the shape's get.
  [[nodiscard]] double farthest(const Interval& within) const noexcept;

  const PartTraversal& parts_;
  const RigidMotion& frame_;
  const MovingShape& shape_;
  Vec apart_;
  Vec travel_;
  double frame_rate_;
  double shape_rate_;
  /// At the start, of length 1.
  Quaternion frame_from_;
  Quaternion shape_from_;
};

}  // namespace winnow::impact
