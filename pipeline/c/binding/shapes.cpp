// Shapes whose struct in C is a union of all kinds, and functions of kinds (shapes.h).

#include <winnow/c/shapes.h>

#include "pipeline/c/binding/results.h"
#include "pipeline/kinds/with_shape.h"

#include <cstring>
#include <type_traits>

namespace winnow::c {
namespace {

/// Returns false unless the number is of a convex kind.
[[nodiscard]] bool read_kind(winnow_shape_kind number, ShapeKind& kind) noexcept {
  if (number < 0 || number > static_cast<winnow_shape_kind>(kLastConvexKind)) return false;
  kind = static_cast<ShapeKind>(number);
  return !ShapeId::of(kind, 0).is_composite();
}

}  // namespace

// The C structs of all kinds but hulls have the same members as the C++ structs, in the same order.

Answer<ShapeId> add(ShapePool& pool, const winnow_shape& shape) noexcept {
  ShapeKind kind{};
  if (!read_kind(shape.kind, kind)) return Status::invalid_argument;
  return with_kind(kind, [&](auto of) -> Answer<ShapeId> {
    using Shape = typename decltype(of)::Shape;
    if constexpr (std::is_same_v<Shape, HullShape>) {
      return Status::invalid_argument;
    } else {
      Shape one;
      static_assert(sizeof one <= sizeof shape.as);
      std::memcpy(static_cast<void*>(&one), &shape.as, sizeof one);
      return pool.add(one);
    }
  });
}

winnow_shape shape_at(const ShapeTables& tables, ShapeId id) noexcept {
  winnow_shape shape{};
  shape.kind = static_cast<winnow_shape_kind>(id.kind_index());
  with_shape(tables, id, [&](const auto& one) {
    if constexpr (sizeof one <= sizeof shape.as) std::memcpy(&shape.as, &one, sizeof one);
  });
  return shape;
}

bool is_hull(ShapeId id) noexcept {
  return !id.is_composite() && id.kind() == ShapeKind::hull;
}

bool is_compound(ShapeId id) noexcept {
  return id.is_composite() && id.composite_kind() == CompositeKind::compound;
}

}  // namespace winnow::c

using namespace winnow::c;

const char* winnow_shape_kind_name(winnow_shape_kind kind) {
  switch (kind) {
    case WINNOW_SHAPE_MESH:
      return "mesh";
    case WINNOW_SHAPE_COMPOUND:
      return "compound";
    case WINNOW_SHAPE_HEIGHT_FIELD:
      return "height_field";
    default:
      break;
  }
  winnow::ShapeKind known{};
  return read_kind(kind, known) ? winnow::to_string(known) : "none";
}

winnow_status winnow_shape_pool_size(const winnow_shape_pool* pool, winnow_shape_kind kind,
                                     size_t* size) {
  winnow::ShapeKind which{};
  if (!are_given(pool, size) || !read_kind(kind, which)) return WINNOW_INVALID_ARGUMENT;
  *size = pool->value.size(which);
  return WINNOW_OK;
}
