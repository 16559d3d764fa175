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

}  // namespace winnow::solver
