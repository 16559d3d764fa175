// Exact GJK on the Minkowski difference of two cores, without rounding: decides whether the origin
// is outside, on the boundary or inside. exact_overlap.cpp calls `locate_origin`.

#include "pipeline/exact/exact_gjk.h"

namespace winnow {
namespace {

/// Up to four affinely independent points, the newest last.
struct ExactSimplex {
  int size = 0;
  ExactVector point[4];
};

/// Returns whether the origin projects into the interior of the segment; `toward` then becomes a
/// direction from the segment to the origin.
[[nodiscard]] bool is_beside_segment(const ExactVector& a, const ExactVector& b,
                                     ExactVector& toward) noexcept {
  const ExactVector edge = b - a;
  const Dyadic along = dot(a, edge);
  if (along.sign() >= 0 || dot(b, edge).sign() <= 0) return false;
  toward = edge * along - a * dot(edge, edge);
  return true;
}

/// As above, for a triangle; `toward` is zero if the origin is in it.
[[nodiscard]] bool is_beside_triangle(const ExactVector& a, const ExactVector& b,
                                      const ExactVector& c, ExactVector& toward) noexcept {
  const ExactVector normal = cross(b - a, c - a);
  if (dot(normal, cross(b, c)).sign() <= 0 || dot(normal, cross(c, a)).sign() <= 0 ||
      dot(normal, cross(a, b)).sign() <= 0) {
    return false;
  }
  const int side = dot(normal, a).sign();
  toward = side > 0 ? -normal : side < 0 ? normal : ExactVector{};
  return true;
}

/// The points of a simplex selected by a bit mask.
struct SimplexFace {
  int count = 0;
  int index[4] = {};
};

[[nodiscard]] SimplexFace face_of(unsigned mask) noexcept {
  SimplexFace face;
  for (int i = 0; i < 4; ++i) {
    if ((mask >> i & 1U) != 0) face.index[face.count++] = i;
  }
  return face;
}

/// Johnson's conditions for the face `mask`; see keep_nearest_face.
[[nodiscard]] bool is_nearest(const ExactSimplex& s, unsigned mask, ExactVector& toward) noexcept {
  const SimplexFace face = face_of(mask);
  const ExactVector& first = s.point[face.index[0]];
  bool is_beside = true;
  switch (face.count) {
    case 1:
      toward = -first;
      break;
    case 2:
      is_beside = is_beside_segment(first, s.point[face.index[1]], toward);
      break;
    default:
      is_beside = is_beside_triangle(first, s.point[face.index[1]], s.point[face.index[2]], toward);
  }
  if (!is_beside) return false;
  const Dyadic plane = dot(toward, first);
  for (int i = 0; i < s.size; ++i) {
    if ((mask >> i & 1U) == 0 && compare(dot(toward, s.point[i]), plane) > 0) return false;
  }
  return true;
}

void keep(ExactSimplex& s, unsigned mask) noexcept {
  int kept = 0;
  for (int i = 0; i < s.size; ++i) {
    if ((mask >> i & 1U) == 0) continue;
    if (kept != i) s.point[kept] = s.point[i];
    ++kept;
  }
  s.size = kept;
}

/// Reduces the simplex to the smallest face that contains the point nearest to the origin; this
/// face contains the newest point. `toward` becomes a direction from the nearest point to the
/// origin, or zero if they coincide: the origin then lies in the relative interior of the face.
///
/// Tests faces by increasing dimension. A face is the nearest if the origin projects into its
/// interior and the other points are behind the plane through it (Johnson's conditions, in GJK:
/// Gilbert, Johnson and Keerthi 1988), so that no distances are compared.
void keep_nearest_face(ExactSimplex& simplex, ExactVector& toward) noexcept {
  const unsigned newest = 1U << (simplex.size - 1);
  for (int count = 1; count <= 3; ++count) {
    for (unsigned mask = newest; mask < 2 * newest; ++mask) {
      if (face_of(mask).count != count || !is_nearest(simplex, mask, toward)) continue;
      keep(simplex, mask);
      return;
    }
  }
  toward = ExactVector{};
}

/// Sign of (squared distance of the origin from the face that keep_nearest_face kept) - `square`.
[[nodiscard]] int compare_square_distance(const ExactSimplex& face, const Dyadic& square) noexcept {
  const ExactVector& a = face.point[0];
  if (face.size == 1) return compare(dot(a, a), square);
  const ExactVector edge = face.point[1] - a;
  if (face.size == 2) {
    const Dyadic along = dot(a, edge);
    const Dyadic length = dot(edge, edge);
    return compare(dot(a, a) * length - along * along, square * length);
  }
  const ExactVector normal = cross(edge, face.point[2] - a);
  const Dyadic height = dot(normal, a);
  return compare(height * height, square * dot(normal, normal));
}

/// GJK (Gilbert, Johnson and Keerthi 1988) in exact arithmetic: descends towards the origin until
/// the simplex contains it (returns true) or `is_end(direction, height)` is true for a support
/// point. Each step gets strictly closer to the origin, so no simplex recurs and the loop
/// terminates.
template <typename End>
[[nodiscard]] bool descend(const CoreDifference& difference, const End& is_end,
                           ExactVector direction, ExactSimplex& simplex) noexcept {
  Dyadic height;
  while (!is_zero(direction)) {
    difference.support(direction, simplex.point[simplex.size], height);
    if (is_end(direction, height)) return false;
    ++simplex.size;
    keep_nearest_face(simplex, direction);
  }
  return true;
}

/// A direction orthogonal to `line`, near `hint` if `hint` is not parallel to `line`.
[[nodiscard]] ExactVector across(const ExactVector& line, const ExactVector& hint) noexcept {
  ExactVector side = cross(cross(line, hint), line);
  if (!is_zero(side)) return side;
  const bool is_upright = line.x[0].sign() == 0 && line.x[1].sign() == 0;
  return cross(line, is_upright ? ExactVector{{1.0, 0.0, 0.0}} : ExactVector{{0.0, 0.0, 1.0}});
}

/// Returns whether no point of the difference is strictly beyond the plane through the origin with
/// normal `direction`. `vertex` becomes the support point.
[[nodiscard]] bool supports(const CoreDifference& difference, const ExactVector& direction,
                            ExactVector& vertex) noexcept {
  Dyadic height;
  difference.support(direction, vertex, height);
  return height.sign() <= 0;
}

/// Decides the case that the origin is in the interior of a segment of the difference along `line`.
/// A supporting plane would contain the line, so that the problem is two-dimensional, in the plane
/// orthogonal to the line: rotate a half-plane from each support point to the next, until it
/// contains no points (touching) or the points surround the line (overlapping). No point is visited
/// twice.
[[nodiscard]] ExactVerdict turn_about(const CoreDifference& difference, const ExactVector& line,
                                      const ExactVector& hint) noexcept {
  ExactVector first;
  if (supports(difference, across(line, hint), first)) return ExactVerdict::touching;
  ExactVector last = first;
  // The total rotation is at most half a turn: a point beyond that is on the other side of the
  // first one.
  while (dot(line, cross(first, last)).sign() >= 0) {
    if (supports(difference, cross(line, last), last)) return ExactVerdict::touching;
  }
  return ExactVerdict::overlapping;
}

/// The origin is in the relative interior of `face`, a simplex of the difference. Decides whether
/// it is on the boundary of the difference.
[[nodiscard]] ExactVerdict boundary_or_inside(const CoreDifference& difference,
                                              const ExactSimplex& face,
                                              const ExactVector& hint) noexcept {
  // The origin is a support point and therefore on the boundary.
  if (face.size == 1) return ExactVerdict::touching;
  if (face.size == 4) return ExactVerdict::overlapping;
  if (face.size == 2) return turn_about(difference, face.point[1] - face.point[0], hint);
  const ExactVector normal = cross(face.point[1] - face.point[0], face.point[2] - face.point[0]);
  ExactVector vertex;
  return supports(difference, normal, vertex) || supports(difference, -normal, vertex)
             ? ExactVerdict::touching
             : ExactVerdict::overlapping;
}

[[nodiscard]] ExactVerdict locate_in_rounded(const CoreDifference& difference,
                                             const Dyadic& rounding,
                                             const ExactVector& direction) noexcept {
  const Dyadic length = rounding * difference.scale();
  const Dyadic square = length * length;
  ExactSimplex simplex;
  bool apart = false;
  const auto is_end = [&](const ExactVector& d, const Dyadic& height) {
    // Only the first direction's plane is tested: it often decides, and later directions have more
    // digits.
    if (simplex.size == 0) {
      apart = height.sign() < 0 && compare(height * height, square * dot(d, d)) > 0;
      return apart;
    }
    // No point is closer to the origin than the simplex.
    return compare(height, dot(d, simplex.point[0])) <= 0;
  };
  if (descend(difference, is_end, direction, simplex)) return ExactVerdict::overlapping;
  if (apart) return ExactVerdict::separated;
  return verdict_of(compare_square_distance(simplex, square));
}

}  // namespace

ExactVerdict locate_origin(const CoreDifference& difference, const Dyadic& rounding,
                           const ExactVector& direction) noexcept {
  if (rounding.sign() > 0) return locate_in_rounded(difference, rounding, direction);
  ExactSimplex simplex;
  const auto is_outside = [](const ExactVector&, const Dyadic& height) {
    return height.sign() < 0;
  };
  if (!descend(difference, is_outside, direction, simplex)) return ExactVerdict::separated;
  return boundary_or_inside(difference, simplex, direction);
}

}  // namespace winnow
