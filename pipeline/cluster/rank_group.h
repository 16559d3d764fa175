#pragma once

#include <winnow/pipeline/cluster.h>
#include "core/memory/guarded.h"
#include "pipeline/cluster/name_directory.h"
#include "pipeline/cluster/regions.h"

#include <algorithm>
#include <cstdint>
#include <deque>
#include <limits>
#include <memory_resource>
#include <span>
#include <vector>

namespace winnow {

/// What one rank found, to be summed over all.
struct RankCounts {
  std::uint64_t bodies = 0;
  std::uint64_t ghosts = 0;
  std::uint64_t pairs = 0;
  std::uint64_t migrated = 0;
  std::uint64_t work = 0;
};

/// Those of sorted parcels that are for one rank.
[[nodiscard]] std::span<const Parcel> parcels_for(std::span<const Parcel> parcels,
                                                  std::uint32_t rank);

/// The ranks of a cluster as this process sees them: how they speak, who has which part of space,
/// which names are taken, and what was counted. What the ranks hold is no concern of it.
struct RankGroup {
  RankGroup(Transport& given, double imbalance_bound, std::pmr::memory_resource* memory);

  [[nodiscard]] bool is_alone() const noexcept { return ranks == 1; }

  /// Sends what is in `parcels`, and counts what leaves its rank.
  [[nodiscard]] Status exchange(std::span<const Parcel>& received, const Meanwhile& meanwhile = {});
  /// Gives ranks new regions, if the last frame asks for it. One entry for each hosted rank.
  [[nodiscard]] Status cut_space(std::span<const CutWork> work);
  /// Takes names for hosted ranks, and frees others, one list for each; `invalid_key` for a rank of
  /// which one name is taken or wanted by two, which then gets none. In three exchanges.
  [[nodiscard]] Status take_names(std::span<const std::span<const BodyName>> freed,
                                  std::span<const std::span<const BodyName>> wanted,
                                  std::span<Status> answers);
  /// Tells all ranks what each found, also that one could not, and whether to cut space anew.
  [[nodiscard]] Status count(std::span<const RankCounts> counts, Status found);

  Transport& transport;
  std::uint32_t ranks;
  std::uint32_t first;
  Status status = Status::ok;
  std::deque<NameDirectory> names;
  Regions regions;
  std::vector<Parcel> parcels;
  ClusterStatistics statistics;
  // What decides on cuts, the same on every process.
  bool wants_cut = true;
  bool was_cut = false;

 private:
  void decide_on_cut();

  double imbalance_;
  double after_cut_ = std::numeric_limits<double>::infinity();  // imbalance
  // Of this process, since statistics were last counted.
  std::uint64_t bytes_ = 0;
  std::uint64_t messages_ = 0;
};

/// Which collective call: the same number on all processes.
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

/// A collective call: what goes wrong in it ends the cluster.
template <typename State, typename Call>
Status collective(State* state, CollectiveCall which, Call&& call) noexcept {
  if (state == nullptr) return Status::out_of_memory;
  if (state->status != Status::ok) return state->status;
  state->transport.begin(static_cast<std::uint32_t>(which));
  return state->status = guarded(call, Status::out_of_memory);
}

/// A call of one rank: refused, it has changed nothing.
template <typename State, typename Call>
Status on_rank(State* state, std::uint32_t rank, Call&& call) noexcept {
  if (state == nullptr) return Status::out_of_memory;
  if (state->status != Status::ok) return state->status;
  auto* const hosted = state->find(rank);
  if (hosted == nullptr) return Status::invalid_argument;
  return guarded([&] { return call(*hosted); }, Status::out_of_memory);
}

}  // namespace winnow
