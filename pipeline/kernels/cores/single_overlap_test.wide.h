#pragma once

// Overlap test of a single pair of convex shapes in double, by GJK (Gilbert, Johnson, Keerthi
// 1988). It ends as soon as a direction separates the shapes or points of the simplex prove an
// overlap. The lane version (overlap_test.wide.h) is wasteful for one pair.

#include "pipeline/kernels/cores/curved_pair.wide.h"
#include "pipeline/kernels/cores/overlap_test.wide.h"

namespace winnow::WINNOW_ISA_NAME::curved {

class SingleOverlapTest {
 public:
  /// Answers a job of one pair, or adds it to `uncertified`; returns the number of pairs there.
  [[gnu::noinline]] static std::uint32_t run(NarrowJob& job) {
    CurvedPair pair;
    if (place_pair(job, job.pairs[0], pair)) {
      SingleOverlapTest single_test(pair);
      const OverlapResult found = single_test.find();
      job.overlap[0] = found == OverlapResult::overlapping ? 1 : 0;
      if (found != OverlapResult::unsure) return 0;
    }
    job.uncertified[0] = 0;
    return 1;
  }

 private:
  enum class OverlapResult : std::uint8_t { unsure, apart, overlapping };
  using Point = double[3];

  /// Tolerance of lengths, which are below 2. It is far above the rounding errors, and equals the
  /// tolerance of the lanes, so that a single pair is certified for the same distances as in a
  /// larger job.
  static constexpr double kLengthError = static_cast<double>(hull::OverlapTest::kLengthError);
  /// Tolerance of the product of a length and two edges.
  static constexpr double kPlaneError = 1e-14;
  /// The search stops if |v|^2 - v . w is at most this fraction of |v|^2, where v is the point of
  /// the simplex nearest to the origin and w the new support point.
  static constexpr double kNoGain = 1e-14;
  static constexpr int kMaxSteps = 48;
  /// If the nearest point is closer to the origin than this, it is not used as a direction.
  static constexpr double kNowhere = 1e-15;

  explicit SingleOverlapTest(const CurvedPair& pair) : pair_(pair) {}

  [[nodiscard]] OverlapResult find() {
    begin();
    const double near = pair_.rounding - kLengthError;
    const double far = pair_.rounding + kLengthError;
    for (int step = 0; step < kMaxSteps; ++step) {
      const double square = dot3(nearest_, nearest_);
      if (count_ > 0 && near > 0.0 && square < near * near) return OverlapResult::overlapping;
      if (!(square > kNowhere * kNowhere)) return OverlapResult::unsure;
      const Point towards{-nearest_[0], -nearest_[1], -nearest_[2]};
      Point mine;
      Point found;
      difference_point(pair_, towards, found, mine);
      const double height = dot3(nearest_, found);
      if (height > 0.0 && height * height > far * far * square) return OverlapResult::apart;
      if (count_ > 0 && square - height <= kNoGain * square) return OverlapResult::unsure;
      if (contains_origin(found)) return OverlapResult::overlapping;
    }
    return OverlapResult::unsure;
  }

  /// Starts from the difference of two inner points, which is a point of the simplex. No inner
  /// point of a user shape is available; the difference is then only a direction.
  void begin() {
    Point theirs;
    turn3(pair_.turn, pair_.second.center, theirs);
    for (int k = 0; k < 3; ++k) {
      nearest_[k] = pair_.first.center[k] - (theirs[k] + pair_.shift[k]);
    }
    if (!has_user_shape(pair_)) put(nearest_);
  }

  /// Adds a point and moves `nearest_` to the point of the simplex that is nearest to the origin;
  /// returns true if the simplex certainly contains the origin.
  [[nodiscard]] bool contains_origin(const Point& w) {
    switch (count_) {
      case 0:
        put(w);
        for (int k = 0; k < 3; ++k) nearest_[k] = w[k];
        return false;
      case 1:
        to_segment(w);
        return false;
      case 2: {
        const Nearest nearest = of_triangle(w, point_[0], point_[1]);
        take(w, nearest, point_[0], point_[1]);
        return false;
      }
      default:
        return tetrahedron_contains_origin(w);
    }
  }

  void to_segment(const Point& w) {
    Point edge;
    for (int k = 0; k < 3; ++k) edge[k] = point_[0][k] - w[k];
    const double place = -dot3(edge, w);
    const double square = dot3(edge, edge);
    const double share = place <= 0.0 ? 0.0 : place < square ? place / square : 1.0;
    take(
        w,
        {share, 0.0, {w[0] + share * edge[0], w[1] + share * edge[1], w[2] + share * edge[2]}, 0.0},
        point_[0], point_[0]);
  }

  /// A point of the triangle w, a, b: w + s (a - w) + t (b - w), and its squared distance from the
  /// origin.
  struct Nearest {
    double s;
    double t;
    Point at;
    double square;
  };

