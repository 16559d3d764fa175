#pragma once

// How the queries of a recorded scene call the QueryObserver.

#include <winnow/core/filter.h>
#include <winnow/core/memory.h>
#include "pipeline/scene/queries/queries.h"
#include "pipeline/scene/queries/query_observer.h"

#include <optional>

namespace winnow {

/// True if a query with this status succeeded, and the scene is recorded.
[[nodiscard]] inline bool is_observed(Status status, const QueryState* state) noexcept {
  return status == Status::ok && state->observer != nullptr;
}

/// The filter of a query. If the scene is recorded, it stores the bodies that the predicate
/// accepts. Only the querying thread calls it.
class ObservedFilter {
 public:
  /// `given` must outlive this object. `state` may be null.
  ObservedFilter(QueryState* state, const Filter& given) noexcept : given_(given) {
    if (given.predicate.accept == nullptr || state == nullptr || state->observer == nullptr) return;
    accepted_ = &state->accepted;
    accepted_->clear();
    storing_ = given;
    storing_->predicate = {[](void* context, Key key, ClientData data) {
                             return static_cast<ObservedFilter*>(context)->accept(key, data);
                           },
                           this};
  }
  ObservedFilter(const ObservedFilter&) = delete;
  ObservedFilter& operator=(const ObservedFilter&) = delete;

  /// Returns the filter to use in the query.
  [[nodiscard]] const Filter& used() const noexcept { return storing_ ? *storing_ : given_; }
  [[nodiscard]] const Filter& given() const noexcept { return given_; }
  /// Returns the ids of accepted bodies, in any order and possibly repeated; null without a
  /// predicate.
  [[nodiscard]] Column<ObjectId>* accepted() noexcept { return accepted_; }
  /// Returns false if memory for an id was refused.
  [[nodiscard]] bool is_complete() const noexcept { return is_complete_; }

 private:
  [[nodiscard]] bool accept(Key key, ClientData data) noexcept {
    const bool accepts = given_.predicate.accept(given_.predicate.context, key, data);
    if (accepts) is_complete_ = accepted_->push_back(key.id) && is_complete_;
    return accepts;
  }

  const Filter& given_;
  std::optional<Filter> storing_;
  Column<ObjectId>* accepted_ = nullptr;
  bool is_complete_ = true;
};

}  // namespace winnow
