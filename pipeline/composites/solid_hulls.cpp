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
#include <utility>
#include <vector>

namespace winnow::mid {
namespace {

/// Vertices of meshes are floats: rounding bends flat faces by about this share of the size.
constexpr HullTolerance kSolidTolerance = {.coplanar = 2e-7, .convex = 2e-7};

/// The triangles of a mesh with scaled vertices, of which equal ones are one.
struct WeldedMesh {
  WeldedMesh(const Composites& all, ShapeId id) : points(all.memory), corners(all.memory) {
    const TransformedShape body = TransformedShape::at(all, id, {}, Solids::triangles);
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

/// Checks that the triangles of a mesh enclose a volume. `invalid_shape` unless as many triangles
/// traverse each edge in one direction as in the other, so that the mesh winds a whole number of
/// times around each point, and the enclosed volume is positive (corners counter-clockwise seen
/// from outside). Parts of the mesh may touch, overlap or be given twice. O(n log n).
[[nodiscard]] Status check_solid(const Composites& all, ShapeId id) {
  const WeldedMesh mesh(all, id);
  struct Edge {
    std::uint32_t low, high;
    int direction;
  };
  std::pmr::vector<Edge> edges(all.memory);
  double volume = 0.0;
  for (std::size_t t = 0; t < mesh.corners.size(); t += 3) {
    const std::uint32_t* const corner = mesh.corners.data() + t;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(corner[k], corner[(k + 1) % 3]);
      edges.push_back({low, high, corner[k] == low ? 1 : -1});
    }
    const auto from_first = [&](std::size_t k) -> Vec {
      return as_eigen(mesh.points[corner[k]]) - as_eigen(mesh.points[0]);
    };
    volume += from_first(0).dot(from_first(1).cross(from_first(2)));
  }
  const auto ends = [](const Edge& edge) { return std::pair(edge.low, edge.high); };
  std::ranges::sort(edges, {}, ends);
  for (auto edge = edges.begin(); edge != edges.end();) {
    int balance = 0;
    const auto first = edge;
    for (; edge != edges.end() && ends(*edge) == ends(*first); ++edge) balance += edge->direction;
    if (balance != 0) return Status::invalid_shape;
  }
  return volume > 0.0 ? Status::ok : Status::invalid_shape;
}

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
  Status status =
      catch_bad_alloc([&] { return mid::check_solid(*state_, id); }, Status::out_of_memory);
  if (status == Status::ok) status = mid::make_hull(*state_, id);
  if (status != Status::ok) return status;
  status = state_->solid.set(id, true, revision_);
  if (status != Status::ok) state_->drop_hull(state_->meshes.entries[id.index()]);
  return status;
}

}  // namespace winnow
