#pragma once

// Computes a local minimum of the depth of two cores to double precision, and a range of directions
// around it in which no direction is less deep. The expanding polytope of curved_depth.wide.h thus
// has to find the least depth only roughly; curved_search.wide.h uses the same for closest points.
//
// Near its least depth, the Minkowski difference of two cores is often a simple sum: a point plus
// discs (of rims), ellipsoids and segments (edges, or lines of curved sides). The difference
// contains this sum, so the sum's support function h bounds the support function of the difference
// from below. Let n = n0 + t, where t is perpendicular to n0 and |t| <= T.
//
// - A disc of radius r whose axis makes the sine s with n0 rises above its tangent by at least
//   r (e . t)^2 / (2 (s + T)), where e is perpendicular to both.
// - A segment along g that touches at least p away from its ends rises by p |g . t|, which is at
//   least p (g . t)^2 / T.
// - A flat part that touches at least p inside its border rises by p |t|.
// - The height of an ellipsoid along n is the length of M n, with M its axes times its radii; a
//   disc is an ellipsoid whose third radius is 0. It rises by at least
//   |P M t|^2 / (2 (|M n0| + m T)), with m the largest radius and P the projection perpendicular to
//   M n0. Eroding an ellipsoid by a length costs at most half of that length times |t|^2.
//
// If these rises add up to at least h(n0) |t|^2 / 2, then h(n) is at least h(n0) |n|.
//
// The line of a cone's side turns with the normal. If it touches at the fraction q of its length
// from the tip, then the bounds above hold with q / 2 times the cone's disc as a disc, and half of
// the distance to the nearer end as p of a segment, because the cone is at least as high as any
// weighted mean of its tip and its rim. The side of a tapered capsule is the side of the cone
// between its tip and the circle where the larger ball begins; the ball is an ellipsoid.

#include "pipeline/kernels/curved/local_minkowski_sum.wide.h"

namespace winnow::WINNOW_ISA_NAME::curved {

/// Computes two unit vectors perpendicular to n and to each other (Duff et al., "Building an
/// orthonormal basis, revisited", 2017).
static inline void span_across(const double* n, double (*e)[3]) {
  const double sign = n[2] < 0.0 ? -1.0 : 1.0;
  const double a = -1.0 / (sign + n[2]);
  const double b = n[0] * n[1] * a;
  const double first[3] = {1.0 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]};
  const double second[3] = {b, sign + n[1] * n[1] * a, -n[1]};
  for (int k = 0; k < 3; ++k) {
    e[0][k] = first[k];
    e[1][k] = second[k];
  }
}

class LocalMinimum {
 public:
  /// Finds the minimum near the unit direction `near`, from three points of the difference around
  /// it and the points of the first in these. If the cores are `apart`, heights are negative and
  /// there is only one minimum. Returns false if no minimum is found.
  bool find(const CurvedPair& pair, const double* const* corner, const double* const* mine,
            const double* near, bool apart = false) {
    pair_ = &pair;
    sign_ = apart ? -1.0 : 1.0;
    for (int k = 0; k < 3; ++k) normal_[k] = near[k];
    take_points(corner, mine);
    is_flat_ = find_flat_part(0) || find_flat_part(1);
    if (is_flat_) return true;
    sum_.discs = 0;
    sum_.segments = 0;
    sum_.ellipsoids = 0;
    if (!add_side(0)) return false;
    sum_.first_discs = sum_.discs;
    sum_.first_ellipsoids = sum_.ellipsoids;
    sum_.first_segments = sum_.segments;
    return add_side(1) && approach() && touch_segments();
  }

