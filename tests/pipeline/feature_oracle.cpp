// Reference implementation of feature impacts: bisects the step in exact arithmetic. Used by the
// tests of feature impacts and deformable meshes.

#include "tests/pipeline/feature_oracle.h"

#include "pipeline/exact/exact_vector.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace winnow::test {
namespace {

using Points = std::array<Vec3d, 4>;

struct CornerPair {
  std::size_t a;
  std::size_t b;
};

/// Returns the pairs of points whose differences are the corners of the polygon.
std::vector<CornerPair> corners_of(FeaturePair kind) {
  if (kind == FeaturePair::vertex_face) return {{0, 1}, {0, 2}, {0, 3}};
  return {{0, 2}, {1, 2}, {1, 3}, {0, 3}};
}

ExactVector exact(const Vec3d& v) {
  return {{Dyadic(v.x()), Dyadic(v.y()), Dyadic(v.z())}};
}

/// Returns approximately the point of a polygon nearest to the origin.
Vec3d nearest_point(const std::vector<Vec3d>& corner) {
  Vec3d best = corner[0];
  const auto consider = [&](const Vec3d& q) {
    if (q.squared_norm() < best.squared_norm()) best = q;
  };
  for (std::size_t k = 0; k < corner.size(); ++k) {
    const Vec3d& a = corner[k];
    const Vec3d side = corner[(k + 1) % corner.size()] - a;
    const double square = side.squared_norm();
    const double s = square > 0.0 ? std::clamp(-a.dot(side) / square, 0.0, 1.0) : 0.0;
    Vec3d q = a + s * side;
    if (s > 0.0 && s < 1.0) q -= side * (q.dot(side) / square);
    consider(q);
  }
  const Vec3d n = (corner[1] - corner[0]).cross(corner.back() - corner[0]);
  bool inside = n.squared_norm() > 0.0;
  for (std::size_t k = 0; k < corner.size(); ++k) {
    const Vec3d& a = corner[k];
    inside = inside && n.dot(a.cross(corner[(k + 1) % corner.size()])) >= 0.0;
  }
  if (inside) consider(n * (n.dot(corner[0]) / n.squared_norm()));
  return best;
}

class ExactSearch {
 public:
  ExactSearch(FeaturePair kind, const Points& start, const Points& end) {
    for (const CornerPair& pair : corners_of(kind)) {
      start_.push_back(exact(start[pair.a]) - exact(start[pair.b]));
      end_.push_back(exact(end[pair.a]) - exact(end[pair.b]));
    }
  }

  /// Bisects [low, high], unless an earlier interval has settled the answer: it contains a touch,
  /// or the bisections ended without a proof.
  void run(double low, double high, int halvings) {
    if (settled_) return;
    const std::vector<ExactVector> first = at(low);
    const std::vector<ExactVector> last = at(high);
    const double middle = 0.5 * (low + high);
    std::vector<Vec3d> rough;
    for (const ExactVector& v : at(middle)) {
      rough.emplace_back(v.x[0].scaled(0), v.x[1].scaled(0), v.x[2].scaled(0));
    }
    if (is_apart(rough, first, last)) return;
    if (touches(rough, first, last)) {
      answer_ = {true, false, low, high};
      settled_ = true;
    } else if (halvings == 0) {
      answer_ = {false, false, low, 1.0};
      settled_ = true;
    } else {
      run(low, middle, halvings - 1);
      run(middle, high, halvings - 1);
    }
  }

  [[nodiscard]] ExactImpact answer() const {
    return settled_ ? answer_ : ExactImpact{false, true, 1.0, 1.0};
  }

 private:
  [[nodiscard]] std::vector<ExactVector> at(double time) const {
    std::vector<ExactVector> corner;
    for (std::size_t k = 0; k < start_.size(); ++k) {
      corner.push_back(start_[k] * (Dyadic(1.0) - Dyadic(time)) + end_[k] * Dyadic(time));
    }
    return corner;
  }

  static bool all_beyond(const Vec3d& direction, const std::vector<ExactVector>& corners) {
    const ExactVector n = exact(direction);
    return std::all_of(corners.begin(), corners.end(),
                       [&](const ExactVector& v) { return dot(n, v).sign() > 0; });
  }

  static bool is_apart(const std::vector<Vec3d>& rough, const std::vector<ExactVector>& first,
                       const std::vector<ExactVector>& last) {
    const Vec3d normal = (rough[1] - rough[0]).cross(rough.back() - rough[0]);
    for (const Vec3d& n : {nearest_point(rough), normal, -normal}) {
      if (n.all_finite() && all_beyond(n, first) && all_beyond(n, last)) return true;
    }
    return false;
  }

  static int volume_sign(const std::vector<ExactVector>& corner) {
    return dot(corner[0], cross(corner[1] - corner[0], corner.back() - corner[0])).sign();
  }

  static bool touches(const std::vector<Vec3d>& rough, const std::vector<ExactVector>& first,
                      const std::vector<ExactVector>& last) {
    if (volume_sign(first) * volume_sign(last) > 0) return false;
    const Vec3d along = (rough[1] - rough[0]).cross(rough.back() - rough[0]);
    if (!along.all_finite()) return false;
    const ExactVector w = exact(along);
    for (std::size_t k = 0; k < first.size(); ++k) {
      const std::size_t next = (k + 1) % first.size();
      // Bernstein coefficients of a quadratic polynomial. The middle one is doubled.
      const ExactVector mixed = cross(first[k], last[next]) + cross(last[k], first[next]);
      if (dot(w, cross(first[k], first[next])).sign() <= 0 || dot(w, mixed).sign() <= 0 ||
          dot(w, cross(last[k], last[next])).sign() <= 0) {
        return false;
      }
    }
    return true;
  }

  std::vector<ExactVector> start_;
  std::vector<ExactVector> end_;
  ExactImpact answer_;
  bool settled_ = false;
};

}  // namespace

ExactImpact exact_impact(FeaturePair kind, const Points& start, const Points& end, int halvings) {
  ExactSearch search(kind, start, end);
  search.run(0.0, 1.0, halvings);
  return search.answer();
}

double feature_distance(FeaturePair kind, const Points& start, const Points& end, double time) {
  std::vector<Vec3d> corner;
  for (const CornerPair& pair : corners_of(kind)) {
    const Vec3d a = start[pair.a] - start[pair.b];
    corner.push_back(a + time * ((end[pair.a] - end[pair.b]) - a));
  }
  return nearest_point(corner).norm();
}

}  // namespace winnow::test
