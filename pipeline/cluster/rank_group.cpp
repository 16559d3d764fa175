#include "pipeline/cluster/rank_group.h"

#include <algorithm>

namespace winnow {

std::span<const RankMessage> messages_for(std::span<const RankMessage> messages,
                                          std::uint32_t rank) {
  // clang 14 cannot read std::ranges::subrange.
  const auto begin = std::ranges::lower_bound(messages, rank, {}, &RankMessage::to);
  return {begin, std::ranges::upper_bound(begin, messages.end(), rank, {}, &RankMessage::to)};
}

RankGroup::RankGroup(Transport& given, double imbalance_bound, std::pmr::memory_resource* memory)
    : transport(given),
      ranks(given.ranks()),
      first(given.first_hosted()),
      imbalance_(imbalance_bound) {
  for (std::uint32_t i = 0; i < given.hosted(); ++i) names.emplace_back(first + i, ranks, memory);
  if (!(imbalance_bound >= 1.0)) status = Status::invalid_argument;
}

Status RankGroup::exchange(std::span<const RankMessage>& received,
                           const OverlappedWork& meanwhile) {
  for (const RankMessage& message : messages) {
    if (message.from == message.to) continue;
    bytes_ += message.bytes();
    ++message_count_;
  }
  const Status answer = transport.exchange(messages, received, meanwhile);
  messages.clear();
  return answer;
}

Status RankGroup::cut_space(std::span<const CutWork> work) {
  std::vector<SplitPlane> cuts(ranks - 1);
  const Status answer = transport.cut(work, cuts);
  if (answer == Status::ok) regions = Regions(cuts);
  ++statistics.cuts;
  return answer;
}

Status RankGroup::take_names(std::span<const std::span<const BodyName>> freed,
                             std::span<const std::span<const BodyName>> requested,
                             std::span<Status> answers) {
  std::span<const RankMessage> received;
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (const BodyName name : freed[i]) names[i].release(name);
    names[i].request(requested[i], messages);
  }
  Status answer = exchange(received);
  if (answer != Status::ok) return answer;
  for (std::uint32_t i = 0; i < names.size(); ++i) {
    names[i].answer(messages_for(received, first + i), messages);
  }
  answer = exchange(received);
  if (answer != Status::ok) return answer;
  for (std::uint32_t i = 0; i < names.size(); ++i) {
    const bool free = names[i].conclude(messages_for(received, first + i), messages);
    if (!free) answers[i] = Status::invalid_key;
  }
  answer = exchange(received);
  if (answer != Status::ok) return answer;
  for (std::uint32_t i = 0; i < names.size(); ++i) {
    names[i].keep(messages_for(received, first + i));
  }
  return Status::ok;
}

Status RankGroup::count(std::span<const RankCounts> counts, Status found) {
  std::uint64_t sums[7] = {0, 0, 0, 0, bytes_, message_count_, 0};
  std::uint64_t greatest[2] = {static_cast<std::uint64_t>(found), 0};
  for (const RankCounts& one : counts) {
    sums[0] += one.bodies;
    sums[1] += one.ghosts;
    sums[2] += one.pairs;
    sums[3] += one.work;
    sums[6] += one.migrated;
    greatest[1] = std::max(greatest[1], one.work);
  }
  const Status answer = transport.reduce(sums, greatest);
  if (answer != Status::ok) return answer;
  if (greatest[0] != 0) return static_cast<Status>(greatest[0]);
  bytes_ = message_count_ = 0;
  const double mean = static_cast<double>(sums[3]) / static_cast<double>(ranks);
  statistics.bodies = sums[0];
  statistics.ghosts = sums[1];
  statistics.pairs = sums[2];
  statistics.bytes = sums[4];
  statistics.messages = sums[5];
  statistics.migrated = sums[6];
  statistics.imbalance = mean > 0.0 ? static_cast<double>(greatest[1]) / mean : 1.0;
  decide_on_cut();
  return Status::ok;
}

/// Space is cut again if the imbalance exceeds its bound and also: directly after a cut, if that
/// cut reduced the imbalance by more than 2 %; later, if the imbalance is more than 5 % above its
/// value after the last cut.
void RankGroup::decide_on_cut() {
  constexpr double kHelped = 0.98;
  constexpr double kWorse = 1.05;
  const double now = statistics.imbalance;
  needs_cut = !is_single_rank() && now > imbalance_ &&
              (was_cut ? now < kHelped * after_cut_ : now > kWorse * after_cut_);
  if (was_cut) after_cut_ = now;
}

}  // namespace winnow