  /// True if no direction is less deep up to the angle with this tangent from the minimum.
  [[nodiscard]] bool is_least_within(double tangent) const {
    if (is_flat_) return 2.0 * inside_[0] > (1.0 + kMargin) * height_ * tangent;
    double e[2][3];
    span_across(normal_, e);
    double q[3] = {-height_, 0.0, -height_};
    for (std::uint32_t i = 0; i < sum_.discs; ++i) {
      double across[3];
      const double sine = sine_of(sum_.disc[i].axis, across);
      add_square(e, across, sum_.disc[i].radius / (sine + tangent), q);
    }
    for (std::uint32_t i = 0; i < sum_.ellipsoids; ++i) {
      const LocalMinkowskiSum::Ellipsoid& s = sum_.ellipsoid[i];
      const double most = largest_of(largest_of(s.radius[0], s.radius[1]), s.radius[2]);
      const EllipsoidHeight height(s, normal_);
      add_ellipsoid_rise(e, s, height, height.length + most * tangent, q);
    }
    for (std::uint32_t i = 0; i < sum_.segments; ++i) {
      const LocalMinkowskiSum::Segment& s = sum_.segment[i];
      const double share = s.radius > 0.0 ? 0.5 : 1.0;
      add_square(e, s.along, 2.0 * share * inside_[i] / tangent, q);
      if (!(s.radius > 0.0)) continue;
      double across[3];
      const double sine = sine_of(s.axis, across);
      add_square(e, across, 0.5 * s.radius * at_[i] / (s.length * (sine + tangent)), q);
    }
    const double least = kMargin * height_;
    return q[0] > least && q[2] > least && (q[0] - least) * (q[2] - least) > q[1] * q[1];
  }

  /// Lower bound of all depths if the simple part is a ball swept along segments, and the depth is
  /// at most the ball's radius: the radius minus the distance of the origin from the center of the
  /// touching ball. Negative if there is no such bound.
  [[nodiscard]] double ball_lower_bound() const {
    double radius = 0.0;
    if (is_flat_ || !is_swept_ball(radius)) return -1.0;
    const double below = height_ - radius;
    return below > 0.0 ? -1.0 : radius - __builtin_sqrt(below * below + miss_ * miss_);
  }

  /// Unit, from the first to the second.
  [[nodiscard]] const double* normal() const { return normal_; }
  /// The height of the simple part along the normal.
  [[nodiscard]] double height() const { return height_; }
  /// Distance of the origin's foot from the point in which the simple part touches.
  [[nodiscard]] double miss() const { return miss_; }

  /// The touching point of the difference.
  void write_difference(double* x) const {
    if (is_flat_) {
      for (int k = 0; k < 3; ++k) x[k] = height_ * normal_[k];
      return;
    }
    sum_support(x);
    for (std::uint32_t i = 0; i < sum_.segments; ++i) {
      for (int k = 0; k < 3; ++k) x[k] += at_[i] * sum_.segment[i].along[k];
    }
  }

  /// The touching point of the first.
  void write_point(double* point) const {
    if (is_flat_) {
      for (int k = 0; k < 3; ++k) point[k] = flat_point_[k];
      return;
    }
    for (int k = 0; k < 3; ++k) point[k] = sum_.mine[k];
    for (std::uint32_t i = 0; i < sum_.first_discs; ++i) {
      double rim[3];
      rim_of(sum_.disc[i], rim);
      for (int k = 0; k < 3; ++k) point[k] += rim[k];
    }
    for (std::uint32_t i = 0; i < sum_.first_ellipsoids; ++i) {
      double x[3];
      touch_of(sum_.ellipsoid[i], x);
      for (int k = 0; k < 3; ++k) point[k] += x[k];
    }
    for (std::uint32_t i = 0; i < sum_.first_segments; ++i) {
      for (int k = 0; k < 3; ++k) point[k] += at_[i] * sum_.segment[i].along[k];
    }
  }

 private:
  static constexpr int kMaxSteps = 6;
  /// A step about squares the error, so the search ends after a step shorter than kLastStep. It
  /// fails if a step is longer than kWideStep.
  static constexpr double kLastStep = 1e-7;
  static constexpr double kWideStep = 0.5;
  /// Below kMinSine, discs count as flat and segments as parallel. Below kFlatSine a disc may be
  /// touched on its flat side.
  static constexpr double kMinSine = 1e-3;
  static constexpr double kFlatSine = 0.4;
  /// Above this sine, the perpendicular component of a direction loses no digits.
  static constexpr double kSteepSine = 0.25;
  /// Rounding error of curvatures, relative to the height.
  static constexpr double kMargin = 1e-6;
  /// Heights that differ by at most this are equal up to rounding.
  static constexpr double kLevel = 1e-13;
  static constexpr double kLevelFace = 2e-15;

