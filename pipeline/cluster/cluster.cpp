#include <winnow/pipeline/cluster.h>

#include "pipeline/cluster/name_directory.h"
#include "pipeline/cluster/rank_bodies.h"

#include <algorithm>
#include <deque>
#include <limits>
#include <new>
#include <utility>

namespace winnow {

/// The ranks that this process hosts, and what all ranks know.
struct ClusterState {
  ClusterState(Transport& given, const ClusterOptions& with);

  [[nodiscard]] RankBodies* find(std::uint32_t rank) noexcept {
    const std::uint32_t place = rank - first;
    return place < bodies.size() ? &bodies[place] : nullptr;
  }
  [[nodiscard]] bool is_alone() const noexcept { return ranks == 1; }

  [[nodiscard]] Status exchange(std::span<const Parcel>& received);
  [[nodiscard]] Status cut_space();
  [[nodiscard]] Status settle();
  [[nodiscard]] Status deliver();
  [[nodiscard]] Status ask_for_names(std::span<const ClusterBatch> batches,
                                     std::span<Status> answers);
  [[nodiscard]] Status add(std::span<const ClusterBatch> batches, std::span<Status> answers);
  [[nodiscard]] Status self_pairs(Order order);
  [[nodiscard]] Status count(Status found);
  void decide_on_cut();
  [[nodiscard]] Status digest(ClusterDigest& digest);

  Transport& transport;
  ClusterOptions options;
  std::uint32_t ranks;
  std::uint32_t first;
  Status status = Status::ok;
  std::deque<RankBodies> bodies;
  std::deque<NameDirectory> names;
  Regions regions;
  std::vector<Parcel> parcels;
  ClusterStatistics statistics;
  // Of this process, since statistics were last counted.
  std::uint64_t bytes = 0;
  std::uint64_t messages = 0;
  // What decides on cuts, the same on every process.
  bool wants_cut = true;
  bool was_cut = false;
  double after_cut = std::numeric_limits<double>::infinity();  // imbalance
};

namespace {

/// Those of sorted parcels that are for one rank.
std::span<const Parcel> parcels_for(std::span<const Parcel> parcels, std::uint32_t rank) {
  const auto range = std::ranges::equal_range(parcels, rank, {}, &Parcel::to);
  return {range.begin(), range.end()};
}

}  // namespace

ClusterState::ClusterState(Transport& given, const ClusterOptions& with)
    : transport(given), options(with), ranks(given.ranks()), first(given.first_hosted()) {
  for (std::uint32_t i = 0; i < given.hosted(); ++i) {
    bodies.emplace_back(first + i, is_alone(), with);
    names.emplace_back(first + i, ranks, with.memory);
  }
  if (!(with.imbalance >= 1.0) || with.structure == StructureKind{}) {
    status = Status::invalid_argument;
  }
}

/// Sends what is in `parcels`, and counts what leaves its rank.
Status ClusterState::exchange(std::span<const Parcel>& received) {
  for (const Parcel& parcel : parcels) {
    if (parcel.from == parcel.to) continue;
    bytes += parcel.bytes();
    ++messages;
  }
  const Status answer = transport.exchange(parcels, received);
  parcels.clear();
  return answer;
}

Status ClusterState::cut_space() {
  std::vector<CutWork> work;
  for (RankBodies& one : bodies) work.push_back(one.cut_work());
  std::vector<RegionCut> cuts(ranks - 1);
  const Status answer = transport.cut(work, cuts);
  if (answer == Status::ok) regions = Regions(cuts);
  ++statistics.cuts;
  return answer;
}

/// Brings bodies where they belong, and copies to where they are met.
Status ClusterState::settle() {
  const Regions before = regions;
  was_cut = wants_cut && !is_alone();
  if (was_cut) {
    const Status answer = cut_space();
    if (answer != Status::ok) return answer;
  }
  wants_cut = false;
  for (RankBodies& one : bodies) {
    one.send(before, regions, was_cut);
    one.pack(parcels);
  }
  return deliver();
}

/// Brings every rank what others tell it.
Status ClusterState::deliver() {
  std::span<const Parcel> received;
  Status answer = is_alone() ? Status::ok : exchange(received);
  for (std::uint32_t i = 0; i < bodies.size() && answer == Status::ok; ++i) {
    answer = bodies[i].receive(parcels_for(received, first + i));
  }
  return answer;
}

Status ClusterState::ask_for_names(std::span<const ClusterBatch> batches,
                                   std::span<Status> answers) {
  std::span<const Parcel> received;
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (const BodyName name : bodies[i].take_removed()) names[i].forget(name);
    const bool asks = answers[i] == Status::ok;
    names[i].ask(asks ? batches[i].names : std::span<const BodyName>{}, parcels);
  }
  Status answer = exchange(received);
  if (answer != Status::ok) return answer;
  for (std::uint32_t i = 0; i < names.size(); ++i) {
    names[i].answer(parcels_for(received, first + i), parcels);
  }
  answer = exchange(received);
  if (answer != Status::ok) return answer;
  for (std::uint32_t i = 0; i < names.size(); ++i) {
    const bool free = names[i].conclude(parcels_for(received, first + i), parcels);
    if (!free) answers[i] = Status::invalid_key;
  }
  answer = exchange(received);
  if (answer != Status::ok) return answer;
  for (std::uint32_t i = 0; i < names.size(); ++i) {
    names[i].keep(parcels_for(received, first + i));
  }
  return Status::ok;
}

