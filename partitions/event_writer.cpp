#include <winnow/partitions/event_writer.h>

#include <winnow/partitions/counting_sort.h>

#include <algorithm>

namespace winnow {
namespace {

constexpr std::uint64_t packed(const Pair& pair) {
  return static_cast<std::uint64_t>(pair.first) << 32U | pair.second;
}
constexpr ObjectId first_of(std::uint64_t pair) {
  return static_cast<ObjectId>(pair >> 32U);
}
constexpr ObjectId second_of(std::uint64_t pair) {
  return static_cast<ObjectId>(pair);
}

}  // namespace

bool EventWriter::hold_all(const PairBuffer& out) noexcept {
  kept_ = 0;
  return !follows_ || sort_into(events_.before_, out.pairs());
}

bool EventWriter::hold_moved(PairBuffer& out, const std::uint64_t* moved) noexcept {
  kept_ = 0;
  if (!follows_) {
    PairTracker::drop(out, moved);
    return true;
  }
  events_.dropped_.clear();
  if (!PairTracker::drop(out, moved, events_.dropped_)) return false;
  kept_ = out.size();
  return sort_into(events_.before_, {events_.dropped_.data(), events_.dropped_.size()});
}

bool EventWriter::sort_into(Column<std::uint64_t>& list, std::span<const Pair> pairs) noexcept {
  const std::size_t slots = keys_.slot_count();
  if (!list.resize(pairs.size())) return false;
  if (pairs.size() < slots / 16) {
    std::transform(pairs.begin(), pairs.end(), list.begin(), packed);
    std::sort(list.begin(), list.end());
    return true;
  }
  // By the first object in one pass; of each there are few.
  Column<std::uint32_t>& start = events_.start_;
  if (!start.resize(slots + 1)) return false;
  std::fill(start.begin(), start.end(), 0U);
  for (const Pair& pair : pairs) ++start[pair.first];
  (void)positions_from_counts(start);
  for (const Pair& pair : pairs) list[start[pair.first]++] = packed(pair);
  std::uint32_t begin = 0;
  for (std::size_t id = 0; id < slots; ++id) {
    const std::uint32_t end = start[id];
    if (end - begin > 1) std::sort(list.data() + begin, list.data() + end);
    begin = end;
  }
  return true;
}

bool EventWriter::compare(PairBuffer& out) noexcept {
  PairEvents& e = events_;
  e.begun_.clear();
  e.ended_.clear();
  if (!sort_into(e.after_, out.pairs().subspan(kept_))) return false;
  Pair* to = PairTracker::data(out) + kept_;
  const std::uint64_t* before = e.before_.begin();
  const std::uint64_t* after = e.after_.begin();
  while (before != e.before_.end() || after != e.after_.end()) {
    if (after == e.after_.end() || (before != e.before_.end() && *before < *after)) {
      if (!end(*before++)) return false;
    } else if (before == e.before_.end() || *after < *before) {
      if (!begin(*after++)) return false;
    } else {
      if (is_same(*after)) {
        *to++ = {first_of(*after), second_of(*after)};
      } else if (!end(*before) || !begin(*after)) {
        return false;
      }
      ++before;
      ++after;
    }
  }
  e.persisting_ = static_cast<std::size_t>(to - PairTracker::data(out));
  for (const KeyPair& pair : e.begun_) *to++ = {pair.first.id, pair.second.id};
  return true;
}

Key EventWriter::key_before(ObjectId id) const noexcept {
  return {id, events_.stamps_[id]};
}

bool EventWriter::is_same(std::uint64_t pair) const noexcept {
  return key_before(first_of(pair)) == keys_.key_of(first_of(pair)) &&
         key_before(second_of(pair)) == keys_.key_of(second_of(pair));
}

bool EventWriter::end(std::uint64_t pair) noexcept {
  return events_.ended_.push_back({key_before(first_of(pair)), key_before(second_of(pair))});
}

bool EventWriter::begin(std::uint64_t pair) noexcept {
  return events_.begun_.push_back({keys_.key_of(first_of(pair)), keys_.key_of(second_of(pair))});
}

bool EventWriter::take_stamps(std::span<const ObjectId> moved, bool all) noexcept {
  Column<std::uint32_t>& stamps = events_.stamps_;
  const std::size_t slots = keys_.slot_count();
  if (!stamps.resize(slots)) return false;
  if (all || !follows_) {
    for (std::size_t id = 0; id < slots; ++id) {
      stamps[id] = keys_.key_of(static_cast<ObjectId>(id)).stamp;
    }
  } else {
    for (const ObjectId id : moved) stamps[id] = keys_.key_of(id).stamp;
  }
  return true;
}

}  // namespace winnow
