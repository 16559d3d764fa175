#pragma once

// Penetration depth of segments, cylinders and cones that are parallel to each other or to an edge
// of a box, as most shapes on a floor are. The direction of least depth is in a plane that contains
// the axis. In this plane the cores are two polygons, and the direction is a normal of one of these
// polygons. For two axes, the plane is that of both axes. For a box, it is the plane from the axis
// towards the nearest point of the box's rectangle as seen along the axis: of all directions with
// the same slope, the one in that plane has the least depth. Called by curved_answers.wide.h.

#include "pipeline/kernels/cores/curved_pair.wide.h"

namespace winnow::WINNOW_ISA_NAME::curved {

class ParallelDepth {
 public:
  /// For cores that overlap; returns false if they are not parallel, or of other kinds.
  bool find(const CurvedPair& pair) {
    const bool is_placed = pair.first.kind == ShapeKind::box    ? place_box_first(pair)
                           : pair.second.kind == ShapeKind::box ? place_box_second(pair)
                                                                : place_axes(pair);
    if (!is_placed) return false;
    upper_ = __builtin_inf();
    test_direction(1.0, 0.0);
    test_direction(0.0, 1.0);
    test_direction(0.0, -1.0);
    test_side_normal(first_, 1.0);
    test_side_normal(second_, -1.0);
    if (!(upper_ >= 0.0)) return false;
    lower_ = upper_ - 2.0 * askew_ * pair.size;
    return true;
  }

  /// Bounds of the depth, after `find` has returned true.
  [[nodiscard]] double upper() const { return upper_; }
  [[nodiscard]] double lower() const { return lower_; }

  /// As CurvedDepth::answer; the point is the middle of the range over which the polygons touch.
  void answer(double* direction, double* point) const {
    const double tangent[2] = {-normal_[1], normal_[0]};
    const double back[2] = {-normal_[0], -normal_[1]};
    const double apart = dot2(tangent, away_);
    const Reach mine = first_.touching(normal_, tangent);
    const Reach theirs = second_.touching(back, tangent);
    const double middle =
        0.5 * (largest_of(mine.low, theirs.low + apart) + least_of(mine.high, theirs.high + apart));
    const double height = first_.height(normal_);
    for (int k = 0; k < 3; ++k) {
      direction[k] = normal_[0] * across_[k] + normal_[1] * up_[k];
      point[k] = base_[k] + (normal_[0] * height + tangent[0] * middle) * across_[k] +
                 (normal_[1] * height + tangent[1] * middle) * up_[k];
    }
  }

 private:
  /// The largest sine of the angle between parallel axes; its effect on the depth is below the
  /// tolerance of an answer.
  static constexpr double kParallel = 1e-11;
  /// Corners at most this much below the highest one touch; lengths are about 1.
  static constexpr double kLevel = 1e-13;

  struct Reach {
    double low;
    double high;
  };

  /// The polygon of a core in the plane: the ranges of its lower and its upper end, and half of its
  /// height.
  struct CoreOutline {
    double lower[2];
    double upper[2];
    double half;

    /// The support along a direction.
    [[nodiscard]] double height(const double* n) const {
      const int side = n[0] > 0.0 ? 1 : 0;
      return largest_of(n[0] * upper[side] + n[1] * half, n[0] * lower[side] - n[1] * half);
    }
    /// The range along the tangent in which the support is attained.
    [[nodiscard]] Reach touching(const double* n, const double* tangent) const {
      const double most = height(n) - kLevel;
      Reach reach{__builtin_inf(), -__builtin_inf()};
      for (int corner = 0; corner < 4; ++corner) {
        const double x[2] = {corner < 2 ? lower[corner] : upper[corner - 2],
                             corner < 2 ? -half : half};
        if (!(dot2(n, x) >= most)) continue;
        reach.low = least_of(reach.low, dot2(tangent, x));
        reach.high = largest_of(reach.high, dot2(tangent, x));
      }
      return reach;
    }
  };

  /// Sets the plane of two axes.
  bool place_axes(const CurvedPair& pair) {
    const double axis[3] = {pair.turn[2], pair.turn[5], pair.turn[8]};
    if (!set_up(axis, 2) || !set_revolved(pair.first, 1.0, first_) ||
        !set_revolved(pair.second, axis[2], second_)) {
      return false;
    }
    const double* s = pair.shift;
    away_[0] = __builtin_sqrt(s[0] * s[0] + s[1] * s[1]);
    away_[1] = s[2];
    const bool is_beside = away_[0] > 0.0;
    across_[0] = is_beside ? s[0] / away_[0] : 1.0;
    across_[1] = is_beside ? s[1] / away_[0] : 0.0;
    across_[2] = 0.0;
    for (double& x : base_) x = 0.0;
    return true;
  }

  /// The first is a box, and the second's axis is parallel to one of its axes.
  bool place_box_first(const CurvedPair& pair) {
    const double axis[3] = {pair.turn[2], pair.turn[5], pair.turn[8]};
    const int along = longest(axis);
    if (!set_up(axis, along) || !set_revolved(pair.second, axis[along], second_)) return false;
    const int side[2] = {(along + 1) % 3, (along + 2) % 3};
    const double* half = pair.first.number;
    const Rectangle seen(half[side[0]], half[side[1]], pair.shift[side[0]], pair.shift[side[1]]);
    away_[0] = seen.distance;
    away_[1] = pair.shift[along];
    for (int k = 0; k < 3; ++k) across_[k] = base_[k] = 0.0;
    for (int i = 0; i < 2; ++i) {
      across_[side[i]] = seen.outward[i];
      base_[side[i]] = seen.foot[i];
    }
    first_ = {{-seen.chord, 0.0}, {-seen.chord, 0.0}, half[along]};
    return true;
  }