Status ClusterState::add(std::span<const ClusterBatch> batches, std::span<Status> answers) {
  // What was removed is gone on every rank before its name can come anew.
  for (RankBodies& one : bodies) {
    one.send_removals(regions);
    one.pack(parcels);
  }
  Status answer = deliver();
  for (std::size_t i = 0; i < bodies.size() && answer == Status::ok; ++i) {
    answers[i] = bodies[i].check(batches[i]);
  }
  if (answer == Status::ok && !is_alone()) answer = ask_for_names(batches, answers);
  for (std::size_t i = 0; i < bodies.size() && answer == Status::ok; ++i) {
    if (answers[i] == Status::ok) answer = bodies[i].insert(batches[i]);
  }
  return answer;
}

Status ClusterState::self_pairs(Order order) {
  Status found = settle();
  if (found == Status::communication_failed) return found;
  for (RankBodies& one : bodies) {
    if (found == Status::ok) found = one.find_pairs(order);
  }
  return count(found);
}

/// Tells all ranks what each found, also that one could not, and whether to cut space anew.
Status ClusterState::count(Status found) {
  std::uint64_t sums[7] = {0, 0, 0, 0, bytes, messages, 0};
  std::uint64_t greatest[2] = {static_cast<std::uint64_t>(found), 0};
  for (const RankBodies& one : bodies) {
    sums[0] += one.size();
    sums[1] += one.ghosts();
    sums[2] += one.pairs().size();
    sums[3] += one.work();
    sums[6] += one.departed().size();
    greatest[1] = std::max(greatest[1], one.work());
  }
  const Status answer = transport.reduce(sums, greatest);
  if (answer != Status::ok) return answer;
  if (greatest[0] != 0) return static_cast<Status>(greatest[0]);
  bytes = messages = 0;
  const double mean = static_cast<double>(sums[3]) / static_cast<double>(ranks);
  statistics.bodies = sums[0];
  statistics.ghosts = sums[1];
  statistics.pairs = sums[2];
  statistics.bytes = sums[4];
  statistics.messages = sums[5];
  statistics.migrated = sums[6];
  statistics.imbalance = mean > 0.0 ? static_cast<double>(greatest[1]) / mean : 1.0;
  decide_on_cut();
  if (!wants_cut) return Status::ok;
  for (RankBodies& one : bodies) one.measure_work();
  return Status::ok;
}

/// A cut that helped is followed by another; after one that did not, things have to get worse
/// first.
void ClusterState::decide_on_cut() {
  constexpr double kHelped = 0.98;
  constexpr double kWorse = 1.05;
  const double now = statistics.imbalance;
  wants_cut = !is_alone() && now > options.imbalance &&
              (was_cut ? now < kHelped * after_cut : now > kWorse * after_cut);
  if (was_cut) after_cut = now;
}

