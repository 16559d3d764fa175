#pragma once

#include "pipeline/solver/problem.h"
#include "pipeline/solver/solver.h"

namespace winnow::solver {

/// Fills in the contacts of an answer whose normal is known: the supporting features of both cores
/// along it, met by contact_patch. `point`: on the surface of a; `distance`: both in units of the
/// problem. At least one point, and the deepest one is as deep as the distance says.
void make_manifold(const Problem& problem, const Vec& point, double distance, double margin,
                   PairAnswer& answer) noexcept;

}  // namespace winnow::solver
