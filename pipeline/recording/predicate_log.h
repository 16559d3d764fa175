#pragma once

// Records what the program's predicates accept, so that a player can answer in their place.

#include <winnow/core/column.h>
#include <winnow/core/filter.h>
#include "pipeline/recording/recorder_state.h"

#include <algorithm>
#include <span>

namespace winnow {

/// Sorts what was accepted, and removes duplicates.
template <typename T>
[[nodiscard]] std::span<const T> sorted_unique(Column<T>& passed) noexcept {
  std::sort(passed.begin(), passed.end());
  const T* const end = std::unique(passed.begin(), passed.end());
  passed.set_size(static_cast<std::size_t>(end - passed.begin()));
  return {passed.data(), passed.size()};
}

/// Calls the predicate of a scene, from any threads, and stores the pairs that it accepts: in the
/// memory of the recorder, protected by its lock.
struct AcceptedPairs {
  explicit AcceptedPairs(RecorderState& state) noexcept
      : recorder(state), pairs(state.block.memory()) {}

  /// Returns the predicate to use from now on; none if `predicate` is none.
  [[nodiscard]] PairPredicate wrap(const PairPredicate& predicate) noexcept {
    asked = predicate;
    if (predicate.accept == nullptr) return {};
    return {[](void* context, ObjectId first, ObjectId second) {
              auto& self = *static_cast<AcceptedPairs*>(context);
              const bool passes = self.asked.accept(self.asked.context, first, second);
              if (passes) self.keep(lower_first(first, second));
              return passes;
            },
            this};
  }
  void keep(const Pair& pair) {
    const Lock lock(recorder.mutex);
    if (!pairs.push_back(pair)) recorder.fail(Status::out_of_memory);
  }

  RecorderState& recorder;
  PairPredicate asked;
  Column<Pair> pairs;
};

/// Calls the predicate of a scene query, and stores the bodies that it accepts during that query.
/// All calls are made by the querying thread.
class AcceptedObjects {
 public:
  AcceptedObjects(const Filter& filter, Column<ObjectId>& ids) noexcept
      : asked_(filter), ids_(ids) {
    ids_.clear();
  }

  /// Returns the filter to query with.
  [[nodiscard]] Filter filter() noexcept {
    Filter listening = asked_;
    if (asked_.predicate.accept == nullptr) return listening;
    listening.predicate = {[](void* context, Key key, ClientData data) {
                             return static_cast<AcceptedObjects*>(context)->ask(key, data);
                           },
                           this};
    return listening;
  }
  /// Writes whether there is a predicate, and what it accepted.
  void put(CallWriter& call) {
    call.put(asked_.predicate.accept != nullptr);
    if (asked_.predicate.accept != nullptr) call.put_array(sorted_unique(ids_));
  }
  /// False if memory was refused.
  [[nodiscard]] bool is_complete() const noexcept { return is_complete_; }

 private:
  bool ask(Key key, ClientData data) {
    const bool passes = asked_.predicate.accept(asked_.predicate.context, key, data);
    if (passes) is_complete_ = ids_.push_back(key.id) && is_complete_;
    return passes;
  }

  const Filter& asked_;
  Column<ObjectId>& ids_;
  bool is_complete_ = true;
};

}  // namespace winnow
