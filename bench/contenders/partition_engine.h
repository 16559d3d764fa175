#pragma once

#include "bench/common/counting_resource.h"
#include "bench/common/need.h"
#include "bench/common/sample.h"
#include "bench/contenders/engines.h"
#include "bench/contenders/partitions.h"

#include <memory>
#include <string_view>
#include <vector>

namespace winnow::bench {

/// A partition as a simulation uses it: keys are kept from the first frame on, each frame is one
/// bulk update of the objects that moved, and all pairs go into one reused buffer.
class PartitionEngine final : public Engine {
 public:
  /// `name` is one of all_partitions().
  PartitionEngine(std::string_view name, int threads)
      : PartitionEngine(name, execution_for(threads)) {}
  PartitionEngine(std::string_view name, const Execution& execution)
      : partition_(make_named(name, {.memory = &memory_, .execution = execution})) {}

  [[nodiscard]] std::string name() const override { return std::string(partition_.name()); }
  [[nodiscard]] std::size_t largest() const override { return largest_for(partition_.name()); }
  void start(std::span<const Aabb> boxes) override {
    const Stopwatch clock;
    keys_.resize(boxes.size());
    need(partition_.insert(boxes, {}, keys_), "insert");
    update_ms_ = clock.ms();
    find_pairs();
  }
  void frame(std::span<const std::uint32_t> changed_rows,
             std::span<const Aabb> all_boxes) override {
    const Stopwatch clock;
    const std::size_t known = keys_.size();
    const std::span<const Aabb> old_boxes = all_boxes.first(known);
    if (changed_rows.size() == known) {
      need(partition_.update(keys_, old_boxes), "update");
    } else {
      need(partition_.update(keys_, old_boxes, IndexSubset::listed(changed_rows)), "update");
    }
    if (all_boxes.size() > known) {
      keys_.resize(all_boxes.size());
      need(partition_.insert(all_boxes.subspan(known), {}, std::span(keys_).subspan(known)),
           "insert");
    }
    update_ms_ = clock.ms();
    find_pairs();
  }
  [[nodiscard]] std::span<const Pair> pairs() const override { return pairs_.pairs(); }
  [[nodiscard]] std::size_t bytes() const override {
    const Footprint footprint = partition_.footprint();
    return footprint.total().reserved - footprint.results.reserved;
  }
  [[nodiscard]] double update_ms() const override { return update_ms_; }

  [[nodiscard]] const Partition& partition() const noexcept { return partition_; }
  /// The memory resource of the partition; the pair buffer does not use it.
  [[nodiscard]] const CountingResource& memory() const noexcept { return memory_; }
  [[nodiscard]] const PairBuffer& buffer() const noexcept { return pairs_; }

  void forget_peak() noexcept { memory_.forget_peak(); }
  /// Frees the partition; afterwards only the pair buffer can be used.
  void drop_partition() noexcept { partition_ = Partition(StructureKind{}); }

 private:
  void find_pairs() { need(partition_.self_pairs(pairs_), "self_pairs"); }

  CountingResource memory_;
  Partition partition_;
  PairBuffer pairs_;
  std::vector<Key> keys_;
  double update_ms_ = 0.0;
};

}  // namespace winnow::bench
