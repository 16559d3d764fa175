#include "pipeline/exact/origin_walk.h"
#include "pipeline/exact/exact_simplex.h"

namespace winnow {
namespace {

constexpr int kMaxSteps = 4096;

enum class Place : unsigned char { outside, in_face, unknown };

void append(ExactSimplex& simplex, const DifferenceVertex& vertex) noexcept {
  simplex.point[simplex.size] = vertex.point;
  simplex.a[simplex.size] = vertex.a;
  simplex.b[simplex.size] = vertex.b;
  ++simplex.size;
}

/// The algorithm of Gilbert, Johnson and Keerthi (1988), exactly: walks towards the origin until
/// the simplex contains it (in_face) or `is_outside(direction, height)` says that it never will.
/// `support` answers false if there are no points. Without rounding each step comes strictly
/// nearer, so no simplex returns and it ends.
template <typename Support, typename Outside>
[[nodiscard]] Place walk(const Support& support, const Outside& is_outside, ExactVector direction,
                         ExactSimplex& simplex) noexcept {
  DifferenceVertex vertex;
  Dyadic height;
  simplex.size = 0;
  for (int step = 0; step < kMaxSteps; ++step) {
    if (!support(direction, vertex, height)) return Place::outside;
    if (is_outside(direction, height)) return Place::outside;
    append(simplex, vertex);
    keep_nearest_face(simplex, direction);
    if (is_zero(direction)) return Place::in_face;
  }
  return Place::unknown;
}

/// Any direction at right angles to `line`, near `hint` if that is not along it.
[[nodiscard]] ExactVector across(const ExactVector& line, const ExactVector& hint) noexcept {
  ExactVector side = cross(cross(line, hint), line);
  if (!is_zero(side)) return side;
  for (int k = 0; k < 3; ++k) {
    const double unit[3] = {k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0};
    ExactVector other = cross(line, exact_vector(unit));
    if (!is_zero(other)) return other;
  }
  return line;
}

/// True if no point of the difference lies strictly beyond the plane through the origin.
[[nodiscard]] bool supports(const CoreDifference& difference, const ExactVector& direction,
                            DifferenceVertex& vertex) noexcept {
  Dyadic height;
  difference.support(direction, vertex, height);
  return height.sign() <= 0;
}

/// The origin lies inside a segment of the difference along `line`. A supporting plane contains the
/// line, so this is a question in the plane across it: turn from the farthest point found to the
/// farthest one beyond it until a half plane is free of points, or they surround the line.
[[nodiscard]] ExactVerdict turn_about(const CoreDifference& difference, const ExactVector& line,
                                      const ExactVector& hint) noexcept {
  DifferenceVertex first;
  DifferenceVertex next;
  if (supports(difference, across(line, hint), first)) return ExactVerdict::touching;
  ExactVector last = first.point;
  for (int step = 0; step < kMaxSteps; ++step) {
    if (supports(difference, cross(line, last), next)) return ExactVerdict::touching;
    last = next.point;
    const int turned = dot(line, cross(first.point, last)).sign();
    if (turned < 0) return ExactVerdict::overlapping;
    if (turned == 0) {
      return supports(difference, -cross(line, first.point), next) ? ExactVerdict::touching
                                                                   : ExactVerdict::overlapping;
    }
  }
  return ExactVerdict::undecided;
}

/// The origin lies in the relative interior of `face`, a simplex of the difference: is it on the
/// boundary of the whole?
[[nodiscard]] ExactVerdict boundary_or_inside(const CoreDifference& difference, ExactSimplex& face,
                                              const ExactVector& hint) noexcept {
  if (face.size == 1) {
    // A vertex of the difference: its cone is everything or else a plane supports it. A plane that
    // meets the cone in no other point is one that parts the cone's generators from the origin.
    const std::uint32_t a = face.a[0];
    const std::uint32_t b = face.b[0];
    const auto support = [&](const ExactVector& direction, DifferenceVertex& vertex,
                             Dyadic& height) {
      return difference.cone_support(a, b, direction, vertex, height);
    };
    const auto is_outside = [](const ExactVector&, const Dyadic& height) {
      return height.sign() < 0;
    };
    const Place place = walk(support, is_outside, hint, face);
    if (place == Place::outside) return ExactVerdict::touching;
    if (place == Place::unknown) return ExactVerdict::undecided;
  }
  if (face.size == 4) return ExactVerdict::overlapping;
  if (face.size == 2) return turn_about(difference, face.point[1] - face.point[0], hint);
  const ExactVector normal = cross(face.point[1] - face.point[0], face.point[2] - face.point[0]);
  DifferenceVertex vertex;
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
  const auto support = [&](const ExactVector& d, DifferenceVertex& vertex, Dyadic& height) {
    difference.support(d, vertex, height);
    return true;
  };
  bool apart = false;
  const auto is_outside = [&](const ExactVector& d, const Dyadic& height) {
    // The plane of the first direction often settles it; later ones have more digits.
    if (simplex.size == 0) {
      apart = height.sign() < 0 && compare(height * height, square * dot(d, d)) > 0;
      return apart;
    }
    return compare(height, dot(d, simplex.point[0])) <= 0;
  };
  const Place place = walk(support, is_outside, direction, simplex);
  if (apart) return ExactVerdict::separated;
  if (place == Place::in_face) return ExactVerdict::overlapping;
  if (place == Place::unknown) return ExactVerdict::undecided;
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
  const auto support = [&](const ExactVector& d, DifferenceVertex& vertex, Dyadic& height) {
    difference.support(d, vertex, height);
    return true;
  };
  const auto is_outside = [](const ExactVector&, const Dyadic& height) {
    return height.sign() < 0;
  };
  const Place place = walk(support, is_outside, direction, simplex);
  if (place == Place::outside) return ExactVerdict::separated;
  if (place == Place::unknown) return ExactVerdict::undecided;
  return boundary_or_inside(difference, simplex, direction);
}

}  // namespace winnow
