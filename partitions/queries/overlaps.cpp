// Overlap queries of a partition: one region (regions.h) or a batch of boxes. Results go to an
// OverlapBuffer or, as pairs, through PairWriter.

#include <winnow/core/results.h>
#include "core/threads/float_environment.h"
#include "partitions/pairs/pair_tracker.h"
#include "partitions/pairs/pair_writer.h"
#include "partitions/queries/kernel_arguments.h"
#include "partitions/queries/regions.h"
#include "partitions/rows/row_input.h"
#include "partitions/state/partition_observer.h"
#include "partitions/state/partition_state.h"

#include <algorithm>
#include <array>

namespace winnow {

/// Access of queries to the private data of an OverlapBuffer.
class OverlapWriter {
 public:
  explicit OverlapWriter(OverlapBuffer& out) noexcept : out_(out) {
    out_.clear();
    out_.crossing_.clear();
    aim(sinks_.inside, out_.rows_);
    aim(sinks_.crossing, out_.crossing_);
  }

  [[nodiscard]] RegionSinks& sinks() noexcept { return sinks_; }

  /// Appends the crossing objects to the objects inside. False if memory is refused.
  [[nodiscard]] bool finish(Order order) noexcept {
    out_.rows_.set_size(written(sinks_.inside, out_.rows_));
    out_.crossing_.set_size(written(sinks_.crossing, out_.crossing_));
    out_.inside_ = out_.rows_.size();
    if (!out_.rows_.resize(out_.inside_ + out_.crossing_.size())) return false;
    std::copy(out_.crossing_.begin(), out_.crossing_.end(), out_.rows_.begin() + out_.inside_);
    if (order == Order::canonical) {
      std::sort(out_.rows_.begin(), out_.rows_.begin() + out_.inside_);
      std::sort(out_.rows_.begin() + out_.inside_, out_.rows_.end());
    }
    return true;
  }

 private:
  static constexpr std::size_t kLanes = kBlockRows;

  static std::size_t written(const IdSink& sink, const Column<ObjectId>& column) noexcept {
    return column.data() == nullptr ? 0 : static_cast<std::size_t>(sink.cursor - column.data());
  }

  static void aim(IdSink& sink, Column<ObjectId>& column) noexcept {
    sink.owner = &column;
    place(sink, column, 0);
    sink.grow = [](IdSink& full) {
      auto& ids = *static_cast<Column<ObjectId>*>(full.owner);
      const std::size_t used = written(full, ids);
      ids.set_size(used);
      if (!ids.grow(used + 4 * kLanes)) return false;
      place(full, ids, used);
      return true;
    };
  }
  /// If the column is too small for one write, the sink starts full, so that the first write grows
  /// the column.
  static void place(IdSink& sink, Column<ObjectId>& column, std::size_t used) noexcept {
    static constinit ObjectId none = 0;
    const bool fits = column.capacity() >= kLanes;
    sink.cursor = fits ? column.data() + used : &none + 1;
    sink.limit = fits ? column.data() + column.capacity() - kLanes : &none;
  }

  OverlapBuffer& out_;
  RegionSinks sinks_;
};

namespace {

constexpr std::size_t kBoxesPerTask = 64;

/// A range of the caller's boxes as a query batch.
class BoxBatch {
 public:
  BoxBatch(const BoxSource& boxes, std::size_t begin, std::size_t end) noexcept {
    std::array<float*, 6> columns;
    for (std::size_t c = 0; c < 6; ++c) batch_.column[c] = columns[c] = column_[c].data();
    for (std::size_t i = begin; i < end; ++i) {
      boxes.write(i, columns.data(), i - begin);
      index_[i - begin] = static_cast<std::uint32_t>(i);
    }
    batch_.id = index_.data();
    batch_.end = static_cast<std::uint32_t>(end - begin);
    batch_.mode = HitMode::query_first;
  }
  BoxBatch(const BoxBatch&) = delete;
  BoxBatch& operator=(const BoxBatch&) = delete;

  [[nodiscard]] QueryBatch& batch() noexcept { return batch_; }

