// ranks CASE FOLDER: a rank of a cluster in which rank 1 is late or makes another call. Each rank
// writes the status of its call to its own file, as a program would save its state; then all ranks
// exit together. A late rank calls after the files of all others exist, so they did not wait for
// it. Run by failures.

#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>
#include <winnow/pipeline/cluster.h>
#include <winnow/pipeline/cluster_mpi.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>

namespace {

/// In seconds: long enough that no rank of a busy machine is late by chance, unless the test waits
/// for the limit.
constexpr double kLimit = 120.0;
constexpr double kAwaitedLimit = 3.0;

/// The folder of the files of ranks.
std::filesystem::path folder;

std::filesystem::path file_of(std::uint32_t rank) {
  return folder / std::to_string(rank);
}

/// Returns when the ranks 0 to `ranks` - 1, except one, have written their files.
void wait_for_files(std::uint32_t ranks, std::uint32_t except) {
  for (std::uint32_t rank = 0; rank < ranks; ++rank) {
    while (rank != except && !std::filesystem::exists(file_of(rank))) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
}

winnow::Status add(winnow::Cluster& cluster, winnow::BodyName name) {
  const winnow::Aabb box{{0, 0, 0}, {1, 1, 1}};
  const winnow::ClusterBatch batch{{&name, 1}, {std::span(&box, 1)}};
  winnow::Status answer{};
  return cluster.add({&batch, 1}, {&answer, 1});
}

/// Makes the call that all ranks make except the one that calls deviating_call().
winnow::Status common(winnow::Cluster& cluster, const std::string& kind) {
  winnow::ClusterDigest digest;
  if (kind == "late_for_exchange") return add(cluster, 10 + cluster.first_hosted());
  if (kind == "late_for_sums") return cluster.digest().get(digest);
  return cluster.self_pairs();  // begins with a repartitioning
}

winnow::Status deviating_call(winnow::Cluster& cluster, const std::string& kind) {
  winnow::ClusterDigest digest;
  if (kind == "adds_instead") return add(cluster, 20);
  if (kind == "sums_instead") return cluster.digest().get(digest);
  if (kind != "all_in_time") wait_for_files(cluster.ranks(), 1);
  return common(cluster, kind);
}

}  // namespace

int main(int, char** arguments) {
  const std::string kind = arguments[1];
  folder = arguments[2];
  int threads = 0;
  MPI_Init_thread(nullptr, nullptr,
                  kind == "late_without_threads" ? MPI_THREAD_FUNNELED : MPI_THREAD_SERIALIZED,
                  &threads);
  std::unique_ptr<winnow::Transport> transport;
  if (winnow::make_mpi_transport(static_cast<int>(MPI_Comm_c2f(MPI_COMM_WORLD)), transport,
                                 {.time_limit = kind == "all_in_time" ? kLimit : kAwaitedLimit}) !=
      winnow::Status::ok) {
    return 1;
  }
  // Ranks start at different times.
  MPI_Barrier(MPI_COMM_WORLD);
  winnow::Cluster cluster(*transport);
  const std::uint32_t rank = cluster.first_hosted();
  if (add(cluster, rank) != winnow::Status::ok) return 1;
  const winnow::Status status = rank == 1 ? deviating_call(cluster, kind) : common(cluster, kind);
  // The file appears with its text in it.
  const std::filesystem::path written = folder / ("written_" + std::to_string(rank));
  std::ofstream(written) << winnow::to_string(status) << std::endl;
  std::filesystem::rename(written, file_of(rank));
  // If one rank exits early, mpirun ends the other ranks.
  wait_for_files(cluster.ranks(), rank);
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  std::_Exit(0);
}
