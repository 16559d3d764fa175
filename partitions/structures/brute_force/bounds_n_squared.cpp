#include "partitions/structures/brute_force/bounds_n_squared.h"

#include "partitions/structures/brute_force/flat_rows.h"

namespace winnow {
namespace {

const FlatKernel& kernel_for(Volume volume) noexcept {
  const FlatKernels& kernels = flat_kernels();
  switch (volume) {
    case Volume::aabb:
      return kernels.aabb;
    case Volume::sphere:
      return kernels.sphere;
    case Volume::kdop14:
      return kernels.kdop14;
    case Volume::kdop18:
      return kernels.kdop18;
    case Volume::kdop26:
      return kernels.kdop26;
  }
  return kernels.aabb;
}

}  // namespace

BoundsNSquared::BoundsNSquared(const PartitionOptions& options)
    : RowPartition(options, options.volume) {}

std::size_t BoundsNSquared::regular_tasks() const noexcept {
  return flat_tasks(pool());
}

bool BoundsNSquared::run_regular_task(std::size_t task, PairSink& sink) const noexcept {
  const FlatTask range(pool(), task);
  return kernel_for(volume()).self_pairs(flat_view(block_filters(), pool()), range.begin, range.end,
                                         sink);
}

bool BoundsNSquared::query_regular(const QueryBatch& batch, PairSink& sink) const noexcept {
  return kernel_for(volume()).query(flat_view(block_filters(), pool()), batch, sink);
}

}  // namespace winnow
