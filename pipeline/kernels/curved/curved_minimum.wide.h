#pragma once

// Where the depth of two cores has a local minimum, to double's precision, and how far around it
// nothing is less deep: a polytope that says roughly where the least depth is needs no more.
//
// Near its least depth the difference of two cores is often as simple as a point, discs (of rims)
// and segments (edges, and sides of cylinders) added up; it contains those, so their heights h
// bound its own from below. For n = n0 + t, t across n0 and |t| <= T, a disc of radius r whose axis
// makes the sine s with n0 rises over its tangent by at least r (e . t)^2 / (2 (s + T)), with e
// across both, and a segment along g, whose ends are at least p away from where it is met, by p |g
// . t| >= p (g . t)^2 / T. Where these together are not less than h(n0) |t|^2 / 2, h(n) is at least
// h(n0) |n|.

#include "pipeline/kernels/curved/curved_pair.wide.h"

namespace winnow::WINNOW_ISA_NAME::curved {

/// A point, up to two discs and up to two segments from it, added up, in the first's frame.
struct SimpleSum {
  double point[3];
  std::uint32_t discs;
  double radius[2];
  double axis[2][3];
  std::uint32_t segments;
  /// Unit, and the segment's length along it.
  double along[2][3];
  double length[2];
  /// Of the first: what it adds to the point, which disc and segment are its own.
  double mine[3];
  std::uint32_t own_discs;
  std::uint32_t own_segments;
};

class LocalMinimum {
 public:
  /// Finds the minimum near a unit direction in the difference's simple part there: of the corners
  /// of a face of the polytope and the points of the first in them. False if there is none.
  bool find(const CurvedPair& pair, const double* const* corner, const double* const* mine,
            const double* near) {
    for (int k = 0; k < 3; ++k) normal_[k] = near[k];
    return take_first(pair.first, mine) && take_second(pair, corner, mine) && approach() &&
           meet_segments();
  }

  /// Whether nothing is less deep up to the angle from the minimum with this tangent.
  [[nodiscard]] bool holds(double tangent) const {
    double e[2][3];
    span_across(e);
    double q[3] = {-height_, 0.0, -height_};
    for (std::uint32_t i = 0; i < sum_.discs; ++i) {
      double across[3];
      const double sine = sine_of(i, across);
      add_square(e, across, sum_.radius[i] / (sine + tangent), q);
    }
    for (std::uint32_t i = 0; i < sum_.segments; ++i) {
      add_square(e, sum_.along[i], 2.0 * inside_[i] / tangent, q);
    }
    const double least = kMargin * height_;
    return q[0] > least && q[2] > least && (q[0] - least) * (q[2] - least) > q[1] * q[1];
  }

  /// Unit, from the first to the second.
  [[nodiscard]] const double* normal() const { return normal_; }
  /// Of the simple part.
  [[nodiscard]] double height() const { return height_; }
  /// How far the origin's foot is from where the simple part is met.
  [[nodiscard]] double miss() const { return miss_; }

  /// The point of the first that is met.
  void write_point(double* point) const {
    for (int k = 0; k < 3; ++k) point[k] = sum_.mine[k];
    for (std::uint32_t i = 0; i < sum_.own_discs; ++i) {
      double rim[3];
      rim_of(i, rim);
      for (int k = 0; k < 3; ++k) point[k] += rim[k];
    }
    for (std::uint32_t i = 0; i < sum_.own_segments; ++i) {
      for (int k = 0; k < 3; ++k) point[k] += at_[i] * sum_.along[i][k];
    }
  }

 private:
  static constexpr int kMostSteps = 6;
  /// A step after which nothing is left to gain, since steps square the error; and one too wide.
  static constexpr double kLastStep = 1e-7;
  static constexpr double kWideStep = 0.5;
  /// Sines below which discs look flat and segments parallel.
  static constexpr double kLeastSine = 1e-3;
  /// Of curvatures, over the height, for what rounding takes.
  static constexpr double kMargin = 1e-6;

  /// The cores' simple parts at three points, `at` in the frame of the core; `place` puts a point
  /// where it adds to the sum, `turned` a direction.
  template <typename Place, typename Turned>
  bool take(const Form& form, const double (*at)[3], Place&& place, Turned&& turned) {
    const bool is_cone = form.kind == ShapeKind::cone;
    if (is_cone || form.kind == ShapeKind::cylinder) {
      return take_round(form.number[0], form.number[2], is_cone, at, place, turned);
    }
    const double* other = nullptr;
    for (int i = 1; i < 3; ++i) {
      if (are_same(at[i], at[0])) continue;
      // Three different points are of a face, which the polytope finds soon.
      if (other != nullptr && !are_same(at[i], other)) return false;
      other = at[i];
    }
    place(at[0]);
    if (other == nullptr) return true;
    const double side[3] = {other[0] - at[0][0], other[1] - at[0][1], other[2] - at[0][2]};
    return add_segment(side, turned);
  }

