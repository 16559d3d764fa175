// RowPartition: which objects meet a region.

#include <winnow/core/hits.h>
#include <winnow/partitions/pair_tracker.h>
#include <winnow/partitions/pair_writer.h>
#include <winnow/partitions/queries/query_filter.h>
#include <winnow/partitions/queries/regions.h>
#include <winnow/partitions/row_partition.h>

#include <algorithm>
#include <array>
#include <cfloat>

namespace winnow {

/// A query's access to the inside of an OverlapBuffer.
class OverlapWriter {
 public:
  explicit OverlapWriter(OverlapBuffer& out) noexcept : out_(out) {
    out_.clear();
    out_.crossing_.clear();
    aim(sinks_.inside, out_.ids_);
    aim(sinks_.crossing, out_.crossing_);
  }

  [[nodiscard]] RegionSinks& sinks() noexcept { return sinks_; }

  /// Puts the crossing objects behind those inside. False if memory is refused.
  [[nodiscard]] bool finish(Order order) noexcept {
    out_.ids_.set_size(written(sinks_.inside, out_.ids_));
    out_.crossing_.set_size(written(sinks_.crossing, out_.crossing_));
    out_.inside_ = out_.ids_.size();
    if (!out_.ids_.resize(out_.inside_ + out_.crossing_.size())) return false;
    std::copy(out_.crossing_.begin(), out_.crossing_.end(), out_.ids_.begin() + out_.inside_);
    if (order == Order::canonical) {
      std::sort(out_.ids_.begin(), out_.ids_.begin() + out_.inside_);
      std::sort(out_.ids_.begin() + out_.inside_, out_.ids_.end());
    }
    return true;
  }

 private:
  static constexpr std::size_t kLanes = BoundsPool::kBlock;

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
  /// A column too small for any write makes the first one grow it.
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

}  // namespace

Status RowPartition::overlap(const Region& region, OverlapBuffer& objects, const Filter& filter,
                             Order order) const {
  objects.clear();
  const PreparedRegion prepared(region);
  if (prepared.status() != Status::ok) return prepared.status();
  QueryView view;
  if (const Status status = prepare(view); status != Status::ok) return status;
  const KernelFilter wanted(filter, view, keys_);
  if (wanted.meets_nothing()) return Status::ok;
  OverlapWriter writer(objects);
  if (prepared.run(view, wanted.wanted(), writer.sinks()) && writer.finish(order)) {
    return Status::ok;
  }
  objects.clear();
  return Status::out_of_memory;
}

Status RowPartition::overlap(const BoxView&, PairBuffer&, const Filter&, Order) const {
  return Status::unsupported_volume;
}

}  // namespace winnow
