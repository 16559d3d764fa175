#include "pipeline/cluster/outbox.h"

#include <algorithm>

namespace winnow {
namespace {

/// As many entries from the front as go to one rank.
template <typename Entry>
std::size_t run_to(std::span<const Entry> entries, std::uint32_t to) noexcept {
  std::size_t count = 0;
  while (count < entries.size() && entries[count].to == to) ++count;
  return count;
}

constexpr auto by_receiver = [](const auto& a, const auto& b) { return a.to < b.to; };

}  // namespace

void BodyOutbox::pack(std::uint32_t from, std::vector<Parcel>& parcels) {
  std::stable_sort(held_.begin(), held_.end(), by_receiver);
  std::stable_sort(gone_.begin(), gone_.end(), by_receiver);
  names_.clear();
  boxes_.clear();
  belongs_.clear();
  gone_names_.clear();
  for (const Held& held : held_) {
    names_.push_back(held.name);
    boxes_.push_back(held.box);
    belongs_.push_back(held.belongs ? 1 : 0);
  }
  for (const Gone& gone : gone_) gone_names_.push_back(gone.name);

  std::size_t h = 0;
  std::size_t g = 0;
  while (h < held_.size() || g < gone_.size()) {
    const bool gone_alone = h == held_.size() || (g < gone_.size() && gone_[g].to < held_[h].to);
    const std::uint32_t to = gone_alone ? gone_[g].to : held_[h].to;
    const std::size_t held = run_to(std::span<const Held>(held_).subspan(h), to);
    const std::size_t gone = run_to(std::span<const Gone>(gone_).subspan(g), to);
    parcels.push_back({from,
                       to,
                       {std::as_bytes(std::span(names_).subspan(h, held)),
                        std::as_bytes(std::span(boxes_).subspan(h, held)),
                        std::as_bytes(std::span(belongs_).subspan(h, held)),
                        std::as_bytes(std::span(gone_names_).subspan(g, gone))}});
    h += held;
    g += gone;
  }
}

BodyNews::BodyNews(const Parcel& parcel) noexcept
    : names(column_of<std::uint64_t>(parcel, 0)),
      boxes(column_of<Aabb>(parcel, 1)),
      belongs(column_of<std::uint8_t>(parcel, 2)),
      gone(column_of<std::uint64_t>(parcel, 3)) {}

}  // namespace winnow