  void take_points(const double* const* corner, const double* const* mine) {
    side_[0].form = &pair_->first;
    side_[1].form = &pair_->second;
    for (int i = 0; i < 3; ++i) {
      double x[3];
      for (int k = 0; k < 3; ++k) {
        side_[0].at[i][k] = mine[i][k];
        x[k] = mine[i][k] - corner[i][k] - pair_->shift[k];
      }
      turn_back3(pair_->turn, x, side_[1].at[i]);
    }
    side_[1].unite();
  }

  // Flat parts: a cap, or a face that contains all three points.

  bool find_flat_part(int side) {
    const NearPoints& points = side_[side];
    if (points.is_smooth()) return false;
    const SidePlace place(*pair_, side == 1);
    return points.is_round() ? find_flat_cap(points, place, side)
                             : find_flat_face(points, place, side);
  }

  bool find_flat_cap(const NearPoints& points, const SidePlace& place, int side) {
    const int high = points.high();
    const bool is_cone = points.form->kind == ShapeKind::cone;
    if (high != 0 && (high != 3 || is_cone)) return false;
    const double z = high == 3 ? 1.0 : -1.0;
    const double outward[3] = {0.0, 0.0, z};
    double n[3];
    place.direction(outward, n);
    if (!(dot3(n, normal_) > 1.0 - 0.5 * kFlatSine * kFlatSine)) return false;
    const double middle[3] = {0.0, 0.0, z * points.form->number[2]};
    double at[3];
    place.point(middle, at);
    return touch_flat(n, side, at, [&](const double* foot) {
      const double away[3] = {foot[0] - at[0], foot[1] - at[1], foot[2] - at[2]};
      return points.form->number[0] - __builtin_sqrt(dot3(away, away));
    });
  }

