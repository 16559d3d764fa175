// Exact overlap test for axis-aligned shapes: AlignedPair for boxes, cylinders and their roundings,
// `over_plane` for half-spaces, FlatTriangle and `point_on_triangle` for triangles.
// exact_overlap.cpp calls it before the general methods.

#include "pipeline/exact/aligned_overlap.h"

#include "pipeline/exact/exact_vector.h"

#include <algorithm>
#include <cmath>

namespace winnow {
namespace {

constexpr int kNoAxis = -1;

/// Maps each world axis to the axis of a frame that is parallel to it; the sign is -1 if the two
/// point in opposite directions.
struct QuarterTurns {
  int axis[3];
  int sign[3];
};

/// Returns false unless the orientation consists of quarter turns. Those are the quaternions, of
/// any length, with one, two or four nonzero components of equal magnitude.
[[nodiscard]] bool quarter_turns(const Pose& pose, QuarterTurns& turns) noexcept {
  const double* q = pose.orientation.data();
  const double most =
      std::max({std::fabs(q[0]), std::fabs(q[1]), std::fabs(q[2]), std::fabs(q[3])});
  int s[4];
  int count = 0;
  for (int i = 0; i < 4; ++i) {
    if (q[i] != 0.0 && std::fabs(q[i]) != most) return false;
    s[i] = q[i] == 0.0 ? 0 : (q[i] > 0.0 ? 1 : -1);
    count += s[i] != 0 ? 1 : 0;
  }
  if (count == 3) return false;
  const int square = 2 * s[0] * s[0] - count;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      int turn = 2 * s[1 + i] * s[1 + k];
      if (i == k) {
        turn += square;
      } else {
        const int about = 2 * s[0] * s[1 + 3 - i - k];
        turn += k == (i + 1) % 3 ? -about : about;
      }
      if (turn == 0) continue;
      turns.axis[i] = k;
      turns.sign[i] = turn > 0 ? 1 : -1;
    }
  }
  return true;
}

/// A rounded box, or a rounded cylinder about a world axis, aligned with the world axes.
struct AlignedShape {
  /// For a cylinder, the radius in the two directions orthogonal to its axis.
  double half[3];
  int round = kNoAxis;
  double rounding;
};

/// Returns false for other cores and for frames that are not aligned.
[[nodiscard]] bool align(const ShapeCore& core, const Pose& pose, AlignedShape& shape) noexcept {
  if (core.kind == ShapeKind::sphere) {
    shape = {{0.0, 0.0, 0.0}, kNoAxis, core.rounding};
    return true;
  }
  const bool is_round = core.kind == ShapeKind::cylinder;
  if (!is_round && core.kind != ShapeKind::capsule && core.kind != ShapeKind::box) return false;
  QuarterTurns turns;
  if (!quarter_turns(pose, turns)) return false;
  for (int k = 0; k < 3; ++k) shape.half[k] = core.half[turns.axis[k]];
  if (is_round) shape.round = turns.axis[0] == 2 ? 0 : turns.axis[1] == 2 ? 1 : 2;
  shape.rounding = core.rounding;
  return true;
}

[[nodiscard]] Dyadic magnitude(const Dyadic& x) noexcept {
  return x.sign() < 0 ? -x : x;
}

/// max(x, 0).
[[nodiscard]] Dyadic above_zero(const Dyadic& x) noexcept {
  return x.sign() > 0 ? x : Dyadic();
}

/// Two aligned shapes and the distance of their positions along each world axis.
class AlignedPair {
 public:
  AlignedPair(const AlignedShape& a, const AlignedShape& b, const Pose& pose_a,
              const Pose& pose_b) noexcept
      : a_(a), b_(b), rounding_(Dyadic(a.rounding) + b.rounding) {
    for (int k = 0; k < 3; ++k) {
      away_[k] = magnitude(Dyadic(pose_b.position[k]) - pose_a.position[k]);
    }
  }

  [[nodiscard]] ExactVerdict verdict() const noexcept {
    if (a_.round == kNoAxis && b_.round == kNoAxis) return of_boxes();
    if (!fourth_powers_fit()) return ExactVerdict::undecided;
    if (a_.round == kNoAxis || b_.round == kNoAxis || a_.round == b_.round) return about_an_axis();
    return rounding_.sign() == 0 ? of_crossed_cylinders() : ExactVerdict::undecided;
  }

