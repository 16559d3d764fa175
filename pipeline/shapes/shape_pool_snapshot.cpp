#include <winnow/pipeline/shape_pool.h>

#include "core/hooks/log.h"
#include "core/memory/free_list_io.h"
#include "core/memory/snapshot_frame.h"
#include "core/threads/float_environment.h"
#include "pipeline/shapes/hull_builder.h"
#include "pipeline/shapes/hull_bytes.h"
#include "pipeline/shapes/shape_pool_put.h"

#include <type_traits>

namespace winnow {
namespace {

constexpr std::string_view kShapesMagic = "WINNOWSP";
constexpr std::uint32_t kShapesVersion = 1;

template <typename Shape>
[[nodiscard]] Shape nothing() noexcept {
  if constexpr (std::is_same_v<Shape, HullShape>) {
    return point_hull();
  } else {
    return {};
  }
}

template <typename Shape>
void put_shape(ByteWriter& out, const Shape& shape) noexcept {
  if constexpr (std::is_same_v<Shape, HullShape>) {
    put_hull(out, shape);
  } else {
    out.put_bytes(&shape, sizeof shape);
  }
}

/// Adds the next saved shape to the pool; it gets the next free index.
template <typename Shape>
[[nodiscard]] Status read_shape(ByteReader& in, std::pmr::memory_resource* memory,
                                ShapePool& pool) {
  if constexpr (std::is_same_v<Shape, HullShape>) {
    ReadHull hull(memory);
    hull.read(in);
    return in.ok() ? pool.add_built_hull(hull.points(), hull.faces(), hull.rounding).status
                   : status_of(in);
  } else if constexpr (std::is_same_v<Shape, SupportShape>) {
    return Status::invalid_argument;
  } else {
    Shape shape;
    return in.get_bytes(&shape, sizeof shape) ? pool.add(shape).status : status_of(in);
  }
}

}  // namespace

Status ShapePool::save(Column<std::byte>& out) const {
  // Function pointers cannot be saved.
  if (size(ShapeKind::support) != 0) return logged(Status::unsupported, "ShapePool::save");
  const Status status = write_snapshot(out, kShapesMagic, kShapesVersion, [&](ByteWriter& writer) {
    writer.put(kShapeKinds);
    for_each_kind([&](auto of) {
      const auto& table = PoolRows::of<typename decltype(of)::Shape>(*this);
      write_slots(writer, table.shapes.size(), table.free);
      for (std::size_t i = 0; i < table.shapes.size(); ++i) {
        if (table.live[i] != 0) put_shape(writer, table.shapes[i]);
      }
    });
  });
  return logged(status, "ShapePool::save");
}

// Adds each shape through the checked public functions, with the free list arranged so that each
// gets its saved index.
Status ShapePool::load(std::span<const std::byte> saved) {
  const DefaultFloatEnvironment environment;
  ByteReader in = open_snapshot(saved, kShapesMagic, kShapesVersion);
  ShapePool fresh(memory_);
  Status status = in.get<std::uint32_t>() == kShapeKinds ? Status::ok : Status::invalid_argument;
  for_each_kind([&](auto of) {
    using Shape = typename decltype(of)::Shape;
    auto& table = PoolRows::of<Shape>(fresh);
    SlotReader places(memory_);
    if (status != Status::ok || !places.read(in)) return;
    if (!places.open(in, table.shapes, table.free, nothing<Shape>())) return;
    if (!table.live.resize(places.size())) {
      in.refuse_memory();
      return;
    }
    std::fill(table.live.begin(), table.live.end(), std::uint8_t{0});
    for (std::size_t i = 0; i < places.taken() && status == Status::ok; ++i) {
      status = read_shape<Shape>(in, memory_, fresh);
    }
  });
  if (!in.ok()) status = status_of(in);
  if (status == Status::ok && !in.rest().empty()) status = Status::invalid_argument;
  if (status != Status::ok) return logged(snapshot_status(status), "ShapePool::load");
  for_each_kind([&](auto of) {
    using Shape = typename decltype(of)::Shape;
    PoolRows::of<Shape>(*this).swap(PoolRows::of<Shape>(fresh));
  });
  PoolRows::refresh(*this);
  return Status::ok;
}

}  // namespace winnow
