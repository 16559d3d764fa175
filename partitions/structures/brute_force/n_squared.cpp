#include "partitions/structures/brute_force/n_squared.h"

#include "partitions/structures/brute_force/flat_rows.h"

namespace winnow {

NSquared::NSquared(const PartitionOptions& options) : RowPartition(options, options.volume) {}

std::size_t NSquared::regular_tasks() const noexcept {
  return flat_tasks(pool());
}

bool NSquared::run_regular_task(std::size_t task, PairSink& sink) const noexcept {
  const FlatTask range(pool(), task);
  return flat_kernels().untested.self_pairs(flat_view(block_filters(), pool()), range.begin,
                                            range.end, sink);
}

bool NSquared::query_regular(const QueryBatch& batch, PairSink& sink) const noexcept {
  return flat_kernels().untested.query(flat_view(block_filters(), pool()), batch, sink);
}

}  // namespace winnow
