#include "partitions/rows/filter_table.h"

#include <algorithm>
#include <utility>

namespace winnow {
namespace {

bool is_apart(const ObjectFilter& filter) noexcept {
  return filter.environment != 0 && filter.environment != kAllEnvironments;
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
  span_ = {};
  span_.add({});
  return true;
}

void FilterTable::set(ObjectId id, const ObjectFilter& filter) noexcept {
  if (!in_use()) return;
  ObjectFilter& own = filters_[id];
  if (own.environment != filter.environment) ++changed_;
  apart_ += is_apart(filter) ? 1U : 0U;
  apart_ -= is_apart(own) ? 1U : 0U;
  own = filter;
  span_.add(filter);
  span_grown_ = true;
}

void FilterTable::reset(ObjectId id) noexcept {
  if (!in_use()) return;
  apart_ -= is_apart(filters_[id]) ? 1U : 0U;
  filters_[id] = {};
  span_grown_ = true;
}

FilterSpan FilterTable::span() const noexcept {
  FilterSpan span = span_;
  if (!in_use()) {
    span = {};
    span.add({});
  }
  span.environments = has_environments();
  return span;
}

void FilterTable::note_build(std::span<const ObjectId> ids) noexcept {
  changed_ = 0;
  if (!in_use() || !std::exchange(span_grown_, false)) return;
  span_ = {};
  for (const ObjectId id : ids) {
    if (id != kNoObject) span_.add(filters_[id]);
  }
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
