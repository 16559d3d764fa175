#pragma once

#include <winnow/core/export.h>
#include <winnow/core/status.h>
#include <winnow/pipeline/cluster_transport.h>

#include <memory>

namespace winnow {

/// Options of the MPI transport.
struct MpiOptions {
  /// Timeout in seconds after which a collective call returns `communication_failed` if another
  /// rank does not respond. It must exceed the time that any rank computes between two collective
  /// calls. Positive.
  double time_limit = 30.0;
};

/// Creates a transport with one rank per process of an MPI communicator; space is partitioned by
/// the recursive coordinate bisection of Zoltan. It is in the component `cluster`
/// (`winnow::cluster`), which exists if winnow was built with MPI and Zoltan.
///
/// `communicator` is the result of MPI_Comm_c2f; it is duplicated. Call MPI_Init before, and
/// MPI_Finalize after `transport` is destroyed. In each step of a collective call the ranks first
/// check that all of them make the same call. If a rank died, does not respond within the time
/// limit, or makes another call, the others get `communication_failed` within the limit, and the
/// cluster ends on them. The program should then save its data and call MPI_Abort, the only way to
/// leave MPI in this state. If a rank hangs while space is partitioned, the time limit works only
/// with MPI_THREAD_SERIALIZED; with a lower thread level the other ranks block. Collective;
/// `invalid_argument`, `out_of_memory` and `communication_failed` leave `transport` unchanged.
Status make_mpi_transport(int communicator, std::unique_ptr<Transport>& transport,
                          const MpiOptions& options = {});

}  // namespace winnow