  bool find_flat_face(const NearPoints& points, const SidePlace& place, int side) {
    if (are_same(points.at[0], points.at[1]) || are_same(points.at[1], points.at[2]) ||
        are_same(points.at[2], points.at[0])) {
      return false;
    }
    double at[3][3];
    double e[3][3];
    for (int i = 0; i < 3; ++i) place.point(points.at[i], at[i]);
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) e[i][k] = at[(i + 1) % 3][k] - at[i][k];
    }
    double n[3];
    cross3(e[0], e[1], n);
    const double area = __builtin_sqrt(dot3(n, n));
    if (!(area > kMinSine * __builtin_sqrt(dot3(e[0], e[0]) * dot3(e[1], e[1])))) return false;
    const double sign = dot3(n, normal_) < 0.0 ? -1.0 : 1.0;
    for (double& x : n) x *= sign / area;
    // If the cores are apart, their distance is measured to a point of the face, so the face must
    // be level up to rounding.
    for (int i = 0; i < 2 && sign_ < 0.0; ++i) {
      if (!(__builtin_fabs(dot3(n, e[i])) <= kLevelFace)) return false;
    }
    return touch_flat(n, side, at[0], [&](const double* foot) {
      double least = __builtin_inf();
      for (int i = 0; i < 3; ++i) {
        double inward[3];
        const double out[3] = {foot[0] - at[i][0], foot[1] - at[i][1], foot[2] - at[i][2]};
        cross3(n, e[i], inward);
        const double depth = sign * dot3(inward, out) / __builtin_sqrt(dot3(e[i], e[i]));
        least = depth < least ? depth : least;
      }
      return least;
    });
  }

  /// True if the flat part through `at` is touched inside its border: by the other core's support
  /// point, or by the mean of the other core's three points if these are equally far. inside(x) is
  /// the distance of a point x of the plane from the border, negative outside.
  template <typename Inside>
  bool touch_flat(const double* n, int side, const double* at, Inside&& inside) {
    const SidePlace place(*pair_, side == 0);
    double w[3];
    double mine[3];
    double other[3];
    difference_point(*pair_, n, w, mine);
    for (int k = 0; k < 3; ++k) other[k] = side == 0 ? w[k] - mine[k] : mine[k];
    const double farthest = dot3(n, other);
    if (touch_flat_at(n, side, at, other, inside)) return true;
    for (double& x : other) x = 0.0;
    for (const double(&x)[3] : side_[1 - side].at) {
      double placed[3];
      place.point(x, placed);
      for (int k = 0; k < 3; ++k) other[k] += placed[k] / 3.0;
    }
    return dot3(n, other) >= farthest - kLevel && touch_flat_at(n, side, at, other, inside);
  }

  template <typename Inside>
  bool touch_flat_at(const double* n, int side, const double* at, const double* other,
                     Inside&& inside) {
    height_ = dot3(n, at) + dot3(n, other);
    double foot[3];
    for (int k = 0; k < 3; ++k) foot[k] = height_ * n[k] - other[k];
    inside_[0] = inside(foot);
    if (!(sign_ * height_ > 0.0) || !(inside_[0] > 0.0)) return false;
    for (int k = 0; k < 3; ++k) {
      normal_[k] = n[k];
      flat_point_[k] = side == 0 ? foot[k] : other[k];
    }
    miss_ = 0.0;
    return true;
  }

  // Sums of points, discs and segments.

  bool add_side(int side) {
    const NearPoints& points = side_[side];
    const SidePlace place(*pair_, side == 1);
    if (points.is_round()) return add_round(points, place, side);
    if (points.is_tapered()) return add_taper(points, place, side);
    if (points.is_smooth()) {
      add_point(points.form->center, place, side);
      add_ellipsoid(points.form->number, points.form->number[3], place);
      return true;
    }
    const double* other = nullptr;
    for (int i = 1; i < 3; ++i) {
      if (are_same(points.at[i], points.at[0])) continue;
      if (other != nullptr && !are_same(points.at[i], other)) return false;
      other = points.at[i];
    }
    add_point(points.at[0], place, side);
    if (other == nullptr) return true;
    const double* from = points.at[0];
    const double along[3] = {other[0] - from[0], other[1] - from[1], other[2] - from[2]};
    return add_edge(along, place);
  }

  bool add_round(const NearPoints& points, const SidePlace& place, int side) {
    const double radius = points.form->number[0];
    const double half = points.form->number[2];
    const int high = points.high();
    const bool is_side = high != 0 && high != 3;
    const bool is_cone = points.form->kind == ShapeKind::cone;
    const double end[3] = {0.0, 0.0, high == 3 || (is_cone && is_side) ? half : -half};
    const double axis[3] = {0.0, 0.0, 1.0};
    add_point(end, place, side);
    if (is_cone && is_side) return add_cone_side(radius, 2.0 * half, axis, place);
    if (!is_cone || high == 0) {
      LocalMinkowskiSum::Disc& disc = sum_.disc[sum_.discs++];
      disc.radius = radius;
      place.direction(axis, disc.axis);
    }
    const double along[3] = {0.0, 0.0, 2.0 * half};
    return !is_side || add_edge(along, place);
  }

  void add_ellipsoid(const double* radius, double off, const SidePlace& place) {
    LocalMinkowskiSum::Ellipsoid& s = sum_.ellipsoid[sum_.ellipsoids++];
    for (int k = 0; k < 3; ++k) {
      double axis[3] = {0.0, 0.0, 0.0};
      axis[k] = 1.0;
      place.direction(axis, s.axis[k]);
      s.radius[k] = radius[k];
    }
    s.off = off;
  }

  /// Adds the tip, the ball, or the side between them.
  bool add_taper(const NearPoints& points, const SidePlace& place, int side) {
    const double more = points.form->number[0];
    const double ball[3] = {0.0, 0.0, points.form->number[1]};
    const double tip[3] = {0.0, 0.0, points.form->number[2]};
    const double length = tip[2] - ball[2];
    const int tips = points.tips();
    add_point(tips == 0 ? ball : tip, place, side);
    if (tips == 3) return true;
    if (tips == 0) {
      const double radius[3] = {more, more, more};
      if (more > 0.0) add_ellipsoid(radius, 0.0, place);
      return true;
    }
    if (!(more > 0.0)) {
      const double along[3] = {0.0, 0.0, -length};
      return add_edge(along, place);
    }
    const double apart = __builtin_fabs(length);
    const double axis[3] = {0.0, 0.0, length < 0.0 ? -1.0 : 1.0};
    const double slant = __builtin_sqrt((apart - more) * (apart + more));
    const double share = slant / apart;
    return add_cone_side(more * share, slant * share, axis, place);
  }

  void add_point(const double* x, const SidePlace& place, int side) {
    double placed[3];
    place.point(x, placed);
    for (int k = 0; k < 3; ++k) {
      if (side == 0) sum_.mine[k] = placed[k];
      sum_.point[k] = side == 0 ? placed[k] : sum_.point[k] + placed[k];
    }
  }

  bool add_edge(const double* along, const SidePlace& place) {
    const double length = __builtin_sqrt(dot3(along, along));
    if (!(length > 0.0)) return false;
    const double unit[3] = {along[0] / length, along[1] / length, along[2] / length};
    LocalMinkowskiSum::Segment& s = sum_.segment[sum_.segments++];
    place.direction(unit, s.axis);
    for (int k = 0; k < 3; ++k) s.along[k] = s.axis[k];
    s.cosine = 0.0;
    s.sine = 1.0;
    s.length = length;
    s.radius = 0.0;
    return true;
  }

  /// The axis points to the tip; the segment runs from the tip to the rim.
  bool add_cone_side(double radius, double height, const double* axis, const SidePlace& place) {
    LocalMinkowskiSum::Segment& s = sum_.segment[sum_.segments++];
    place.direction(axis, s.axis);
    s.length = __builtin_sqrt(radius * radius + height * height);
    s.cosine = radius / s.length;
    s.sine = height / s.length;
    s.radius = radius;
    return radius > 0.0 && height > 0.0;
  }

  /// Returns the sine of the angle between an axis and the normal; `across` is the unit vector
  /// perpendicular to both.
  double sine_of(const double* axis, double* across) const {
    cross3(axis, normal_, across);
    const double sine = __builtin_sqrt(dot3(across, across));
    const double over = 1.0 / largest_of(sine, kMinSine);
    for (int k = 0; k < 3; ++k) across[k] *= over;
    return sine;
  }

  /// The unit vector perpendicular to an axis, on the side of the normal. The rounding error along
  /// the axis grows as both become parallel: then the component along the axis is removed once
  /// more.
  void out_of(const double* axis, double* out) const {
    double along = dot3(axis, normal_);
    for (int k = 0; k < 3; ++k) out[k] = normal_[k] - along * axis[k];
    double square = dot3(out, out);
    if (square < kSteepSine * kSteepSine) {
      along = dot3(axis, out);
      for (int k = 0; k < 3; ++k) out[k] -= along * axis[k];
      square = dot3(out, out);
    }
    const double over = 1.0 / __builtin_sqrt(square);
    for (int k = 0; k < 3; ++k) out[k] *= over;
  }

  /// From the center of a disc to its support point along the normal.
  void rim_of(const LocalMinkowskiSum::Disc& disc, double* rim) const {
    out_of(disc.axis, rim);
    for (int k = 0; k < 3; ++k) rim[k] *= disc.radius;
  }

  /// From the center of an ellipsoid to its support point along the normal.
  void touch_of(const LocalMinkowskiSum::Ellipsoid& ellipsoid, double* x) const {
    const EllipsoidHeight height(ellipsoid, normal_);
    const double over = 1.0 / largest_of(height.length, 1e-150);
    for (int k = 0; k < 3; ++k) x[k] = -ellipsoid.off * normal_[k];
    for (int i = 0; i < 3; ++i) {
      const double reach = ellipsoid.radius[i] * height.stretched[i] * over;
      for (int k = 0; k < 3; ++k) x[k] += reach * ellipsoid.axis[i][k];
    }
  }

  /// The sum's support point along the normal, at the start of its segments.
  void sum_support(double* w) const {
    for (int k = 0; k < 3; ++k) w[k] = sum_.point[k];
    for (std::uint32_t i = 0; i < sum_.discs; ++i) {
      double rim[3];
      rim_of(sum_.disc[i], rim);
      for (int k = 0; k < 3; ++k) w[k] += rim[k];
    }
    for (std::uint32_t i = 0; i < sum_.ellipsoids; ++i) {
      double x[3];
      touch_of(sum_.ellipsoid[i], x);
      for (int k = 0; k < 3; ++k) w[k] += x[k];
    }
  }

  /// Adds f x x^T to a quadratic form over e, given by its entries (0, 0), (0, 1) and (1, 1).
  static void add_square(const double (*e)[3], const double* x, double f, double* q) {
    const double u = dot3(e[0], x);
    const double v = dot3(e[1], x);
    q[0] += f * u * u;
    q[1] += f * u * v;
    q[2] += f * v * v;
  }

  /// Adds the rise of an ellipsoid over its tangent plane, less the erosion. `length` is an upper
  /// bound of the length of the stretched direction.
  static void add_ellipsoid_rise(const double (*e)[3],
                                 const LocalMinkowskiSum::Ellipsoid& ellipsoid,
                                 const EllipsoidHeight& height, double length, double* q) {
    double across[2][3];
    for (int i = 0; i < 2; ++i) height.turn(ellipsoid, e[i], across[i]);
    q[0] += dot3(across[0], across[0]) / length - ellipsoid.off;
    q[1] += dot3(across[0], across[1]) / length;
    q[2] += dot3(across[1], across[1]) / length - ellipsoid.off;
  }

  bool set_normal(const double* n) {
    const double length = __builtin_sqrt(dot3(n, n));
    if (!(length > kMinSine)) return false;
    for (int k = 0; k < 3; ++k) normal_[k] = n[k] / length;
    return true;
  }

  /// True if the minimum is determined: by at least two discs or segments, by a cone's side, which
  /// is both, or by an ellipsoid.
  [[nodiscard]] bool is_determined() const {
    const bool has_cone_side = sum_.segments > 0 && sum_.segment[0].radius > 0.0;
    return has_cone_side || sum_.ellipsoids > 0 || sum_.segments + sum_.discs >= 2;
  }

  /// True if the sum is a ball swept along segments; adds to `radius` its radius.
  bool is_swept_ball(double& radius) const {
    if (sum_.discs > 0 || sum_.ellipsoids == 0) return false;
    for (std::uint32_t i = 0; i < sum_.segments; ++i) {
      if (sum_.segment[i].radius > 0.0) return false;
    }
    for (std::uint32_t i = 0; i < sum_.ellipsoids; ++i) {
      const LocalMinkowskiSum::Ellipsoid& s = sum_.ellipsoid[i];
      if (s.radius[0] != s.radius[1] || s.radius[0] != s.radius[2] || s.off != 0.0) return false;
      radius += s.radius[0];
    }
    return true;
  }

  /// The shortest translation out of a ball is away from its center.
  void leave_ball() {
    const double length = __builtin_sqrt(dot3(sum_.point, sum_.point));
    if (!(length > 0.0)) return;
    for (int k = 0; k < 3; ++k) normal_[k] = -sum_.point[k] / length;
  }

  /// Newton's method over the normals that are perpendicular to all segments (for a cone's side,
  /// over the normals of the side).
  bool approach() {
    double radius = 0.0;
    if (sum_.segments == 0 && is_swept_ball(radius)) {
      leave_ball();
      return true;
    }
    if (sum_.segments > 2 || !is_determined()) return false;
    if (sum_.segments > 0 && !move_on_circle(normal_)) return false;
    if (sum_.segments == 2 && are_parallel()) take_amid_second();
    if (sum_.segments == 2) return align_with_both();
    for (int i = 0; i < kMaxSteps; ++i) {
      double step[3];
      if (!next_step(step)) return false;
      const double square = dot3(step, step);
      if (!(square < kWideStep * kWideStep)) return false;
      const double n[3] = {normal_[0] + step[0], normal_[1] + step[1], normal_[2] + step[2]};
      if (!(sum_.segments == 1 ? move_on_circle(n) : set_normal(n))) return false;
      if (square < kLastStep * kLastStep) return true;
    }
    return false;
  }

  /// True for two parallel edges or sides of cylinders.
  [[nodiscard]] bool are_parallel() const {
    const LocalMinkowskiSum::Segment& s = sum_.segment[0];
    const LocalMinkowskiSum::Segment& t = sum_.segment[1];
    double out[3];
    cross3(s.axis, t.axis, out);
    return !(s.radius > 0.0) && !(t.radius > 0.0) && dot3(out, out) <= kMinSine * kMinSine;
  }

  /// Replaces the second segment by one of its points: the point for which the touching point on
  /// the first segment is nearest to its middle.
  void take_amid_second() {
    const LocalMinkowskiSum::Segment& s = sum_.segment[0];
    const LocalMinkowskiSum::Segment& t = sum_.segment[1];
    double w[3];
    sum_support(w);
    const double target = -(0.5 * s.length + dot3(w, s.axis)) / dot3(t.axis, s.axis);
    const double least = target > 0.0 ? target : 0.0;
    const double at = least < t.length ? least : t.length;
    for (int k = 0; k < 3; ++k) sum_.point[k] += at * t.axis[k];
    sum_.segments = 1;
  }

  /// Moves to the normal nearest to `to` along which all points of the first segment are equally
  /// far.
  bool move_on_circle(const double* to) {
    const LocalMinkowskiSum::Segment& s = sum_.segment[0];
    const double along = dot3(s.axis, to);
    double across[3];
    for (int k = 0; k < 3; ++k) across[k] = to[k] - along * s.axis[k];
    const double length = __builtin_sqrt(dot3(across, across));
    if (!(length > kMinSine)) return false;
    const double scale = s.sine / length;
    for (int k = 0; k < 3; ++k) normal_[k] = s.cosine * s.axis[k] + scale * across[k];
    return true;
  }

  /// Moves to the normal along which both segments are level; there are two, the nearer is taken.
  bool align_with_both() {
    const LocalMinkowskiSum::Segment& s = sum_.segment[0];
    const LocalMinkowskiSum::Segment& t = sum_.segment[1];
    double out[3];
    cross3(s.axis, t.axis, out);
    const double square = dot3(out, out);
    if (!(square > kMinSine * kMinSine)) return false;
    const double both = dot3(s.axis, t.axis);
    const double x = (s.cosine - both * t.cosine) / square;
    const double y = (t.cosine - both * s.cosine) / square;
    const double rest = 1.0 - (x * s.cosine + y * t.cosine);
    if (!(rest > 0.0)) return false;
    const double z = __builtin_sqrt(rest / square) * (dot3(out, normal_) < 0.0 ? -1.0 : 1.0);
    double n[3];
    for (int k = 0; k < 3; ++k) n[k] = x * s.axis[k] + y * t.axis[k] + z * out[k];
    return set_normal(n);
  }

  /// Computes a step of Newton's method. Returns false if the second derivatives are not positive
  /// definite, or if a disc or ellipsoid is seen along its flat side.
  bool next_step(double* step) const {
    double w[3];
    sum_support(w);
    const double height = dot3(w, normal_);
    double e[2][3];
    span_across(normal_, e);
    double q[3] = {-height, 0.0, -height};
    if (sum_.segments == 1) {
      // Along the circle of normals, which curves towards its own center.
      const LocalMinkowskiSum::Segment& s = sum_.segment[0];
      sine_of(s.axis, e[0]);
      q[0] = -(height - s.cosine * dot3(w, s.axis)) / (s.sine * s.sine);
    }
    for (std::uint32_t i = 0; i < sum_.discs; ++i) {
      double across[3];
      const double sine = sine_of(sum_.disc[i].axis, across);
      if (!(sine > kMinSine)) return false;
      add_square(e, across, sum_.disc[i].radius / sine, q);
    }
    for (std::uint32_t i = 0; i < sum_.ellipsoids; ++i) {
      const EllipsoidHeight at(sum_.ellipsoid[i], normal_);
      if (!(at.length > kMinSine * kMinSine)) return false;
      add_ellipsoid_rise(e, sum_.ellipsoid[i], at, at.length, q);
    }
    if (!(q[0] > 0.0)) return false;
    const double slope[2] = {dot3(e[0], w), dot3(e[1], w)};
    double s = -slope[0] / q[0];
    double t = 0.0;
    if (sum_.segments == 0) {
      const double det = q[0] * q[2] - q[1] * q[1];
      if (!(det > 0.0)) return false;
      s = (q[1] * slope[1] - q[2] * slope[0]) / det;
      t = (q[1] * slope[0] - q[0] * slope[1]) / det;
    }
    for (int k = 0; k < 3; ++k) step[k] = s * e[0][k] + t * e[1][k];
    return true;
  }

  /// Sets the line of a cone's side that touches, from the tip on.
  void turn_to_normal(LocalMinkowskiSum::Segment& s) const {
    double out[3];
    out_of(s.axis, out);
    for (int k = 0; k < 3; ++k) s.along[k] = s.cosine * out[k] - s.sine * s.axis[k];
  }

  /// Computes the touching point on each segment, where the foot of the origin is; returns false if
  /// it is beyond an end.
  bool touch_segments() {
    const std::uint32_t count = sum_.segments;
    for (std::uint32_t i = 0; i < count; ++i) {
      if (sum_.segment[i].radius > 0.0) turn_to_normal(sum_.segment[i]);
    }
    double w[3];
    sum_support(w);
    height_ = dot3(w, normal_);
    if (!(sign_ * height_ > 0.0)) return false;
    double across[3];
    for (int k = 0; k < 3; ++k) across[k] = w[k] - height_ * normal_[k];
    const double slope[2] = {count > 0 ? dot3(across, sum_.segment[0].along) : 0.0,
                             count > 1 ? dot3(across, sum_.segment[1].along) : 0.0};
    const double both = count > 1 ? dot3(sum_.segment[0].along, sum_.segment[1].along) : 0.0;
    const double det = 1.0 - both * both;
    if (!(det > kMinSine * kMinSine)) return false;
    at_[0] = (both * slope[1] - slope[0]) / det;
    at_[1] = (both * slope[0] - slope[1]) / det;
    for (std::uint32_t i = 0; i < count; ++i) {
      const double rest = sum_.segment[i].length - at_[i];
      inside_[i] = at_[i] < rest ? at_[i] : rest;
      if (!(inside_[i] > 0.0)) return false;
      for (int k = 0; k < 3; ++k) across[k] += at_[i] * sum_.segment[i].along[k];
    }
    miss_ = __builtin_sqrt(dot3(across, across));
    return true;
  }

  const CurvedPair* pair_;
  NearPoints side_[2];
  LocalMinkowskiSum sum_;
  double sign_;
  double normal_[3];
  double height_;
  double miss_;
  /// The position of the touching point along each segment.
  double at_[2];
  /// The distance of the touching point from the nearer end of each segment; for a flat part,
  /// inside_[0] is the distance from the border.
  double inside_[2];
  bool is_flat_ = false;
  double flat_point_[3];
};

}  // namespace winnow::WINNOW_ISA_NAME::curved
