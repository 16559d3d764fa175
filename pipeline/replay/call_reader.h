#pragma once

#include <winnow/core/kdop.h>
#include "pipeline/recording/format.h"

#include <algorithm>
#include <memory_resource>
#include <span>

namespace winnow {

/// Lets those pairs pass that are among sorted ones, named as `named` names what is asked.
template <Pair (*named)(ObjectId, ObjectId) noexcept>
[[nodiscard]] PairPredicate among(Column<Pair>& pairs) noexcept {
  return {[](void* context, ObjectId first, ObjectId second) {
            const auto& passed = *static_cast<const Column<Pair>*>(context);
            return std::binary_search(passed.begin(), passed.end(), named(first, second));
          },
          &pairs};
}

/// A pair as a partition asks, whose second object may be another partition's.
[[nodiscard]] constexpr Pair in_order(ObjectId first, ObjectId second) noexcept {
  return {first, second};
}

/// A filter as it was recorded, with what the predicate let pass, if there was one. The reader of
/// it must outlive what it is asked with.
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
  /// The predicate of a question for pairs.
  [[nodiscard]] PairPredicate read_passed_pairs(ByteReader& in) noexcept {
    if (!in.get_bool() || !in.get_array(pairs_)) return {};
    std::sort(pairs_.begin(), pairs_.end());
    return among<in_order>(pairs_);
  }
  [[nodiscard]] const Filter& filter() const noexcept { return filter_; }

 private:
  Filter filter_;
  Column<ObjectId> ids_;
  Column<Pair> pairs_;
};

/// A structure by name and parameter; none for a name that no structure has.
[[nodiscard]] inline StructureKind read_structure(ByteReader& in) noexcept {
  const StructureKind named = structure_named(in.get_text());
  const auto parameter = in.get<float>();
  if (named.info() == nullptr || named.parameter() == parameter) return named;
  return StructureKind(*named.info(), parameter);
}

}  // namespace winnow
