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

#ifdef WINNOW_HAVE_CLUSTER

MpiSession::MpiSession(double time_limit) {
  int given = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &given);
  const Status status = make_mpi_transport(static_cast<int>(MPI_Comm_c2f(MPI_COMM_WORLD)),
                                           transport_, {.time_limit = time_limit});
  if (status != Status::ok) {
    throw std::runtime_error(std::string("cannot use MPI: ") + to_string(status));
  }
}

MpiSession::~MpiSession() {
  transport_.reset();
  MPI_Finalize();
}

void MpiSession::abort() {
  MPI_Abort(MPI_COMM_WORLD, EXIT_FAILURE);
  std::_Exit(EXIT_FAILURE);
}

bool MpiSession::is_available() noexcept {
  return true;
}

#else

MpiSession::MpiSession(double) {
  throw std::runtime_error("the tool was built without MPI and Zoltan");
}

MpiSession::~MpiSession() = default;

void MpiSession::abort() {
  std::_Exit(EXIT_FAILURE);
}

bool MpiSession::is_available() noexcept {
  return false;
}

#endif

}  // namespace winnow::bench
