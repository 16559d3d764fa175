// GJK for two cores: `reduce` finds the point of a simplex that is closest to the origin, `iterate`
// is the loop. Called by core_distance.cpp, and by the motion code with the simplex of the step
// before.

#include "pipeline/solver/gjk.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace winnow::solver {
namespace {

/// A point of the simplex as weights of its corners, and the squared distance from the origin.
struct SimplexPoint {
  std::array<double, 4> weight{};
  double square = std::numeric_limits<double>::infinity();
};

void offer(const GjkSimplex& s, const std::array<double, 4>& weight, SimplexPoint& best) noexcept {
  Vec v = Vec::Zero();
  for (int i = 0; i < s.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (weight[k] != 0.0) v += weight[k] * s.point[k].w;
  }
  const double square = v.squaredNorm();
  if (square < best.square) best = {weight, square};
}

void try_segment(const GjkSimplex& s, std::size_t i, std::size_t j, SimplexPoint& best) noexcept {
  const Vec& p = s.point[i].w;
  const Vec& q = s.point[j].w;
  const Vec edge = q - p;
  const double length = edge.squaredNorm();
  std::array<double, 4> weight{};
  const double from_p = -p.dot(edge);
  const double from_q = q.dot(edge);
  if (!(length > 0.0) || from_p <= 0.0) {
    weight[i] = 1.0;
  } else if (from_q <= 0.0) {
    weight[j] = 1.0;
  } else if (from_p < from_q) {
    // Compute the weight of the farther end: it is the smaller one and has the smaller error.
    weight[j] = from_p / length;
    weight[i] = 1.0 - weight[j];
  } else {
    weight[i] = from_q / length;
    weight[j] = 1.0 - weight[i];
  }
  offer(s, weight, best);
}

void try_triangle(const GjkSimplex& s, std::size_t i, std::size_t j, std::size_t k,
                  SimplexPoint& best) noexcept {
  const Vec& p = s.point[i].w;
  const Vec& q = s.point[j].w;
  const Vec& r = s.point[k].w;
  const Vec n = (q - p).cross(r - p);
  const double area = n.squaredNorm();
  // Signed areas of the triangles that the origin's projection makes with the sides.
  const double ap = n.dot((q - r).cross(r));
  const double aq = n.dot((r - p).cross(p));
  const double ar = n.dot((p - q).cross(q));
  const double total = ap + aq + ar;
  if (area > 0.0 && total > 0.0 && ap >= 0.0 && aq >= 0.0 && ar >= 0.0) {
    std::array<double, 4> weight{};
    weight[i] = ap / total;
    weight[j] = aq / total;
    weight[k] = ar / total;
    offer(s, weight, best);
  }
  // The areas of a sliver have no certain signs: try its sides as well.
  const double scale = std::max({(q - p).squaredNorm(), (r - p).squaredNorm()});
  const bool sliver = !(area > 1e-16 * scale * scale);
  if (ap <= 0.0 || sliver) try_segment(s, j, k, best);
  if (aq <= 0.0 || sliver) try_segment(s, i, k, best);
  if (ar <= 0.0 || sliver) try_segment(s, i, j, best);
}

void try_tetrahedron(GjkSimplex& s, SimplexPoint& best) noexcept {
  std::array<double, 4> weight{};
  std::array<bool, 4> beyond{};
  bool inside = true;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec& p = s.point[kTetrahedronFace[i][0]].w;
    const Vec& q = s.point[kTetrahedronFace[i][1]].w;
    const Vec& r = s.point[kTetrahedronFace[i][2]].w;
    const Vec e = q - p;
    const Vec f = r - p;
    const Vec g = s.point[i].w - p;
    const Vec n = e.cross(f);
    const double height = n.dot(g);
    const double origin = -n.dot(p);
    const double largest = std::sqrt(e.squaredNorm() * f.squaredNorm());
    const double doubt = 8.0 * kEpsilon * largest * (g.norm() + p.norm());
    const bool flat = std::abs(height) <= doubt;
    weight[i] = flat ? 0.0 : origin / height;
    beyond[i] = flat || weight[i] * height * (height > 0.0 ? 1.0 : -1.0) <= doubt;
    if (flat || weight[i] < 0.0) inside = false;
  }
  const double sum = weight[0] + weight[1] + weight[2] + weight[3];
  if (inside && sum > 0.0) {
    for (double& w : weight) w /= sum;
    s.inside = true;
    best = {weight, 0.0};
    return;
  }
  bool any = false;
  for (std::size_t i = 0; i < 4; ++i) {
    if (!beyond[i]) continue;
    any = true;
    try_triangle(s, kTetrahedronFace[i][0], kTetrahedronFace[i][1], kTetrahedronFace[i][2], best);
  }
  if (any) return;
  for (const auto& face : kTetrahedronFace) try_triangle(s, face[0], face[1], face[2], best);
}

