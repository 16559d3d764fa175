#include "pipeline/narrow/primitive_pairs.h"

namespace winnow {

PrimitivePairs::PrimitivePairs(std::pmr::memory_resource* memory) noexcept
    : shapes(memory),
      poses(memory),
      part(memory),
      triangles(memory),
      active_edges(memory),
      hulls(memory),
      pairs(memory),
      first(memory),
      scratch(memory) {}

void PrimitivePairs::clear() noexcept {
  shapes.clear();
  poses.clear();
  part.clear();
  triangles.clear();
  active_edges.clear();
  hulls.clear();
  pairs.clear();
  first.clear();
  scratch.clear();
}

Footprint PrimitivePairs::footprint() const noexcept {
  Footprint footprint;
  footprint.results += shapes.bytes();
  footprint.results += poses.bytes();
  footprint.results += part.bytes();
  footprint.results += triangles.bytes();
  footprint.results += active_edges.bytes();
  footprint.results += hulls.bytes();
  footprint.results += pairs.bytes();
  footprint.results += first.bytes();
  footprint.scratch += scratch.bytes();
  return footprint;
}

ShapeTables PrimitivePairs::tables(const ShapePool& pool) const noexcept {
  ShapeTables tables = pool.tables();
  tables.triangles = triangles.data();
  tables.count[static_cast<std::uint32_t>(ShapeKind::triangle)] =
      static_cast<std::uint32_t>(triangles.size());
  if (hulls.empty()) return tables;
  tables.hulls = hulls.data();
  tables.count[static_cast<std::uint32_t>(ShapeKind::hull)] =
      static_cast<std::uint32_t>(hulls.size());
  return tables;
}

}  // namespace winnow
