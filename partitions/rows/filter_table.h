#pragma once

#include <winnow/core/column.h>
#include <winnow/core/key.h>
#include <winnow/core/object_filter.h>
#include "partitions/rows/filter_span.h"

#include <cstddef>
#include <memory_resource>
#include <span>

namespace winnow {

/// Filters of a partition's objects by id. It holds nothing until one is set that is not the
/// default; from then on every id has an entry, and free ids have the default.
class FilterTable {
 public:
  explicit FilterTable(std::pmr::memory_resource* memory) noexcept : filters_(memory) {}

  /// True from the first filter that is not the default on, until `clear`.
  [[nodiscard]] bool in_use() const noexcept { return !filters_.empty(); }

  /// Room for ids below `slots`, now if the table is in use, else when it comes into use. False,
  /// and unchanged, if memory is refused.
  [[nodiscard]] bool reserve(std::size_t slots) noexcept;

  /// Writes to the pages that hold nothing yet.
  void touch() noexcept { filters_.touch(); }

  /// Comes into use. False, and unchanged, if memory is refused.
  [[nodiscard]] bool begin_use() noexcept;

  /// By id; null if not in use.
  [[nodiscard]] const ObjectFilter* data() const noexcept {
    return in_use() ? filters_.data() : nullptr;
  }
  [[nodiscard]] ObjectFilter of(ObjectId id) const noexcept {
    return in_use() ? filters_[id] : ObjectFilter{};
  }

  /// The table must be in use, or the filter the default.
  void set(ObjectId id, const ObjectFilter& filter) noexcept;

  /// Gives a free id the default.
  void reset(ObjectId id) noexcept;

  /// Free ids have got objects, with the default.
  void note_new() noexcept { span_.add({}); }

  /// Of all objects' filters, and perhaps of some that objects had since `note_build`.
  [[nodiscard]] FilterSpan span() const noexcept;

  /// False if all objects are of environment 0 or of every environment; true otherwise, even if
  /// they share one.
  [[nodiscard]] bool has_environments() const noexcept { return apart_ != 0; }

  /// How often an object changed its environment since `note_build`.
  [[nodiscard]] std::size_t changed_environments() const noexcept { return changed_; }
  /// These are all objects, and holes between them. O(ids) if a filter was set since the last time.
  void note_build(std::span<const ObjectId> ids) noexcept;

  /// Every filter is the default again; memory is kept.
  void clear() noexcept;
  void release() noexcept;
  [[nodiscard]] Bytes bytes() const noexcept { return filters_.bytes(); }

 private:
  Column<ObjectFilter> filters_;
  std::size_t slots_ = 0;    // entries to have once in use
  std::size_t apart_ = 0;    // objects of an environment of their own
  std::size_t changed_ = 0;  // environments changed since the last build
  FilterSpan span_;          // of every object, while in use
  bool span_grown_ = false;  // filters that it is of may be nobody's now
};

}  // namespace winnow
