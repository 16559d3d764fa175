// Linking a PairBuffer and changing it in place; the class comment in linked_pairs.h describes the
// method. Called by the linked and resting pair queries (pair_finder.cpp).

#include "partitions/pairs/linked_pairs.h"

#include "partitions/pairs/pair_tracker.h"

#include <algorithm>
#include <bit>
#include <functional>

namespace winnow {
namespace {

// Following the links of one moved object costs about as much as a pass over all pairs of 48
// objects, independent of the number of pairs per object.
constexpr std::size_t kObjectsPassed = 48;
// Frames over which all pairs of a buffer get links.
constexpr std::size_t kLinkFrames = 4;
// No valid pair: both ids are kNoObject.
constexpr std::uint64_t kMatched = ~std::uint64_t{0};

// Hash table of the found pairs: linear probing, size a power of two, at most half full.
struct FoundTable {
  std::uint64_t* entry;
  std::size_t mask;
  unsigned shift;

  explicit FoundTable(Column<std::uint64_t>& entries) noexcept
      : entry(entries.data()),
        mask(entries.size() - 1),
        shift(64U - static_cast<unsigned>(std::bit_width(mask))) {}

  // Returns the entry of the pair, or the empty entry (0) where it would be inserted.
  [[nodiscard]] std::uint64_t& find(std::uint64_t pair) const noexcept {
    auto at = static_cast<std::size_t>(pair * 0x9E3779B97F4A7C15U >> shift);
    while (entry[at] != 0 && entry[at] != pair) at = (at + 1) & mask;
    return entry[at];
  }
};

}  // namespace

bool LinkedPairs::is_worthwhile(std::size_t moved, std::size_t objects) const noexcept {
  return kObjectsPassed * moved <= objects && can_link();
}

bool LinkedPairs::is_due(std::size_t moved, std::size_t objects) const noexcept {
  return out_.state_ != PairBuffer::LinkState::unlinked && is_worthwhile(moved, objects);
}

void LinkedPairs::unlink_pairs(std::size_t moved, std::size_t objects) noexcept {
  out_.state_ = is_worthwhile(moved, objects) ? PairBuffer::LinkState::few_moved
                                              : PairBuffer::LinkState::unlinked;
}

bool LinkedPairs::grow_heads(std::size_t slots) noexcept {
  Column<std::uint32_t>& heads = out_.heads_;
  const std::size_t known = heads.size();
  if (slots <= known) return true;
  if (!heads.resize(slots)) return false;
  std::fill(heads.begin() + known, heads.end(), kNoPlace);
  return true;
}

bool LinkedPairs::link(std::size_t slots) noexcept {
  if (out_.state_ == PairBuffer::LinkState::linked) return grow_heads(slots);
  out_.heads_.clear();
  out_.links_.clear();
  if (!grow_heads(slots) || !out_.links_.reserve(out_.size())) return false;
  out_.state_ = PairBuffer::LinkState::linked;
  return true;
}

void LinkedPairs::link_next(std::size_t count) noexcept {
  const std::size_t linked = out_.links_.size();
  const std::size_t end = linked + std::min(count, out_.size() - linked);
  for (std::size_t i = linked; i < end; ++i) insert_links(static_cast<std::uint32_t>(i));
  out_.links_.set_size(end);
}

void LinkedPairs::insert_links(std::uint32_t index) noexcept {
  for (std::uint32_t side = 0; side < 2; ++side) {
    std::uint32_t& head = out_.heads_[object_at(out_.rows_[index], side)];
    const std::uint32_t place = 2 * index + side;
    out_.links_[index].next[side] = head;
    out_.links_[index].before[side] = kNoPlace;
    if (head != kNoPlace) out_.links_[head >> 1U].before[head & 1U] = place;
    head = place;
  }
}

void LinkedPairs::remove_links(std::uint32_t index) noexcept {
  for (std::uint32_t side = 0; side < 2; ++side) {
    const std::uint32_t next = out_.links_[index].next[side];
    const std::uint32_t before = out_.links_[index].before[side];
    std::uint32_t& from = before == kNoPlace ? out_.heads_[object_at(out_.rows_[index], side)]
                                             : out_.links_[before >> 1U].next[before & 1U];
    from = next;
    if (next != kNoPlace) out_.links_[next >> 1U].before[next & 1U] = before;
  }
}

void LinkedPairs::move(std::uint32_t from, std::uint32_t to) noexcept {
  out_.rows_[to] = out_.rows_[from];
  out_.links_[to] = out_.links_[from];
  for (std::uint32_t side = 0; side < 2; ++side) {
    const std::uint32_t place = 2 * to + side;
    const std::uint32_t next = out_.links_[to].next[side];
    const std::uint32_t before = out_.links_[to].before[side];
    if (before == kNoPlace) {
      out_.heads_[object_at(out_.rows_[to], side)] = place;
    } else {
      out_.links_[before >> 1U].next[before & 1U] = place;
    }
    if (next != kNoPlace) out_.links_[next >> 1U].before[next & 1U] = place;
  }
}

bool LinkedPairs::hash_found() noexcept {
  Column<std::uint64_t>& table = out_.page_table_;
  const std::span<const Pair> found = begun();
  if (!table.resize(std::bit_ceil(2 * found.size() + 2))) return false;
  std::fill(table.begin(), table.end(), 0);
  const FoundTable entries(table);
  for (const Pair& pair : found) entries.find(as_number(pair)) = as_number(pair);
  return true;
}

// True if the pair was found. Marks it as taken, so that a second call returns false.
bool LinkedPairs::mark_found(const Pair& pair) noexcept {
  std::uint64_t& entry = FoundTable(out_.page_table_).find(as_number(pair));
  if (entry == 0) return false;
  entry = kMatched;
  return true;
}

// Appends the found pairs that `mark_found` did not mark: these pairs began.
void LinkedPairs::append_begun() noexcept {
  std::size_t size = kept_;
  for (const std::uint64_t entry : out_.page_table_) {
    if (entry == 0 || entry == kMatched) continue;
    out_.rows_[size++] = {static_cast<ObjectId>(entry >> 32U), static_cast<ObjectId>(entry)};
  }
  out_.rows_.set_size(size);
}

// Follows the lists of both objects alternately, so that the shorter list determines the cost.
bool LinkedPairs::end(const Pair& pair) noexcept {
  std::uint32_t place[2] = {out_.heads_[pair.first], out_.heads_[pair.second]};
  for (std::uint32_t side = 0;; side ^= 1U) {
    const std::uint32_t index = place[side] >> 1U;
    if (out_.rows_[index] == pair) return out_.places_.push_back(index);
    place[side] = out_.links_[index].next[place[side] & 1U];
  }
}

bool LinkedPairs::sort() noexcept {
  std::ranges::sort(out_.places_, std::greater<>());
  const std::size_t most = std::max(kept_, out_.size() - out_.places_.size());
  return PairTracker::sort(out_, out_.heads_.size(), kept_, out_.size()) && out_.links_.grow(most);
}

// Replaces a pair by the last one; both may be the same.
void LinkedPairs::replace(std::uint32_t index, std::uint32_t last) noexcept {
  const std::size_t linked = out_.links_.size();
  if (index < linked) remove_links(index);
  if (last < linked) {
    if (index != last) move(last, index);
    return out_.links_.set_size(last);
  }
  out_.rows_[index] = out_.rows_[last];
  if (index < linked) insert_links(index);
}

void LinkedPairs::apply() noexcept {
  const std::size_t begun_count = out_.size() - kept_;
  const std::size_t persisting = kept_ - out_.places_.size();
  auto last = static_cast<std::uint32_t>(kept_);
  for (const std::uint32_t index : out_.places_) replace(index, --last);
  std::copy_n(out_.rows_.begin() + kept_, begun_count, out_.rows_.begin() + last);
  out_.rows_.set_size(persisting + begun_count);
  link_next(begun_count + out_.size() / kLinkFrames + 1);
}

}  // namespace winnow
