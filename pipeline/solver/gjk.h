#pragma once

#include "pipeline/solver/core.h"

#include <array>
#include <cstddef>
#include <limits>

namespace winnow::solver {

/// A point w of the Minkowski difference b - a, and the points of a and b that make it. (Exact
/// tests and hull kernels use a - b.)
struct DifferencePoint {
  Vec w;
  Vec a;
  Vec b;
};

/// Up to four points and the convex combination of them that is closest to the origin.
struct GjkSimplex {
  std::array<DifferencePoint, 4> point;
  std::array<double, 4> weight{};
  int count = 0;
  /// The simplex is a tetrahedron that contains the origin.
  bool inside = false;

  [[nodiscard]] Vec closest() const noexcept;
  [[nodiscard]] Vec on_a() const noexcept;
  [[nodiscard]] Vec on_b() const noexcept;
};

/// Face i of a tetrahedron is opposite to point i.
inline constexpr std::size_t kTetrahedronFace[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}};

/// Sets the weights to the point of the simplex that is closest to the origin, and drops the points
/// that it does not need. The region is chosen by signed volumes, areas and lengths (Montanari,
/// Petrinic, Barbieri, "Improving the GJK algorithm", 2017); if one of these is too small to have a
/// certain sign, all sides are tried and the closest is taken.
void reduce(GjkSimplex& simplex) noexcept;

struct GjkResult {
  GjkSimplex simplex;
  /// The vector from a to b between the closest points found; zero if `contact`.
  Vec between = Vec::Zero();
  /// The length of `between`, and the best separation along any direction tested: the distance of
  /// the cores is between the two, up to rounding.
  double upper = 0.0;
  double lower = 0.0;
  /// The unit direction of `lower`.
  Vec axis = Vec::Zero();
  /// The cores share a point, up to rounding.
  bool contact = false;
  /// Stopped early: `lower` is above GjkLimits::enough.
  bool far = false;
  /// Stopped by the limit of iterations.
  bool hit_limit = false;
};

/// When a search by GJK may stop early.
struct GjkLimits {
  /// Lengths up to this cannot be distinguished from zero: the cores are then in contact.
  double noise = 0.0;
  /// Stops, with GjkResult::far, as soon as the cores are certainly farther apart than this.
  double enough = std::numeric_limits<double>::infinity();
  /// If positive, stops as soon as the distance less `roundings` is exact to this relative error.
  double share = 0.0;
  double roundings = 0.0;
  /// Stops as soon as the distance is below this; the lower bound is then not tight.
  double near = 0.0;
};

/// Computes the distance of two bounded cores by GJK (Gilbert, Johnson, Keerthi 1988), with
/// simplices reduced by signed volumes. Ends when the relative difference between the length of
/// `between` and the separation along it is as small as doubles allow, or when there is no
/// progress: in at most 64 iterations for polytopes of any size that are not degenerate, never in
/// more than 256. `start` is the first search direction, from a to b.
[[nodiscard]] GjkResult gjk(const Core& a, const Core& b, const Vec& start,
                            const GjkLimits& limits) noexcept;
/// As above, but starts from a simplex of points of both cores, such as the result before the cores
/// moved a little.
[[nodiscard]] GjkResult gjk(const Core& a, const Core& b, const GjkSimplex& start,
                            const GjkLimits& limits) noexcept;

}  // namespace winnow::solver
