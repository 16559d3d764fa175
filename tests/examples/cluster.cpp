// A row of boxes on four ranks of this process, one of which moves into its neighbour.

#include <winnow/pipeline/cluster.h>

#include <cstddef>
#include <vector>

#include "tests/examples/check.h"

namespace {

std::size_t reported = 0;
void report(winnow::BodyName, winnow::BodyName) {
  ++reported;
}

}  // namespace

int main() {
  std::vector<winnow::BodyName> names;
  std::vector<winnow::Aabb> boxes;
  for (winnow::BodyName name = 0; name < 1000; ++name) {
    const float x = 1.5F * static_cast<float>(name);
    names.push_back(name);
    boxes.push_back({{x, 0, 0}, {x + 1, 1, 1}});
  }
  const winnow::Aabb moved{{4, 0, 0}, {5, 1, 1}};
  std::vector<winnow::ClusterBatch> batches(4);
  batches[0] = {names, boxes};
  std::vector<winnow::Status> answers(batches.size());

  // [a cluster]
  winnow::LoopbackTransport transport(4);  // or make_mpi_transport: one rank in each process
  winnow::Cluster cluster(transport);
  must(cluster.add(batches, answers));  // for each rank here: 64-bit names and boxes
  must(cluster.self_pairs());           // bodies move to the ranks that own their centres
  for (std::uint32_t rank = 0; rank < cluster.hosted(); ++rank) {
    for (const winnow::ClusterBody& body : cluster.arrived(rank)) {
      if (body.name == 3) must(cluster.move(rank, std::span(&body.key, 1), std::span(&moved, 1)));
    }
  }
  must(cluster.self_pairs());  // sends only bodies that moved and have ghosts
  for (std::uint32_t rank = 0; rank < cluster.hosted(); ++rank) {
    for (const winnow::NamePair pair : cluster.pairs(rank)) report(pair.first, pair.second);
  }
  // [end]
  check(answers[0] == winnow::Status::ok, "the bodies are taken");
  check(reported == 1, "two boxes overlap, and one rank reports it");
}
