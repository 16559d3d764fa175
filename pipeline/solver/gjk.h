#pragma once

#include "pipeline/solver/core.h"

#include <array>

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
  /// Stopped early: `lower` is above `enough`.
  bool far = false;
  /// Stopped by the bound on iterations.
  bool bounded = false;
};

/// Computes the distance of two bounded cores by GJK (Gilbert, Johnson, Keerthi 1988), with
/// simplices reduced by signed volumes. Ends when the relative difference between the length of
/// `between` and the separation along it is as small as doubles allow, or when there is no
/// progress: in at most 64 iterations for polytopes of any size that are not degenerate, never in
/// more than 256.
///
/// `start`: the first search direction, from a to b. `noise`: lengths up to this cannot be
/// distinguished from zero. `enough`: stops if the cores are farther apart. `share`: if positive,
/// stops as soon as the distance less `roundings` is exact to this relative error. `near`: stops as
/// soon as the distance is below it; the lower bound is then not tight.
[[nodiscard]] GjkResult gjk(const Core& a, const Core& b, const Vec& start, double noise,
                            double enough, double share = 0.0, double roundings = 0.0,
                            double near = 0.0) noexcept;
/// As above, but starts from a simplex of points of both cores, such as the result before the cores
/// moved a little.
[[nodiscard]] GjkResult gjk(const Core& a, const Core& b, const GjkSimplex& start, double noise,
                            double enough, double share, double roundings) noexcept;

}  // namespace winnow::solver
