// RowPartition: the objects' filters.

#include "partitions/rows/row_partition.h"

#include <algorithm>

namespace winnow {

Status RowPartition::set_filter(std::span<const Key> keys, std::span<const ObjectFilter> filters) {
  if (keys.size() != filters.size()) return Status::size_mismatch;
  if (!std::ranges::all_of(keys, [&](Key key) { return keys_.is_valid(key); })) {
    return Status::invalid_key;
  }
  const bool any = std::ranges::any_of(filters, [](const auto& f) { return f != ObjectFilter{}; });
  if (any && !filters_.begin_use()) return Status::out_of_memory;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const ObjectId id = keys[i].id;
    if (filters_.of(id) == filters[i]) continue;
    filters_.set(id, filters[i]);
    stale_.add(id);
    dirty_.store(true, std::memory_order_relaxed);
  }
  return Status::ok;
}

Status RowPartition::set_filter(Key key, const ObjectFilter& filter) {
  return set_filter(std::span<const Key>(&key, 1), std::span<const ObjectFilter>(&filter, 1));
}

Status RowPartition::filter(Key key, ObjectFilter& filter) const noexcept {
  if (!keys_.is_valid(key)) return Status::invalid_key;
  filter = filters_.of(key.id);
  return Status::ok;
}

}  // namespace winnow
