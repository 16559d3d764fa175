#pragma once

// The class Filter, and its use by queries of partitions and scenes.

#include "pipeline/python/callbacks.h"
#include "pipeline/python/init_checks.h"
#include "pipeline/python/partition.h"

#include <winnow/core/filter.h>
#include <winnow/pipeline/scene.h>

#include <optional>
#include <type_traits>
#include <utility>

namespace winnow::python {

/// A filter with its Python parts.
struct PythonFilter : EmptyIfZero {
  /// Layer and ignored body are for queries of a scene.
  SceneFilter filter;
  /// A predicate; null accepts all.
  py::object accept;
};

/// The filter of one call, a Filter or a SceneFilter. `during` raises the exception of the filter's
/// Python function.
class FilterOfCall {
 public:
  FilterOfCall() = default;
  FilterOfCall(const FilterOfCall&) = delete;
  FilterOfCall& operator=(const FilterOfCall&) = delete;

  /// Null selects all.
  template <typename F>
  [[nodiscard]] const F& of(const PythonFilter* input) {
    if (input != nullptr) take(*input);
    if constexpr (std::is_same_v<F, Filter>) {
      return in_partition();
    } else {
      return filter_;
    }
  }
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
  void take(const PythonFilter& input);
  /// Throws if the filter has a layer or an ignored body.
  [[nodiscard]] const Filter& in_partition();

  SceneFilter filter_;
  Filter in_partition_;
  std::optional<Predicate> accept_;
};

template <typename Argument>
inline constexpr bool kIsFilter =
    std::is_same_v<Argument, const Filter&> || std::is_same_v<Argument, const SceneFilter&>;

/// The Python form of an argument of a query.
template <typename Argument>
using PythonArgument = std::conditional_t<kIsFilter<Argument>, const PythonFilter*, Argument>;

/// Converts a query that takes a Filter or SceneFilter to one that takes a PythonFilter.
template <typename Answer, typename Owner, typename... Arguments>
[[nodiscard]] auto filtered(Answer (*query)(Owner, Arguments...)) {
  return [query](Owner owner, PythonArgument<Arguments>... given) -> Answer {
    FilterOfCall call;
    const auto pass = [&call]<typename Argument>(PythonArgument<Argument>& one,
                                                 std::type_identity<Argument>) -> Argument {
      if constexpr (kIsFilter<Argument>) {
        return call.of<std::remove_cvref_t<Argument>>(one);
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
