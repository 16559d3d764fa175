#pragma once

// PoolRows, by which the sources of ShapePool change its rows.

#include <winnow/pipeline/shape_pool.h>
#include "pipeline/kinds/with_shape.h"

#include <cmath>
#include <initializer_list>
#include <type_traits>

namespace winnow {

[[nodiscard]] inline bool are_lengths(std::initializer_list<double> values) noexcept {
  for (const double v : values) {
    if (!std::isfinite(v) || v < 0.0) return false;
  }
  return true;
}

/// Changes the rows of a pool.
struct PoolRows {
  /// Returns the rows of a kind of shape.
  template <typename Shape, typename Pool>
  [[nodiscard]] static auto& of(Pool& pool) noexcept {
#define WINNOW_TABLE(kind, Other, table)        \
  if constexpr (std::is_same_v<Shape, Other>) { \
    return pool.table##_;                       \
  } else
    WINNOW_CONVEX_SHAPES(WINNOW_TABLE) {
      static_assert(sizeof(Shape) == 0, "not a convex shape");
    }
#undef WINNOW_TABLE
  }

  /// Adds a shape that was checked.
  template <typename Shape>
  static Answer<ShapeId> put(ShapePool& pool, const Shape& shape) {
    detail::ShapeRows<Shape>& table = of<Shape>(pool);
    std::uint32_t index = 0;
    if (!table.free.empty()) {
      index = table.free[table.free.size() - 1];
      table.free.set_size(table.free.size() - 1);
      table.shapes[index] = shape;
      table.live[index] = 1;
    } else {
      if (table.shapes.size() >> ShapeId::kIndexBits != 0) return Status::too_many_objects;
      index = static_cast<std::uint32_t>(table.shapes.size());
      // Reserve room in the free list now, so that removal never allocates.
      if (!table.free.grow(index + 1U) || !table.live.grow(index + 1U) ||
          !table.shapes.push_back(shape)) {
        return Status::out_of_memory;
      }
      table.live.set_size(index + 1U);
      table.live[index] = 1;
    }
    refresh(pool);
    return ShapeId::of(KindOf<Shape>::kKind, index);
  }
  /// Points the tables of a pool to its rows.
  static void refresh(ShapePool& pool) noexcept;
};

}  // namespace winnow
