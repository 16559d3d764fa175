#include "pipeline/exact/exact_gjk.h"

namespace winnow {
namespace {

/// Up to four affinely independent points, the newest last.
struct ExactSimplex {
  int size = 0;
  ExactVector point[4];
};

/// True if the origin projects into the interior of the segment; then `toward` leads there.
[[nodiscard]] bool segment_faces(const ExactVector& a, const ExactVector& b,
                                 ExactVector& toward) noexcept {
  const ExactVector edge = b - a;
  const Dyadic along = dot(a, edge);
  if (along.sign() >= 0 || dot(b, edge).sign() <= 0) return false;
  toward = edge * along - a * dot(edge, edge);
  return true;
}

[[nodiscard]] bool triangle_faces(const ExactVector& a, const ExactVector& b, const ExactVector& c,
                                  ExactVector& toward) noexcept {
  const ExactVector normal = cross(b - a, c - a);
  if (dot(normal, cross(b, c)).sign() <= 0 || dot(normal, cross(c, a)).sign() <= 0 ||
      dot(normal, cross(a, b)).sign() <= 0) {
    return false;
  }
  const int side = dot(normal, a).sign();
  toward = side > 0 ? -normal : side < 0 ? normal : ExactVector{};
  return true;
}

/// Points of a simplex by the bits of a mask.
struct Face {
  int count = 0;
  int index[4] = {};
};

[[nodiscard]] Face face_of(unsigned mask) noexcept {
  Face face;
  for (int i = 0; i < 4; ++i) {
    if ((mask >> i & 1U) != 0) face.index[face.count++] = i;
  }
  return face;
}

[[nodiscard]] bool is_nearest(const ExactSimplex& s, unsigned mask, ExactVector& toward) noexcept {
  const Face face = face_of(mask);
  const ExactVector& first = s.point[face.index[0]];
  bool faces = true;
  switch (face.count) {
    case 1:
      toward = -first;
      break;
    case 2:
      faces = segment_faces(first, s.point[face.index[1]], toward);
      break;
    default:
      faces = triangle_faces(first, s.point[face.index[1]], s.point[face.index[2]], toward);
  }
  if (!faces) return false;
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

/// Keeps the smallest face of the simplex that contains its point nearest to the origin, which is
/// one that contains the newest point. `toward` becomes a direction from that nearest point to the
/// origin, zero if they are the same: the origin then lies in the relative interior of the face.
///
/// Tries faces by dimension; one is the nearest if the origin projects into its interior and the
/// other points lie behind the plane through it (Johnson's conditions: Gilbert, Johnson and
/// Keerthi, 1988), so no distances are compared.
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

/// The algorithm of Gilbert, Johnson and Keerthi (1988), exactly: descends towards the origin until
/// the simplex contains it (true) or `is_outside(direction, height)` says that it never will.
/// Without rounding each step comes strictly nearer, so no simplex returns and it ends.
template <typename Outside>
[[nodiscard]] bool descend(const CoreDifference& difference, const Outside& is_outside,
                           ExactVector direction, ExactSimplex& simplex) noexcept {
  Dyadic height;
  while (!is_zero(direction)) {
    difference.support(direction, simplex.point[simplex.size], height);
    if (is_outside(direction, height)) return false;
    ++simplex.size;
    keep_nearest_face(simplex, direction);
  }
  return true;
}

/// Any direction at right angles to `line`, near `hint` if that is not along it.
[[nodiscard]] ExactVector across(const ExactVector& line, const ExactVector& hint) noexcept {
  ExactVector side = cross(cross(line, hint), line);
  if (!is_zero(side)) return side;
  const bool is_upright = line.x[0].sign() == 0 && line.x[1].sign() == 0;
  return cross(line, is_upright ? ExactVector{{1.0, 0.0, 0.0}} : ExactVector{{0.0, 0.0, 1.0}});
}

/// True if no point of the difference lies strictly beyond the plane through the origin.
[[nodiscard]] bool supports(const CoreDifference& difference, const ExactVector& direction,
                            ExactVector& vertex) noexcept {
  Dyadic height;
  difference.support(direction, vertex, height);
  return height.sign() <= 0;
}

/// The origin lies inside a segment of the difference along `line`. A supporting plane contains the
/// line, so this is a question in the plane across it: turn from the farthest point found to the
/// farthest one beyond it until a half plane is free of points, or they surround the line. No point
/// is met twice.
[[nodiscard]] ExactVerdict turn_about(const CoreDifference& difference, const ExactVector& line,
                                      const ExactVector& hint) noexcept {
  ExactVector first;
  if (supports(difference, across(line, hint), first)) return ExactVerdict::touching;
  ExactVector last = first;
  // By half a turn in all at most: a point beyond that lies on the other side of the first one.
  while (dot(line, cross(first, last)).sign() >= 0) {
    if (supports(difference, cross(line, last), last)) return ExactVerdict::touching;
  }
  return ExactVerdict::overlapping;
}

/// The origin lies in the relative interior of `face`, a simplex of the difference: is it on the
/// boundary of the whole?
[[nodiscard]] ExactVerdict boundary_or_inside(const CoreDifference& difference,
                                              const ExactSimplex& face,
                                              const ExactVector& hint) noexcept {
  // The newest point, and so the farthest one along a direction.
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
  const auto is_outside = [&](const ExactVector& d, const Dyadic& height) {
    // The plane of the first direction often settles it; later ones have more digits.
    if (simplex.size == 0) {
      apart = height.sign() < 0 && compare(height * height, square * dot(d, d)) > 0;
      return apart;
    }
    return compare(height, dot(d, simplex.point[0])) <= 0;
  };
  if (descend(difference, is_outside, direction, simplex)) return ExactVerdict::overlapping;
  if (apart) return ExactVerdict::separated;
  const int sign = compare_square_distance(simplex, square);
  return sign > 0   ? ExactVerdict::separated
         : sign < 0 ? ExactVerdict::overlapping
                    : ExactVerdict::touching;
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
