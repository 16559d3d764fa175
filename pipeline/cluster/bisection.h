#pragma once

#include <winnow/pipeline/cluster_transport.h>

#include <span>

namespace winnow {

/// Cuts space for `cuts.size() + 1` ranks by recursive bisection: across the axis on which the
/// fewest boxes are cut in two, where the work on both sides is as the numbers of ranks. O(boxes *
/// log ranks).
void bisect(std::span<const CutWork> work, std::span<RegionCut> cuts);

}  // namespace winnow
