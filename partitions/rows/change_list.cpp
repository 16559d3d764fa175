#include "partitions/rows/change_list.h"

#include "core/memory/columns.h"

#include <algorithm>

namespace winnow {

bool ChangeList::reserve(std::size_t slots) noexcept {
  const std::size_t words = (slots + 63) / 64;
  const std::size_t limit = slots / 4 + 16;
  if (!bits_.grow(words) || !list_.grow(limit)) return false;
  if (words > bits_.size()) {
    std::fill(bits_.data() + bits_.size(), bits_.data() + words, 0);
    bits_.set_size(words);
  }
  limit_ = std::max(limit_, limit);
  return true;
}

void ChangeList::touch() noexcept {
  touch_columns(bits_, list_);
}

void ChangeList::clear() noexcept {
  for (const ObjectId id : list_) bits_[id >> 6U] = 0;
  list_.clear();
  all_ = false;
}

void ChangeList::release() noexcept {
  release_columns(bits_, list_);
  limit_ = 0;
  all_ = false;
}

Bytes ChangeList::bytes() const noexcept {
  return bytes_of(bits_, list_);
}

void RowChanges::end_refresh(bool track_moves) noexcept {
  if (track_moves) {
    if (stale.all()) {
      moved.add_all();
    } else {
      for (const ObjectId id : stale.ids()) moved.add(id);
    }
  }
  stale.clear();
  any = false;
}

}  // namespace winnow
