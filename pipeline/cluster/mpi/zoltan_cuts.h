#pragma once

#include <winnow/core/status.h>
#include <winnow/pipeline/cluster_transport.h>
#include "pipeline/cluster/mpi/mpi.h"

#include <span>

namespace winnow {

/// Cuts space by Zoltan's recursive coordinate bisection, and returns the cuts as a tree whose
/// leaves are ranks. On each axis, centres are divided by the mean extent of the boxes. Zoltan cuts
/// across the axis on which the scaled centres extend farthest, so cuts intersect few boxes.
[[nodiscard]] Status cut_by_zoltan(MPI_Comm communicator, const CutWork& work,
                                   std::span<SplitPlane> cuts);

}  // namespace winnow
