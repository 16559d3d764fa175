#include "partitions/structures/bvh/static_bvh.h"

namespace winnow {

StaticBvh::StaticBvh(const PartitionOptions& options)
    : RowPartition(options, options.volume), boxes_(options.memory) {}

bool StaticBvh::order_rest(std::span<std::uint32_t> rest, Column<std::uint32_t>& order) {
  if (filters().has_environments()) return RowPartition::order_rest(rest, order);
  return append_in_sah_order(pool(), rest, boxes_, order, execution());
}

std::uint64_t StaticBvh::build_price() const noexcept {
  return 240;
}

void StaticBvh::release_memory() noexcept {
  boxes_.release();
  RowPartition::release_memory();
}

void StaticBvh::add_structure_bytes(Footprint& footprint) const noexcept {
  footprint.scratch += boxes_.bytes();
}

}  // namespace winnow
