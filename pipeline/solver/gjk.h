#pragma once

#include "pipeline/solver/core.h"

#include <array>

namespace winnow::solver {

/// A point of the Minkowski difference b - a and the points that make it.
struct DifferencePoint {
  Vec w;
  Vec a;
  Vec b;
};

/// Up to four points and the convex combination of them that is closest to the origin.
struct Simplex {
  std::array<DifferencePoint, 4> point;
  std::array<double, 4> weight{};
  int count = 0;
  /// The tetrahedron contains the origin.
  bool inside = false;

  [[nodiscard]] Vec closest() const noexcept;
  [[nodiscard]] Vec on_a() const noexcept;
  [[nodiscard]] Vec on_b() const noexcept;
};

/// Sets the weights to those of the point of the simplex that is closest to the origin, and drops
/// the points that it does not need. Regions are told apart by signed volumes, areas and lengths
/// (Montanari, Petrinic, Barbieri, "Improving the GJK algorithm", 2017); where one is too small to
/// have a sure sign, all sides are tried and the closest wins.
void reduce(Simplex& simplex) noexcept;

struct GjkResult {
  Simplex simplex;
  /// From a to b between the closest points found; zero length where `contact`.
  Vec between = Vec::Zero();
  /// Length of `between`, and the best separation along any direction that was tried: the distance
  /// of the cores lies between the two, roundings aside.
  double upper = 0.0;
  double lower = 0.0;
  /// The unit direction of `lower`.
  Vec axis = Vec::Zero();
  /// The cores share a point, as far as double can tell.
  bool contact = false;
  /// Stopped early: `lower` is above `enough`.
  bool far = false;
  /// Ended by the bound on iterations.
  bool bounded = false;
};

/// Distance of two bounded cores (Gilbert, Johnson, Keerthi, 1988) with simplices reduced by signed
/// volumes. Ends when the gap between the distance and its supporting plane is relatively as small
/// as doubles can make it, or no progress is made; in at most 64 iterations for polytopes of any
/// size that are not degenerate, and never in more than 256. `start`: where to look first, from a
/// to b. `noise`: lengths that cannot be told from zero. With a `share` it
/// ends as soon as the distance, less `roundings`, is known to that share of it; and as soon as it
/// is surely below `near`, without a bound from below then.
[[nodiscard]] GjkResult gjk(const Core& a, const Core& b, const Vec& start, double noise,
                            double enough, double share = 0.0, double roundings = 0.0,
                            double near = 0.0) noexcept;
/// The same from a simplex of points of both cores instead of a direction, such as what was found
/// before the cores moved by little.
[[nodiscard]] GjkResult gjk(const Core& a, const Core& b, const Simplex& start, double noise,
                            double enough, double share, double roundings) noexcept;

}  // namespace winnow::solver
