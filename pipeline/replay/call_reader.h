#pragma once

#include "pipeline/recording/format.h"

#include <algorithm>
#include <memory_resource>

namespace winnow {

/// Returns a predicate that accepts two objects if the sorted column contains named(first, second).
template <Pair (*named)(ObjectId, ObjectId) noexcept>
[[nodiscard]] PairPredicate among(Column<Pair>& pairs) noexcept {
  return {[](void* context, ObjectId first, ObjectId second) {
            const auto& passed = *static_cast<const Column<Pair>*>(context);
            return std::binary_search(passed.begin(), passed.end(), named(first, second));
          },
          &pairs};
}

/// Keeps the order of a pair of a partition query: the second object may belong to another
/// partition.
[[nodiscard]] constexpr Pair in_order(ObjectId first, ObjectId second) noexcept {
  return {first, second};
}

/// A recorded filter. If it had a predicate, it has one here that accepts the recorded objects or
/// pairs. Must outlive the query that uses it.
class RecordedFilter {
 public:
  explicit RecordedFilter(std::pmr::memory_resource* memory) noexcept
      : ids_(memory), pairs_(memory) {}

  void read_filter(ByteReader& in) noexcept {
    filter_ = {};
    filter_.layers = in.get<std::uint32_t>();
    filter_.mask = in.get<std::uint32_t>();
    filter_.environment = in.get<std::uint32_t>();
  }
  void read_passed_objects(ByteReader& in) noexcept {
    if (!in.get_bool() || !in.get_array(ids_)) return;
    std::sort(ids_.begin(), ids_.end());
    filter_.predicate = {[](void* context, Key key, ClientData) {
                           const auto& ids = static_cast<RecordedFilter*>(context)->ids_;
                           return std::binary_search(ids.begin(), ids.end(), key.id);
                         },
                         this};
  }
  /// Reads the accepted pairs of a pair query, and returns its predicate.
  [[nodiscard]] PairPredicate read_passed_pairs(ByteReader& in) noexcept {
    if (!in.get_bool() || !in.get_array(pairs_)) return {};
    std::sort(pairs_.begin(), pairs_.end());
    return among<in_order>(pairs_);
  }
  [[nodiscard]] const Filter& filter() const noexcept { return filter_; }
  [[nodiscard]] SceneFilter scene_filter() const noexcept {
    return {.layers = filter_.layers,
            .mask = filter_.mask,
            .environment = filter_.environment,
            .predicate = filter_.predicate};
  }

 private:
  Filter filter_;
  Column<ObjectId> ids_;
  Column<Pair> pairs_;
};

/// Reads a structure by name and parameter. For an unknown name, info() of the result is null.
[[nodiscard]] inline StructureKind read_structure(ByteReader& in) noexcept {
  const StructureKind named = structure_named(in.get_text());
  const auto parameter = in.get<float>();
  if (named.info() == nullptr || named.parameter() == parameter) return named;
  return StructureKind(*named.info(), parameter);
}

}  // namespace winnow
