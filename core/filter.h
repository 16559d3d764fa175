#pragma once

#include <winnow/core/key.h>
#include <winnow/core/object_filter.h>

#include <cstdint>

namespace winnow {

/// True if two objects may be paired.
[[nodiscard]] constexpr bool may_meet(const ObjectFilter& a, const ObjectFilter& b) noexcept {
  return (a.layers & b.mask) != 0 && (b.layers & a.mask) != 0 &&
         (a.environment == b.environment || a.environment == kEveryEnvironment ||
          b.environment == kEveryEnvironment);
}

/// A caller's last word on an object that a query would report. Plain pointers, so that it costs
/// one call per object. It may be called from several threads at once, in any order, and not for
/// every object that is reported in the end; it must answer the same each time. It must not call
/// what asks it, which may hold locks, and it must not throw: an exception that leaves it ends the
/// process (`std::terminate`), whatever thread asks.
struct ObjectPredicate {
  bool (*accept)(void* context, Key key, ClientData data) = nullptr;  ///< null: all
  void* context = nullptr;                                            ///< handed to `accept`
};

/// What a query asks for: the filter that stands for the one who asks, and a predicate. Subtrees in
/// which the filter can match nothing are not entered.
struct Filter {
  std::uint32_t layers = ~0U;  ///< layers that the one who asks is in, a bit each; all by default
  std::uint32_t mask = ~0U;    ///< layers that it wants to meet
  std::uint32_t environment = kEveryEnvironment;  ///< objects of another one are not met
  ObjectPredicate predicate{};  ///< asked last, about objects that the filter lets pass

  /// The filter alone, as an object would have it.
  [[nodiscard]] constexpr ObjectFilter object() const noexcept {
    return {layers, mask, environment};
  }
};

/// A caller's last word on a pair; see ObjectPredicate.
struct PairPredicate {
  bool (*accept)(void* context, ObjectId first, ObjectId second) = nullptr;  ///< null: all
  void* context = nullptr;                                                   ///< handed to `accept`
};

}  // namespace winnow