Status ClusterState::digest(ClusterDigest& digest) {
  std::uint64_t sums[2] = {0, 0};
  for (const RankBodies& one : bodies) {
    for (const NamePair& pair : one.pairs()) {
      const std::uint64_t second = scattered(pair.second + 0x9E3779B97F4A7C15ULL);
      sums[0] += scattered(pair.first ^ second);
      sums[1] += scattered(scattered(pair.first + 0xD1B54A32D192ED03ULL) + second);
    }
  }
  const Status answer = transport.reduce(sums, {});
  if (answer == Status::ok) digest = {sums[0], sums[1]};
  return answer;
}

namespace {

/// A collective call: what goes wrong in it ends the cluster.
template <typename Call>
Status collective(ClusterState* state, Call&& call) noexcept {
  if (state == nullptr) return Status::out_of_memory;
  if (state->status != Status::ok) return state->status;
  try {
    state->status = call();
  } catch (const std::bad_alloc&) {
    state->status = Status::out_of_memory;
  }
  return state->status;
}

/// A call of one rank: refused, it has changed nothing.
template <typename Call>
Status on_rank(ClusterState* state, std::uint32_t rank, Call&& call) noexcept {
  if (state == nullptr) return Status::out_of_memory;
  if (state->status != Status::ok) return state->status;
  RankBodies* const bodies = state->find(rank);
  if (bodies == nullptr) return Status::invalid_argument;
  try {
    return call(*bodies);
  } catch (const std::bad_alloc&) {
    return Status::out_of_memory;
  }
}

}  // namespace

Cluster::Cluster(Transport& transport, const ClusterOptions& options) noexcept {
  try {
    state_ = new ClusterState(transport, options);
  } catch (const std::bad_alloc&) {
    state_ = nullptr;
  }
}

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
  const bool fit = batches.size() == hosted() && answers.size() == hosted();
  const Status status = collective(state_, [&] {
    if (fit) return state_->add(batches, answers);
    // Others wait for this process, which adds nothing.
    const std::vector<ClusterBatch> nothing(hosted());
    std::vector<Status> ignored(hosted());
    return state_->add(nothing, ignored);
  });
  return status == Status::ok && !fit ? Status::size_mismatch : status;
}

Status Cluster::move(std::uint32_t rank, std::span<const BodyName> names, const BoxView& boxes) {
  return on_rank(state_, rank, [&](RankBodies& bodies) { return bodies.move(names, boxes); });
}

Status Cluster::move(std::uint32_t rank, std::span<const Key> keys, const BoxView& boxes) {
  return on_rank(state_, rank, [&](RankBodies& bodies) { return bodies.move(keys, boxes); });
}

Status Cluster::remove(std::uint32_t rank, std::span<const BodyName> names) {
  return on_rank(state_, rank, [&](RankBodies& bodies) { return bodies.remove(names); });
}

Status Cluster::self_pairs(Order order) {
  return collective(state_, [&] { return state_->self_pairs(order); });
}

std::span<const NamePair> Cluster::pairs(std::uint32_t rank) const noexcept {
  const RankBodies* const bodies = state_ == nullptr ? nullptr : state_->find(rank);
  return bodies == nullptr ? std::span<const NamePair>{} : bodies->pairs();
}

Status Cluster::digest(ClusterDigest& digest) {
  return collective(state_, [&] { return state_->digest(digest); });
}

std::size_t Cluster::size(std::uint32_t rank) const noexcept {
  const RankBodies* const bodies = state_ == nullptr ? nullptr : state_->find(rank);
  return bodies == nullptr ? 0 : bodies->size();
}

Status Cluster::bodies(std::uint32_t rank, std::span<ClusterBody> bodies,
                       std::span<Aabb> boxes) const {
  return on_rank(state_, rank, [&](RankBodies& one) { return one.bodies(bodies, boxes); });
}

Status Cluster::key_of(std::uint32_t rank, BodyName name, Key& key) const noexcept {
  return on_rank(state_, rank, [&](RankBodies& one) { return one.key_of(name, key); });
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