 private:
  [[nodiscard]] bool fourth_powers_fit() const noexcept {
    BitSpan lengths;
    for (int k = 0; k < 3; ++k) {
      lengths.include(away_[k]);
      lengths.include(a_.half[k]);
      lengths.include(b_.half[k]);
    }
    lengths.include(rounding_);
    constexpr int kSums = 6;
    return fits_dyadic(4, lengths.bits() + kSums);
  }

  /// Gap between the cores along world axis `k`; negative if they overlap there.
  [[nodiscard]] Dyadic gap(int k) const noexcept {
    return away_[k] - (Dyadic(a_.half[k]) + b_.half[k]);
  }

  [[nodiscard]] ExactVerdict of_boxes() const noexcept {
    int most = -1;
    Dyadic square;
    for (int k = 0; k < 3; ++k) {
      const Dyadic apart = gap(k);
      most = std::max(most, apart.sign());
      if (apart.sign() > 0) square = square + apart * apart;
    }
    if (rounding_.sign() == 0) return verdict_of(most);
    return verdict_of(compare(square, rounding_ * rounding_));
  }

  /// One or two cylinders about the same axis. Orthogonal to the axis this is a disc against a
  /// point or a box (as Minkowski difference); along the axis, two segments.
  [[nodiscard]] ExactVerdict about_an_axis() const noexcept {
    const int axis = a_.round == kNoAxis ? b_.round : a_.round;
    Dyadic square;
    Dyadic radius;
    for (int k = 0; k < 3; ++k) {
      if (k == axis) continue;
      const Dyadic box =
          Dyadic(a_.round == kNoAxis ? a_.half[k] : 0.0) + (b_.round == kNoAxis ? b_.half[k] : 0.0);
      radius =
          Dyadic(a_.round == kNoAxis ? 0.0 : a_.half[k]) + (b_.round == kNoAxis ? 0.0 : b_.half[k]);
      const Dyadic beside = above_zero(away_[k] - box);
      square = square + beside * beside;
    }
    const Dyadic along = gap(axis);
    const int across = compare(square, radius * radius);
    if (rounding_.sign() == 0) return verdict_of(std::max(along.sign(), across));
    if (across <= 0) return verdict_of(compare(along, rounding_));
    if (along.sign() <= 0) {
      const Dyadic reach = radius + rounding_;
      return verdict_of(compare(square, reach * reach));
    }
    // The sign of (sqrt(square) - radius)^2 + along^2 - rounding^2.
    const Dyadic rest = square + radius * radius + along * along - rounding_ * rounding_;
    const Dyadic twice = radius + radius;
    return verdict_of(rest.sign() < 0 ? -1 : compare(rest * rest, twice * twice * square));
  }

  /// At a height along the axis orthogonal to both cylinders, the section of each is as wide as a
  /// chord of its disc. They touch if at some height both chords reach the other's segment.
  [[nodiscard]] ExactVerdict of_crossed_cylinders() const noexcept {
    const auto reach = [](const AlignedShape& disc, const AlignedShape& other, const Dyadic& away) {
      const Dyadic radius = disc.half[other.round];
      const Dyadic to = above_zero(away - other.half[other.round]);
      return radius * radius - to * to;
    };
    const Dyadic reach_a = reach(a_, b_, away_[b_.round]);
    const Dyadic reach_b = reach(b_, a_, away_[a_.round]);
    const int least = std::min(reach_a.sign(), reach_b.sign());
    if (least < 0) return ExactVerdict::separated;
    const Dyadic& height = away_[3 - a_.round - b_.round];
    // The sign of height - sqrt(reach_a) - sqrt(reach_b).
    const Dyadic rest = height * height - reach_a - reach_b;
    const int sign = rest.sign() < 0 ? -1 : compare(rest * rest, Dyadic(4.0) * reach_a * reach_b);
    return verdict_of(std::max(sign, -least));
  }

  const AlignedShape& a_;
  const AlignedShape& b_;
  Dyadic rounding_;
  Dyadic away_[3];
};

/// A half-space and an aligned shape.
[[nodiscard]] ExactVerdict over_plane(const HalfSpaceShape& half_space, const Pose& pose,
                                      const AlignedShape& shape, const Pose& shape_pose) noexcept {
  QuarterTurns turns;
  // A normal that is only nearly parallel to an axis can also have length 1, so count the zeros.
  const bool is_across = std::count(half_space.normal.begin(), half_space.normal.end(), 0.0) == 2;
  if (!is_across || !quarter_turns(pose, turns)) return ExactVerdict::undecided;
  int k = 0;
  while (half_space.normal[turns.axis[k]] == 0.0) ++k;
  const double normal = half_space.normal[turns.axis[k]];
  if (std::fabs(normal) != 1.0) return ExactVerdict::undecided;
  const Dyadic apart = Dyadic(shape_pose.position[k]) - pose.position[k];
  const Dyadic height = normal * turns.sign[k] > 0.0 ? apart : -apart;
  return verdict_of((height - half_space.offset - shape.half[k] - shape.rounding).sign());
}

