#pragma once

// The class Filter, and its use by queries of partitions and scenes.

#include "pipeline/python/callbacks.h"
#include "pipeline/python/init_checks.h"
#include "pipeline/python/partition.h"
#include "pipeline/python/shared_scene.h"

#include <winnow/core/filter.h>
#include <winnow/pipeline/scene.h>

#include <cstdint>
#include <optional>
#include <type_traits>
#include <utility>

namespace winnow::python {

/// A filter with its Python parts.
struct PythonFilter : EmptyIfZero {
  Filter filter;
  /// A predicate; null accepts all.
  py::object accept;
  /// For queries of a scene: the layer that the query belongs to.
  std::optional<std::uint16_t> layer;
};

/// The filter of one call. `during` raises the exception of the filter's Python function.
class FilterOfCall {
 public:
  /// `scene` is the scene that is queried; null for a partition.
  explicit FilterOfCall(const Scene* scene) noexcept : scene_(scene) {}
  FilterOfCall(const FilterOfCall&) = delete;
  FilterOfCall& operator=(const FilterOfCall&) = delete;

  /// Null selects all.
  [[nodiscard]] const Filter& of(const PythonFilter* input);
  template <typename Query>
  auto during(Query&& query) {
    try {
      auto answer = std::forward<Query>(query)();
      if (accept_) accept_->raise_if_failed();
      return answer;
    } catch (const Refusal&) {
      if (accept_) accept_->raise_if_failed();
      throw;
    }
  }

 private:
  const Scene* scene_;
  Filter filter_;
  std::optional<Predicate> accept_;
  std::optional<LayerFilter> layer_;
};

[[nodiscard]] inline const Scene* scene_of(const SharedPartition&) noexcept {
  return nullptr;
}
[[nodiscard]] inline const Scene* scene_of(const SharedScene& s) noexcept {
  return &s.scene;
}

/// The Python form of an argument of a query.
template <typename Argument>
using PythonArgument =
    std::conditional_t<std::is_same_v<Argument, const Filter&>, const PythonFilter*, Argument>;

/// Converts a query that takes a Filter to one that takes a PythonFilter.
template <typename Answer, typename Owner, typename... Arguments>
[[nodiscard]] auto filtered(Answer (*query)(Owner, Arguments...)) {
  return [query](Owner owner, PythonArgument<Arguments>... given) -> Answer {
    FilterOfCall call(scene_of(owner));
    const auto pass = [&call]<typename Argument>(PythonArgument<Argument>& one,
                                                 std::type_identity<Argument>) -> Argument {
      if constexpr (std::is_same_v<Argument, const Filter&>) {
        return call.of(one);
      } else {
        return static_cast<Argument>(one);
      }
    };
    return call.during(
        [&] { return query(owner, pass(given, std::type_identity<Arguments>())...); });
  };
}

/// Adds the class `Filter`.
void add_filters(py::module_& module);

}  // namespace winnow::python
