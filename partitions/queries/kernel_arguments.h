#pragma once

// Arguments and results of the kernels of queries: the prepared cast, the caller's filter, and
// hits.

#include <winnow/core/filter.h>
#include <winnow/core/rays.h>
#include <winnow/core/results.h>
#include "core/memory/key_table.h"
#include "partitions/index/query_view.h"
#include "partitions/queries/cast.kernel.h"

#include <Eigen/Core>
#include <bit>
#include <cstdint>

namespace winnow {

/// Prepares the cast of a box along direction * [min_t, max_t]; the direction is not zero. Writes
/// in place, because copying a struct that was just written stalls on its stores. In casts.cpp.
void prepare_cast(KernelCast& cast, const Aabb& box, const Eigen::Vector3d& direction, double min_t,
                  double max_t) noexcept;

/// Converts a caller's filter for the kernels. Not movable, because its QueryFilter points to it.
class KernelFilter {
 public:
  KernelFilter(const Filter& filter, const QueryView& view, const KeyTable& keys) noexcept
      : predicate_(filter.predicate), keys_(keys) {
    query_filter_.object = filter.object();
    FilterSpan query_span;
    query_span.add(query_filter_.object);
    const bool matches_all = surely_match(query_span, view.span);
    const bool filtered = view.filter.layers != nullptr;
    query_filter_.by_object = filtered && !matches_all;
    // If the partition stores no filters, every object has the default filter, so one test decides
    // for all.
    matches_nothing_ = !filtered && !matches_all;
    if (predicate_.accept == nullptr) return;
    query_filter_.context = this;
    query_filter_.accept = [](const void* context, std::uint32_t id) noexcept {
      const auto& self = *static_cast<const KernelFilter*>(context);
      return self.predicate_.accept(self.predicate_.context, self.keys_.key_of(id),
                                    self.keys_.client_data(id));
    };
  }
  KernelFilter(const KernelFilter&) = delete;
  KernelFilter& operator=(const KernelFilter&) = delete;

  [[nodiscard]] bool matches_nothing() const noexcept { return matches_nothing_; }
  [[nodiscard]] const QueryFilter& query_filter() const noexcept { return query_filter_; }

 private:
  QueryFilter query_filter_;
  ObjectPredicate predicate_;
  const KeyTable& keys_;
  bool matches_nothing_ = false;
};

/// Returns the hit encoded as (bits of t) << 32 | id.
[[nodiscard]] inline Hit to_hit(const KeyTable& keys, std::uint64_t found) noexcept {
  const auto id = static_cast<ObjectId>(found);
  return {keys.key_of(id), keys.client_data(id),
          std::bit_cast<float>(static_cast<std::uint32_t>(found >> 32U))};
}

}  // namespace winnow
