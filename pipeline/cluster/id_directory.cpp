#include "pipeline/cluster/id_directory.h"

#include "pipeline/cluster/send_queue.h"

#include <algorithm>

namespace winnow {
namespace {

constexpr std::byte kRefusal{1};

/// The messages for one receiver are sorted by sender.
bool is_of(std::span<const RankMessage> messages, std::uint32_t from) noexcept {
  return std::ranges::binary_search(messages, from, {}, &RankMessage::from);
}

}  // namespace

void IdDirectory::sort_by_keeper(std::vector<std::uint64_t>& names) const {
  std::sort(names.begin(), names.end(),
            [this](std::uint64_t a, std::uint64_t b) { return keeper_of(a) < keeper_of(b); });
}

void IdDirectory::request(std::span<const std::uint64_t> names,
                          std::vector<RankMessage>& messages) {
  sent_.assign(names.begin(), names.end());
  sent_released_.swap(released_);
  released_.clear();
  sort_by_keeper(sent_);
  sort_by_keeper(sent_released_);
  requested_keepers_.clear();
  const auto run_of = [this](const std::vector<std::uint64_t>& all, std::size_t first,
                             std::uint32_t to) {
    std::size_t end = first;
    while (end < all.size() && keeper_of(all[end]) == to) ++end;
    return std::span(all).subspan(first, end - first);
  };
  std::size_t s = 0;
  std::size_t f = 0;
  while (s < sent_.size() || f < sent_released_.size()) {
    std::uint32_t to = ranks_;
    if (s < sent_.size()) to = keeper_of(sent_[s]);
    if (f < sent_released_.size()) to = std::min(to, keeper_of(sent_released_[f]));
    const auto fresh = run_of(sent_, s, to);
    const auto gone = run_of(sent_released_, f, to);
    messages.push_back({rank_, to, {std::as_bytes(fresh), {}, {}, std::as_bytes(gone)}});
    if (!fresh.empty()) requested_keepers_.push_back(to);
    s += fresh.size();
    f += gone.size();
  }
}

void IdDirectory::answer(std::span<const RankMessage> requests,
                         std::vector<RankMessage>& messages) {
  requests_.clear();
  for (const RankMessage& message : requests) {
    for (const std::uint64_t name : column_of<std::uint64_t>(message, 3)) names_.erase(name);
    for (const std::uint64_t name : column_of<std::uint64_t>(message, 0)) {
      requests_.push_back({name, message.from});
    }
  }
  std::sort(requests_.begin(), requests_.end());
  std::vector<std::uint32_t> refused;
  for (std::size_t i = 0; i < requests_.size(); ++i) {
    const std::uint64_t name = requests_[i].name;
    const bool twice = (i > 0 && requests_[i - 1].name == name) ||
                       (i + 1 < requests_.size() && requests_[i + 1].name == name);
    if (twice || names_.find(name) != NameTable::kNone) refused.push_back(requests_[i].from);
  }
  std::sort(refused.begin(), refused.end());
  refused.erase(std::unique(refused.begin(), refused.end()), refused.end());
  for (const std::uint32_t to : refused) messages.push_back({rank_, to, {std::span(&kRefusal, 1)}});
}

bool IdDirectory::conclude(std::span<const RankMessage> refusals,
                           std::vector<RankMessage>& messages) {
  if (refusals.empty()) return true;
  for (const std::uint32_t to : requested_keepers_)
    messages.push_back({rank_, to, {std::span(&kRefusal, 1)}});
  return false;
}

void IdDirectory::keep(std::span<const RankMessage> withdrawn) {
  std::erase_if(requests_, [&](const NameRequest& one) { return is_of(withdrawn, one.from); });
  names_.reserve(names_.size() + requests_.size());
  for (const NameRequest& one : requests_) names_.set(one.name, one.from);
  requests_.clear();
}

}  // namespace winnow
