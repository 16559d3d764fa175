#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/column.h>
#include <winnow/core/execution.h>
#include <winnow/core/export.h>
#include <winnow/core/footprint.h>
#include <winnow/core/large_pages.h>
#include <winnow/core/point_view.h>
#include <winnow/core/status.h>

#include <cstddef>
#include <memory_resource>
#include <span>

namespace winnow {

struct MeshView;

/// How a mesh is built.
struct MeshOptions {
  /// An edge that two triangles share is active if the mesh is convex there and bends by more than
  /// this, in radians. Edges with one triangle or more than two are active; where two triangles are
  /// wound inconsistently, or one has no area, every bend is. Vertices at the same place count as
  /// one. In [0, pi].
  double active_edge_angle = 0.02;
};

/// A triangle mesh with its tree: indexed float vertices in the caller's order, triangles
/// ordered by median cuts, above every 16 of them a box of 16-bit bounds, above every 16 boxes
/// another. Where neighbours share most of their vertices, as in a closed mesh, 15 to 17 bytes per
/// triangle, 12 per vertex, and about 0.8 per triangle for the tree: under 24 bytes a triangle.
/// Elsewhere 16 bytes per triangle instead of 15. Of more vertices than triangles few are shared,
/// and every triangle has a box of its own, of 12 bytes more. Triangles are two-sided, unless
/// CompositePool::set_one_sided says otherwise, and may be degenerate.
class WINNOW_API TriangleMesh {
 public:
  /// A mesh without triangles. Every allocation comes from `memory`, which must outlive the mesh.
  explicit TriangleMesh(std::pmr::memory_resource* memory = default_memory()) noexcept
      : memory_(memory) {}
  /// Takes over triangles, tree and resource; `other` is left without triangles.
  TriangleMesh(TriangleMesh&& other) noexcept;
  ~TriangleMesh();
  TriangleMesh(const TriangleMesh&) = delete;
  TriangleMesh& operator=(const TriangleMesh&) = delete;

  /// Takes copies of vertices (rounded to float) and triangles and builds the tree. O(n log n).
  /// `invalid_shape` if there is no triangle, a vertex is not finite in float, or a corner is not a
  /// vertex; `too_many_objects` beyond 2^28 triangles or 2^31 - 1 vertices; `invalid_argument` for
  /// bad options or views without columns. A refused build, or one without memory, leaves the mesh
  /// as it was.
  Status build(const PointView& vertices, const IndexView& triangles,
               const MeshOptions& options = {}, const Execution& execution = Execution::serial());

  /// Gives all vertices new places and fits the tree to them, keeping its order: for meshes that
  /// deform. Which edges are active is found anew; who is whose neighbour stays, and takes 12 bytes
  /// a triangle from the first call on: later ones allocate nothing. `size_mismatch` for another
  /// number of vertices. O(n), several times faster than `build`; the tree gets worse as neighbours
  /// part.
  Status refit(const PointView& vertices, const Execution& execution = Execution::serial());

  /// Appends vertices, triangles in the order of the tree, and which edges are active, to bytes;
  /// pipeline/CONTRACT.md has the format. `out_of_memory` leaves `out` as it was. O(n).
  Status save(Column<std::byte>& out) const;
  /// Becomes the mesh that was saved, with every answer to the bit; nothing is sorted, only boxes
  /// are put around what is there: O(n). `invalid_argument` for anything that was not saved so,
  /// whoever made it, and `out_of_memory`, leave the mesh as it was.
  Status load(std::span<const std::byte> saved, const Execution& execution = Execution::serial());

  /// Triangles that it was built of; 0 before.
  [[nodiscard]] std::size_t triangles() const noexcept;
  /// Vertices that it was built of, shared ones once; 0 before.
  [[nodiscard]] std::size_t vertices() const noexcept;
  /// Of all triangles; empty if there are none.
  [[nodiscard]] Aabb bounds() const noexcept;
  /// No vertex is farther than this from the origin.
  [[nodiscard]] double radius() const noexcept;

  /// Vertices, triangles and tree, to the byte what the resource gave.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  /// As traversals read it.
  friend const MeshView& view_of(const TriangleMesh& mesh) noexcept;
  struct State;

  std::pmr::memory_resource* memory_;
  /// Null until something is built.
  State* state_ = nullptr;
};

}  // namespace winnow
