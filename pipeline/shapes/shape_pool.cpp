#include <winnow/pipeline/shape_pool.h>

#include "pipeline/shapes/hull_builder.h"
#include "pipeline/shapes/shape_pool_put.h"

#include <type_traits>
#include <utility>

namespace winnow {

const char* to_string(ShapeKind kind) noexcept {
#define WINNOW_NAME(enumerator, Shape, table) \
  if (kind == ShapeKind::enumerator) return #enumerator;
  WINNOW_CONVEX_SHAPES(WINNOW_NAME)
#undef WINNOW_NAME
  return "none";
}

ShapePool::ShapePool(std::pmr::memory_resource* memory) noexcept : memory_(memory) {}

ShapePool::ShapePool(ShapePool&& other) noexcept
    : memory_(other.memory_), tables_(std::exchange(other.tables_, {})) {
  for_each_kind([&](auto of) {
    using Shape = typename decltype(of)::Shape;
    PoolRows::of<Shape>(*this).swap(PoolRows::of<Shape>(other));
  });
}

ShapePool::~ShapePool() {
  for (const HullShape& hull : hulls_.shapes) release_hull(hull, memory_);
}

bool ShapePool::contains(ShapeId id) const noexcept {
  if (id.kind_index() >= kShapeKinds || id.is_composite()) return false;
  return with_kind(id.kind(), [&](auto of) {
    const auto& live = PoolRows::of<typename decltype(of)::Shape>(*this).live;
    return id.index() < live.size() && live[id.index()] != 0;
  });
}

std::size_t ShapePool::size(ShapeKind kind) const noexcept {
  return with_kind(kind, [&](auto of) {
    const auto& table = PoolRows::of<typename decltype(of)::Shape>(*this);
    return table.shapes.size() - table.free.size();
  });
}

Status ShapePool::remove(ShapeId id) {
  if (!contains(id)) return Status::invalid_key;
  with_kind(id.kind(), [&](auto of) {
    using Shape = typename decltype(of)::Shape;
    auto& table = PoolRows::of<Shape>(*this);
    Shape& shape = table.shapes[id.index()];
    if constexpr (std::is_same_v<Shape, HullShape>) {
      release_hull(shape, memory_);
      shape = point_hull();
    } else {
      shape = Shape{};
    }
    table.live[id.index()] = 0;
    table.free.set_size(table.free.size() + 1);
    table.free[table.free.size() - 1] = id.index();
  });
  return Status::ok;
}

void PoolRows::refresh(ShapePool& pool) noexcept {
#define WINNOW_TABLE(kind, Shape, table)                          \
  pool.tables_.table = pool.table##_.shapes.data();               \
  pool.tables_.count[static_cast<std::size_t>(ShapeKind::kind)] = \
      static_cast<std::uint32_t>(pool.table##_.shapes.size());
  WINNOW_CONVEX_SHAPES(WINNOW_TABLE)
#undef WINNOW_TABLE
}

Footprint ShapePool::footprint() const noexcept {
  Footprint footprint;
  for_each_kind([&](auto of) {
    const auto& table = PoolRows::of<typename decltype(of)::Shape>(*this);
    footprint.structure += table.shapes.bytes();
    footprint.keys += table.live.bytes();
    footprint.keys += table.free.bytes();
  });
  for (const HullShape& hull : hulls_.shapes) {
    const std::size_t bytes = hull_bytes(hull);
    footprint.structure += {bytes, bytes};
  }
  return footprint;
}

}  // namespace winnow
