#pragma once

#include <winnow/core/column.h>
#include <winnow/core/footprint.h>
#include "pipeline/mesh/mesh_view.h"

#include <cstdint>

namespace winnow {

/// Corners of triangles by leaf: neighbours share most of their vertices, so that the sixteen of a
/// leaf have hardly more than sixteen, and a corner needs a byte to say which of them it is.
/// Kernels look at each once.
class LeafCorners {
 public:
  explicit LeafCorners(std::pmr::memory_resource* memory) noexcept
      : vertex_(memory), point_(memory), more_(memory), place_(memory) {}

  /// Takes them from a view with corners by slot; or nothing, if most leaves have more than sixteen
  /// vertices. False, and nothing is taken, if memory is refused. O(n).
  [[nodiscard]] bool take(const MeshView& view) noexcept;
  [[nodiscard]] bool empty() const noexcept { return place_.empty(); }
  void link(MeshView& view) const noexcept;
  /// Where the vertices are in the boxes of their leaves, to be written; null if that is not kept.
  [[nodiscard]] std::uint32_t* points() noexcept { return point_.data(); }
  [[nodiscard]] Bytes bytes() const noexcept;

 private:
  Column<std::uint32_t> vertex_;
  Column<std::uint32_t> point_;
  Column<std::uint32_t> more_;
  Column<std::uint8_t> place_;
};

}  // namespace winnow
