// Solid meshes: CompositePool::set_solid, and the hulls of convex solids (solid_hulls.h). Tests of
// points are in solids.cpp.

#include "pipeline/composites/solid_hulls.h"

#include "core/memory/catch_bad_alloc.h"
#include "core/threads/float_environment.h"
#include "pipeline/composites/solids.h"
#include "pipeline/composites/transformed_shape.h"
#include "pipeline/kernels/link.h"
#include "pipeline/shapes/hull_builder.h"

#include <algorithm>
#include <vector>

namespace winnow::mid {
namespace {

/// Vertices of meshes are floats: rounding bends flat faces by about this share of the size.
constexpr HullTolerance kSolidTolerance = {.coplanar = 2e-7, .convex = 2e-7};

/// The triangles of a mesh with scaled vertices, of which equal ones are one.
struct WeldedMesh {
  WeldedMesh(const Composites& all, ShapeId id) : points(all.memory), corners(all.memory) {
    const TransformedShape body =
        TransformedShape::at(all, id, {}, TransformedShape::Solids::triangles);
    const bool is_mirrored = body.to_world.determinant() < 0.0;
    for (std::uint32_t slot = 0; slot < body.mesh->triangle_count; ++slot) {
      double corner[3][3];
      static_cast<void>(body.own_corners(slot, corner));
      if (is_mirrored) std::swap(corner[1], corner[2]);
      for (const double(&own)[3] : corner) points.emplace_back(body.to_world * Vec::Map(own));
    }
    weld();
  }

  std::pmr::vector<Vec3d> points;
  std::pmr::vector<std::uint32_t> corners;

 private:
  void weld() {
    const std::pmr::vector<Vec3d> all = points;
    std::sort(points.begin(), points.end(), is_before);
    points.erase(std::unique(points.begin(), points.end()), points.end());
    for (std::size_t i = 0; i < all.size(); i += 3) {
      std::uint32_t triangle[3];
      for (std::size_t k = 0; k < 3; ++k) triangle[k] = index_of(all[i + k]);
      // Triangles that are segments have no part in the hull.
      if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) {
        continue;
      }
      corners.insert(corners.end(), triangle, triangle + 3);
    }
  }
  [[nodiscard]] static bool is_before(const Vec3d& a, const Vec3d& b) noexcept {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  }
  [[nodiscard]] std::uint32_t index_of(const Vec3d& point) const noexcept {
    return static_cast<std::uint32_t>(
        std::lower_bound(points.begin(), points.end(), point, is_before) - points.begin());
  }
};

/// `invalid_shape` if the mesh is not convex.
[[nodiscard]] Status build_hull(const Composites& all, ShapeId id, HullShape& hull) {
  const WeldedMesh mesh(all, id);
  const std::pmr::vector<std::uint32_t> sizes(mesh.corners.size() / 3, 3U, all.memory);
  return hull_of_faces(PointView(mesh.points), {mesh.corners, sizes}, all.memory, hull,
                       kSolidTolerance);
}

/// A surface that is convex at each edge may still wind around its inside more than once, as a
/// pyramid over a pentagram does.
[[nodiscard]] bool winds_once(const Composites& all, ShapeId id, const HullShape& hull) noexcept {
  return winding_number(all, id, hull.center) < 1.5;
}

/// Copies the address of the hulls after they changed.
void refresh_tables(Composites& all) noexcept {
  all.hull_tables.hulls = all.hulls.entries.data();
  all.hull_tables.count[static_cast<std::size_t>(ShapeKind::hull)] =
      static_cast<std::uint32_t>(all.hulls.entries.size());
}

/// A hull that memory is refused for is missing: the solid is then used by its triangles.
void refit_hulls(Composites& all, const SharedMesh& mesh) noexcept {
  for (const std::uint32_t bits : all.solid.bits()) {
    MeshEntry& entry = all.meshes.entries[ShapeId{bits}.index()];
    if (entry.shared != &mesh) continue;
    all.drop_hull(entry);
    static_cast<void>(make_hull(all, ShapeId{bits}));
  }
}

}  // namespace

Status make_hull(Composites& all, ShapeId mesh) noexcept {
  all.refit_hulls = &refit_hulls;
  MeshEntry& entry = all.meshes.entries[mesh.index()];
  if (entry.hull != MeshEntry::kNoHull) return Status::ok;
  HullShape hull;
  const Status built =
      catch_bad_alloc([&] { return build_hull(all, mesh, hull); }, Status::out_of_memory);
  if (built != Status::ok) return built == Status::invalid_shape ? Status::ok : built;
  Status status = winds_once(all, mesh, hull) ? all.hulls.prepare() : Status::invalid_shape;
  if (status != Status::ok) {
    release_hull(hull, all.memory);
    return status == Status::invalid_shape ? Status::ok : status;
  }
  link_hull_kernels();
  entry.hull = all.hulls.put(hull);
  refresh_tables(all);
  return Status::ok;
}

Status make_hulls(Composites& all) noexcept {
  for (const std::uint32_t bits : all.solid.bits()) {
    if (const Status status = make_hull(all, ShapeId{bits}); status != Status::ok) return status;
  }
  return Status::ok;
}

}  // namespace winnow::mid

namespace winnow {

Status CompositePool::set_solid(ShapeId id, bool solid) {
  const DefaultFloatEnvironment environment;
  if (mesh(id) == nullptr) return Status::invalid_key;
  if (solid == is_solid(id)) return Status::ok;
  if (!solid) {
    state_->drop_hull(state_->meshes.entries[id.index()]);
    return state_->solid.set(id, false, revision_);
  }
  Status status = mid::check_solid(*state_, id);
  if (status == Status::ok) status = mid::make_hull(*state_, id);
  if (status != Status::ok) return status;
  status = state_->solid.set(id, true, revision_);
  if (status != Status::ok) state_->drop_hull(state_->meshes.entries[id.index()]);
  return status;
}

}  // namespace winnow
