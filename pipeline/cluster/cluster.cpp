// Cluster: collective calls, each a sequence of steps on the hosted ranks (rank_bodies.h) and
// exchanges between ranks (rank_group.h).

#include <winnow/pipeline/cluster.h>

#include "core/memory/catch_bad_alloc.h"
#include "core/threads/float_environment.h"
#include "pipeline/cluster/rank_bodies.h"
#include "pipeline/cluster/rank_group.h"

#include <deque>
#include <vector>

namespace winnow {

/// State of a Cluster: the hosted ranks and their boxes.
struct ClusterState : RankGroup {
  ClusterState(Transport& given, const ClusterOptions& with);

  [[nodiscard]] RankBodies* find(std::uint32_t rank) noexcept {
    const std::uint32_t place = rank - first;
    return place < bodies.size() ? &bodies[place] : nullptr;
  }

  [[nodiscard]] Status migrate();
  [[nodiscard]] Status deliver(const OverlappedWork& meanwhile = {});
  [[nodiscard]] Status take_names_of(std::span<const ClusterBatch> batches,
                                     std::span<Status> answers);
  [[nodiscard]] Status add(std::span<const ClusterBatch> batches, std::span<Status> answers);
  [[nodiscard]] Status self_pairs(Order order);
  [[nodiscard]] Status count_found(Status found);
  [[nodiscard]] Status digest(ClusterDigest& digest);

  std::deque<RankBodies> bodies;
};

ClusterState::ClusterState(Transport& given, const ClusterOptions& with)
    : RankGroup(given, with.imbalance, with.memory) {
  for (std::uint32_t i = 0; i < given.hosted(); ++i)
    bodies.emplace_back(first + i, is_single_rank(), with);
  if (with.structure == StructureKind{}) status = Status::invalid_argument;
}

/// Sends bodies to the ranks that they belong to, and copies to the ranks that they overlap.
Status ClusterState::migrate() {
  const Regions before = regions;
  was_cut = needs_cut && !is_single_rank();
  if (was_cut) {
    std::vector<CutWork> work;
    for (RankBodies& one : bodies) work.push_back(one.cut_work());
    const Status answer = cut_space(work);
    if (answer != Status::ok) return answer;
  }
  needs_cut = false;
  for (RankBodies& one : bodies) {
    one.send(before, regions, was_cut);
    one.pack(messages);
  }
  // Refresh during the exchange, except after a cut, when many bodies come and go.
  if (was_cut) return deliver();
  return deliver({[](void* state) noexcept {
                    for (RankBodies& one : static_cast<ClusterState*>(state)->bodies) one.refresh();
                  },
                  this});
}

/// Exchanges the packed messages, and applies the received ones.
Status ClusterState::deliver(const OverlappedWork& meanwhile) {
  std::span<const RankMessage> received;
  Status answer = is_single_rank() ? Status::ok : exchange(received, meanwhile);
  for (std::uint32_t i = 0; i < bodies.size() && answer == Status::ok; ++i) {
    answer = bodies[i].receive(messages_for(received, first + i));
  }
  return answer;
}

Status ClusterState::take_names_of(std::span<const ClusterBatch> batches,
                                   std::span<Status> answers) {
  std::vector<std::vector<BodyName>> removed;
  std::vector<std::span<const BodyName>> freed;
  std::vector<std::span<const BodyName>> requested;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    freed.emplace_back(removed.emplace_back(bodies[i].take_removed()));
    requested.push_back(answers[i] == Status::ok ? batches[i].names : std::span<const BodyName>{});
  }
  return take_names(freed, requested, answers);
}

Status ClusterState::add(std::span<const ClusterBatch> batches, std::span<Status> answers) {
  // Remove bodies on every rank before their names can be added again.
  for (RankBodies& one : bodies) {
    one.forget_pairs();
    one.send_removals(regions);
    one.pack(messages);
  }
  Status answer = deliver();
  for (std::size_t i = 0; i < bodies.size() && answer == Status::ok; ++i) {
    answers[i] = bodies[i].check(batches[i]);
  }
  if (answer == Status::ok && !is_single_rank()) answer = take_names_of(batches, answers);
  for (std::size_t i = 0; i < bodies.size() && answer == Status::ok; ++i) {
    if (answers[i] == Status::ok) answer = bodies[i].insert(batches[i]);
  }
  return answer;
}

Status ClusterState::self_pairs(Order order) {
  Status found = migrate();
  if (found == Status::communication_failed) return found;
  for (RankBodies& one : bodies) {
    if (found == Status::ok) found = one.find_pairs(order);
  }
  return count_found(found);
}

Status ClusterState::count_found(Status found) {
  std::vector<RankCounts> counts;
  for (const RankBodies& one : bodies) {
    counts.push_back(
        {one.size(), one.ghosts(), one.pairs().size(), one.departed().size(), one.work()});
  }
  const Status answer = count(counts, found);
  if (answer != Status::ok || !needs_cut) return answer;
  for (RankBodies& one : bodies) one.measure_work();
  return Status::ok;
}

