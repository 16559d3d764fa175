#include "bench/contenders/partition_engine.h"

#include "bench/common/need.h"
#include "bench/common/sample.h"

namespace winnow::bench {

PartitionEngine::PartitionEngine(std::string_view name, const Execution& execution)
    : partition_(make_named(name, {.memory = &memory_, .execution = execution})) {}

void PartitionEngine::start(std::span<const Aabb> boxes) {
  const Stopwatch clock;
  keys_.resize(boxes.size());
  need(partition_.insert(boxes, {}, keys_), "insert");
  update_ms_ = clock.ms();
  find_pairs();
}

void PartitionEngine::frame(std::span<const std::uint32_t> changed_rows,
                            std::span<const Aabb> all_boxes) {
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

void PartitionEngine::find_pairs() {
  need(partition_.self_pairs(pairs_), "self_pairs");
}

std::size_t PartitionEngine::bytes() const {
  const Footprint footprint = partition_.footprint();
  return footprint.total().reserved - footprint.results.reserved;
}

}  // namespace winnow::bench
