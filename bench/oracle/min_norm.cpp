// GJK in double and in Number (100 digits): finds the point of the Minkowski difference of two
// polytopes that is nearest to the origin. Each iteration tries all subsets of the simplex. A
// supporting plane gives a lower bound of the distance, which proves the result. Called by
// oracle.cpp.

#include "bench/oracle/min_norm.h"

#include <algorithm>
#include <limits>
#include <type_traits>

namespace winnow::oracle {
namespace {

template <typename T>
constexpr bool is_exact = std::is_same_v<T, Number>;

/// Relative determinants below this count as zero.
template <typename T>
T singular() {
  return is_exact<T> ? T(1e-92) : T(1e-22);
}
/// Widths below this are rounding errors.
template <typename T>
T negligible() {
  return is_exact<T> ? T(1e-60) : T(1e-14);
}

template <typename T>
Vector<T> difference(const Polytope& a, const Polytope& b, Simplex::Corner corner) {
  if constexpr (is_exact<T>) {
    return b.vertex[corner.b] - a.vertex[corner.a];
  } else {
    return b.vertex_double[corner.b] - a.vertex_double[corner.a];
  }
}

/// Returns the farthest vertex along `sign` * n. Doubles select the candidates that are compared in
/// Number.
std::pair<std::uint32_t, Number> extreme(const Polytope& core, const Vector<Number>& n, int sign) {
  const Vector<double> guide = rounded(n * Number(sign));
  double best = -std::numeric_limits<double>::infinity();
  for (const Vector<double>& v : core.vertex_double) best = std::max(best, dot(guide, v));
  std::pair<std::uint32_t, Number> found{0, 0};
  bool any = false;
  for (std::uint32_t i = 0; i < core.vertex.size(); ++i) {
    if (dot(guide, core.vertex_double[i]) < best - 1e-13) continue;
    const Number value = dot(n, core.vertex[i]);
    if (!any || (sign > 0 ? value > found.second : value < found.second)) found = {i, value};
    any = true;
  }
  return found;
}

/// Computes the point of the affine hull of up to four points that is nearest to the origin.
/// Returns true if it is in the interior of their simplex.
template <typename T>
bool nearest_inside(const Vector<T>* w, int count, Vector<T>& nearest) {
  const Vector<T> e[3] = {count > 1 ? w[1] - w[0] : Vector<T>{},
                          count > 2 ? w[2] - w[0] : Vector<T>{},
                          count > 3 ? w[3] - w[0] : Vector<T>{}};
  T part[3]{};
  if (count == 2) {
    const T square = dot(e[0], e[0]);
    if (square == 0) return false;
    part[0] = -dot(e[0], w[0]) / square;
  } else if (count == 3) {
    const Vector<T> n = cross(e[0], e[1]);
    const T square = dot(n, n);
    if (square <= singular<T>() * dot(e[0], e[0]) * dot(e[1], e[1])) return false;
    part[0] = dot(cross(e[1], w[0]), n) / square;
    part[1] = dot(cross(w[0], e[0]), n) / square;
  } else if (count == 4) {
    const T volume = dot(e[0], cross(e[1], e[2]));
    const T scale = dot(e[0], e[0]) * dot(e[1], e[1]) * dot(e[2], e[2]);
    if (volume * volume <= singular<T>() * scale) return false;
    part[0] = -dot(w[0], cross(e[1], e[2])) / volume;
    part[1] = -dot(e[0], cross(w[0], e[2])) / volume;
    part[2] = -dot(e[0], cross(e[1], w[0])) / volume;
  }
  const T rest = T(1) - part[0] - part[1] - part[2];
  if (part[0] < 0 || part[1] < 0 || part[2] < 0 || rest < 0) return false;
  nearest = count == 4 ? Vector<T>{} : w[0] + e[0] * part[0] + e[1] * part[1] + e[2] * part[2];
  return true;
}

/// Returns the point of the simplex nearest to the origin, and removes the corners that do not
/// support it.
template <typename T>
Vector<T> reduce(const Polytope& a, const Polytope& b, Simplex& simplex) {
  const int count = static_cast<int>(simplex.corner.size());
  Vector<T> best;
  T best_square = -1;
  std::vector<Simplex::Corner> kept;
  for (unsigned subset = 1; subset < 1U << count; ++subset) {
    Vector<T> w[4];
    std::vector<Simplex::Corner> corners;
    for (int i = 0; i < count; ++i) {
      if ((subset >> i & 1U) == 0) continue;
      w[corners.size()] = difference<T>(a, b, simplex.corner[static_cast<std::size_t>(i)]);
      corners.push_back(simplex.corner[static_cast<std::size_t>(i)]);
    }
    Vector<T> point;
    if (!nearest_inside(w, static_cast<int>(corners.size()), point)) continue;
    const T square = dot(point, point);
    if (best_square < 0 || square < best_square) {
      best = point;
      best_square = square;
      kept = corners;
    }
  }
  simplex.corner = kept;
  return best;
}

}  // namespace

Gap<double> gap_along(const Polytope& a, const Polytope& b, const Vector<double>& n) {
  Gap<double> gap;
  double far_a = -std::numeric_limits<double>::infinity();
  double near_b = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < a.vertex_double.size(); ++i) {
    const double value = dot(n, a.vertex_double[i]);
    if (value > far_a) gap.a = i;
    far_a = std::max(far_a, value);
  }
  for (std::uint32_t i = 0; i < b.vertex_double.size(); ++i) {
    const double value = dot(n, b.vertex_double[i]);
    if (value < near_b) gap.b = i;
    near_b = std::min(near_b, value);
  }
  gap.width = near_b - far_a;
  return gap;
}

Gap<Number> gap_along(const Polytope& a, const Polytope& b, const Vector<Number>& n) {
  const auto far_a = extreme(a, n, 1);
  const auto near_b = extreme(b, n, -1);
  return {near_b.second - far_a.second, far_a.first, near_b.first};
}

template <typename T>
Nearest<T> nearest_point(const Polytope& a, const Polytope& b, Simplex& simplex) {
  constexpr int kRounds = is_exact<T> ? 400 : 60;
  Nearest<T> result;
  for (int round = 0; round < kRounds; ++round) {
    result.point = reduce<T>(a, b, simplex);
    result.upper = length(result.point);
    if (result.upper <= negligible<T>()) {
      result.lower = 0;
      result.proven = true;
      break;
    }
    const Gap<T> gap = gap_along(a, b, result.point * (T(1) / result.upper));
    result.lower = gap.width;
    result.proven = result.upper - result.lower <= negligible<T>();
    const Simplex::Corner next{gap.a, gap.b};
    const auto& has = simplex.corner;
    if (result.proven || std::find(has.begin(), has.end(), next) != has.end()) break;
    if (simplex.corner.size() == 4) break;
    simplex.corner.push_back(next);
  }
  return result;
}

template Nearest<double> nearest_point(const Polytope&, const Polytope&, Simplex&);
template Nearest<Number> nearest_point(const Polytope&, const Polytope&, Simplex&);

}  // namespace winnow::oracle
