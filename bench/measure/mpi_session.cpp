#include "bench/measure/mpi_session.h"

#ifdef WINNOW_HAVE_CLUSTER
#include <winnow/pipeline/cluster_mpi.h>
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>
#endif

#include <algorithm>
#include <array>
#include <cstdlib>
#include <stdexcept>

namespace winnow::bench {

bool MpiSession::is_started() noexcept {
  constexpr std::array kNames{"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK"};
  return std::any_of(kNames.begin(), kNames.end(),
                     [](const char* name) { return std::getenv(name) != nullptr; });
}

bool MpiSession::is_available() noexcept {
#ifdef WINNOW_HAVE_CLUSTER
  return true;
#else
  return false;
#endif
}

MpiSession::MpiSession([[maybe_unused]] double time_limit) {
#ifdef WINNOW_HAVE_CLUSTER
  int given = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &given);
  const Status status = make_mpi_transport(static_cast<int>(MPI_Comm_c2f(MPI_COMM_WORLD)),
                                           transport_, {.time_limit = time_limit});
  if (status != Status::ok) {
    throw std::runtime_error(std::string("cannot use MPI: ") + to_string(status));
  }
#else
  throw std::runtime_error("the tool was built without MPI and Zoltan");
#endif
}

MpiSession::~MpiSession() {
  transport_.reset();
#ifdef WINNOW_HAVE_CLUSTER
  MPI_Finalize();
#endif
}

void MpiSession::abort() {
#ifdef WINNOW_HAVE_CLUSTER
  MPI_Abort(MPI_COMM_WORLD, EXIT_FAILURE);
#endif
  std::_Exit(EXIT_FAILURE);
}

}  // namespace winnow::bench
