#pragma once

#include <winnow/pipeline/cluster.h>
#include "core/memory/catch_bad_alloc.h"
#include "pipeline/cluster/id_directory.h"
#include "pipeline/cluster/regions.h"

#include <cstdint>
#include <deque>
#include <limits>
#include <memory_resource>
#include <span>
#include <vector>

namespace winnow {

/// Counters of one rank, to be summed over all ranks.
struct RankCounts {
  std::uint64_t bodies = 0;
  std::uint64_t ghosts = 0;
  std::uint64_t pairs = 0;
  std::uint64_t migrated = 0;
  std::uint64_t work = 0;
};

/// Returns the messages to one rank, of messages that are sorted by receiver.
[[nodiscard]] std::span<const RankMessage> messages_for(std::span<const RankMessage> messages,
                                                        std::uint32_t rank);

/// The ranks of a cluster, as seen by this process: communication, regions, the directory of names,
/// and statistics. Base of ClusterState and ClusterSceneState, which add the bodies.
struct RankGroup {
  RankGroup(Transport& given, double imbalance_bound, std::pmr::memory_resource* memory);

  [[nodiscard]] bool is_single_rank() const noexcept { return ranks == 1; }

  /// Sends `messages`, and counts the bytes and messages between different ranks.
  [[nodiscard]] Status exchange(std::span<const RankMessage>& received,
                                const OverlappedWork& meanwhile = {});
  /// Computes new regions. `work` has one entry for each hosted rank.
  [[nodiscard]] Status cut_space(std::span<const CutWork> work);
  /// Frees names and reserves names for the hosted ranks: one list of each for each rank. A rank
  /// gets `invalid_key` and no names if one of its names is used, or is requested by two ranks.
  /// Takes three exchanges.
  [[nodiscard]] Status take_names(std::span<const std::span<const BodyName>> freed,
                                  std::span<const std::span<const BodyName>> requested,
                                  std::span<Status> answers);
  /// Sums the counters of all ranks, distributes errors to all of them, and decides whether to cut
  /// space again.
  [[nodiscard]] Status count(std::span<const RankCounts> counts, Status found);

  Transport& transport;
  std::uint32_t ranks;
  std::uint32_t first;
  Status status = Status::ok;
  std::deque<IdDirectory> names;
  Regions regions;
  std::vector<RankMessage> messages;
  ClusterStatistics statistics;
  // Whether the next call cuts space, and whether the last one did; the same on every process.
  bool needs_cut = true;
  bool was_cut = false;

 private:
  void decide_on_cut();

  double imbalance_;
  double after_cut_ = std::numeric_limits<double>::infinity();  // imbalance after the last cut
  // Counters of this process since the last `count`.
  std::uint64_t bytes_ = 0;
  std::uint64_t message_count_ = 0;
};

/// Identifies a collective call; all processes pass the same one.
enum class CollectiveCall : std::uint32_t {
  add,
  replicate,
  move_replicated,
  find,
  digest,
  restore,
  closest,
  all,
  any,
  overlap,
  nearest
};

/// Runs a collective call. Any error in it ends the cluster.
template <typename State, typename Call>
Status collective(State* state, CollectiveCall which, Call&& call) noexcept {
  if (state == nullptr) return Status::out_of_memory;
  if (state->status != Status::ok) return state->status;
  state->transport.begin(static_cast<std::uint32_t>(which));
  return state->status = catch_bad_alloc(call, Status::out_of_memory);
}

/// Runs a call of one rank. If it is refused, it has changed nothing.
template <typename State, typename Call>
Status on_rank(State* state, std::uint32_t rank, Call&& call) noexcept {
  if (state == nullptr) return Status::out_of_memory;
  if (state->status != Status::ok) return state->status;
  auto* const hosted = state->find(rank);
  if (hosted == nullptr) return Status::invalid_argument;
  return catch_bad_alloc([&] { return call(*hosted); }, Status::out_of_memory);
}

}  // namespace winnow
