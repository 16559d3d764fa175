// Penetration depth of solids (solid_depth.h). ClosestParts of shape_distance.h calls it.

#include "pipeline/composites/solid_depth.h"

#include "core/numbers/rotation.h"
#include "pipeline/composites/shape_cast.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace winnow {
namespace {

using mid::Box3;
using mid::kInfinity;
using mid::Vec;

/// Distances below this share of the size of the shapes count as 0.
constexpr double kTolerance = 1e-10;
/// A way counts as shorter if it is by this share.
constexpr double kShorter = 1e-7;
/// Directions with a larger cosine are candidates once.
constexpr double kSameWay = 0.98;

/// A translation that parts the shapes.
struct WayOut {
  Vec direction = Vec::Zero();
  double length = kInfinity;
  /// Normal of the contact that it leaves last, from a to b.
  Vec normal = Vec::Zero();
};

/// The lengths of a way at which two parts overlap.
struct Passage {
  double first = -kInfinity;
  double last = kInfinity;
  /// Normal from a to b where b leaves a.
  Vec normal = Vec::Zero();
};

/// Candidate directions, each once.
class Directions {
 public:
  void add(const Vec& direction) noexcept {
    const double length = direction.norm();
    if (!(length > 0.0) || is_full()) return;
    const Vec unit = direction / length;
    const auto is_same = [&](const Vec& one) { return one.dot(unit) > kSameWay; };
    if (std::any_of(begin(), end(), is_same)) return;
    all_[count_++] = unit;
  }
  [[nodiscard]] bool is_full() const noexcept { return count_ == kRoom; }
  [[nodiscard]] const Vec* begin() const noexcept { return all_.data(); }
  [[nodiscard]] const Vec* end() const noexcept { return all_.data() + count_; }

 private:
  static constexpr std::size_t kRoom = 80;

  std::array<Vec, kRoom> all_;
  std::size_t count_ = 0;
};

/// Rotates from the frame of a pose to the world.
[[nodiscard]] Eigen::Matrix3d turn_of(const Pose& pose) noexcept {
  return rotation_of_unit(normalized(scale_to_unit_max(pose.orientation)));
}

[[nodiscard]] Vec normal_of(const TriangleShape& triangle, const Pose& pose) noexcept {
  const Vec first = as_eigen(triangle.vertex[0]);
  const Vec one = as_eigen(triangle.vertex[1]) - first;
  const Vec two = as_eigen(triangle.vertex[2]) - first;
  return turn_of(pose) * one.cross(two);
}

using TriangleCorners = std::array<Vec, 3>;

[[nodiscard]] TriangleCorners corners_of(const SubShape& part) noexcept {
  const Eigen::Matrix3d turn = turn_of(part.pose);
  TriangleCorners corners;
  for (std::size_t k = 0; k < 3; ++k) {
    corners[k] = as_eigen(part.pose.position) + turn * as_eigen(part.triangle->vertex[k]);
  }
  return corners;
}

/// Shortens the passage of triangle b past triangle a to the lengths at which their projections on
/// an axis overlap.
void project(const TriangleCorners& a, const TriangleCorners& b, const Vec& direction,
             const Vec& axis, Passage& passage) noexcept {
  constexpr double kParallel = 1e-12;
  const double length = axis.norm();
  const double speed = axis.dot(direction);
  if (!(std::abs(speed) > kParallel * length)) return;
  const auto [least_a, most_a] = std::minmax({axis.dot(a[0]), axis.dot(a[1]), axis.dot(a[2])});
  const auto [least_b, most_b] = std::minmax({axis.dot(b[0]), axis.dot(b[1]), axis.dot(b[2])});
  const double one = (most_a - least_b) / speed;
  const double two = (least_a - most_b) / speed;
  passage.first = std::max(passage.first, std::min(one, two));
  const double last = std::max(one, two);
  if (last >= passage.last) return;
  passage.last = last;
  passage.normal = axis / (speed > 0.0 ? length : -length);
}

/// The separating axes of two triangles: their normals, products of their edges, and normals of
/// edges in their planes.
[[nodiscard]] Passage passage_of(const TriangleCorners& a, const TriangleCorners& b,
                                 const Vec& direction) noexcept {
  Passage passage;
  const auto edge = [](const TriangleCorners& of, std::size_t k) -> Vec {
    return of[(k + 1) % 3] - of[k];
  };
  for (const TriangleCorners* const own : {&a, &b}) {
    const Vec normal = edge(*own, 0).cross(edge(*own, 1));
    project(a, b, direction, normal, passage);
    for (std::size_t k = 0; k < 3; ++k) {
      project(a, b, direction, normal.cross(edge(*own, k)), passage);
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      project(a, b, direction, edge(a, i).cross(edge(b, k)), passage);
    }
  }
  return passage;
}

/// Two unit vectors that are perpendicular to a unit vector and to each other.
[[nodiscard]] std::array<Vec, 2> tangents_of(const Vec& direction) noexcept {
  const Vec one = direction.unitOrthogonal();
  return {one, direction.cross(one)};
}

class SolidDepth {
 public:
  SolidDepth(const SubShapeQuery& parts, const Pairing& pair) noexcept
      : parts_(parts),
        pair_(pair),
        box_a_(parts.box(pair.a)),
        box_b_(parts.box(pair.b)),
        size_((box_a_.max - box_a_.min).norm() + (box_b_.max - box_b_.min).norm()) {}