Status ClusterState::digest(ClusterDigest& digest) {
  std::uint64_t sums[2] = {0, 0};
  for (const RankBodies& one : bodies) {
    for (const NamePair pair : one.pairs()) {
      const std::uint64_t second = scattered(pair.second + 0x9E3779B97F4A7C15ULL);
      sums[0] += scattered(pair.first ^ second);
      sums[1] += scattered(scattered(pair.first + 0xD1B54A32D192ED03ULL) + second);
    }
  }
  const Status answer = transport.reduce(sums, {});
  if (answer == Status::ok) digest = {sums[0], sums[1]};
  return answer;
}

Cluster::Cluster(Transport& transport, const ClusterOptions& options) noexcept
    : state_(catch_bad_alloc([&] { return new ClusterState(transport, options); },
                             static_cast<ClusterState*>(nullptr))) {}

Cluster::~Cluster() {
  delete state_;
}

Status Cluster::status() const noexcept {
  return state_ == nullptr ? Status::out_of_memory : state_->status;
}

std::uint32_t Cluster::ranks() const noexcept {
  return state_ == nullptr ? 0 : state_->ranks;
}

std::uint32_t Cluster::first_hosted() const noexcept {
  return state_ == nullptr ? 0 : state_->first;
}

std::uint32_t Cluster::hosted() const noexcept {
  return state_ == nullptr ? 0 : static_cast<std::uint32_t>(state_->bodies.size());
}

Status Cluster::add(std::span<const ClusterBatch> batches, std::span<Status> answers) {
  const DefaultFloatEnvironment environment;
  const bool fit = batches.size() == hosted() && answers.size() == hosted();
  const Status status = collective(state_, CollectiveCall::add, [&] {
    if (fit) return state_->add(batches, answers);
    // The call is collective: other processes wait for this one, which adds no bodies.
    const std::vector<ClusterBatch> nothing(hosted());
    std::vector<Status> ignored(hosted());
    return state_->add(nothing, ignored);
  });
  return status == Status::ok && !fit ? Status::size_mismatch : status;
}

Status Cluster::move(std::uint32_t rank, std::span<const BodyName> names, const BoxView& boxes) {
  const DefaultFloatEnvironment environment;
  return on_rank(state_, rank, [&](RankBodies& bodies) { return bodies.move(names, boxes); });
}

Status Cluster::move(std::uint32_t rank, std::span<const Key> keys, const BoxView& boxes) {
  const DefaultFloatEnvironment environment;
  return on_rank(state_, rank, [&](RankBodies& bodies) { return bodies.move(keys, boxes); });
}

Status Cluster::remove(std::uint32_t rank, std::span<const BodyName> names) {
  const DefaultFloatEnvironment environment;
  return on_rank(state_, rank, [&](RankBodies& bodies) { return bodies.remove(names); });
}

Status Cluster::self_pairs(Order order) {
  const DefaultFloatEnvironment environment;
  return collective(state_, CollectiveCall::find, [&] { return state_->self_pairs(order); });
}

NamePairs Cluster::pairs(std::uint32_t rank) const noexcept {
  const RankBodies* const bodies = state_ == nullptr ? nullptr : state_->find(rank);
  return bodies == nullptr ? NamePairs({}, 0) : bodies->pairs();
}

Answer<ClusterDigest> Cluster::digest() {
  const DefaultFloatEnvironment environment;
  ClusterDigest digest;
  const Status status =
      collective(state_, CollectiveCall::digest, [&] { return state_->digest(digest); });
  if (status != Status::ok) return status;
  return digest;
}

std::size_t Cluster::size(std::uint32_t rank) const noexcept {
  const RankBodies* const bodies = state_ == nullptr ? nullptr : state_->find(rank);
  return bodies == nullptr ? 0 : bodies->size();
}

Status Cluster::bodies(std::uint32_t rank, std::span<ClusterBody> bodies,
                       std::span<Aabb> boxes) const {
  return on_rank(state_, rank, [&](RankBodies& one) { return one.bodies(bodies, boxes); });
}

Answer<Key> Cluster::key_of(std::uint32_t rank, BodyName name) const noexcept {
  Key key;
  const Status status =
      on_rank(state_, rank, [&](RankBodies& one) { return one.key_of(name, key); });
  if (status != Status::ok) return status;
  return key;
}

std::span<const ClusterBody> Cluster::arrived(std::uint32_t rank) const noexcept {
  const RankBodies* const bodies = state_ == nullptr ? nullptr : state_->find(rank);
  return bodies == nullptr ? std::span<const ClusterBody>{} : bodies->arrived();
}

std::span<const BodyName> Cluster::departed(std::uint32_t rank) const noexcept {
  const RankBodies* const bodies = state_ == nullptr ? nullptr : state_->find(rank);
  return bodies == nullptr ? std::span<const BodyName>{} : bodies->departed();
}

ClusterStatistics Cluster::statistics() const noexcept {
  return state_ == nullptr ? ClusterStatistics{} : state_->statistics;
}

Bytes Cluster::bytes() const noexcept {
  Bytes sum;
  if (state_ == nullptr) return sum;
  for (const RankBodies& one : state_->bodies) sum += one.bytes();
  return sum;
}

}  // namespace winnow
