#include "pipeline/motion/face_impact.h"

#include "core/numbers/rotation.h"
#include "pipeline/motion/deterministic_trig.h"
#include "pipeline/motion/part_pair.h"
#include "pipeline/shapes/frame.h"

#include <algorithm>

namespace winnow::impact {
namespace {

/// An interval is halved if the growth of the swept box of the face for curved paths exceeds this
/// fraction of the largest side of the box.
constexpr double kLooseBend = 0.1;
/// Limit on the halvings of an interval.
constexpr int kMaxCuts = 12;

class FaceImpactSearch {
 public:
  FaceImpactSearch(const SubShapeQuery& parts, const MovingBody& body, const MovingFace& face,
                   double tolerance) noexcept
      : parts_(parts), body_(body), face_(face), tolerance_(tolerance) {
    as_eigen(motion_.start.position) = face.start[0];
    as_eigen(motion_.travel) = face.end[0] - face.start[0];
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec local = face.start[i] - face.start[0];
      as_eigen(triangle_.vertex[i]) = local;
      drift_[i] = (face.end[i] - face.end[0]) - local;
    }
    triangle_.rounding = face.rounding;
  }

  [[nodiscard]] BodyImpact run() {
    if (body_.shape.is_composite()) {
      walk({0.0, 1.0}, 0);
    } else {
      test(whole_shape(parts_, body_.shape, body_.motion), {0.0, 1.0});
    }
    return found_;
  }

 private:
  void test(const MovingShape& part, const Interval& within) noexcept;
  void walk(const Interval& given, int halvings);
  [[nodiscard]] Vec seen(const Vec& start, const Vec& end, double time) const noexcept;
  [[nodiscard]] mid::Box3 way(const Interval& within, double& bend) const noexcept;

  const SubShapeQuery& parts_;
  const MovingBody& body_;
  const MovingFace& face_;
  const double tolerance_;
  RigidMotion motion_;
  TriangleShape triangle_;
  std::array<Vec, 3> drift_;
  BodyImpact found_;
};

void FaceImpactSearch::test(const MovingShape& part, const Interval& within) noexcept {
  PartPair pair(parts_.shapes());
  const MovingPart moving = pair.put(0, part);
  SubShape own;
  own.shape = ShapeId::of(ShapeKind::triangle, 0);
  own.triangle = &triangle_;
  MovingPart face = pair.put(1, {own, motion_, 0.0, 0.0, 0.0});
  face.drift = drift_.data();
  const BodyImpact found{find_impact(pair.tables(), moving, face, tolerance_, within),
                         part.shape.part};
  if (comes_before(found, found_)) found_ = found;
}

/// Returns the position of a corner at a time, in the body's frame.
Vec FaceImpactSearch::seen(const Vec& start, const Vec& end, double time) const noexcept {
  const Pose pose = body_.motion.at(time);
  const Eigen::Matrix3d axes = rotation_of(scale_to_unit_max(pose.orientation));
  const Vec corner = start + time * (end - start);
  return axes.transpose() * (corner - as_eigen(pose.position));
}

/// Returns a box that contains the face during an interval, in the body's frame, and writes to
/// `bend` the amount by which the box is grown for curved paths. In a frame that rotates at `rate`,
/// a point's acceleration is at most its distance from the origin times rate^2 plus twice its speed
/// relative to the position of the frame (without rotation) times rate. The point leaves its chord
/// by at most an eighth of this bound times the squared duration.
mid::Box3 FaceImpactSearch::way(const Interval& within, double& bend) const noexcept {
  mid::Box3 box;
  const double width = within.last - within.first;
  const double turned = body_.motion.turn.norm() * width;
  double scale = 0.0;
  bend = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec first = seen(face_.start[i], face_.end[i], within.first);
    const Vec last = seen(face_.start[i], face_.end[i], within.last);
    box.min = box.min.cwiseMin(first).cwiseMin(last);
    box.max = box.max.cwiseMax(first).cwiseMax(last);
    const Vec travel = face_.end[i] - face_.start[i] - as_eigen(body_.motion.travel);
    const double way = width * travel.norm();
    const double far = std::max(first.norm(), last.norm()) + way;
    bend = std::max(bend, 0.125 * turned * (turned * far + 2.0 * way));
    scale = std::max(scale, far + face_.start[i].norm() + face_.end[i].norm());
  }
  return box.grown(bend + face_.rounding + 64.0 * mid::kSlack * scale);
}

void FaceImpactSearch::walk(const Interval& given, int halvings) {
  const Interval within = before(given, found_);
  if (within.first > within.last) return;
  double bend = 0.0;
  const mid::Box3 box = way(within, bend);
  const double extent = (box.max - box.min).maxCoeff();
  if (halvings < kMaxCuts && bend > kLooseBend * extent) {
    const double middle = 0.5 * (within.first + within.last);
    walk({within.first, middle}, halvings + 1);
    walk({middle, within.last}, halvings + 1);
    return;
  }
  parts_.visit_parts(PlacedShape{body_.shape, Pose{}}, stationary(box),
                     [&](const SubShape& part, double limit) {
                       test(moving_part(parts_, part, body_.motion), before(within, found_));
                       return limit;
                     });
}

}  // namespace

BodyImpact find_face_impact(const SubShapeQuery& parts, const MovingBody& body,
                            const MovingFace& face, double tolerance) {
  return FaceImpactSearch(parts, body, face, tolerance).run();
}

}  // namespace winnow::impact
