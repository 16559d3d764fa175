#pragma once

#include <winnow/core/filter.h>
#include "core/memory/key_table.h"
#include "partitions/index/query_view.h"

namespace winnow {

/// Converts a caller's filter for the kernels. Not movable, because its QueryFilter points to it.
class KernelFilter {
 public:
  KernelFilter(const Filter& filter, const QueryView& view, const KeyTable& keys) noexcept
      : predicate_(filter.predicate), keys_(keys) {
    query_filter_.object = filter.object();
    FilterSpan query_span;
    query_span.add(query_filter_.object);
    // If the partition stores no filters, every object has the default filter, so one test decides
    // for all.
    const bool matches_all = surely_match(query_span, view.span);
    const bool filtered = view.filter.layers != nullptr;
    query_filter_.by_object = filtered && !matches_all;
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

}  // namespace winnow
