#pragma once

#include "pipeline/solver/problem.h"
#include "pipeline/solver/solver.h"

namespace winnow::solver {

/// The signed distance of two cores and its error bound.
struct CoreDistance {
  /// Minus the depth if the cores overlap. The true distance is within `doubt` of it.
  double distance = 0.0;
  double doubt = 0.0;
  /// Unit, from a to b.
  Vec axis = Vec::UnitX();
  /// The closest point on a; the closest point on b is on_a + distance * axis.
  Vec on_a = Vec::Zero();
  /// `distance` is only a lower bound, and above the caller's `enough`.
  bool far = false;
  /// Level boolean only: the shapes certainly overlap, and the distance was not computed.
  bool overlaps = false;
};

/// Computes the distance or depth of the cores of a pair, which may be half-spaces, only as exactly
/// as `level` needs: boolean ends when the sign of the distance of the rounded shapes is certain.
/// The search stops early, with `far`, if the cores are farther apart than `enough`.
[[nodiscard]] CoreDistance core_distance(const Problem& problem, ContactLevel level, double enough,
                                         SolverCounts& counts) noexcept;

}  // namespace winnow::solver