  /// Returns the point nearest to the origin, by the Voronoi regions of the triangle's features
  /// (Ericson, "Real-time collision detection", 5.1.5).
  [[nodiscard]] static Nearest of_triangle(const Point& w, const Point& a, const Point& b) {
    Point to_a;
    Point to_b;
    for (int k = 0; k < 3; ++k) {
      to_a[k] = a[k] - w[k];
      to_b[k] = b[k] - w[k];
    }
    const double a_at_w = -dot3(to_a, w);
    const double b_at_w = -dot3(to_b, w);
    const double a_at_a = -dot3(to_a, a);
    const double b_at_a = -dot3(to_b, a);
    const double a_at_b = -dot3(to_a, b);
    const double b_at_b = -dot3(to_b, b);
    const double across_b = a_at_w * b_at_a - a_at_a * b_at_w;
    const double across_a = a_at_b * b_at_w - a_at_w * b_at_b;
    const double across_w = a_at_a * b_at_b - a_at_b * b_at_a;
    Nearest r{0.0, 0.0, {}, 0.0};
    if (a_at_w <= 0.0 && b_at_w <= 0.0) {
      // The point is w.
    } else if (a_at_a >= 0.0 && b_at_a <= a_at_a) {
      r.s = 1.0;
    } else if (b_at_b >= 0.0 && a_at_b <= b_at_b) {
      r.t = 1.0;
    } else if (across_b <= 0.0 && a_at_w >= 0.0 && a_at_a <= 0.0) {
      r.s = a_at_w / (a_at_w - a_at_a);
    } else if (across_a <= 0.0 && b_at_w >= 0.0 && b_at_b <= 0.0) {
      r.t = b_at_w / (b_at_w - b_at_b);
    } else if (across_w <= 0.0 && b_at_a >= a_at_a && a_at_b >= b_at_b) {
      const double from_a = b_at_a - a_at_a;
      r.t = from_a / (from_a + (a_at_b - b_at_b));
      r.s = 1.0 - r.t;
    } else {
      const double over = 1.0 / (across_w + across_a + across_b);
      r.s = across_a * over;
      r.t = across_b * over;
    }
    for (int k = 0; k < 3; ++k) r.at[k] = w[k] + r.s * to_a[k] + r.t * to_b[k];
    r.square = dot3(r.at, r.at);
    return r;
  }

  /// The feature that contains the point becomes the simplex.
  void take(const Point& w, const Nearest& nearest, const Point& a, const Point& b) {
    const Point old[2] = {{a[0], a[1], a[2]}, {b[0], b[1], b[2]}};
    for (int k = 0; k < 3; ++k) nearest_[k] = nearest.at[k];
    count_ = 0;
    if (nearest.s + nearest.t < 1.0) put(w);
    if (nearest.s > 0.0) put(old[0]);
    if (nearest.t > 0.0) put(old[1]);
  }
  void put(const Point& p) {
    for (int k = 0; k < 3; ++k) point_[count_][k] = p[k];
    ++count_;
  }

  [[nodiscard]] bool tetrahedron_contains_origin(const Point& w) {
    // The three faces at w, and the corner opposite to each.
    constexpr int kSide[3][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}};
    bool contained = is_inside(point_[0], point_[1], point_[2], w);
    Nearest best{0.0, 0.0, {}, __builtin_inf()};
    int at = 0;
    for (int i = 0; i < 3; ++i) {
      const int* const side = kSide[i];
      if (is_inside(w, point_[side[0]], point_[side[1]], point_[side[2]])) continue;
      contained = false;
      const Nearest nearest = of_triangle(w, point_[side[0]], point_[side[1]]);
      if (nearest.square >= best.square) continue;
      best = nearest;
      at = i;
    }
    if (contained || !(best.square < __builtin_inf())) return contained;
    take(w, best, point_[kSide[at][0]], point_[kSide[at][1]]);
    return false;
  }

  /// True if the origin is certainly on the same side of a triangle's plane as the fourth point.
  [[nodiscard]] bool is_inside(const Point& p, const Point& q, const Point& r,
                               const Point& fourth) const {
    Point to_q;
    Point to_r;
    Point to_fourth;
    Point n;
    for (int k = 0; k < 3; ++k) {
      to_q[k] = q[k] - p[k];
      to_r[k] = r[k] - p[k];
      to_fourth[k] = fourth[k] - p[k];
    }
    cross3(to_q, to_r, n);
    const double origin = -dot3(n, p);
    const double height = dot3(n, to_fourth);
    // For slivers the normal is mostly rounding error, which is proportional to the edges' lengths,
    // not to the normal's.
    const double edges = __builtin_sqrt(dot3(to_q, to_q) * dot3(to_r, to_r));
    const double limit = kLengthError * __builtin_sqrt(dot3(n, n)) + kPlaneError * edges;
    return __builtin_fabs(origin) > limit && __builtin_fabs(height) > limit &&
           (origin > 0.0) == (height > 0.0);
  }

  const CurvedPair& pair_;
  /// Points of the difference, and the point of their hull that is nearest to the origin.
  int count_ = 0;
  Point point_[3];
  Point nearest_;
};

/// Decides the pairs that are certain and lists the others in `uncertified`; returns their number.
static inline std::uint32_t overlap_test(NarrowJob& job) {
  return job.count == 1 ? SingleOverlapTest::run(job) : hull::OverlapTest::run(job);
}

}  // namespace winnow::WINNOW_ISA_NAME::curved
