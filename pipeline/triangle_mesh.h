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

/// Options of building a mesh.
struct MeshOptions {
  /// Used for meshes in compounds only, and there for contacts with edges whose other triangle does
  /// not touch: an edge that is not active has contacts along the normal of its face. Angle in
  /// radians above which a convex edge is active. An edge of two triangles is active if the mesh is
  /// convex there and bends by more than this. Edges of one triangle, or of more than two, are
  /// always active; so are all bent edges of triangles with inconsistent winding or without area.
  /// Vertices at the same position count as one. In [0, pi].
  double active_edge_angle = 0.02;
};

/// A triangle mesh with a tree of boxes over it: float vertices in the caller's order, and
/// triangles ordered by median splits. Each leaf has 16 triangles and each node 16 children, with
/// bounds of 16 bits. Memory per triangle: 15 to 17 bytes if triangles of a leaf share most of
/// their vertices, as in a closed mesh, else 16; about 0.8 bytes for the tree; and 12 bytes per
/// vertex. A closed mesh takes less than 24 bytes per triangle. If there are more vertices than
/// triangles, few are shared, and each triangle gets its own box of 12 bytes. Triangles are
/// two-sided unless CompositePool::set_one_sided is called, and may be degenerate.
class WINNOW_API TriangleMesh {
 public:
  /// Creates a mesh without triangles. Every allocation comes from `memory`, which must outlive the
  /// mesh.
  explicit TriangleMesh(std::pmr::memory_resource* memory = default_memory()) noexcept
      : memory_(memory) {}
  /// Takes the triangles, tree and resource of `other`, which is then without triangles.
  TriangleMesh(TriangleMesh&& other) noexcept;
  ~TriangleMesh();
  TriangleMesh(const TriangleMesh&) = delete;
  TriangleMesh& operator=(const TriangleMesh&) = delete;

  /// Copies vertices (rounded to float) and triangles, and builds the tree. `invalid_shape` if
  /// there is no triangle, a vertex is not finite in float, or a corner is not a vertex;
  /// `too_many_objects` beyond 2^28 triangles or 2^31 - 1 vertices; `invalid_argument` for invalid
  /// options or views without columns. After an error, also `out_of_memory`, the mesh is unchanged.
  /// O(n log n).
  Status build(const PointView& vertices, const IndexView& triangles,
               const MeshOptions& options = {}, const Execution& execution = Execution::serial());

  /// Moves all vertices and refits the tree, keeping its order, for meshes that deform. Active
  /// edges are computed again from the same adjacency, which takes 12 bytes per triangle from the
  /// first call on; later calls allocate nothing. `size_mismatch` for another number of vertices.
  /// O(n); the tree gets worse as triangles of a leaf move apart.
  Status refit(const PointView& vertices, const Execution& execution = Execution::serial());

  /// Appends a snapshot of vertices, triangles in the order of the tree, and active edges.
  /// pipeline/FORMATS.md has the format. `out_of_memory` leaves `out` unchanged. O(n).
  Status save(Column<std::byte>& out) const;
  /// Replaces the mesh by a snapshot; results equal the results of the saved mesh bit for bit.
  /// Nothing is sorted, only boxes are computed: O(n). `invalid_argument` if the bytes are not a
  /// valid snapshot (untrusted bytes are safe); it and `out_of_memory` leave the mesh unchanged.
  Status load(std::span<const std::byte> saved, const Execution& execution = Execution::serial());

  /// Returns the number of triangles; 0 before `build`.
  [[nodiscard]] std::size_t triangles() const noexcept;
  /// Returns the number of vertices, shared ones counted once; 0 before `build`.
  [[nodiscard]] std::size_t vertices() const noexcept;
  /// Returns the box of all triangles; empty if there are none.
  [[nodiscard]] Aabb bounds() const noexcept;
  /// Returns an upper bound on the distance of vertices from the origin.
  [[nodiscard]] double radius() const noexcept;

  /// Returns the bytes of vertices, triangles and tree: exactly what is allocated from the
  /// resource.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  /// Returns the mesh as traversals read it.
  friend const MeshView& view_of(const TriangleMesh& mesh) noexcept;
  struct State;

  std::pmr::memory_resource* memory_;
  /// Null until something is built.
  State* state_ = nullptr;
};

}  // namespace winnow
