// ranks CASE FOLDER: a rank of a cluster in which rank 1 is late or makes another call. Each rank
// writes the status and the duration of its call to its own file, as a program would save its
// state; then all ranks exit together. Run by failures.

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

using Seconds = std::chrono::duration<double>;

constexpr double kLimit = 1.0;
constexpr Seconds kLate{2.5};

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
  if (kind == "late_for_sums") return cluster.digest(digest);
  return cluster.self_pairs();  // begins with a repartitioning
}

winnow::Status deviating_call(winnow::Cluster& cluster, const std::string& kind) {
  winnow::ClusterDigest digest;
  if (kind == "adds_instead") return add(cluster, 20);
  if (kind == "sums_instead") return cluster.digest(digest);
  if (kind != "all_in_time") std::this_thread::sleep_for(kLate);
  return common(cluster, kind);
}

}  // namespace

int main(int, char** arguments) {
  const std::string kind = arguments[1];
  const std::filesystem::path folder = arguments[2];
  int threads = 0;
  MPI_Init_thread(nullptr, nullptr,
                  kind == "late_without_threads" ? MPI_THREAD_FUNNELED : MPI_THREAD_SERIALIZED,
                  &threads);
  std::unique_ptr<winnow::Transport> transport;
  if (winnow::make_mpi_transport(static_cast<int>(MPI_Comm_c2f(MPI_COMM_WORLD)), transport,
                                 {.time_limit = kLimit}) != winnow::Status::ok) {
    return 1;
  }
  winnow::Cluster cluster(*transport);
  const std::uint32_t rank = cluster.first_hosted();
  if (add(cluster, rank) != winnow::Status::ok) return 1;
  const auto start = std::chrono::steady_clock::now();
  const winnow::Status status = rank == 1 ? deviating_call(cluster, kind) : common(cluster, kind);
  const Seconds took = std::chrono::steady_clock::now() - start;
  const auto file = [&](std::uint32_t of) { return folder / std::to_string(of); };
  std::ofstream(file(rank)) << winnow::to_string(status) << ' '
                            << (took.count() < kLimit + 1.0 || rank == 1 ? "in time" : "late")
                            << std::endl;
  // Waits for the files of all ranks: if one exits early, mpirun ends the other ranks.
  for (std::uint32_t other = 0; other < cluster.ranks(); ++other) {
    while (!std::filesystem::exists(file(other))) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  std::_Exit(0);
}
