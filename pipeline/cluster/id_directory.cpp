#include "pipeline/cluster/id_directory.h"

#include "pipeline/cluster/send_queue.h"

#include <algorithm>

namespace winnow {
namespace {

constexpr std::byte kRefusal{1};

/// The messages for one receiver are sorted by sender.
bool is_of(std::span<const RankMessage> parcels, std::uint32_t from) noexcept {
  return std::ranges::binary_search(parcels, from, {}, &RankMessage::from);
}

}  // namespace

void IdDirectory::sort_by_keeper(std::vector<std::uint64_t>& names) const {
  std::sort(names.begin(), names.end(),
            [this](std::uint64_t a, std::uint64_t b) { return keeper_of(a) < keeper_of(b); });
}

void IdDirectory::ask(std::span<const std::uint64_t> names, std::vector<RankMessage>& parcels) {
  sent_.assign(names.begin(), names.end());
  sent_forgotten_.swap(forgotten_);
  forgotten_.clear();
  sort_by_keeper(sent_);
  sort_by_keeper(sent_forgotten_);
  asked_.clear();
  const auto run_of = [this](const std::vector<std::uint64_t>& all, std::size_t first,
                             std::uint32_t to) {
    std::size_t end = first;
    while (end < all.size() && keeper_of(all[end]) == to) ++end;
    return std::span(all).subspan(first, end - first);
  };
  std::size_t s = 0;
  std::size_t f = 0;
  while (s < sent_.size() || f < sent_forgotten_.size()) {
    std::uint32_t to = ranks_;
    if (s < sent_.size()) to = keeper_of(sent_[s]);
    if (f < sent_forgotten_.size()) to = std::min(to, keeper_of(sent_forgotten_[f]));
    const auto fresh = run_of(sent_, s, to);
    const auto gone = run_of(sent_forgotten_, f, to);
    parcels.push_back({rank_, to, {std::as_bytes(fresh), {}, {}, std::as_bytes(gone)}});
    if (!fresh.empty()) asked_.push_back(to);
    s += fresh.size();
    f += gone.size();
  }
}

void IdDirectory::answer(std::span<const RankMessage> asked, std::vector<RankMessage>& parcels) {
  wanted_.clear();
  for (const RankMessage& parcel : asked) {
    for (const std::uint64_t name : column_of<std::uint64_t>(parcel, 3)) names_.erase(name);
    for (const std::uint64_t name : column_of<std::uint64_t>(parcel, 0)) {
      wanted_.push_back({name, parcel.from});
    }
  }
  std::sort(wanted_.begin(), wanted_.end());
  std::vector<std::uint32_t> refused;
  for (std::size_t i = 0; i < wanted_.size(); ++i) {
    const std::uint64_t name = wanted_[i].name;
    const bool twice = (i > 0 && wanted_[i - 1].name == name) ||
                       (i + 1 < wanted_.size() && wanted_[i + 1].name == name);
    if (twice || names_.find(name) != NameTable::kNone) refused.push_back(wanted_[i].from);
  }
  std::sort(refused.begin(), refused.end());
  refused.erase(std::unique(refused.begin(), refused.end()), refused.end());
  for (const std::uint32_t to : refused) parcels.push_back({rank_, to, {std::span(&kRefusal, 1)}});
}

bool IdDirectory::conclude(std::span<const RankMessage> refusals,
                           std::vector<RankMessage>& parcels) {
  if (refusals.empty()) return true;
  for (const std::uint32_t to : asked_) parcels.push_back({rank_, to, {std::span(&kRefusal, 1)}});
  return false;
}

void IdDirectory::keep(std::span<const RankMessage> taken_back) {
  std::erase_if(wanted_, [&](const Wanted& one) { return is_of(taken_back, one.from); });
  names_.reserve(names_.size() + wanted_.size());
  for (const Wanted& one : wanted_) names_.set(one.name, one.from);
  wanted_.clear();
}

}  // namespace winnow
