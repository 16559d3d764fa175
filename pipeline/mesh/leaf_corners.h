#pragma once

#include <winnow/core/memory.h>
#include "pipeline/mesh/mesh_view.h"

#include <cstdint>

namespace winnow {

/// Corners of triangles, stored by leaf. Neighbouring triangles share vertices: sixteen triangles
/// of a leaf often have only about sixteen distinct vertices. Each leaf lists its vertices once,
/// and a corner is a one-byte index into this list; kernels load each vertex once.
class LeafCorners {
 public:
  explicit LeafCorners(std::pmr::memory_resource* memory) noexcept
      : vertex_(memory), point_(memory), more_(memory), place_(memory) {}

  /// Converts a view that has corners by slot. Stores nothing if more than three quarters of the
  /// leaves have more than sixteen vertices. Returns false and stores nothing if memory is refused.
  /// O(n).
  [[nodiscard]] bool take(const MeshView& view) noexcept;
  [[nodiscard]] bool empty() const noexcept { return place_.empty(); }
  void link(MeshView& view) const noexcept;
  /// The quantised positions of the vertices in the boxes of their leaves (MeshView::leaf_point),
  /// for fit_mesh_levels to write; null if they are not stored.
  [[nodiscard]] std::uint32_t* points() noexcept { return point_.data(); }
  [[nodiscard]] Bytes bytes() const noexcept;

 private:
  Column<std::uint32_t> vertex_;
  Column<std::uint32_t> point_;
  Column<std::uint32_t> more_;
  Column<std::uint8_t> place_;
};

}  // namespace winnow