  /// Returns false if no way out was found, because the numbers are too large.
  [[nodiscard]] bool find(ShapeDistance& answer) noexcept {
    for (const Vec& direction : candidates()) improve(direction);
    if (!std::isfinite(best_.length)) return false;
    shorten();
    write(answer);
    return true;
  }

 private:
  [[nodiscard]] Directions candidates() const noexcept;
  void improve(const Vec& direction) noexcept;
  void shorten() noexcept;
  [[nodiscard]] WayOut leave(const Vec& direction, double most) const noexcept;
  void leave_parts(WayOut& way) const noexcept;
  [[nodiscard]] Passage passage_of_parts(const SubShape& a, const SubShape& b, const Vec& direction,
                                         double reach) const noexcept;
  [[nodiscard]] double lower_bound(const Vec& touched) const noexcept;
  [[nodiscard]] double bound_at(const Vec& point) const noexcept;
  [[nodiscard]] double depth_in(const PlacedShape& shape, const Vec& point) const noexcept;
  void write(ShapeDistance& answer) const noexcept;

  [[nodiscard]] bool overlaps_at(const Vec& by) const noexcept {
    return do_overlap_at(parts_, pair_, by);
  }
  /// A length of the way at which the boxes are apart.
  [[nodiscard]] double reach(const Box3& a, const Box3& b, const Vec& direction) const noexcept {
    const Vec farthest =
        direction.cwiseProduct(a.max - b.min).cwiseMax(direction.cwiseProduct(a.min - b.max));
    return farthest.sum() + kTolerance * size_;
  }

  const SubShapeQuery& parts_;
  const Pairing& pair_;
  Box3 box_a_;
  Box3 box_b_;
  double size_;
  WayOut best_;
};

// The way to the nearest surface, the way between the centres, the axes of both frames, directions
// to all sides, and the normals of overlapping triangles.
Directions SolidDepth::candidates() const noexcept {
  Directions found;
  ShapeDistance surfaces;
  if (ClosestParts(parts_).find_surfaces(pair_, surfaces)) found.add(-as_eigen(surfaces.normal));
  found.add(0.5 * (box_b_.min + box_b_.max - box_a_.min - box_a_.max));
  for (const PlacedShape* const shape : {&pair_.a, &pair_.b}) {
    const Eigen::Matrix3d axes = turn_of(shape->pose);
    for (int axis = 0; axis < 3; ++axis) {
      found.add(axes.col(axis));
      found.add(-axes.col(axis));
    }
  }
  for (int i = 0; i < 27; ++i) found.add(Vec(i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1));
  each_near_pair(parts_, pair_, [&](const SubShape& a, const SubShape& b) {
    if (!do_overlap(parts_, a, b)) return true;
    if (a.triangle != nullptr) found.add(normal_of(*a.triangle, a.pose));
    if (b.triangle != nullptr) found.add(-normal_of(*b.triangle, b.pose));
    return !found.is_full();
  });
  return found;
}

void SolidDepth::improve(const Vec& direction) noexcept {
  const WayOut way = leave(direction, best_.length);
  if (way.length < best_.length) best_ = way;
}

// Turns the shortest way to the normal of its last contact: the nearest point of a plane is along
// its normal. Ways that end at several contacts are improved by turning them a little to all sides.
void SolidDepth::shorten() noexcept {
  constexpr int kTurns = 12;
  for (int turn = 0; turn < kTurns; ++turn) {
    const double before = best_.length;
    improve(best_.normal);
    if (best_.length == before) break;
  }
  double angle = 0.8;
  for (int turn = 0; turn < 4 * kTurns && angle > 1e-3; ++turn) {
    const double before = best_.length;
    const Vec from = best_.direction;
    for (const Vec& side : tangents_of(from)) {
      improve((from + angle * side).normalized());
      improve((from - angle * side).normalized());
    }
    if (best_.length == before) angle *= 0.5;
  }
}

// Returns an infinite length unless b is apart from a at less than `most` along the direction.
// Halves the interval between a length at which they overlap and one at which they are apart; then
// moves b beyond the parts that still overlap, which are few.
WayOut SolidDepth::leave(const Vec& direction, double most) const noexcept {
  constexpr int kHalvings = 10;
  constexpr int kSteps = 20;
  WayOut way;
  double apart = std::min(most * (1.0 - kShorter), reach(box_a_, box_b_, direction));
  if (!(apart > 0.0) || !std::isfinite(apart) || overlaps_at(apart * direction)) return way;
  double within = 0.0;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (within + apart);
    (overlaps_at(middle * direction) ? within : apart) = middle;
  }
  way = {direction, within, direction};
  double bump = kTolerance * size_;
  for (int step = 0; step < kSteps && way.length < apart; ++step, bump *= 1.5) {
    leave_parts(way);
    way.length += bump;
    if (!overlaps_at(way.length * direction)) return way;
  }
  way.length = apart;
  return way;
}

