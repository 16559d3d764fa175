// `Partition::nearest`: prepares the query and calls the kernel (nearest.kernel.cpp).

#include "core/threads/float_environment.h"
#include "partitions/queries/nearest.kernel.h"

#include "partitions/queries/hit_writer.h"
#include "partitions/queries/kernel_arguments.h"
#include "partitions/state/partition_observer.h"
#include "partitions/state/partition_state.h"

namespace winnow {

WINNOW_DEFINE_KERNELS(NearestKernels, nearest_kernels)

namespace {

/// Returns a heap whose entries are stored in a column.
NearestHeap heap_in(Column<std::uint64_t>& entries, std::size_t most) noexcept {
  NearestHeap heap;
  heap.entries = entries.data();
  heap.room = entries.capacity();
  heap.most = most;
  heap.owner = &entries;
  heap.grow = [](NearestHeap& full) {
    auto& column = *static_cast<Column<std::uint64_t>*>(full.owner);
    column.set_size(full.size);
    if (!column.grow(full.size + 1)) return false;
    full.entries = column.data();
    full.room = column.capacity();
    return true;
  };
  return heap;
}

/// `hits` must be empty.
Status find_nearest(const PartitionState& state, const Aabb& from, std::size_t count, float radius,
                    HitBuffer& hits, const Filter& filter) {
  const bool finite = from.min.all_finite() && from.max.all_finite() && from.is_valid();
  if (!finite || !(radius >= 0.0F)) return Status::invalid_argument;
  QueryView view;
  if (const Status status = state.prepare(QueryKind::nearest, 1, view); status != Status::ok) {
    return status;
  }
  const KeyTable& keys = state.rows.keys();
  const KernelFilter kernel_filter(filter, view, keys);
  NearestQuery query;
  for (int axis = 0; axis < 3; ++axis) {
    query.low[axis] = from.min[axis];
    query.high[axis] = from.max[axis];
  }
  query.radius = radius;
  Column<std::uint64_t>& entries = HitWriter::heap(hits);
  entries.clear();
  NearestHeap heap = heap_in(entries, count);
  const bool done = kernel_filter.matches_nothing() || count == 0 ||
                    nearest_kernels().nearest(view, query, kernel_filter.query_filter(), heap);
  entries.set_size(heap.size);
  if (done && HitWriter::write_heap(hits, keys)) return Status::ok;
  hits.clear();
  return Status::out_of_memory;
}

}  // namespace

Status Partition::nearest(const Aabb& from, std::size_t count, float radius, HitBuffer& hits,
                          const Filter& filter) const {
  const DefaultFloatEnvironment environment;
  hits.clear();
  if (state_ == nullptr) return status_;
  const Status status = find_nearest(*state_, from, count, radius, hits, filter);
  if (is_observed(status, state_)) state_->observer->nearest(from, count, radius, filter, hits);
  return status;
}

}  // namespace winnow
