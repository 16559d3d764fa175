#pragma once

#include <winnow/core/export.h>
#include <winnow/core/status.h>
#include <winnow/pipeline/cluster_transport.h>

#include <memory>

namespace winnow {

/// How a cluster uses MPI.
struct MpiOptions {
  /// Seconds that a collective call waits for other ranks before it answers `communication_failed`:
  /// longer than any rank computes between two of them. Positive.
  double time_limit = 30.0;
};

/// Ranks that are the processes of an MPI communicator, one each; space is cut by Zoltan's
/// recursive coordinate bisection. Part of the component `cluster` (`winnow::cluster`), which is
/// there where winnow was built with MPI and Zoltan.
///
/// `communicator` is what MPI_Comm_c2f makes of one; it is duplicated. MPI has been initialized by
/// then, and is finalized after `transport` is gone. Each step of a collective call begins with the
/// ranks comparing which call they make. If a rank died, stays away longer than the limit or makes
/// another call, the others get `communication_failed` within the limit, and the cluster ends on
/// them: a program writes what it keeps and leaves by MPI_Abort, the only way out of MPI from
/// there. If a rank stands still in the middle of a cut of space, that takes MPI_THREAD_SERIALIZED;
/// under less, the others wait for it. Collective; `invalid_argument`, `out_of_memory` or
/// `communication_failed` leave `transport` unchanged.
Status make_mpi_transport(int communicator, std::unique_ptr<Transport>& transport,
                          const MpiOptions& options = {});

}  // namespace winnow