 private:
  std::array<std::array<float, kBoxesPerTask>, 6> column_;
  std::array<std::uint32_t, kBoxesPerTask> index_;
  QueryBatch batch_;
};

/// Returns a pair predicate that applies the caller's predicate to the object of a (box, object)
/// pair.
PairPredicate accepting_second(const QueryFilter*& filter) noexcept {
  if (filter->accept == nullptr) return {};
  return {[](void* context, ObjectId, ObjectId second) {
            const QueryFilter& query_filter = **static_cast<const QueryFilter**>(context);
            return query_filter.accept(query_filter.context, second);
          },
          &filter};
}

/// `objects` must be empty.
Status find_in_region(const PartitionState& state, const Region& region, OverlapBuffer& objects,
                      const Filter& filter, Order order) {
  const PreparedRegion prepared(region);
  if (prepared.status() != Status::ok) return prepared.status();
  QueryView view;
  if (const Status status = state.prepare(QueryKind::regions, 1, view); status != Status::ok) {
    return status;
  }
  const KernelFilter kernel_filter(filter, view, state.rows.keys());
  if (kernel_filter.matches_nothing()) return Status::ok;
  OverlapWriter writer(objects);
  if (prepared.run(view, kernel_filter.query_filter(), writer.sinks()) && writer.finish(order)) {
    return Status::ok;
  }
  objects.clear();
  return Status::out_of_memory;
}

/// `out` must be empty.
Status find_in_boxes(const PartitionState& state, const BoxView& boxes, PairBuffer& out,
                     const Filter& filter, Order order) {
  const Execution& execution = state.rows.execution();
  const BoxSource source{boxes};
  if (boxes.count > kMaxObjects || !all_valid(source, UpdateSubset(boxes.count), execution)) {
    return Status::invalid_argument;
  }
  QueryView view;
  if (const Status status = state.prepare(QueryKind::regions, boxes.count, view);
      status != Status::ok) {
    return status;
  }
  const SpatialIndex& index = state.index;
  const KernelFilter kernel_filter(filter, view, state.rows.keys());
  if (kernel_filter.matches_nothing()) return Status::ok;
  const ObjectFilter query_object = filter.object();
  const QueryFilter* accepted = &kernel_filter.query_filter();
  PairWriter writer(out, execution, accepting_second(accepted));
  const std::size_t tasks = (boxes.count + kBoxesPerTask - 1) / kBoxesPerTask;
  const Status status = writer.append(tasks, [&](std::size_t task, PairSink& sink) {
    const std::size_t begin = task * kBoxesPerTask;
    BoxBatch columns(source, begin, std::min(boxes.count, begin + kBoxesPerTask));
    QueryBatch& batch = columns.batch();
    if (index.structure().is_flat())
      return region_kernels().flat_boxes(view, batch, kernel_filter.query_filter(), sink);
    batch.filter = {&query_object.layers, &query_object.mask, &query_object.environment};
    // True is always safe, and costs one test.
    batch.environments = true;
    batch.one_filter = true;
    batch.matches_all = !kernel_filter.query_filter().by_object;
    return index.query(batch, sink);
  });
  const std::size_t slots = std::max(state.rows.keys().slot_count(), boxes.count);
  if (status == Status::ok && (order == Order::fast || PairTracker::sort(out, slots))) {
    return Status::ok;
  }
  out.clear();
  return Status::out_of_memory;
}

}  // namespace

Status Partition::overlap(const Region& region, OverlapBuffer& objects, const Filter& filter,
                          Order order) const {
  const DefaultFloatEnvironment environment;
  objects.clear();
  if (state_ == nullptr) return status_;
  const Status status = find_in_region(*state_, region, objects, filter, order);
  if (is_observed(status, state_)) state_->observer->overlap(region, filter, order, objects);
  return status;
}

Status Partition::overlap(const BoxView& boxes, PairBuffer& out, const Filter& filter,
                          Order order) const {
  const DefaultFloatEnvironment environment;
  out.clear();
  if (state_ == nullptr) return status_;
  const Status status = find_in_boxes(*state_, boxes, out, filter, order);
  if (is_observed(status, state_)) state_->observer->overlap(boxes, filter, order, out);
  return status;
}

}  // namespace winnow
