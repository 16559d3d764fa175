#pragma once

#include <winnow/pipeline/cluster_transport.h>

#include <span>

namespace winnow {

/// Cuts space for `cuts.size() + 1` ranks by recursive bisection. Each cut is perpendicular to the
/// axis on which it intersects the fewest boxes. The work on each side of a cut is about
/// proportional to the number of ranks there. O(boxes * log ranks).
void bisect(std::span<const CutWork> work, std::span<SplitPlane> cuts);

}  // namespace winnow
