#include "pipeline/solver/closest_features.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace winnow::solver {
namespace {

constexpr std::uint64_t kMostPairs = 4'000'000;

/// The part of a polytope in which the closest point lies: axis . x above `from`.
struct Slab {
  const Core& core;
  Vec axis;
  double from;

  [[nodiscard]] bool has(std::uint32_t i) const noexcept {
    return axis.dot(vertex(core, i)) >= from;
  }
};

void offer(const Vec& on_a, const Vec& on_b, ClosestPoints& best) noexcept {
  const double square = (on_b - on_a).squaredNorm();
  if (square < best.square) best = {on_a, on_b, square};
}

/// Nearest point of the segment p + [0, 1] e.
Vec on_segment(const Vec& p, const Vec& e, const Vec& x) noexcept {
  const double square = e.squaredNorm();
  if (!(square > 0.0)) return p;
  return p + e * std::clamp(e.dot(x - p) / square, 0.0, 1.0);
}

/// All ends against the other segment, and the insides of both by the parts of everything that are
/// perpendicular to the longer one: that stays right to rounding at small angles, where the usual
/// determinant loses twice as many digits.
void edge_edge(const Vec& p, const Vec& e, const Vec& q, const Vec& f, bool flip,
               ClosestPoints& best) noexcept {
  const auto put = [&](const Vec& x, const Vec& y) {
    flip ? offer(y, x, best) : offer(x, y, best);
  };
  put(p, on_segment(q, f, p));
  put(p + e, on_segment(q, f, p + e));
  put(on_segment(p, e, q), q);
  put(on_segment(p, e, q + f), q + f);
  const Vec u = unit(e);
  const Vec across = f - u * u.dot(f);
  const double square = across.squaredNorm();
  if (!(square > 0.0)) return;
  const double t = across.dot(p - q) / square;
  if (!(t > 0.0 && t < 1.0)) return;
  const Vec y = q + f * t;
  put(on_segment(p, e, y), y);
}

bool edges(const Slab& a, const Slab& b, ClosestPoints& best) noexcept {
  // A point is an edge without length.
  const std::uint32_t count_a = std::max(edge_count(a.core), 1U);
  const std::uint32_t count_b = std::max(edge_count(b.core), 1U);
  std::uint64_t pairs = 0;
  const auto ends = [](const Core& core, std::uint32_t i) {
    return edge_count(core) == 0 ? std::array<std::uint32_t, 2>{0, 0} : edge(core, i);
  };
  for (std::uint32_t i = 0; i < count_a; ++i) {
    const auto [a0, a1] = ends(a.core, i);
    if (!a.has(a0) && !a.has(a1)) continue;
    const Vec p = vertex(a.core, a0);
    const Vec e = vertex(a.core, a1) - p;
    pairs += count_b;
    if (pairs > kMostPairs) return false;
    for (std::uint32_t k = 0; k < count_b; ++k) {
      const auto [b0, b1] = ends(b.core, k);
      if (!b.has(b0) && !b.has(b1)) continue;
      const Vec q = vertex(b.core, b0);
      const Vec f = vertex(b.core, b1) - q;
      if (e.squaredNorm() >= f.squaredNorm()) {
        edge_edge(p, e, q, f, false, best);
      } else {
        edge_edge(q, f, p, e, true, best);
      }
    }
  }
  return true;
}

/// Surely above the inside of a face; what is not is nearer to an edge, or as near. Faces without
/// area have no inside.
bool above_face(const Core& core, std::uint32_t face, const Vec& n, const Vec& x) noexcept {
  const std::uint32_t count = face_size(core, face);
  Vec p = vertex(core, face_vertex(core, face, count - 1));
  for (std::uint32_t i = 0; i < count; ++i) {
    const Vec q = vertex(core, face_vertex(core, face, i));
    const Vec side = q - p;
    const Vec to = x - p;
    const double doubt = 8.0 * kEpsilon * std::sqrt(side.squaredNorm() * to.squaredNorm());
    if (!(n.dot(side.cross(to)) > doubt)) return false;
    p = q;
  }
  return true;
}

bool corners_faces(const Slab& corners, const Slab& faces, bool flip,
                   ClosestPoints& best) noexcept {
  std::uint64_t pairs = 0;
  for (std::uint32_t i = 0; i < vertex_count(corners.core); ++i) {
    if (!corners.has(i)) continue;
    const Vec x = vertex(corners.core, i);
    pairs += face_count(faces.core);
    if (pairs > kMostPairs) return false;
    for (std::uint32_t face = 0; face < face_count(faces.core); ++face) {
      const Vec n = face_normal(faces.core, face);
      const double height = n.dot(x - vertex(faces.core, face_vertex(faces.core, face, 0)));
      if (height * height >= best.square || !above_face(faces.core, face, n, x)) continue;
      const Vec foot = x - n * height;
      flip ? offer(foot, x, best) : offer(x, foot, best);
    }
  }
  return true;
}

}  // namespace

bool closest_features(const Core& a, const Core& b, const Vec& axis, double lower, double upper,
                      double noise, ClosestPoints& points) noexcept {
  const double depth = upper - lower + noise;
  const Slab of_a{a, axis, axis.dot(a.center) + project(a, axis).high - depth};
  const Slab of_b{b, -axis, -axis.dot(b.center) - project(b, axis).low - depth};
  return corners_faces(of_a, of_b, false, points) && corners_faces(of_b, of_a, true, points) &&
         edges(of_a, of_b, points);
}

}  // namespace winnow::solver
