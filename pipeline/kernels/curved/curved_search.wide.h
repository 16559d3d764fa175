#pragma once

// Closest points of pairs of cores in double, by GJK with one pair per lane (search_lanes.wide.h).
// A lane that is done takes the next pair. Called by curved_answers.wide.h.

#include "pipeline/kernels/cores/search_lanes.wide.h"
#include "pipeline/kernels/curved/curved_tangent.wide.h"

namespace winnow::WINNOW_ISA_NAME::curved {

/// Computes the weights of the point of a triangle's plane that is nearest to the origin. They are
/// computed from the shortest side, so that thin triangles lose no digits, and refined once against
/// the remaining rounding errors. Returns false if the point is outside the triangle.
static inline bool weigh_thin_triangle(const double (*corner)[3], double* weight) {
  int shortest = 0;
  double least = __builtin_inf();
  for (int i = 0; i < 3; ++i) {
    double square = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double d = corner[(i + 1) % 3][k] - corner[i][k];
      square += d * d;
    }
    shortest = square < least ? i : shortest;
    least = square < least ? square : least;
  }
  const int near = shortest;
  const int beside = (shortest + 1) % 3;
  const int across = (shortest + 2) % 3;
  double side[3];
  double arm[3];
  double normal[3];
  double x[3];
  for (int k = 0; k < 3; ++k) {
    side[k] = corner[beside][k] - corner[near][k];
    arm[k] = corner[across][k] - corner[near][k];
    x[k] = corner[near][k];
  }
  cross3(side, arm, normal);
  const double over = 1.0 / dot3(normal, normal);
  weight[beside] = 0.0;
  weight[across] = 0.0;
  for (int pass = 0; pass < 2; ++pass) {
    const double along = dot3(x, side);
    const double off = dot3(x, arm);
    const double both = dot3(side, arm);
    const double s = (off * both - along * dot3(arm, arm)) * over;
    const double t = (along * both - off * dot3(side, side)) * over;
    for (int k = 0; k < 3; ++k) x[k] += s * side[k] + t * arm[k];
    weight[beside] += s;
    weight[across] += t;
  }
  weight[near] = 1.0 - weight[beside] - weight[across];
  return weight[0] >= 0.0 && weight[1] >= 0.0 && weight[2] >= 0.0;
}

class CurvedSearch {
 public:
  /// At least one pair; all pairs have the same kinds. `overlap_only`: the search stops with state
  /// inside as soon as the rounded shapes certainly overlap.
  CurvedSearch(CurvedPair* pairs, std::uint32_t count, bool overlap_only)
      : pairs_(pairs, count),
        overlap_only_(overlap_only),
        kind_{pairs->first.kind, pairs->second.kind},
        tries_features_(may_have_features(*pairs)),
        lanes_(has_user_shape(*pairs)) {}

  void run() {
    for (unsigned lane = 0; lane < kWidth; ++lane) refill(lane);
    while (pairs_.active() != 0) {
      Mask16 done = step();
      for (; done != 0; done &= done - 1) {
        const unsigned lane = first(done);
        hand_back(lane);
        confirm_inside(lane);
        if (needs_restart(lane)) {
          start(lane, kAskew);
          add_unrelated_support(lane);
        } else {
          refill(lane);
        }
      }
      for (Mask16 rest = pairs_.active(); rest != 0; rest &= rest - 1) {
        const unsigned lane = first(rest);
        if (tries_features_ && is_near(lane) && ends_on_features(lane)) refill(lane);
      }
    }
  }

 private:
  using Search = hull::SearchLanes<double, true>;
  static constexpr int kWidth = Search::kWidth;
  static constexpr double kLengthError = 1e-14;
  /// Ratio of the lower to the upper bound of the distance from which features are tried.
  static constexpr double kNear = 0.75;
  /// Closest features are accepted if the bounds of the distance differ by at most this.
  static constexpr double kClosed = 1e-14;

  /// Limit for weights, and for heights of lengths about 1: above it the origin is farther inside
  /// than rounding errors.
  static constexpr double kWellInside = 1e-6;

  static constexpr double kAskew[3] = {0.3125, -0.234375, 0.171875};
  static constexpr double kUnrelated[3] = {-0.21875, 0.15625, 0.40625};

  void refill(unsigned lane) {
    CurvedPair* const next = pairs_.refill(lane);
    if (next == nullptr) return;
    CurvedPair& pair = *next;
    const CoreDesc* const forms[2] = {&pair.first, &pair.second};
    for (int side = 0; side < 2; ++side) {
      for (int i = 0; i < hull::kCoreNumbers; ++i) number_[side][i][lane] = forms[side]->number[i];
    }
    for (int i = 0; i < 9; ++i) lanes_.turn[i][lane] = pair.turn[i];
    for (int i = 0; i < 3; ++i) lanes_.shift[i][lane] = pair.shift[i];
    const double far = pair.far * pair.scale + pair.rounding + kLengthError;
    lanes_.far[lane] = far * far;
    const double near = pair.rounding - kLengthError;
    lanes_.near[lane] = overlap_only_ && near > 0.0 ? near * near : -1.0;
    is_askew_[lane] = false;
    constexpr double straight[3] = {0.0, 0.0, 0.0};
    start(lane, straight);
  }

