#pragma once

// Records which pairs and bodies the program's predicates accept. The predicates of a player accept
// the recorded ones.

#include <winnow/core/filter.h>
#include <winnow/core/memory.h>
#include "pipeline/recording/recorder_state.h"

#include <algorithm>
#include <span>

namespace winnow {

/// Sorts accepted pairs or ids, and removes duplicates.
template <typename T>
[[nodiscard]] std::span<const T> sorted_unique(Column<T>& accepted) noexcept {
  std::sort(accepted.begin(), accepted.end());
  const T* const end = std::unique(accepted.begin(), accepted.end());
  accepted.set_size(static_cast<std::size_t>(end - accepted.begin()));
  return {accepted.data(), accepted.size()};
}

/// Calls the predicate of a scene, from any threads, and stores the pairs that it accepts, in the
/// memory of the recorder and protected by the recorder's lock.
class AcceptedPairs {
 public:
  AcceptedPairs(RecorderState& recorder, std::uint32_t world) noexcept
      : recorder_(recorder), world_(world), pairs_(recorder.block.memory()) {}

  /// Returns a predicate that calls `predicate` and stores accepted pairs; an empty one if
  /// `predicate` is empty. Forgets the pairs of the predicate before.
  [[nodiscard]] PairPredicate wrap(const PairPredicate& predicate) noexcept {
    pairs_.clear();
    predicate_ = predicate;
    if (predicate.accept == nullptr) return {};
    return {[](void* context, ObjectId first, ObjectId second) {
              auto& self = *static_cast<AcceptedPairs*>(context);
              const bool accepts = self.predicate_.accept(self.predicate_.context, first, second);
              if (accepts) self.store(lower_first(first, second));
              return accepts;
            },
            this};
  }
  [[nodiscard]] const PairPredicate& predicate() const noexcept { return predicate_; }
  [[nodiscard]] bool empty() const noexcept { return pairs_.empty(); }
  void clear() noexcept { pairs_.clear(); }

  /// Writes the pairs that a query accepted, and forgets them. Called before the query is written,
  /// so that a player has the pairs when it runs the query.
  void write() noexcept {
    write_so_far();
    pairs_.clear();
  }
  /// Writes the pairs that were accepted since `write`. They may include pairs accepted by queries
  /// of other threads. They are not forgotten, because a query of another thread may be written
  /// later.
  void write_so_far() noexcept {
    if (predicate_.accept == nullptr) return;
    CallWriter call(recorder_, RecordedCall::pairs_passed, world_);
    call.put_array(sorted_unique(pairs_));
  }

 private:
  void store(const Pair& pair) {
    const Lock lock(recorder_.mutex);
    if (!pairs_.push_back(pair)) recorder_.fail(Status::out_of_memory);
  }

  RecorderState& recorder_;
  const std::uint32_t world_;
  PairPredicate predicate_;
  Column<Pair> pairs_;
};

}  // namespace winnow
