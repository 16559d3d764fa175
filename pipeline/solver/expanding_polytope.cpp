#include "pipeline/solver/expanding_polytope.h"

#include "pipeline/solver/inner_polytope.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow::solver {
namespace {

/// Grows a polytope inside of the difference b - a.
class Expansion {
 public:
  Expansion(const Core& a, const Core& b, double noise) noexcept
      : a_(a), b_(b), noise_(noise), inner_(noise) {}

  /// Completes the simplex to a tetrahedron; false if the difference is flat: see bounds().
  bool begin(const Simplex& simplex) noexcept;
  void grow(double tolerance) noexcept;
  [[nodiscard]] const DepthBounds& bounds() const noexcept { return bounds_; }

 private:
  [[nodiscard]] Vec support_along(const Vec& d) const noexcept {
    return support(b_, d) - support(a_, -d);
  }
  bool add_farther(const Vec& direction) noexcept;
  bool add_along(const Vec& direction, const Vec& opposite) noexcept;
  bool flat_along(const Vec& n) noexcept;

  const Core& a_;
  const Core& b_;
  double noise_;
  DepthBounds bounds_;
  InnerPolytope inner_;
};

/// Adds the support along the direction if it is farther than the points so far, in a direction in
/// which they are all alike.
bool Expansion::add_farther(const Vec& direction) noexcept {
  if (direction == Vec::Zero()) return false;
  const Vec w = support_along(direction);
  if (direction.dot(w - inner_.point(0)) <= noise_) return false;
  inner_.add(w);
  return true;
}

bool Expansion::add_along(const Vec& direction, const Vec& opposite) noexcept {
  return add_farther(direction) || add_farther(opposite);
}

bool Expansion::flat_along(const Vec& n) noexcept {
  const double forward = n.dot(support_along(n));
  const double backward = -n.dot(support_along(-n));
  bounds_.axis = std::abs(forward) <= std::abs(backward) ? Vec(-n) : n;
  bounds_.upper = std::max(0.0, std::min(std::abs(forward), std::abs(backward)));
  return false;
}

bool Expansion::begin(const Simplex& simplex) noexcept {
  for (std::size_t i = 0; i < static_cast<std::size_t>(simplex.count); ++i) {
    inner_.add(simplex.point[i].w);
  }
  if (inner_.point_count() == 4) {
    return inner_.make_tetrahedron() || flat_along(Vec::UnitX());
  }
  for (int i = 0; i < 3 && inner_.point_count() < 2; ++i) add_along(Vec::Unit(i), -Vec::Unit(i));
  if (inner_.point_count() < 2) return flat_along(Vec::UnitX());
  const Vec line = unit(inner_.point(1) - inner_.point(0));
  int least = 0;
  line.cwiseAbs().minCoeff(&least);
  const Vec side = without(Vec::Unit(least), line);
  const Vec other = line.cross(side);
  if (inner_.point_count() < 3 && !add_along(side, -side) && !add_along(other, -other)) {
    return flat_along(side);
  }
  const Vec n = perpendicular(line, unit(inner_.point(2) - inner_.point(0)));
  if (n == Vec::Zero()) return flat_along(side);
  // The side on which there is more, so that thin differences get their better tetrahedron.
  const double above = n.dot(support_along(n) - inner_.point(0));
  const double below = n.dot(inner_.point(0) - support_along(-n));
  const Vec better = above >= below ? n : Vec(-n);
  if (!add_farther(better)) return flat_along(n);
  return inner_.make_tetrahedron() || flat_along(n);
}

void Expansion::grow(double tolerance) noexcept {
  bounds_.upper = std::numeric_limits<double>::infinity();
  // Of faces that were looked at and can grow no more.
  double settled = std::numeric_limits<double>::infinity();
  std::uint16_t nearest = 0;
  while (inner_.take_nearest(nearest)) {
    const InnerPolytope::Face& face = inner_.face(nearest);
    bounds_.lower = std::min(settled, face.low);
    if (bounds_.upper - bounds_.lower <= tolerance) break;
    const Vec w = support_along(face.normal);
    const double high = face.normal.dot(w);
    if (high < bounds_.upper) {
      bounds_.upper = high;
      // The difference is b - a: its outward normals run from b to a.
      bounds_.axis = -face.normal;
    }
    if (bounds_.upper - bounds_.lower <= tolerance) break;
    if (inner_.height(face, w) <= 0.125 * noise_) {
      settled = std::min(settled, face.low);
      inner_.settle(nearest);
      continue;
    }
    if (!inner_.attach(w, nearest)) {
      settled = std::min(settled, face.low);
      break;
    }
  }
  bounds_.lower = std::clamp(std::min(bounds_.lower, settled), 0.0, std::max(bounds_.upper, 0.0));
}

}  // namespace

DepthBounds expand(const Core& a, const Core& b, const Simplex& simplex, double noise,
                   double tolerance) noexcept {
  Expansion expansion(a, b, noise);
  if (expansion.begin(simplex)) expansion.grow(tolerance);
  return expansion.bounds();
}

}  // namespace winnow::solver