/// A point in the plane orthogonal to a world axis.
struct PlanePoint {
  Dyadic x[2];
};

[[nodiscard]] PlanePoint operator-(const PlanePoint& p, const PlanePoint& q) noexcept {
  return {{p.x[0] - q.x[0], p.x[1] - q.x[1]}};
}

[[nodiscard]] Dyadic dot(const PlanePoint& p, const PlanePoint& q) noexcept {
  return p.x[0] * q.x[0] + p.x[1] * q.x[1];
}

[[nodiscard]] Dyadic cross(const PlanePoint& p, const PlanePoint& q) noexcept {
  return p.x[0] * q.x[1] - p.x[1] * q.x[0];
}

/// A triangle orthogonal to a world axis, as on level floors, and the section of an aligned shape's
/// core that is extreme along that axis: a rectangle (possibly a segment or a point) or a disc,
/// centered at the origin.
class FlatTriangle {
 public:
  /// Returns false if the triangle is not orthogonal to an axis or the exponents span too wide a
  /// range.
  [[nodiscard]] bool place(const TriangleShape& triangle, const Pose& pose,
                           const AlignedShape& shape, const Pose& shape_pose) noexcept {
    QuarterTurns turns;
    if (!quarter_turns(pose, turns)) return false;
    const auto level = [&](int k) {
      const int own = turns.axis[k];
      return triangle.vertex[0][own] == triangle.vertex[1][own] &&
             triangle.vertex[0][own] == triangle.vertex[2][own];
    };
    axis_ = level(0) ? 0 : level(1) ? 1 : 2;
    if (!level(axis_)) return false;
    const auto away = [&](int i, int k) {
      const Dyadic own = triangle.vertex[i][turns.axis[k]];
      return Dyadic(pose.position[k]) - shape_pose.position[k] + (turns.sign[k] > 0 ? own : -own);
    };
    const Dyadic rounding = Dyadic(shape.rounding) + triangle.rounding;
    height_ = magnitude(away(0, axis_)) - shape.half[axis_] - rounding;
    BitSpan lengths;
    for (int e = 0; e < 2; ++e) {
      const int k = (axis_ + 1 + e) % 3;
      half_[e] = shape.round == kNoAxis || shape.round == k || shape.round == axis_
                     ? Dyadic(shape.half[k])
                     : Dyadic();
      lengths.include(half_[e]);
      for (int i = 0; i < 3; ++i) {
        vertex_[i].x[e] = away(i, k);
        lengths.include(vertex_[i].x[e]);
      }
    }
    is_disc_ = shape.round == axis_;
    constexpr int kSums = 6;
    return fits_dyadic(4, lengths.bits() + kSums);
  }

  /// Undecided if the shape is on both sides of the plane, or if the triangle has no area and the
  /// shape touches its plane.
  [[nodiscard]] ExactVerdict verdict() const noexcept {
    if (height_.sign() > 0) return ExactVerdict::separated;
    const int turn = cross(vertex_[1] - vertex_[0], vertex_[2] - vertex_[0]).sign();
    if (height_.sign() < 0 || turn == 0) return ExactVerdict::undecided;
    const bool overlap = is_disc_ ? overlaps_disc(turn) : overlaps_rectangle(turn);
    return overlap ? ExactVerdict::touching : ExactVerdict::separated;
  }

 private:
  [[nodiscard]] bool overlaps_rectangle(int turn) const noexcept {
    for (int e = 0; e < 2; ++e) {
      bool below = true;
      bool above = true;
      for (const PlanePoint& v : vertex_) {
        below = below && compare(v.x[e], -half_[e]) < 0;
        above = above && compare(v.x[e], half_[e]) > 0;
      }
      if (below || above) return false;
    }
    for (int i = 0; i < 3; ++i) {
      const PlanePoint side = vertex_[(i + 1) % 3] - vertex_[i];
      // Distance of the origin outside the side, and how far the rectangle extends towards it (both
      // times the side's length).
      const Dyadic inside = cross(vertex_[i], side);
      const Dyadic out = turn > 0 ? -inside : inside;
      const Dyadic reach = half_[0] * magnitude(side.x[1]) + half_[1] * magnitude(side.x[0]);
      if (compare(out, reach) > 0) return false;
    }
    return true;
  }

