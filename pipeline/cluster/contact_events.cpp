#include "pipeline/cluster/contact_events.h"

#include "pipeline/cluster/name_table.h"
#include "pipeline/cluster/send_queue.h"

#include <algorithm>
#include <iterator>

namespace winnow {

std::uint32_t ContactEvents::keeper_of(const TouchingPair& pair) const noexcept {
  const std::uint64_t hash = scattered(scattered(pair.a) + pair.b);
  return static_cast<std::uint32_t>((hash >> 32U) % ranks_);
}

/// Adds one message per receiver: begun pairs, then ended pairs.
void ContactEvents::post(std::vector<AddressedPair>& begun, std::vector<AddressedPair>& ended,
                         Columns& columns, std::vector<RankMessage>& messages) const {
  columns.begun.clear();
  columns.ended.clear();
  std::sort(begun.begin(), begun.end());
  std::sort(ended.begin(), ended.end());
  for (const AddressedPair& one : begun) columns.begun.push_back(one.pair);
  for (const AddressedPair& one : ended) columns.ended.push_back(one.pair);
  const std::span<const AddressedPair> all_begun(begun);
  const std::span<const AddressedPair> all_ended(ended);
  for_each_receiver(all_begun, all_ended, [&](std::uint32_t to, auto ones, auto others) {
    const auto i = static_cast<std::size_t>(ones.data() - begun.data());
    const auto k = static_cast<std::size_t>(others.data() - ended.data());
    messages.push_back({rank_,
                        to,
                        {std::as_bytes(std::span(columns.begun).subspan(i, ones.size())),
                         std::as_bytes(std::span(columns.ended).subspan(k, others.size()))}});
  });
}

void ContactEvents::request(std::vector<RankMessage>& messages) {
  post(begun_uncertain_, ended_uncertain_, requests_, messages);
}

void ContactEvents::answer(std::span<const RankMessage> requests,
                           std::vector<RankMessage>& messages) {
  struct SentPairs {
    TouchingPair pair;
    std::uint32_t by;
    bool operator<(const SentPairs& other) const noexcept { return pair < other.pair; }
  };
  std::vector<SentPairs> begun;
  std::vector<SentPairs> ended;
  for (const RankMessage& message : requests) {
    for (const TouchingPair& pair : column_of<TouchingPair>(message, 0)) {
      begun.push_back({pair, message.from});
    }
    for (const TouchingPair& pair : column_of<TouchingPair>(message, 1)) {
      ended.push_back({pair, message.from});
    }
  }
  std::sort(begun.begin(), begun.end());
  std::sort(ended.begin(), ended.end());
  // These lists have been copied to the sent messages: reuse them.
  begun_uncertain_.clear();
  ended_uncertain_.clear();
  for (const SentPairs& one : begun) {
    if (std::binary_search(ended.begin(), ended.end(), one)) {
      begun_uncertain_.push_back({one.by, one.pair});
    }
  }
  for (const SentPairs& one : ended) {
    if (std::binary_search(begun.begin(), begun.end(), one)) {
      ended_uncertain_.push_back({one.by, one.pair});
    }
  }
  post(begun_uncertain_, ended_uncertain_, answered_, messages);
}

void ContactEvents::conclude(std::span<const RankMessage> answers) {
  std::vector<TouchingPair> persisting;
  for (const RankMessage& message : answers) {
    for (const TouchingPair& pair : column_of<TouchingPair>(message, 0)) {
      const auto at = std::lower_bound(touching_.begin(), touching_.end(), pair);
      persisted_[static_cast<std::size_t>(at - touching_.begin())] = 1;
    }
    const auto ended = column_of<TouchingPair>(message, 1);
    persisting.insert(persisting.end(), ended.begin(), ended.end());
  }
  std::sort(persisting.begin(), persisting.end());
  std::erase_if(ended_, [&](const TouchingPair& pair) {
    return std::binary_search(persisting.begin(), persisting.end(), pair);
  });
}

void ContactEvents::add_touching(std::span<const TouchingPair> pairs) {
  std::vector<TouchingPair> both;
  both.reserve(touching_.size() + pairs.size());
  std::set_union(touching_.begin(), touching_.end(), pairs.begin(), pairs.end(),
                 std::back_inserter(both));
  touching_.swap(both);
}

}  // namespace winnow
