// Each rank adds a box, and all boxes overlap: prints the number of pairs.

#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>
#include <winnow/pipeline/cluster.h>
#include <winnow/pipeline/cluster_mpi.h>

#include <cstdio>
#include <memory>

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  std::unique_ptr<winnow::Transport> transport;
  if (winnow::make_mpi_transport(static_cast<int>(MPI_Comm_c2f(MPI_COMM_WORLD)), transport) !=
      winnow::Status::ok) {
    return 1;
  }
  {
    winnow::Cluster cluster(*transport);
    const winnow::BodyName name = cluster.first_hosted();
    const winnow::Aabb box{{0, 0, 0}, {1, 1, 1}};
    const winnow::ClusterBatch batch{{&name, 1}, {std::span(&box, 1)}};
    winnow::Status answer{};
    if (cluster.add({&batch, 1}, {&answer, 1}) != winnow::Status::ok ||
        answer != winnow::Status::ok || cluster.self_pairs() != winnow::Status::ok) {
      return 1;
    }
    if (name == 0) {
      std::printf("%llu pairs\n", static_cast<unsigned long long>(cluster.statistics().pairs));
    }
  }
  transport.reset();
  MPI_Finalize();
}
