#include "core/memory/key_table.h"

#include "core/memory/columns.h"

#include <atomic>

namespace winnow {
namespace {

// Partitions of one process get different tags until 4,095 of them have been made.
std::uint32_t next_tag() noexcept {
  static std::atomic<std::uint32_t> counter{0};
  return 1U + counter.fetch_add(1, std::memory_order_relaxed) % 0xFFFU;
}

}  // namespace

KeyTable::KeyTable(std::pmr::memory_resource* memory) noexcept
    : stamps_(memory), rows_(memory), data_(memory), tag_(next_tag() << 20U) {}

bool KeyTable::reserve(std::size_t count) noexcept {
  const std::size_t fresh = count > live_ ? count - live_ : 0;
  if (fresh <= free_count_) return true;
  const std::size_t slots = stamps_.size() + fresh - free_count_;
  return stamps_.grow(slots) && rows_.grow(slots) && data_.grow(slots);
}

Key KeyTable::acquire(std::uint32_t row, ClientData data) noexcept {
  ObjectId id = first_free_;
  if (id != kNoObject) {
    first_free_ = rows_[id];
    --free_count_;
    ++stamps_[id];
  } else {
    id = static_cast<ObjectId>(stamps_.size());
    stamps_.set_size(id + std::size_t{1});
    rows_.set_size(id + std::size_t{1});
    data_.set_size(id + std::size_t{1});
    stamps_[id] = tag_ | 1U;
  }
  rows_[id] = row;
  data_[id] = data;
  ++live_;
  return {id, stamps_[id]};
}

void KeyTable::release(ObjectId id) noexcept {
  --live_;
  if ((stamps_[id] & kGenerationMask) == kGenerationMask) {
    stamps_[id] = tag_;  // generation 0 is even: dead for good
    return;
  }
  ++stamps_[id];
  rows_[id] = first_free_;
  first_free_ = id;
  ++free_count_;
}

void KeyTable::clear() noexcept {
  for (std::size_t slot = stamps_.size(); slot-- > 0;) {
    if (is_live(static_cast<ObjectId>(slot))) release(static_cast<ObjectId>(slot));
  }
}

void KeyTable::release_if_unused() noexcept {
  if (live_ == 0 && stamps_.empty()) {
    release_columns(stamps_, rows_, data_);
  }
}

Bytes KeyTable::key_bytes() const noexcept {
  return bytes_of(stamps_, rows_);
}

}  // namespace winnow