  [[nodiscard]] bool overlaps_disc(int turn) const noexcept {
    const Dyadic square = half_[0] * half_[0];
    bool inside = true;
    for (int i = 0; i < 3; ++i) {
      const PlanePoint& from = vertex_[i];
      const PlanePoint side = vertex_[(i + 1) % 3] - from;
      const Dyadic area = cross(from, side);
      inside = inside && area.sign() * turn >= 0;
      if (compare(dot(from, from), square) <= 0) return true;
      const Dyadic length = dot(side, side);
      const Dyadic foot = -dot(from, side);
      const bool between = foot.sign() > 0 && compare(foot, length) < 0;
      if (between && compare(area * area, square * length) <= 0) return true;
    }
    return inside;
  }

  int axis_ = 0;
  bool is_disc_ = false;
  /// Height of the shape over the plane.
  Dyadic height_;
  Dyadic half_[2];
  PlanePoint vertex_[3];
};

/// A point and a triangle in any plane. Closest-point queries often give points on corners of
/// terrains, each shared by several triangles. Undecided for triangles without area.
[[nodiscard]] ExactVerdict point_on_triangle(const TriangleShape& triangle, const Pose& pose,
                                             const Pose& point_pose) noexcept {
  QuarterTurns turns;
  if (!quarter_turns(pose, turns)) return ExactVerdict::undecided;
  ExactVector vertex[3];
  BitSpan lengths;
  for (int k = 0; k < 3; ++k) {
    const Dyadic between = Dyadic(pose.position[k]) - point_pose.position[k];
    for (int i = 0; i < 3; ++i) {
      vertex[i].x[k] = between + turns.sign[k] * triangle.vertex[i][turns.axis[k]];
      lengths.include(vertex[i].x[k]);
    }
  }
  if (std::any_of(vertex, vertex + 3, is_zero)) return ExactVerdict::touching;
  constexpr int kSums = 6;
  if (!fits_dyadic(4, lengths.bits() + kSums)) return ExactVerdict::undecided;
  const ExactVector normal = cross(vertex[1] - vertex[0], vertex[2] - vertex[0]);
  if (is_zero(normal)) return ExactVerdict::undecided;
  if (dot(normal, vertex[0]).sign() != 0) return ExactVerdict::separated;
  for (int i = 0; i < 3; ++i) {
    const ExactVector area = cross(vertex[i], vertex[(i + 1) % 3]);
    if (dot(normal, area).sign() < 0) return ExactVerdict::separated;
  }
  return ExactVerdict::touching;
}

[[nodiscard]] bool is_point(const AlignedShape& shape) noexcept {
  return shape.half[0] == 0.0 && shape.half[1] == 0.0 && shape.half[2] == 0.0 &&
         shape.rounding == 0.0;
}

[[nodiscard]] ExactVerdict on_triangle(const TriangleShape& triangle, const Pose& pose,
                                       const AlignedShape& shape, const Pose& shape_pose) noexcept {
  if (is_point(shape) && triangle.rounding == 0.0) {
    return point_on_triangle(triangle, pose, shape_pose);
  }
  FlatTriangle flat;
  return flat.place(triangle, pose, shape, shape_pose) ? flat.verdict() : ExactVerdict::undecided;
}

/// True for half-spaces and triangles: aligned_overlap makes them the first shape.
[[nodiscard]] bool is_flat(const ShapeCore& core) noexcept {
  return core.kind == ShapeKind::half_space || core.kind == ShapeKind::triangle;
}

}  // namespace

ExactVerdict aligned_overlap(const ShapeCore& a, const Pose& pose_a, const ShapeCore& b,
                             const Pose& pose_b) noexcept {
  if (is_flat(b) && !is_flat(a)) return aligned_overlap(b, pose_b, a, pose_a);
  AlignedShape second;
  if (!align(b, pose_b, second)) return ExactVerdict::undecided;
  if (a.kind == ShapeKind::half_space) return over_plane(*a.half_space, pose_a, second, pose_b);
  if (a.kind == ShapeKind::triangle) return on_triangle(*a.triangle, pose_a, second, pose_b);
  AlignedShape first;
  if (!align(a, pose_a, first)) return ExactVerdict::undecided;
  return AlignedPair(first, second, pose_a, pose_b).verdict();
}

}  // namespace winnow