  /// If shapes are aligned, the origin may be on an edge or a face of the simplex although the
  /// cores overlap. A second search from another start avoids that.
  bool needs_restart(unsigned lane) {
    if (pairs_[lane].state != CurvedState::close || is_askew_[lane]) return false;
    is_askew_[lane] = true;
    return true;
  }

  /// Tests whether the origin is certainly inside. If the depth is needed, only after the second
  /// search: a polytope that starts from the simplex of the second search takes fewer steps.
  void confirm_inside(unsigned lane) {
    CurvedPair& pair = pairs_[lane];
    if (pair.state != CurvedState::close || !(overlap_only_ || is_askew_[lane])) return;
    if (is_surrounded(pair)) pair.state = CurvedState::inside;
  }

  /// True if the origin, which is on the triangle that the search ended with, is certainly inside
  /// the difference: there are points of the difference on both sides of the triangle. The one on
  /// the origin's side becomes the fourth point.
  static bool is_surrounded(CurvedPair& pair) {
    if (pair.count != 3 || !(pair.upper <= Search::kTouching)) return false;
    double weight[3];
    if (!weigh_thin_triangle(pair.difference, weight)) return false;
    for (const double share : weight) {
      if (!(share > kWellInside)) return false;
    }
    double side[2][3];
    for (int i = 0; i < 2; ++i) {
      for (int k = 0; k < 3; ++k) side[i][k] = pair.difference[i + 1][k] - pair.difference[0][k];
    }
    double normal[3];
    cross3(side[0], side[1], normal);
    // Towards the origin.
    const double turn = dot3(normal, pair.difference[0]) > 0.0 ? -1.0 : 1.0;
    const double over = turn / __builtin_sqrt(dot3(normal, normal));
    for (double& x : normal) x *= over;
    const double back[3] = {-normal[0], -normal[1], -normal[2]};
    double behind[3];
    double mine[3];
    difference_point(pair, back, behind, mine);
    difference_point(pair, normal, pair.difference[3], pair.on_first[3]);
    return dot3(back, behind) > kWellInside && dot3(normal, pair.difference[3]) > kWellInside;
  }

  /// Starts a search from a point of the difference, moved by `aside` times the sizes.
  void start(unsigned lane, const double* aside) {
    const CurvedPair& pair = pairs_[lane];
    lanes_.start(lane);
    double middle[3];
    turn3(pair.turn, pair.second.center, middle);
    double square = 0.0;
    for (int i = 0; i < 3; ++i) {
      const double x = pair.first.center[i] - (middle[i] + pair.shift[i]) + aside[i] * pair.size;
      lanes_.gap[i][lane] = x;
      square += x * x;
    }
    if (!(square > Search::kTouching * Search::kTouching)) {
      lanes_.gap[0][lane] = 1.0;
      square += 1.0;
    }
    lanes_.square[lane] = square;
  }

  /// Adds a support point along an unrelated direction: for two balls, all points that are found
  /// from one starting direction are in one plane with the origin.
  void add_unrelated_support(unsigned lane) {
    double w[3];
    double mine[3];
    difference_point(pairs_[lane], kUnrelated, w, mine);
    for (int k = 0; k < 3; ++k) {
      lanes_.slot[0][k][lane] = w[k];
      lanes_.slot_mine[0][k][lane] = mine[k];
    }
    lanes_.present[0][lane] = 1.0;
  }

  /// The support point of the cores of one side along d.
  [[gnu::always_inline]] Vec3<double> support_of(int side, const Vec3<double>& d) {
    hull::CoreLanes<double> core;
    core.kind = kind_[side];
    for (int i = 0; i < hull::kCoreNumbers; ++i) core.number[i] = Doubles::load(number_[side][i]);
    return hull::support(core, d,
                         [&](const Vec3<double>& along) { return one_by_one(side, along); });
  }

  [[gnu::noinline]] Vec3<double> one_by_one(int side, const Vec3<double>& along) {
    return Search::one_by_one(
        along, pairs_.active(), [&](unsigned lane, const double* direction, double* point) {
          const CurvedPair& pair = pairs_[lane];
          hull::single_support(side == 0 ? pair.first : pair.second, direction, pair.scale, point);
        });
  }

  /// Advances all lanes by one step; returns the lanes that are done.
  Mask16 step() {
    const hull::SearchEnds ends = lanes_.step(
        pairs_.active(), [&](int side, const Vec3<double>& d) { return support_of(side, d); });
    pairs_.mark(ends.far, CurvedState::far);
    pairs_.mark(ends.apart, CurvedState::apart);
    pairs_.mark(ends.inside, CurvedState::inside);
    pairs_.mark(ends.close, CurvedState::close);
    return ends.all();
  }

