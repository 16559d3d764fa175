#pragma once

// The kinds of convex shapes as types, and the one branch by kind: it calls a function with the
// struct of a shape. Code that depends on the kind has an overload for each struct.

#include <winnow/pipeline/shapes.h>

namespace winnow {

/// The kind of a shape struct, and its table.
template <typename Shape>
struct KindOf;

#define WINNOW_KIND_OF(enumerator, Type, table)                                         \
  template <>                                                                           \
  struct KindOf<Type> {                                                                 \
    using Shape = Type;                                                                 \
    static constexpr ShapeKind kKind = ShapeKind::enumerator;                           \
    [[nodiscard]] static constexpr const Type* in(const ShapeTables& tables) noexcept { \
      return tables.table;                                                              \
    }                                                                                   \
  };
WINNOW_CONVEX_SHAPES(WINNOW_KIND_OF)
#undef WINNOW_KIND_OF

/// The kind with the largest number.
inline constexpr ShapeKind kLastConvexKind =
    kConvexKinds[sizeof kConvexKinds / sizeof *kConvexKinds - 1];

/// Calls visit(KindOf<Shape>) with the struct of a kind, and returns its result.
template <typename Visit>
[[gnu::always_inline]] constexpr decltype(auto) with_kind(ShapeKind kind, Visit&& visit) {
  switch (kind) {
#define WINNOW_CASE(enumerator, Shape, table) \
  case ShapeKind::enumerator:                 \
    return visit(KindOf<Shape>{});
    WINNOW_CONVEX_SHAPES(WINNOW_CASE)
#undef WINNOW_CASE
  }
  return visit(KindOf<SphereShape>{});  // not reached
}

/// Calls visit(shape), and returns its result.
template <typename Visit>
[[gnu::always_inline]] constexpr decltype(auto) with_shape(const ShapeTables& tables, ShapeId id,
                                                           Visit&& visit) {
  return with_kind(id.kind(),
                   [&](auto of) -> decltype(auto) { return visit(of.in(tables)[id.index()]); });
}

/// Calls visit(KindOf<Shape>) for each kind, in order.
template <typename Visit>
constexpr void for_each_kind(Visit&& visit) {
  for (const ShapeKind kind : kConvexKinds) with_kind(kind, visit);
}

}  // namespace winnow
