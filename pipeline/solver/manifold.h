#pragma once

#include <winnow/pipeline/solver/problem.h>
#include <winnow/pipeline/solver/solver.h>

namespace winnow::solver {

/// Fills in the contacts of an answer whose distance, normal and point are known: the supporting
/// features of both cores along the normal, met by contact_patch. At least one point.
void make_manifold(const Problem& problem, double margin, PairAnswer& answer) noexcept;

}  // namespace winnow::solver