  /// False for user shapes against shapes with flat parts or edges: ends_on_tangent needs a smooth
  /// minimum. User shapes count as smooth, because their curvature is unknown.
  static bool may_have_features(const CurvedPair& pair) {
    if (!has_user_shape(pair)) return true;
    const ShapeKind kind = pair.first.kind;
    return kind == ShapeKind::sphere || kind == ShapeKind::ellipsoid || kind == ShapeKind::support;
  }

  /// True at a few steps if the bounds are near each other: the simplex then likely contains the
  /// closest features.
  [[nodiscard]] bool is_near(unsigned lane) const {
    const std::uint32_t steps = lanes_.steps[lane];
    if (steps != 4 && steps != 7 && steps != 12) return false;
    return lanes_.height_along[lane] > kNear * lanes_.square[lane];
  }

  /// Tests whether the closest points of the features in the simplex are the closest points of the
  /// cores. On curved sides, GJK converges ever more slowly.
  bool ends_on_features(unsigned lane) {
    CurvedPair& pair = pairs_[lane];
    const double length = __builtin_sqrt(lanes_.square[lane]);
    double near[3];
    for (int k = 0; k < 3; ++k) near[k] = -lanes_.gap[k][lane] / length;
    const bool ends =
        has_user_shape(pair) ? ends_on_tangent(pair, near) : ends_on_sum(lane, pair, near);
    if (!ends) return false;
    for (int k = 0; k < 3; ++k) pair.gap[k] = pair.difference[0][k];
    pair.count = 1;
    pair.state = CurvedState::apart;
    return true;
  }

  bool ends_on_sum(unsigned lane, CurvedPair& pair, const double* near) {
    double point[3][3];
    double on_first_core[3][3];
    const std::uint32_t count = take_simplex(lane, point, on_first_core);
    const double* corner[3];
    const double* mine[3];
    for (std::uint32_t i = 0; i < 3; ++i) {
      const std::uint32_t at = i < count ? i : count - 1;
      corner[i] = point[at];
      mine[i] = on_first_core[at];
    }
    LocalMinimum found;
    if (!found.find(pair, corner, mine, near, true)) return false;
    double w[3];
    double on_first[3];
    difference_point(pair, found.normal(), w, on_first);
    found.write_difference(pair.difference[0]);
    found.write_point(pair.on_first[0]);
    pair.upper = __builtin_sqrt(dot3(pair.difference[0], pair.difference[0]));
    pair.lower = -dot3(found.normal(), w);
    const double open = pair.upper - pair.lower;
    return open <= kClosed && open >= -Search::kNoGain;
  }

  static bool ends_on_tangent(CurvedPair& pair, const double* near) {
    TangentMinimum found;
    if (!found.find(pair, near, pair.size, true)) return false;
    for (int k = 0; k < 3; ++k) {
      pair.difference[0][k] = found.difference()[k];
      pair.on_first[0][k] = found.point()[k];
    }
    pair.upper = __builtin_sqrt(dot3(pair.difference[0], pair.difference[0]));
    pair.lower = -found.height();
    return pair.upper - pair.lower <= Search::kUserGain * pair.upper;
  }

  /// Copies the points of the simplex and the points of the first in them; returns their number.
  std::uint32_t take_simplex(unsigned lane, double (*point)[3], double (*mine)[3]) const {
    std::uint32_t count = 0;
    for (int s = 0; s < hull::kSlots; ++s) {
      if (!(lanes_.present[s][lane] > 0.0)) continue;
      for (int k = 0; k < 3; ++k) {
        point[count][k] = lanes_.slot[s][k][lane];
        mine[count][k] = lanes_.slot_mine[s][k][lane];
      }
      ++count;
    }
    return count;
  }

  void hand_back(unsigned lane) {
    CurvedPair& pair = pairs_[lane];
    pair.count = take_simplex(lane, pair.difference, pair.on_first);
    for (int k = 0; k < 3; ++k) {
      pair.difference[3][k] = lanes_.latest[k][lane];
      pair.on_first[3][k] = lanes_.latest_mine[k][lane];
    }
    pair.upper = __builtin_sqrt(lanes_.square[lane]);
    pair.lower = lanes_.height_along[lane] / pair.upper;
    for (int k = 0; k < 3; ++k) pair.gap[k] = lanes_.gap[k][lane];
  }

  hull::LanePairs<CurvedPair, kWidth> pairs_;
  bool overlap_only_;
  ShapeKind kind_[2];
  bool tries_features_;
  bool is_askew_[kWidth] = {};
  alignas(64) double number_[2][hull::kCoreNumbers][kWidth] = {};
  Search lanes_;
};

}  // namespace winnow::WINNOW_ISA_NAME::curved
