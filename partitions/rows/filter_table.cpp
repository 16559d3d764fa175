#include "partitions/rows/filter_table.h"

#include <algorithm>

namespace winnow {
namespace {

bool is_apart(const ObjectFilter& filter) noexcept {
  return filter.environment != 0 && filter.environment != kEveryEnvironment;
}

}  // namespace

bool FilterTable::reserve(std::size_t slots) noexcept {
  if (slots <= slots_) return true;
  if (in_use()) {
    if (!filters_.grow(slots)) return false;
    std::fill(filters_.end(), filters_.data() + slots, ObjectFilter{});
    filters_.set_size(slots);
  }
  slots_ = slots;
  return true;
}

bool FilterTable::begin_use() noexcept {
  if (in_use()) return true;
  if (!filters_.grow(slots_)) return false;
  filters_.set_size(slots_);
  std::fill(filters_.begin(), filters_.end(), ObjectFilter{});
  return true;
}

void FilterTable::set(ObjectId id, const ObjectFilter& filter) noexcept {
  if (!in_use()) return;
  ObjectFilter& own = filters_[id];
  if (own.environment != filter.environment) ++changed_;
  apart_ += is_apart(filter) ? 1U : 0U;
  apart_ -= is_apart(own) ? 1U : 0U;
  own = filter;
}

void FilterTable::reset(ObjectId id) noexcept {
  if (!in_use()) return;
  apart_ -= is_apart(filters_[id]) ? 1U : 0U;
  filters_[id] = {};
}

void FilterTable::clear() noexcept {
  filters_.clear();
  apart_ = changed_ = 0;
}

void FilterTable::release() noexcept {
  filters_.release();
  slots_ = apart_ = changed_ = 0;
}

}  // namespace winnow
