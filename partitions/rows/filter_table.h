#pragma once

#include <winnow/core/filter.h>
#include <winnow/core/key.h>
#include <winnow/core/memory.h>
#include "partitions/rows/filter_span.h"

#include <cstddef>
#include <memory_resource>
#include <span>

namespace winnow {

/// Filters of the objects of a partition, by id. Stores nothing until a filter other than the
/// default is set; from then on every id has an entry, and free ids have the default.
class FilterTable {
 public:
  explicit FilterTable(std::pmr::memory_resource* memory) noexcept : filters_(memory) {}

  /// True from the first filter other than the default until `clear`.
  [[nodiscard]] bool in_use() const noexcept { return !filters_.empty(); }

  /// Makes room for ids below `slots`: now if the table is in use, else when it comes into use.
  /// False, and unchanged, if memory is refused.
  [[nodiscard]] bool reserve(std::size_t slots) noexcept;

  /// Prefaults reserved pages.
  void touch() noexcept { filters_.touch(); }

  /// Starts storing filters. False, and unchanged, if memory is refused.
  [[nodiscard]] bool begin_use() noexcept;

  /// By id; null if not in use.
  [[nodiscard]] const ObjectFilter* data() const noexcept {
    return in_use() ? filters_.data() : nullptr;
  }
  [[nodiscard]] ObjectFilter of(ObjectId id) const noexcept {
    return in_use() ? filters_[id] : ObjectFilter{};
  }

  /// Requires that the table is in use or the filter is the default.
  void set(ObjectId id, const ObjectFilter& filter) noexcept;

  /// Gives a free id the default filter.
  void reset(ObjectId id) noexcept;

  /// Adds the default filter to the span, because objects that are inserted have it.
  void note_new() noexcept { span_.add({}); }

  /// Returns the span of all objects' filters; it may also cover filters that objects had since
  /// `note_build`.
  [[nodiscard]] FilterSpan span() const noexcept;

  /// False if all objects have environment 0 or kAllEnvironments. True otherwise, even if all
  /// share one.
  [[nodiscard]] bool has_environments() const noexcept { return apart_ != 0; }

  /// Returns how often an object changed its environment since `note_build`.
  [[nodiscard]] std::size_t changed_environments() const noexcept { return changed_; }
  /// Resets `changed_environments`, and recomputes the span from all objects (`ids` may contain
  /// holes). O(ids) if a filter was set since the last call.
  void note_build(std::span<const ObjectId> ids) noexcept;

  /// Resets all filters to the default; memory is kept.
  void clear() noexcept;
  void release() noexcept;
  [[nodiscard]] Bytes bytes() const noexcept { return filters_.bytes(); }

 private:
  Column<ObjectFilter> filters_;
  std::size_t slots_ = 0;    // number of entries that the table has while in use
  std::size_t apart_ = 0;    // objects with an environment other than 0 and kAllEnvironments
  std::size_t changed_ = 0;  // environment changes since the last build
  FilterSpan span_;          // of all objects, while in use
  bool span_grown_ = false;  // the span may cover filters that no object has any more
};

}  // namespace winnow