  template <typename Place, typename Turned>
  bool take_round(double radius, double half, bool is_cone, const double (*at)[3], Place&& place,
                  Turned&& turned) {
    int high = 0;
    for (int i = 0; i < 3; ++i) high += at[i][2] > 0.0 ? 1 : 0;
    const bool is_side = high != 0 && high != 3;
    // A cone's side is no sum of these, and its tip no disc.
    if (is_cone && high != 0) return false;
    const double middle[3] = {0.0, 0.0, high == 3 ? half : -half};
    const double axis[3] = {0.0, 0.0, 1.0};
    const double side[3] = {0.0, 0.0, 2.0 * half};
    place(middle);
    sum_.radius[sum_.discs] = radius;
    turned(axis, sum_.axis[sum_.discs++]);
    return !is_side || add_segment(side, turned);
  }

  template <typename Turned>
  bool add_segment(const double* side, Turned&& turned) {
    const double length = __builtin_sqrt(dot3(side, side));
    if (!(length > 0.0)) return false;
    const double unit[3] = {side[0] / length, side[1] / length, side[2] / length};
    sum_.length[sum_.segments] = length;
    turned(unit, sum_.along[sum_.segments++]);
    return true;
  }

  static bool are_same(const double* a, const double* b) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
  }

  bool take_first(const Form& form, const double* const* mine) {
    double at[3][3];
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) at[i][k] = mine[i][k];
    }
    sum_.discs = 0;
    sum_.segments = 0;
    const auto copy = [](const double* x, double* r) {
      for (int k = 0; k < 3; ++k) r[k] = x[k];
    };
    const bool taken = take(
        form, at,
        [&](const double* x) {
          copy(x, sum_.point);
          copy(x, sum_.mine);
        },
        copy);
    sum_.own_discs = sum_.discs;
    sum_.own_segments = sum_.segments;
    return taken;
  }

  /// The second is taken away: its points are against the sum's directions.
  bool take_second(const CurvedPair& pair, const double* const* corner, const double* const* mine) {
    double at[3][3];
    for (int i = 0; i < 3; ++i) {
      double x[3];
      for (int k = 0; k < 3; ++k) x[k] = mine[i][k] - corner[i][k] - pair.shift[k];
      turn_back3(pair.turn, x, at[i]);
    }
    round_to_vertices(pair.second, at);
    return take(
        pair.second, at,
        [&](const double* x) {
          double placed[3];
          turn3(pair.turn, x, placed);
          for (int k = 0; k < 3; ++k) sum_.point[k] -= placed[k] + pair.shift[k];
        },
        [&](const double* x, double* r) {
          turn3(pair.turn, x, r);
          for (int k = 0; k < 3; ++k) r[k] = -r[k];
        });
  }

  /// Points that are the same but for rounding become so.
  static void round_to_vertices(const Form& form, double (*at)[3]) {
    if (form.kind == ShapeKind::cone || form.kind == ShapeKind::cylinder) return;
    for (int i = 1; i < 3; ++i) {
      for (int j = 0; j < i; ++j) {
        double most = 0.0;
        for (int k = 0; k < 3; ++k) {
          most = largest_of(most, __builtin_fabs(at[i][k] - at[j][k]));
        }
        if (most > kRoundingError * 4.0) continue;
        for (int k = 0; k < 3; ++k) at[i][k] = at[j][k];
      }
    }
  }

  /// The sine of the angle between disc i's axis and the normal, and the unit direction across
  /// both.
  double sine_of(std::uint32_t i, double* across) const {
    cross3(sum_.axis[i], normal_, across);
    const double sine = __builtin_sqrt(dot3(across, across));
    const double over = 1.0 / largest_of(sine, kLeastSine);
    for (int k = 0; k < 3; ++k) across[k] *= over;
    return sine;
  }

  /// From the middle of disc i to its point farthest along the normal.
  void rim_of(std::uint32_t i, double* rim) const {
    const double* a = sum_.axis[i];
    const double along = dot3(a, normal_);
    for (int k = 0; k < 3; ++k) rim[k] = normal_[k] - along * a[k];
    const double scale = sum_.radius[i] / __builtin_sqrt(dot3(rim, rim));
    for (int k = 0; k < 3; ++k) rim[k] *= scale;
  }

  /// The sum's point farthest along the normal, where its segments begin.
  void met(double* w) const {
    for (int k = 0; k < 3; ++k) w[k] = sum_.point[k];
    for (std::uint32_t i = 0; i < sum_.discs; ++i) {
      double rim[3];
      rim_of(i, rim);
      for (int k = 0; k < 3; ++k) w[k] += rim[k];
    }
  }

  /// Unit directions across the normal and each other.
  void span_across(double (*e)[3]) const {
    const double* n = normal_;
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

  /// Adds f x^T x to a form over e: its entries (0, 0), (0, 1) and (1, 1).
  static void add_square(const double (*e)[3], const double* x, double f, double* q) {
    const double u = dot3(e[0], x);
    const double v = dot3(e[1], x);
    q[0] += f * u * u;
    q[1] += f * u * v;
    q[2] += f * v * v;
  }

  bool set_normal(const double* n) {
    const double length = __builtin_sqrt(dot3(n, n));
    if (!(length > kLeastSine)) return false;
    for (int k = 0; k < 3; ++k) normal_[k] = n[k] / length;
    return true;
  }

  /// Newton's method across the normal, along no segment.
  bool approach() {
    if (sum_.segments > 2 || sum_.segments + sum_.discs < 2) return false;
    if (sum_.segments == 2) return stand_across_both();
    if (sum_.segments == 1) {
      const double* g = sum_.along[0];
      const double along = dot3(g, normal_);
      const double n[3] = {normal_[0] - along * g[0], normal_[1] - along * g[1],
                           normal_[2] - along * g[2]};
      if (!set_normal(n)) return false;
    }
    for (int i = 0; i < kMostSteps; ++i) {
      double step[3];
      if (!next_step(step)) return false;
      const double square = dot3(step, step);
      if (!(square < kWideStep * kWideStep)) return false;
      const double n[3] = {normal_[0] + step[0], normal_[1] + step[1], normal_[2] + step[2]};
      if (!set_normal(n)) return false;
      if (square < kLastStep * kLastStep) return true;
    }
    return false;
  }

  bool stand_across_both() {
    double n[3];
    cross3(sum_.along[0], sum_.along[1], n);
    const double sign = dot3(n, normal_) < 0.0 ? -1.0 : 1.0;
    for (double& x : n) x *= sign;
    return set_normal(n);
  }

  /// False where the depth has no minimum along the step.
  bool next_step(double* step) const {
    double w[3];
    met(w);
    const double height = dot3(w, normal_);
    double e[2][3];
    span_across(e);
    if (sum_.segments == 1) {
      // Along the circle across the segment.
      cross3(normal_, sum_.along[0], e[0]);
    }
    double q[3] = {-height, 0.0, -height};
    for (std::uint32_t i = 0; i < sum_.discs; ++i) {
      double across[3];
      const double sine = sine_of(i, across);
      if (!(sine > kLeastSine)) return false;
      add_square(e, across, sum_.radius[i] / sine, q);
    }
    const double slope[2] = {dot3(e[0], w), dot3(e[1], w)};
    double s = -slope[0] / q[0];
    double t = 0.0;
    if (!(q[0] > 0.0)) return false;
    if (sum_.segments == 0) {
      const double det = q[0] * q[2] - q[1] * q[1];
      if (!(det > 0.0)) return false;
      s = (q[1] * slope[1] - q[2] * slope[0]) / det;
      t = (q[1] * slope[0] - q[0] * slope[1]) / det;
    }
    for (int k = 0; k < 3; ++k) step[k] = s * e[0][k] + t * e[1][k];
    return true;
  }

  /// Where along the segments the foot of the origin is; false if it is beyond an end.
  bool meet_segments() {
    double w[3];
    met(w);
    height_ = dot3(w, normal_);
    if (!(height_ > 0.0)) return false;
    double across[3];
    for (int k = 0; k < 3; ++k) across[k] = w[k] - height_ * normal_[k];
    const std::uint32_t count = sum_.segments;
    const double slope[2] = {count > 0 ? dot3(across, sum_.along[0]) : 0.0,
                             count > 1 ? dot3(across, sum_.along[1]) : 0.0};
    const double both = count > 1 ? dot3(sum_.along[0], sum_.along[1]) : 0.0;
    const double det = 1.0 - both * both;
    at_[0] = (both * slope[1] - slope[0]) / det;
    at_[1] = (both * slope[0] - slope[1]) / det;
    for (std::uint32_t i = 0; i < count; ++i) {
      const double rest = sum_.length[i] - at_[i];
      inside_[i] = at_[i] < rest ? at_[i] : rest;
      if (!(inside_[i] > 0.0)) return false;
      for (int k = 0; k < 3; ++k) across[k] += at_[i] * sum_.along[i][k];
    }
    miss_ = __builtin_sqrt(dot3(across, across));
    return true;
  }

  SimpleSum sum_;
  double normal_[3];
  double height_;
  double miss_;
  /// Along each segment: where it is met, and how far that is from its nearer end.
  double at_[2];
  double inside_[2];
};

}  // namespace winnow::WINNOW_ISA_NAME::curved
