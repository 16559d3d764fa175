#pragma once

#include <winnow/pipeline/cluster_transport.h>

#include <span>

namespace winnow {

/// Cuts space for `cuts.size() + 1` ranks by recursive bisection. Each cut is across the axis on
/// which it intersects the fewest boxes; the work on its sides is proportional to the numbers of
/// ranks. O(boxes * log ranks).
void bisect(std::span<const CutWork> work, std::span<SplitPlane> cuts);

}  // namespace winnow
