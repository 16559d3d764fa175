#include "pipeline/solver/gjk.h"

#include <cmath>

namespace winnow::solver {
namespace {

constexpr int kIterations = 256;

DifferencePoint support_towards(const Core& a, const Core& b, const Vec& v) noexcept {
  DifferencePoint p;
  p.a = support(a, v);
  p.b = support(b, -v);
  p.w = p.b - p.a;
  return p;
}

bool holds(const Simplex& simplex, const Vec& w) noexcept {
  for (int i = 0; i < simplex.count; ++i) {
    if (simplex.point[static_cast<std::size_t>(i)].w == w) return true;
  }
  return false;
}

}  // namespace

GjkResult gjk(const Core& a, const Core& b, const Vec& start, double noise,
              double enough) noexcept {
  GjkResult result;
  Simplex& simplex = result.simplex;
  simplex.point[0] = support_towards(a, b, start);
  simplex.weight[0] = 1.0;
  simplex.count = 1;
  Vec v = simplex.point[0].w;
  result.lower = -std::numeric_limits<double>::infinity();
  result.bounded = true;
  for (int i = 0; i < kIterations; ++i) {
    const double square = v.squaredNorm();
    const double length = std::sqrt(square);
    if (length <= noise) {
      result.contact = true;
      result.bounded = false;
      break;
    }
    const DifferencePoint p = support_towards(a, b, v);
    const double reach = v.dot(p.w);
    if (reach > result.lower * length) {
      result.lower = reach / length;
      result.axis = v / length;
    }
    result.far = result.lower > enough;
    if (result.far || square - reach <= 2.0 * kEpsilon * square || holds(simplex, p.w)) {
      result.bounded = false;
      break;
    }
    const Simplex before = simplex;
    simplex.point[static_cast<std::size_t>(simplex.count++)] = p;
    reduce(simplex);
    const Vec next = simplex.closest();
    if (simplex.inside) {
      result.contact = true;
      result.bounded = false;
      break;
    }
    if (!(next.squaredNorm() < square)) {
      simplex = before;
      result.bounded = false;
      break;
    }
    v = next;
  }
  if (result.contact) return result;
  result.between = v;
  result.upper = v.norm();
  return result;
}

}  // namespace winnow::solver
