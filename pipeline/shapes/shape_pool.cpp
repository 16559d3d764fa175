#include <winnow/pipeline/shape_pool.h>

#include "pipeline/shapes/hull_builder.h"

#include <type_traits>
#include <utility>

namespace winnow {

const char* to_string(ShapeKind kind) noexcept {
  constexpr const char* kNames[kShapeKinds] = {
      "sphere",          "capsule",    "box",  "cylinder", "cone", "hull",
      "triangle",        "half_space", "none", "none",     "none", "ellipsoid",
      "tapered_capsule", "support"};
  const auto index = static_cast<std::uint32_t>(kind);
  return index < kShapeKinds ? kNames[index] : "none";
}

ShapePool::ShapePool(std::pmr::memory_resource* memory) noexcept
    : memory_(memory),
      spheres_(memory),
      capsules_(memory),
      boxes_(memory),
      cylinders_(memory),
      cones_(memory),
      hulls_(memory),
      triangles_(memory),
      half_spaces_(memory),
      ellipsoids_(memory),
      tapered_capsules_(memory),
      supports_(memory) {}

ShapePool::ShapePool(ShapePool&& other) noexcept
    : memory_(other.memory_),
      spheres_(std::move(other.spheres_)),
      capsules_(std::move(other.capsules_)),
      boxes_(std::move(other.boxes_)),
      cylinders_(std::move(other.cylinders_)),
      cones_(std::move(other.cones_)),
      hulls_(std::move(other.hulls_)),
      triangles_(std::move(other.triangles_)),
      half_spaces_(std::move(other.half_spaces_)),
      ellipsoids_(std::move(other.ellipsoids_)),
      tapered_capsules_(std::move(other.tapered_capsules_)),
      supports_(std::move(other.supports_)),
      tables_(std::exchange(other.tables_, {})) {}

ShapePool::~ShapePool() {
  for (const HullShape& hull : hulls_.shapes) release_hull(hull, memory_);
}

template <typename Pool, typename Body>
decltype(auto) ShapePool::with_table(Pool& pool, ShapeKind kind, Body&& body) {
  switch (kind) {
    case ShapeKind::capsule:
      return body(pool.capsules_);
    case ShapeKind::box:
      return body(pool.boxes_);
    case ShapeKind::cylinder:
      return body(pool.cylinders_);
    case ShapeKind::cone:
      return body(pool.cones_);
    case ShapeKind::hull:
      return body(pool.hulls_);
    case ShapeKind::triangle:
      return body(pool.triangles_);
    case ShapeKind::half_space:
      return body(pool.half_spaces_);
    case ShapeKind::ellipsoid:
      return body(pool.ellipsoids_);
    case ShapeKind::tapered_capsule:
      return body(pool.tapered_capsules_);
    case ShapeKind::support:
      return body(pool.supports_);
    case ShapeKind::sphere:
      break;
  }
  return body(pool.spheres_);
}

bool ShapePool::contains(ShapeId id) const noexcept {
  if (id.kind_index() >= kShapeKinds || id.is_composite()) return false;
  return with_table(*this, id.kind(), [&](const auto& table) {
    return id.index() < table.live.size() && table.live[id.index()] != 0;
  });
}

std::size_t ShapePool::size(ShapeKind kind) const noexcept {
  return with_table(*this, kind,
                    [](const auto& table) { return table.shapes.size() - table.free.size(); });
}

Status ShapePool::remove(ShapeId id) {
  if (!contains(id)) return Status::invalid_key;
  with_table(*this, id.kind(), [&](auto& table) {
    auto& shape = table.shapes[id.index()];
    using Shape = std::remove_reference_t<decltype(shape)>;
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

void ShapePool::refresh_tables() noexcept {
  tables_ = {spheres_.shapes.data(),          capsules_.shapes.data(),    boxes_.shapes.data(),
             cylinders_.shapes.data(),        cones_.shapes.data(),       hulls_.shapes.data(),
             triangles_.shapes.data(),        half_spaces_.shapes.data(), ellipsoids_.shapes.data(),
             tapered_capsules_.shapes.data(), supports_.shapes.data()};
  for (const ShapeKind kind : kConvexKinds) {
    tables_.count[static_cast<std::size_t>(kind)] = with_table(*this, kind, [](const auto& table) {
      return static_cast<std::uint32_t>(table.shapes.size());
    });
  }
}

Footprint ShapePool::footprint() const noexcept {
  Footprint footprint;
  for (const ShapeKind kind : kConvexKinds) {
    with_table(*this, kind, [&](const auto& table) {
      footprint.structure += table.shapes.bytes();
      footprint.keys += table.live.bytes();
      footprint.keys += table.free.bytes();
    });
  }
  for (const HullShape& hull : hulls_.shapes) {
    const std::size_t bytes = hull_bytes(hull);
    footprint.structure += {bytes, bytes};
  }
  return footprint;
}

}  // namespace winnow