// Moves b beyond all parts that overlap, if any do.
void SolidDepth::leave_parts(WayOut& way) const noexcept {
  const double from = way.length;
  each_near_pair(parts_, {pair_.a, moved_b(pair_, from * way.direction)},
                 [&](const SubShape& a, const SubShape& b) {
                   const double most = reach(parts_.box(a), parts_.box(b), way.direction);
                   if (from + most <= way.length) return true;
                   const Passage passage = passage_of_parts(a, b, way.direction, most);
                   const bool overlaps = passage.first <= 0.0 && passage.last >= 0.0;
                   if (!overlaps || from + passage.last <= way.length) return true;
                   way.length = from + passage.last;
                   way.normal = passage.normal;
                   return true;
                 });
}

// Returns an empty passage for parts that do not overlap. Parts that are no triangles come back
// from far along the direction: b leaves a where they touch.
Passage SolidDepth::passage_of_parts(const SubShape& a, const SubShape& b, const Vec& direction,
                                     double reach) const noexcept {
  if (a.triangle != nullptr && b.triangle != nullptr && a.triangle->rounding == 0.0 &&
      b.triangle->rounding == 0.0) {
    return passage_of(corners_of(a), corners_of(b), direction);
  }
  const Passage none = {.first = kInfinity, .last = -kInfinity, .normal = Vec::Zero()};
  if (!do_overlap(parts_, a, b)) return none;
  PartTables tables(parts_.shapes());
  CastPair cast;
  cast.moving = tables.put(0, b);
  cast.from = b.pose;
  as_eigen(cast.from.position) += reach * direction;
  cast.direction = -direction;
  cast.max_t = reach;
  cast.stationary = tables.put(1, a);
  cast.pose = a.pose;
  CastTouch touch;
  if (!cast_shape(tables.tables(), cast, kTolerance * size_, touch)) return none;
  return {.first = 0.0, .last = reach - touch.t, .normal = as_eigen(touch.normal)};
}

// Climbs to a point around which balls inside both shapes are largest. `touched` is the point on a
// at the end of the shortest way.
double SolidDepth::lower_bound(const Vec& touched) const noexcept {
  const Vec out = best_.length * best_.direction;
  Vec at = touched - 0.5 * out;
  double bound = 0.0;
  const auto climb = [&](const Vec& point) {
    const double next = bound_at(point);
    if (!(next > bound)) return false;
    bound = next;
    at = point;
    return true;
  };
  for (const Vec& start : {touched, Vec(touched - out), at, Vec(0.5 * (box_a_.min + box_a_.max)),
                           Vec(0.5 * (box_b_.min + box_b_.max))}) {
    climb(start);
  }
  const double enough = best_.length * (1.0 - kTolerance);
  for (double step = 0.5 * best_.length; bound < enough && step > 0.02 * best_.length;) {
    bool any = false;
    for (int axis = 0; axis < 3; ++axis) {
      any = climb(at + step * Vec::Unit(axis)) || climb(at - step * Vec::Unit(axis)) || any;
    }
    if (!any) step *= 0.5;
  }
  return bound;
}

double SolidDepth::bound_at(const Vec& point) const noexcept {
  const double in_a = depth_in(pair_.a, point);
  const double in_b = depth_in(pair_.b, point);
  return std::max(in_a, in_b) > 0.0 ? in_a + in_b : 0.0;
}

double SolidDepth::depth_in(const PlacedShape& shape, const Vec& point) const noexcept {
  const SphereShape ball{0.0};
  SubShape center{ShapeId::of(ShapeKind::sphere, 0), mid::pose_of(point, {1.0, 0.0, 0.0, 0.0})};
  center.ball = &ball;
  ShapeDistance to;
  if (!ClosestParts(parts_).find(center, shape, kInfinity, to)) return -kInfinity;
  return -to.distance - to.error_bound;
}

void SolidDepth::write(ShapeDistance& answer) const noexcept {
  const Vec out = best_.length * best_.direction;
  // The parts that b leaves last are the nearest ones after it.
  static_cast<void>(ClosestParts(parts_).find_surfaces({pair_.a, moved_b(pair_, out)}, answer));
  const Vec touched = as_eigen(answer.point_a);
  answer.distance = -best_.length;
  answer.error_bound = std::max(best_.length - lower_bound(touched), 0.0) + mid::kSlack * size_;
  answer.normal = Vec3d(best_.direction);
  for (int axis = 0; axis < 3; ++axis) {
    answer.point_a[axis] = pair_.base[axis] + touched[axis];
    answer.point_b[axis] = pair_.base[axis] + (touched[axis] - out[axis]);
  }
}

}  // namespace

bool find_solid_depth(const SubShapeQuery& parts, const Pairing& pair,
                      ShapeDistance& answer) noexcept {
  return SolidDepth(parts, pair).find(answer);
}

}  // namespace winnow
