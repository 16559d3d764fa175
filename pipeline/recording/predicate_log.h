#pragma once

// Records which pairs and objects the program's predicates accept. The predicates of a player
// accept the recorded ones.

#include <winnow/core/column.h>
#include <winnow/core/filter.h>
#include "pipeline/recording/recorder_state.h"

#include <algorithm>
#include <span>

namespace winnow {

/// Sorts accepted pairs or ids, and removes duplicates.
template <typename T>
[[nodiscard]] std::span<const T> sorted_unique(Column<T>& passed) noexcept {
  std::sort(passed.begin(), passed.end());
  const T* const end = std::unique(passed.begin(), passed.end());
  passed.set_size(static_cast<std::size_t>(end - passed.begin()));
  return {passed.data(), passed.size()};
}

/// Calls the predicate of a scene, from any threads, and stores the pairs that it accepts, in the
/// memory of the recorder and protected by the recorder's lock.
struct AcceptedPairs {
  explicit AcceptedPairs(RecorderState& state) noexcept
      : recorder(state), pairs(state.block.memory()) {}

  /// Returns a predicate that calls `predicate` and stores accepted pairs; an empty one if
  /// `predicate` is empty.
  [[nodiscard]] PairPredicate wrap(const PairPredicate& predicate) noexcept {
    original = predicate;
    if (predicate.accept == nullptr) return {};
    return {[](void* context, ObjectId first, ObjectId second) {
              auto& self = *static_cast<AcceptedPairs*>(context);
              const bool passes = self.original.accept(self.original.context, first, second);
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
  PairPredicate original;
  Column<Pair> pairs;
};

/// Calls the predicate of a scene query, and stores the bodies that it accepts during that query.
/// All calls are made by the querying thread.
class AcceptedObjects {
 public:
  AcceptedObjects(const Filter& filter, Column<ObjectId>& ids) noexcept
      : original_(filter), ids_(ids) {
    ids_.clear();
  }

  /// Returns the filter, with a predicate that stores accepted bodies.
  [[nodiscard]] Filter filter() noexcept {
    Filter wrapped = original_;
    if (original_.predicate.accept == nullptr) return wrapped;
    wrapped.predicate = {[](void* context, Key key, ClientData data) {
                           return static_cast<AcceptedObjects*>(context)->test(key, data);
                         },
                         this};
    return wrapped;
  }
  /// Writes whether there is a predicate, and the ids of the bodies that it accepted.
  void put(CallWriter& call) {
    call.put(original_.predicate.accept != nullptr);
    if (original_.predicate.accept != nullptr) call.put_array(sorted_unique(ids_));
  }
  /// False if memory was refused.
  [[nodiscard]] bool is_complete() const noexcept { return is_complete_; }

 private:
  bool test(Key key, ClientData data) {
    const bool passes = original_.predicate.accept(original_.predicate.context, key, data);
    if (passes) is_complete_ = ids_.push_back(key.id) && is_complete_;
    return passes;
  }

  const Filter& original_;
  Column<ObjectId>& ids_;
  bool is_complete_ = true;
};

}  // namespace winnow