Vec weighted(const GjkSimplex& s, Vec DifferencePoint::*which) noexcept {
  Vec v = Vec::Zero();
  const auto count = static_cast<std::size_t>(s.count);
  for (std::size_t i = 0; i < count; ++i) v += s.weight[i] * (s.point[i].*which);
  return v;
}

}  // namespace

Vec GjkSimplex::closest() const noexcept {
  return weighted(*this, &DifferencePoint::w);
}
Vec GjkSimplex::on_a() const noexcept {
  return weighted(*this, &DifferencePoint::a);
}
Vec GjkSimplex::on_b() const noexcept {
  return weighted(*this, &DifferencePoint::b);
}

void reduce(GjkSimplex& simplex) noexcept {
  SimplexPoint best;
  simplex.inside = false;
  switch (simplex.count) {
    case 1:
      best.weight[0] = 1.0;
      break;
    case 2:
      try_segment(simplex, 0, 1, best);
      break;
    case 3:
      try_triangle(simplex, 0, 1, 2, best);
      break;
    default:
      try_tetrahedron(simplex, best);
      break;
  }
  const auto given = static_cast<std::size_t>(simplex.count);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < given; ++i) {
    if (best.weight[i] == 0.0 && !simplex.inside) continue;
    simplex.point[kept] = simplex.point[i];
    simplex.weight[kept] = best.weight[i];
    ++kept;
  }
  simplex.count = static_cast<int>(kept);
}

namespace {

constexpr int kIterations = 256;

DifferencePoint support_towards(const Core& a, const Core& b, const Vec& v) noexcept {
  DifferencePoint p;
  p.a = support(a, v);
  p.b = support(b, -v);
  p.w = p.b - p.a;
  return p;
}

bool contains(const GjkSimplex& simplex, const Vec& w) noexcept {
  for (int i = 0; i < simplex.count; ++i) {
    if (simplex.point[static_cast<std::size_t>(i)].w == w) return true;
  }
  return false;
}

/// Runs GJK from the closest point of the simplex in `result`.
void iterate(const Core& a, const Core& b, const GjkLimits& limits, GjkResult& result) noexcept {
  GjkSimplex& simplex = result.simplex;
  Vec v = simplex.closest();
  result.lower = -std::numeric_limits<double>::infinity();
  result.hit_limit = true;
  for (int i = 0; i < kIterations; ++i) {
    const double square = v.squaredNorm();
    const double length = std::sqrt(square);
    if (length <= limits.noise) {
      result.contact = true;
      result.hit_limit = false;
      break;
    }
    if (length < limits.near) {
      result.hit_limit = false;
      break;
    }
    const DifferencePoint p = support_towards(a, b, v);
    const double reach = v.dot(p.w);
    if (reach > result.lower * length) {
      result.lower = reach / length;
      result.axis = v / length;
    }
    result.far = result.lower > limits.enough;
    const double known =
        std::max(2.0 * kEpsilon * square, limits.share * length * (length - limits.roundings));
    if (result.far || square - reach <= known || contains(simplex, p.w)) {
      result.hit_limit = false;
      break;
    }
    const GjkSimplex before = simplex;
    simplex.point[static_cast<std::size_t>(simplex.count++)] = p;
    reduce(simplex);
    const Vec next = simplex.closest();
    if (simplex.inside) {
      result.contact = true;
      result.hit_limit = false;
      break;
    }
    if (!(next.squaredNorm() < square)) {
      simplex = before;
      result.hit_limit = false;
      break;
    }
    v = next;
  }
  if (result.contact) return;
  result.between = v;
  result.upper = v.norm();
}

}  // namespace

GjkResult gjk(const Core& a, const Core& b, const Vec& start, const GjkLimits& limits) noexcept {
  GjkResult result;
  result.simplex.point[0] = support_towards(a, b, start);
  result.simplex.weight[0] = 1.0;
  result.simplex.count = 1;
  iterate(a, b, limits, result);
  return result;
}

GjkResult gjk(const Core& a, const Core& b, const GjkSimplex& start,
              const GjkLimits& limits) noexcept {
  GjkResult result;
  result.simplex = start;
  reduce(result.simplex);
  result.contact = result.simplex.inside;
  if (!result.contact) iterate(a, b, limits, result);
  return result;
}

}  // namespace winnow::solver
