#pragma once

// The shape of the Minkowski difference of two cores near its least depth, if it is simple, and the
// support points of each core from which that shape is derived. Used by curved_minimum.wide.h.

#include "pipeline/kernels/cores/curved_pair.wide.h"

namespace winnow::WINNOW_ISA_NAME::curved {

/// A point plus up to two discs, two ellipsoids and two segments, in the first's frame.
struct LocalMinkowskiSum {
  struct Disc {
    double radius;
    double axis[3];
  };
  /// An edge, or a line of a curved side.
  struct Segment {
    /// All points of the segment are equally far along a normal whose angle with the axis has this
    /// cosine. For an edge or a cylinder's side, the axis is its direction and the cosine is 0.
    double axis[3];
    double cosine;
    double sine;
    double length;
    /// The radius of a cone's disc, else 0.
    double radius;
    /// Unit direction of the segment; on a cone's side it turns with the normal.
    double along[3];
  };

  struct Ellipsoid {
    double radius[3];
    /// The unit axes of the radii.
    double axis[3][3];
    /// Length by which the ellipsoid is eroded.
    double off;
  };

  double point[3];
  /// The part of `point` that is from the first core. The first_ counts below are those of the
  /// first core, whose discs, ellipsoids and segments are stored before those of the second.
  double mine[3];
  std::uint32_t discs;
  std::uint32_t segments;
  std::uint32_t ellipsoids;
  std::uint32_t first_discs;
  std::uint32_t first_ellipsoids;
  std::uint32_t first_segments;
  Disc disc[2];
  Segment segment[2];
  Ellipsoid ellipsoid[2];
};

/// An ellipsoid's height along a unit direction; the height of its core is `length` less `off`.
struct EllipsoidHeight {
  /// The components of the direction along the axes, times the radii.
  double stretched[3];
  double length;

  EllipsoidHeight(const LocalMinkowskiSum::Ellipsoid& ellipsoid, const double* n) {
    for (int k = 0; k < 3; ++k) stretched[k] = ellipsoid.radius[k] * dot3(ellipsoid.axis[k], n);
    length = __builtin_sqrt(dot3(stretched, stretched));
  }

  /// The part of the change of `stretched` perpendicular to it, if the direction moves along e.
  void turn(const LocalMinkowskiSum::Ellipsoid& ellipsoid, const double* e, double* across) const {
    for (int k = 0; k < 3; ++k) across[k] = ellipsoid.radius[k] * dot3(ellipsoid.axis[k], e);
    const double along = dot3(across, stretched) / (length * length);
    for (int k = 0; k < 3; ++k) across[k] -= along * stretched[k];
  }
};

static inline bool are_same(const double* a, const double* b) {
  return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/// Three support points of one core, in its frame, for directions near each other.
struct NearPoints {
  const CoreDesc* form;
  double at[3][3];

  [[nodiscard]] bool is_round() const {
    return form->kind == ShapeKind::cylinder || form->kind == ShapeKind::cone;
  }
  [[nodiscard]] bool is_smooth() const {
    return form->kind == ShapeKind::ellipsoid || is_tapered();
  }
  [[nodiscard]] bool is_tapered() const { return form->kind == ShapeKind::tapered_capsule; }
  /// Cylinder or cone: the number of points at the upper end.
  [[nodiscard]] int high() const {
    int count = 0;
    for (const double(&x)[3] : at) count += x[2] > 0.0 ? 1 : 0;
    return count;
  }
  /// Tapered capsule: the number of points at the tip. All other points are farther from the tip
  /// than the circle where the larger ball begins.
  [[nodiscard]] int tips() const {
    const double length = form->number[2] - form->number[1];
    if (length == 0.0) return 3;
    const double side = length * length - form->number[0] * form->number[0];
    int count = 0;
    for (const double(&x)[3] : at) {
      const double z = x[2] - form->number[2];
      count += x[0] * x[0] + x[1] * x[1] + z * z <= 0.25 * side ? 1 : 0;
    }
    return count;
  }
  /// Makes points of polytopes that are equal up to rounding exactly equal.
  void unite() {
    if (is_round() || is_smooth()) return;
    for (int i = 1; i < 3; ++i) {
      for (int j = 0; j < i; ++j) {
        double most = 0.0;
        for (int k = 0; k < 3; ++k) {
          most = largest_of(most, __builtin_fabs(at[i][k] - at[j][k]));
        }
        if (most > 4.0 * kRoundingError) continue;
        for (int k = 0; k < 3; ++k) at[i][k] = at[j][k];
      }
    }
  }
};

/// Moves points of one core to the first's frame. Points of the second are negated, so that the sum
/// of a point of each core is a point of the difference.
class SidePlace {
 public:
  SidePlace(const CurvedPair& pair, bool second) : pair_(pair), second_(second) {}

  void direction(const double* x, double* r) const {
    if (!second_) {
      for (int k = 0; k < 3; ++k) r[k] = x[k];
      return;
    }
    turn3(pair_.turn, x, r);
    for (int k = 0; k < 3; ++k) r[k] = -r[k];
  }
  void point(const double* x, double* r) const {
    direction(x, r);
    for (int k = 0; k < 3 && second_; ++k) r[k] -= pair_.shift[k];
  }

 private:
  const CurvedPair& pair_;
  bool second_;
};

}  // namespace winnow::WINNOW_ISA_NAME::curved
