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
    wanted_.object = filter.object();
    FilterSpan asking;
    asking.add(wanted_.object);
    // If the partition stores no filters, every object has the default filter, so one test decides
    // for all.
    const bool matches_all = surely_match(asking, view.span);
    const bool filtered = view.filter.layers != nullptr;
    wanted_.by_object = filtered && !matches_all;
    matches_nothing_ = !filtered && !matches_all;
    if (predicate_.accept == nullptr) return;
    wanted_.context = this;
    wanted_.accept = [](const void* context, std::uint32_t id) noexcept {
      const auto& self = *static_cast<const KernelFilter*>(context);
      return self.predicate_.accept(self.predicate_.context, self.keys_.key_of(id),
                                    self.keys_.client_data(id));
    };
  }
  KernelFilter(const KernelFilter&) = delete;
  KernelFilter& operator=(const KernelFilter&) = delete;

  [[nodiscard]] bool matches_nothing() const noexcept { return matches_nothing_; }
  [[nodiscard]] const QueryFilter& wanted() const noexcept { return wanted_; }

 private:
  QueryFilter wanted_;
  ObjectPredicate predicate_;
  const KeyTable& keys_;
  bool matches_nothing_ = false;
};

}  // namespace winnow
