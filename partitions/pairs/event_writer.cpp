// Computes the events of a pair query: both frames are sorted and merged, or a linked buffer passes
// its changes directly (`store_changes`). Called by PairFinder.

#include "partitions/pairs/event_writer.h"

#include "core/sort/radix_sort.h"

#include <algorithm>
#include <bit>

namespace winnow {
namespace {

constexpr ObjectId first_of(std::uint64_t pair) {
  return static_cast<ObjectId>(pair >> 32U);
}
constexpr ObjectId second_of(std::uint64_t pair) {
  return static_cast<ObjectId>(pair);
}

// Sorts runs of equal first object by the second object.
void sort_runs(std::span<std::uint64_t> list) {
  constexpr std::size_t kShort = 16;
  std::size_t begin = 0;
  while (begin < list.size()) {
    std::size_t end = begin + 1;
    while (end < list.size() && first_of(list[end]) == first_of(list[begin])) {
      // Short runs are sorted by insertion.
      if (end - begin < kShort) {
        const std::uint64_t pair = list[end];
        std::size_t at = end;
        for (; at > begin && list[at - 1] > pair; --at) list[at] = list[at - 1];
        list[at] = pair;
      }
      ++end;
    }
    if (end - begin > kShort) {
      std::sort(list.begin() + static_cast<std::ptrdiff_t>(begin),
                list.begin() + static_cast<std::ptrdiff_t>(end));
    }
    begin = end;
  }
}

}  // namespace

bool EventWriter::reserve(PairEvents& events, std::size_t pairs, std::size_t objects,
                          Pages pages) noexcept {
  PairEvents& e = events;
  const auto each = [&](std::size_t count, auto&... columns) {
    return (columns.reserve(count, pages) && ...);
  };
  if (!each(pairs, e.begun_, e.ended_, e.dropped_, e.before_, e.after_, e.spare_) ||
      !e.stamps_.reserve(objects, pages)) {
    return false;
  }
  return !e.with_client_data_ ||
         (each(pairs, e.begun_data_, e.ended_data_) && e.data_.reserve(objects, pages));
}

bool EventWriter::hold_all(const PairBuffer& out) noexcept {
  kept_ = 0;
  if (!follows_) return true;
  if (events_.after_is_all_) {
    events_.before_.swap(events_.after_);
    events_.after_is_all_ = false;
  } else if (!sort_into(events_.before_, out.pairs())) {
    return false;
  }
  held_ = HeldPairs::all;
  return true;
}

bool EventWriter::hold_moved(PairBuffer& out, const std::uint64_t* moved) noexcept {
  kept_ = 0;
  if (!follows_) {
    PairTracker::drop(out, moved);
    return true;
  }
  events_.dropped_.clear();
  if (!PairTracker::drop(out, moved, events_.dropped_)) return false;
  held_ = HeldPairs::dropped;
  kept_ = out.size();
  return sort_into(events_.before_, {events_.dropped_.data(), events_.dropped_.size()});
}

bool EventWriter::sort_into(Column<std::uint64_t>& list, std::span<const Pair> pairs) noexcept {
  constexpr std::size_t kFew = 512;
  const std::size_t count = pairs.size();
  if (!list.resize(count)) return false;
  std::transform(pairs.begin(), pairs.end(), list.begin(), as_number);
  if (count < kFew) {
    std::sort(list.begin(), list.end());
    return true;
  }
  // Radix sort by the first object. sort_runs then sorts the few pairs of each first object.
  if (!events_.spare_.resize(count)) return false;
  const auto bits = static_cast<unsigned>(std::bit_width(keys_.slot_count()));
  const std::uint64_t* const sorted =
      radix_sort(list.data(), events_.spare_.data(), count, bits, execution_);
  if (sorted != list.data()) list.swap(events_.spare_);
  sort_runs({list.data(), count});
  return true;
}

bool EventWriter::compare(PairBuffer& out, std::span<const ObjectId> moved, bool all) noexcept {
  PairEvents& e = events_;
  e.begun_.clear();
  e.ended_.clear();
  e.after_is_all_ = false;
  if (!sort_into(e.after_, out.pairs().subspan(kept_))) return false;
  other_keys_ = follows_ && any_other_key(moved, all);
  Pair* to = PairTracker::data(out) + kept_;
  if (!merge(to)) return false;
  e.persisting_ = static_cast<std::size_t>(to - PairTracker::data(out));
  for (const KeyPair& pair : e.begun_) *to++ = {pair.first.id, pair.second.id};
  e.after_is_all_ = kept_ == 0;
  return write_client_data() && reserve_frame(moved, all);
}

bool EventWriter::store_changes(const PairBuffer& out, std::span<const Pair> begun,
                                std::span<const std::uint32_t> ended,
                                std::span<const ObjectId> moved) noexcept {
  PairEvents& e = events_;
  e.begun_.clear();
  e.ended_.clear();
  e.after_is_all_ = false;
  for (const std::uint32_t index : ended) {
    if (!end(as_number(out[index]))) return false;
  }
  std::ranges::sort(e.ended_, {}, [](const KeyPair& pair) {
    return as_number({pair.first.id, pair.second.id});
  });
  for (const Pair& pair : begun) {
    if (!begin(as_number(pair))) return false;
  }
  e.persisting_ = out.size() - begun.size() - ended.size();
  return write_client_data() && reserve_frame(moved, false);
}

// Merges two ascending lists. Writes the pairs that persist from `to` on.
bool EventWriter::merge(Pair*& to) noexcept {
  const std::uint64_t* before = events_.before_.begin();
  const std::uint64_t* const before_end = events_.before_.end();
  for (const std::uint64_t pair : std::span(events_.after_.data(), events_.after_.size())) {
    while (before != before_end && *before < pair) {
      if (!end(*before++)) return false;
    }
    const bool was = before != before_end && *before == pair;
    if (was) ++before;
    if (was && !(other_keys_ && (is_other(first_of(pair)) || is_other(second_of(pair))))) {
      *to++ = {first_of(pair), second_of(pair)};
    } else if ((was && !end(pair)) || !begin(pair)) {
      return false;
    }
  }
  while (before != before_end) {
    if (!end(*before++)) return false;
  }
  return true;
}

bool EventWriter::any_other_key(std::span<const ObjectId> moved, bool all) const noexcept {
  const std::size_t known = events_.stamps_.size();
  if (!all) {
    return std::ranges::any_of(moved, [&](ObjectId id) { return id < known && is_other(id); });
  }
  bool any = false;
  for (std::size_t id = 0; id < known; ++id) any |= is_other(static_cast<ObjectId>(id));
  return any;
}

bool EventWriter::end(std::uint64_t pair) noexcept {
  return events_.ended_.push_back({key_before(first_of(pair)), key_before(second_of(pair))});
}

bool EventWriter::begin(std::uint64_t pair) noexcept {
  return events_.begun_.push_back({keys_.key_of(first_of(pair)), keys_.key_of(second_of(pair))});
}

// Fills the client data of the sorted begun and ended pairs. Ended pairs use the data of the last
// frame.
bool EventWriter::write_client_data() noexcept {
  PairEvents& e = events_;
  if (!e.with_client_data_) return true;
  if (!e.begun_data_.resize(e.begun_.size()) || !e.ended_data_.resize(e.ended_.size())) {
    return false;
  }
  std::ranges::transform(e.begun_, e.begun_data_.begin(), [&](const KeyPair& pair) {
    return ClientDataPair{keys_.client_data(pair.first.id), keys_.client_data(pair.second.id)};
  });
  std::ranges::transform(e.ended_, e.ended_data_.begin(), [&](const KeyPair& pair) {
    return ClientDataPair{e.data_[pair.first.id], e.data_[pair.second.id]};
  });
  return true;
}

// Reserves the stamps and client data of this frame. The stamps and data of `moved`, or of all
// objects, may have changed.
bool EventWriter::reserve_frame(std::span<const ObjectId> moved, bool all) noexcept {
  moved_ = moved;
  all_ = all || !follows_;
  const std::size_t slots = keys_.slot_count();
  return events_.stamps_.grow(slots) && (!events_.with_client_data_ || events_.data_.grow(slots));
}

void EventWriter::finish_frame(PairBuffer::Provenance provenance) noexcept {
  Column<std::uint32_t>& stamps = events_.stamps_;
  Column<ClientData>& data = events_.data_;
  const bool with_data = events_.with_client_data_;
  const std::size_t slots = keys_.slot_count();
  events_.provenance_ = provenance;
  stamps.set_size(slots);
  if (with_data) data.set_size(slots);
  if (all_) {
    for (std::size_t id = 0; id < slots; ++id) {
      stamps[id] = keys_.key_of(static_cast<ObjectId>(id)).stamp;
    }
    if (with_data) std::ranges::copy(keys_.all_client_data(), data.begin());
    return;
  }
  for (const ObjectId id : moved_) stamps[id] = keys_.key_of(id).stamp;
  if (with_data) {
    for (const ObjectId id : moved_) data[id] = keys_.client_data(id);
  }
}

// Allocates nothing, because the buffer contained all of these pairs before.
bool EventWriter::undo(PairBuffer& out, PairBuffer::Provenance provenance) noexcept {
  PairEvents& e = events_;
  e.begun_.clear();
  e.ended_.clear();
  e.begun_data_.clear();
  e.ended_data_.clear();
  e.persisting_ = 0;
  e.after_is_all_ = false;
  if (!follows_) return false;
  Pair* const pairs = PairTracker::data(out);
  if (held_ == HeldPairs::kept || held_ == HeldPairs::dropped) PairTracker::set_size(out, kept_);
  if (held_ == HeldPairs::dropped) {
    std::ranges::copy(e.dropped_, pairs + kept_);
    PairTracker::set_size(out, kept_ + e.dropped_.size());
  } else if (held_ == HeldPairs::all) {
    std::ranges::transform(e.before_, pairs, [](std::uint64_t pair) {
      return Pair{first_of(pair), second_of(pair)};
    });
    PairTracker::set_size(out, e.before_.size());
  }
  e.persisting_ = out.size();
  e.provenance_ = provenance;
  PairTracker::set_provenance(out, provenance);
  return true;
}

}  // namespace winnow