  /// The second is a box, and the first's axis is parallel to one of its axes.
  bool place_box_second(const CurvedPair& pair) {
    const double axis[3] = {pair.turn[6], pair.turn[7], pair.turn[8]};
    const int along = longest(axis);
    if (!set_up(axis, along) || !set_revolved(pair.first, 1.0, first_)) return false;
    up_[0] = up_[1] = 0.0;
    up_[2] = 1.0;
    const int side[2] = {(along + 1) % 3, (along + 2) % 3};
    const double* half = pair.second.number;
    double at[2];
    for (int i = 0; i < 2; ++i) {
      at[i] = 0.0;
      for (int k = 0; k < 3; ++k) at[i] -= pair.turn[3 * k + side[i]] * pair.shift[k];
    }
    const Rectangle seen(half[side[0]], half[side[1]], at[0], at[1]);
    away_[0] = seen.distance;
    away_[1] = pair.shift[2];
    for (int k = 0; k < 3; ++k) {
      base_[k] = 0.0;
      across_[k] = -(seen.outward[0] * pair.turn[3 * k + side[0]] +
                     seen.outward[1] * pair.turn[3 * k + side[1]]);
    }
    second_ = {{0.0, seen.chord}, {0.0, seen.chord}, half[along]};
    return true;
  }

  /// A rectangle around the origin, and the point of its outline that is nearest to another point.
  struct Rectangle {
    /// Distance of the other point, negative inside.
    double distance;
    double foot[2];
    double outward[2];
    /// Length of the rectangle from the foot in the direction opposite to `outward`.
    double chord;

    Rectangle(double half_x, double half_y, double x, double y) {
      const double half[2] = {half_x, half_y};
      const double at[2] = {x, y};
      double off[2];
      double over[2];
      for (int i = 0; i < 2; ++i) {
        over[i] = __builtin_fabs(at[i]) - half[i];
        foot[i] = over[i] > 0.0 ? with_sign_of(half[i], at[i]) : at[i];
        off[i] = at[i] - foot[i];
      }
      const double square = dot2(off, off);
      distance = __builtin_sqrt(square);
      for (int i = 0; i < 2; ++i) outward[i] = off[i] / distance;
      if (!(distance > kLevel)) turn_to_side(half, at, over);
      chord = __builtin_inf();
      for (int i = 0; i < 2; ++i) {
        const double size = __builtin_fabs(outward[i]);
        const double room = half[i] + with_sign_of(foot[i], foot[i] * outward[i]);
        if (size > 0.0) chord = least_of(chord, room / size);
      }
    }

   private:
    static double with_sign_of(double size, double of) {
      return of < 0.0 ? -__builtin_fabs(size) : __builtin_fabs(size);
    }
    /// For a point inside or on the outline: takes the nearest side.
    void turn_to_side(const double* half, const double* at, const double* over) {
      const int i = over[1] > over[0] ? 1 : 0;
      distance = over[i];
      outward[i] = at[i] < 0.0 ? -1.0 : 1.0;
      outward[1 - i] = 0.0;
      foot[i] = with_sign_of(half[i], at[i]);
      foot[1 - i] = at[1 - i];
    }
  };

  static int longest(const double* v) {
    const int i = __builtin_fabs(v[1]) > __builtin_fabs(v[0]) ? 1 : 0;
    return __builtin_fabs(v[2]) > __builtin_fabs(v[i]) ? 2 : i;
  }
  /// Sets `up` to an axis of the first; returns false if the other axis is not parallel to it.
  bool set_up(const double* axis, int along) {
    const double aside[2] = {axis[(along + 1) % 3], axis[(along + 2) % 3]};
    askew_ = __builtin_sqrt(dot2(aside, aside));
    for (int k = 0; k < 3; ++k) up_[k] = k == along ? 1.0 : 0.0;
    return askew_ <= kParallel;
  }

  /// Sets the outline of a core of revolution whose axis points up or down; returns false for other
  /// kinds.
  static bool set_revolved(const CoreDesc& form, double upright, CoreOutline& outline) {
    const double* n = form.number;
    const bool is_cone = form.kind == ShapeKind::cone;
    if (!is_cone && form.kind != ShapeKind::cylinder && form.kind != ShapeKind::capsule) {
      return false;
    }
    const double lower = is_cone && upright < 0.0 ? 0.0 : n[0];
    const double upper = is_cone && upright > 0.0 ? 0.0 : n[0];
    outline = {{-lower, lower}, {-upper, upper}, n[2]};
    return true;
  }

  /// Tests a direction in the plane, of length 1.
  void test_direction(double aside, double up) {
    const double n[2] = {aside, up};
    const double back[2] = {-aside, -up};
    const double depth = first_.height(n) + second_.height(back) - dot2(n, away_);
    if (!(depth < upper_)) return;
    upper_ = depth;
    normal_[0] = aside;
    normal_[1] = up;
  }
  /// Tests the normal of the sloping side of an outline, outward (sign 1) or inward (sign -1).
  void test_side_normal(const CoreOutline& outline, double sign) {
    const double rise = 2.0 * outline.half;
    const double slope = outline.lower[1] - outline.upper[1];
    const double length = __builtin_sqrt(rise * rise + slope * slope);
    if (length > 0.0) test_direction(rise / length, sign * slope / length);
  }

  CoreOutline first_;
  CoreOutline second_;
  /// The plane in the first's frame: the directions from the first to the second and up, and the
  /// point from which the first's outline is measured.
  double across_[3];
  double up_[3];
  double base_[3];
  /// The origin of the second's outline in the plane, and the sine of the angle between the axes.
  double away_[2];
  double askew_;
  double normal_[2];
  double upper_;
  double lower_;
};

}  // namespace winnow::WINNOW_ISA_NAME::curved
