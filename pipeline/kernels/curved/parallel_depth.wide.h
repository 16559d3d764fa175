#pragma once

// Penetration depth of segments, cylinders and cones that stand parallel, as most do that stand on
// a floor: their difference is a body of revolution. The direction of least depth is in the plane
// of both axes, where the cores are two polygons: it is a normal of one of these.

#include "pipeline/kernels/hull/curved_pair.wide.h"

namespace winnow::WINNOW_ISA_NAME::curved {

class ParallelDepth {
 public:
  /// Of cores that overlap; false if their axes are not parallel, or they are others.
  bool find(const CurvedPair& pair) {
    const double askew = __builtin_sqrt(pair.turn[2] * pair.turn[2] + pair.turn[5] * pair.turn[5]);
    if (!(askew <= kParallel)) return false;
    if (!set_outline(pair.first, 1.0, first_)) return false;
    if (!set_outline(pair.second, pair.turn[8] > 0.0 ? 1.0 : -1.0, second_)) return false;
    set_plane(pair);
    upper_ = __builtin_inf();
    look(1.0, 0.0);
    look(0.0, 1.0);
    look(0.0, -1.0);
    look_across(first_, 1.0);
    look_across(second_, -1.0);
    if (!(upper_ >= 0.0)) return false;
    lower_ = upper_ - 2.0 * askew * second_.size();
    return true;
  }

  /// Of the last call that was true.
  [[nodiscard]] double upper() const { return upper_; }
  [[nodiscard]] double lower() const { return lower_; }

  /// As that of CurvedDepth: the point is the middle of what touches in the plane of the axes.
  void answer(double* direction, double* point) const {
    const double tangent[2] = {-normal_[1], normal_[0]};
    const double apart = tangent[0] * away_[0] + tangent[1] * away_[1];
    const Reach mine = first_.touching(normal_, tangent);
    const double back[2] = {-normal_[0], -normal_[1]};
    const Reach theirs = second_.touching(back, tangent);
    const double low = largest_of(mine.low, theirs.low + apart);
    const double high = -largest_of(-mine.high, -(theirs.high + apart));
    const double middle = 0.5 * (low + high);
    const double height = first_.height(normal_);
    const double x = normal_[0] * height + tangent[0] * middle;
    for (int k = 0; k < 2; ++k) {
      direction[k] = normal_[0] * across_[k];
      point[k] = x * across_[k];
    }
    direction[2] = normal_[1];
    point[2] = normal_[1] * height + tangent[1] * middle;
  }

 private:
  /// The largest sine of the angle between the axes: what it makes of a depth is below what an
  /// answer may be wrong by.
  static constexpr double kParallel = 1e-11;
  /// Corners that are no more below the highest one touch, lengths being about 1.
  static constexpr double kLevel = 1e-13;

  struct Reach {
    double low;
    double high;
  };

  /// The polygon of a core in a plane of its axis, which is its mirror image: half of how wide it
  /// is at its lower and its upper end, and half of its height.
  struct Outline {
    double lower;
    double upper;
    double half;

    /// How far it reaches along a direction.
    [[nodiscard]] double height(const double* n) const {
      const double wide = __builtin_fabs(n[0]);
      return largest_of(wide * upper + n[1] * half, wide * lower - n[1] * half);
    }
    [[nodiscard]] double size() const { return largest_of(lower, upper) + half; }
    /// Where, along the tangent, it reaches that far.
    [[nodiscard]] Reach touching(const double* n, const double* tangent) const {
      const double most = height(n) - kLevel;
      Reach reach{__builtin_inf(), -__builtin_inf()};
      for (const double end : {-1.0, 1.0}) {
        for (const double side : {-1.0, 1.0}) {
          const double x[2] = {side * (end < 0.0 ? lower : upper), end * half};
          if (!(n[0] * x[0] + n[1] * x[1] >= most)) continue;
          const double along = tangent[0] * x[0] + tangent[1] * x[1];
          reach.low = -largest_of(-reach.low, -along);
          reach.high = largest_of(reach.high, along);
        }
      }
      return reach;
    }
  };

  /// False for other cores.
  static bool set_outline(const Form& form, double upright, Outline& outline) {
    const double* n = form.number;
    outline = {0.0, 0.0, n[2]};
    if (form.kind == ShapeKind::capsule) return true;
    if (form.kind == ShapeKind::cylinder) outline.upper = outline.lower = n[0];
    if (form.kind == ShapeKind::cone) (upright > 0.0 ? outline.lower : outline.upper) = n[0];
    return form.kind == ShapeKind::cylinder || form.kind == ShapeKind::cone;
  }

  /// The plane of both axes, and where the second is in it.
  void set_plane(const CurvedPair& pair) {
    const double* s = pair.shift;
    away_[0] = __builtin_sqrt(s[0] * s[0] + s[1] * s[1]);
    away_[1] = s[2];
    const bool is_beside = away_[0] > 0.0;
    across_[0] = is_beside ? s[0] / away_[0] : 1.0;
    across_[1] = is_beside ? s[1] / away_[0] : 0.0;
  }

  /// A direction in that plane, of length 1.
  void look(double aside, double up) {
    const double n[2] = {aside, up};
    const double back[2] = {-aside, -up};
    const double depth =
        first_.height(n) + second_.height(back) - (aside * away_[0] + up * away_[1]);
    if (!(depth < upper_)) return;
    upper_ = depth;
    normal_[0] = aside;
    normal_[1] = up;
  }
  /// At right angles to the sloping sides of an outline, away from it or towards it.
  void look_across(const Outline& outline, double sign) {
    const double rise = 2.0 * outline.half;
    const double slope = outline.lower - outline.upper;
    const double length = __builtin_sqrt(rise * rise + slope * slope);
    if (length > 0.0) look(rise / length, sign * slope / length);
  }

  Outline first_;
  Outline second_;
  /// A unit vector at right angles to the axes, from the first to the second.
  double across_[2];
  /// The middle of the second along it, and along the axes.
  double away_[2];
  double normal_[2];
  double upper_;
  double lower_;
};

}  // namespace winnow::WINNOW_ISA_NAME::curved
