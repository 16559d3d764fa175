#pragma once

// How the queries of a recorded scene call the QueryObserver.

#include <winnow/core/memory.h>
#include "pipeline/scene/queries/queries.h"
#include "pipeline/scene/queries/query_observer.h"

#include <optional>

namespace winnow {

/// True if a query with this status succeeded, and the scene is recorded.
[[nodiscard]] inline bool is_observed(Status status, const QueryState* state) noexcept {
  return status == Status::ok && state->observer != nullptr;
}

/// The filter of a query. If the scene is recorded, it stores the bodies that layer, ignored body
/// and predicate let pass. Only the querying thread calls it.
class ObservedFilter {
 public:
  /// `given` must outlive this object. `state` may be null.
  ObservedFilter(QueryState* state, const SceneFilter& given) noexcept : given_(given) {
    const bool is_tested =
        given.predicate.accept != nullptr || given.layer != kEveryLayer || given.ignored != Key{};
    if (!is_tested || state == nullptr || state->observer == nullptr) return;
    state_ = state;
    state->accepted.clear();
    storing_ = {.layers = given.layers, .mask = given.mask, .environment = given.environment};
    storing_->predicate = {[](void* context, Key key, ClientData) {
                             return static_cast<ObservedFilter*>(context)->accept(key.id);
                           },
                           this};
  }
  ObservedFilter(const ObservedFilter&) = delete;
  ObservedFilter& operator=(const ObservedFilter&) = delete;

  /// Returns the filter to use in the query.
  [[nodiscard]] const SceneFilter& used() const noexcept { return storing_ ? *storing_ : given_; }
  [[nodiscard]] const SceneFilter& given() const noexcept { return given_; }
  /// Returns the ids of accepted bodies, in any order and possibly repeated; null if only layers,
  /// mask and environment decide.
  [[nodiscard]] Column<ObjectId>* accepted() noexcept {
    return state_ != nullptr ? &state_->accepted : nullptr;
  }
  /// Returns false if memory for an id was refused.
  [[nodiscard]] bool is_complete() const noexcept { return is_complete_; }

 private:
  [[nodiscard]] bool accept(std::uint32_t body) noexcept {
    const bool accepts = passes(state_->scene, given_, body);
    if (accepts) is_complete_ = state_->accepted.push_back(body) && is_complete_;
    return accepts;
  }

  const SceneFilter& given_;
  std::optional<SceneFilter> storing_;
  QueryState* state_ = nullptr;
  bool is_complete_ = true;
};

}  // namespace winnow
