#include "pipeline/recording/composite_bytes.h"

#include "pipeline/mesh/height_grid.h"
#include "pipeline/mesh/mesh_view.h"

namespace winnow {

std::span<const float> values_of(const CompositePool& pool, ShapeId id) noexcept {
  if (const TriangleMesh* const mesh = pool.mesh(id)) {
    const MeshView& view = view_of(*mesh);
    return {view.vertex, std::size_t{3} * view.vertex_count};
  }
  if (const HeightField* const field = pool.height_field(id)) {
    const HeightGrid grid = grid_of(*field);
    return {grid.heights, std::size_t{grid.columns} * grid.rows};
  }
  return {};
}

namespace {

/// Adds corner k of all triangles as if they were an array.
void add_corners(Digest& digest, const MeshView& view, std::size_t k) noexcept {
  const std::uint32_t count = view.triangle_count;
  for (std::uint32_t slot = 0; slot + 2 <= count; slot += 2) {
    digest.add(corner_of(view, k, slot) | std::uint64_t{corner_of(view, k, slot + 1)} << 32U);
  }
  digest.add(std::uint64_t{count % 2 != 0 ? corner_of(view, k, count - 1) : 0U});
  digest.add(std::uint64_t{count} * sizeof(std::uint32_t));
}

}  // namespace

// The active edges of a mesh are not included: they are computed from its triangles, its vertices
// and the angle in its build options.
CompositeDigests digests_of(const CompositePool& pool, ShapeId id) noexcept {
  Digest digest;
  digest.add(std::uint64_t{id.kind_index()});
  if (const TriangleMesh* const mesh = pool.mesh(id)) {
    const MeshView& view = view_of(*mesh);
    for (std::size_t k = 0; k < 3; ++k) add_corners(digest, view, k);
    for (const double factor : pool.scale(id)) digest.add(factor);
  }
  if (const HeightField* const field = pool.height_field(id)) {
    const HeightGrid grid = grid_of(*field);
    digest.add(std::uint64_t{grid.columns} << 32U | grid.rows);
    for (const double spacing : grid.spacing) digest.add(spacing);
  }
  for (const CompoundChild& child : pool.children(id)) {
    digest.add(std::uint64_t{child.shape.kind_index()});
    digest.add(std::as_bytes(std::span(&child.pose, 1)));
  }
  CompositeDigests digests;
  digests.form = digest.value();
  digest.add_array(values_of(pool, id));
  digests.all = digest.value();
  return digests;
}

Status save_composite(const CompositePool& pool, ShapeId id, Column<std::byte>& out) {
  if (const TriangleMesh* const mesh = pool.mesh(id)) return mesh->save(out);
  if (const HeightField* const field = pool.height_field(id)) return field->save(out);
  return Status::ok;
}

}  // namespace winnow
