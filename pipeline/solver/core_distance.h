#pragma once

#include "pipeline/solver/problem.h"
#include "pipeline/solver/solver.h"

namespace winnow::solver {

/// The signed distance of two cores, and how sure it is.
struct CoreDistance {
  /// Negative by the depth. The true one is within `doubt` of it.
  double distance = 0.0;
  double doubt = 0.0;
  /// Unit, from a to b.
  Vec axis = Vec::UnitX();
  /// That of b is distance * axis farther.
  Vec on_a = Vec::Zero();
  /// `distance` is but a lower bound, above what was asked for.
  bool far = false;
  /// Level boolean only: that they overlap is sure, the distance is not known.
  bool overlaps = false;
};

/// Distance or depth of the cores of a pair, half-spaces included. Only as far as `level` needs
/// it: boolean ends where the sign of the distance of the rounded shapes is sure. `enough`: a
/// larger distance of the cores need not be known.
[[nodiscard]] CoreDistance core_distance(const Problem& problem, ContactLevel level, double enough,
                                         SolverCounts& counts) noexcept;

}  // namespace winnow::solver
