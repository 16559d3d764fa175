#pragma once

#include <winnow/core/status.h>
#include <winnow/pipeline/cluster_transport.h>
#include "pipeline/cluster/mpi/mpi.h"

#include <span>

namespace winnow {

/// Cuts by Zoltan's recursive coordinate bisection, as a tree whose leaves are ranks. On each axis
/// centres are measured in mean extents of boxes, so that space is cut where few boxes are cut in
/// two.
[[nodiscard]] Status cut_by_zoltan(MPI_Comm communicator, const CutWork& work,
                                   std::span<RegionCut> cuts);

}  // namespace winnow
