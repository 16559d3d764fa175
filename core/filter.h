#pragma once

// Which objects form pairs, and which objects a query reports.

#include <winnow/core/export.h>
#include <winnow/core/key.h>

#include <cstdint>

namespace winnow {

/// Environment of objects that can form pairs with objects of every environment.
inline constexpr std::uint32_t kAllEnvironments = 0xFFFFFFFFU;

/// Restricts which objects form a pair. Two objects pair only if their environments are equal (or
/// one is `kAllEnvironments`), and each one's mask contains a layer of the other.
struct ObjectFilter {
  std::uint32_t layers = 1;       ///< layers that the object is in, one bit each
  std::uint32_t mask = ~0U;       ///< layers of objects that it accepts
  std::uint32_t environment = 0;  ///< objects of different environments do not pair

  /// True if layers, masks and environments are equal.
  friend constexpr bool operator==(const ObjectFilter&, const ObjectFilter&) noexcept = default;
};

/// Returns true if the filters allow a pair of the two objects.
[[nodiscard]] constexpr bool filters_allow(const ObjectFilter& a, const ObjectFilter& b) noexcept {
  return (a.layers & b.mask) != 0 && (b.layers & a.mask) != 0 &&
         (a.environment == b.environment || a.environment == kAllEnvironments ||
          b.environment == kAllEnvironments);
}

/// Callback that accepts or rejects an object that a query would report. It is a plain function
/// pointer, which costs one call per object. It may be called from several threads at once and in
/// any order. It may be called more than once for an object, and must return the same value each
/// time. It must not call the partition or scene that calls it, which may hold locks. It must not
/// throw: an exception ends the process (`std::terminate`) on any thread.
struct ObjectPredicate {
  bool (*accept)(void* context, Key key, ClientData data) = nullptr;  ///< null accepts all
  void* context = nullptr;                                            ///< passed to `accept`
};

/// Filter of a query: layers, mask and environment, as if the query were an object, and a
/// predicate. Queries skip subtrees in which no object can match.
struct Filter {
  std::uint32_t layers = ~0U;  ///< layers that the query is in, one bit each; all by default
  std::uint32_t mask = ~0U;    ///< layers that it accepts
  std::uint32_t environment = kAllEnvironments;  ///< objects of other environments are skipped
  ObjectPredicate predicate{};  ///< called last, for objects that pass the rest of the filter

  /// Returns the layers, mask and environment as an ObjectFilter.
  [[nodiscard]] constexpr ObjectFilter object() const noexcept {
    return {layers, mask, environment};
  }
};

/// Callback that accepts or rejects a pair; the rules of ObjectPredicate apply. An incremental
/// query does not call it again for pairs that it keeps.
struct PairPredicate {
  bool (*accept)(void* context, ObjectId first, ObjectId second) = nullptr;  ///< null accepts all
  void* context = nullptr;                                                   ///< passed to `accept`
};

}  // namespace winnow
