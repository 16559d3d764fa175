#pragma once

// Surfaces of triangles: meshes and height fields. A CompositePool (composite_pool.h) stores those
// that bodies have as shapes. The implementation is in mesh/.

#include <winnow/core/execution.h>
#include <winnow/core/export.h>
#include <winnow/core/memory.h>
#include <winnow/core/point_view.h>
#include <winnow/core/status.h>
#include <winnow/core/volumes.h>
#include <winnow/pipeline/shapes.h>

#include <cstddef>
#include <cstdint>
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

struct HeightGrid;

/// Heights in the caller's memory: sample (column, row) is `heights[row * row_stride + column]`, at
/// (column * spacing[0], row * spacing[1], height) in the frame of the shape. NaN is a hole:
/// squares with such a corner have no triangles.
struct HeightSamples {
  std::span<const float> heights;  ///< at least (rows - 1) * row_stride + columns values
  std::uint32_t columns = 0;       ///< samples along x, 2 or more
  std::uint32_t rows = 0;          ///< samples along y, 2 or more
  std::uint32_t row_stride = 0;    ///< 0 means `columns`
  double spacing[2] = {1.0, 1.0};  ///< along x and y; positive, finite
};

/// A surface over a regular grid, z up. Each square consists of two triangles that share the
/// diagonal from its lowest column and row to its highest. There is no tree of boxes: cells are
/// found by division, and pruned by a pyramid of minimal and maximal heights, whose lowest level
/// covers 16 x 16 squares per entry, and each higher level 4 x 4 entries of the level below. A
/// field takes 4 bytes per sample, plus a thirtieth of a byte for the pyramid. Squares are numbered
/// row by row. Triangle 2 * square has a corner at (column + 1, row), triangle 2 * square + 1 has a
/// corner at (column, row + 1).
class WINNOW_API HeightField {
 public:
  /// Creates a field without samples. Every allocation comes from `memory`, which must outlive the
  /// field.
  explicit HeightField(std::pmr::memory_resource* memory = default_memory()) noexcept
      : memory_(memory) {}
  /// Takes the samples and the resource of `other`, which is then without samples.
  HeightField(HeightField&& other) noexcept;
  ~HeightField();

  /// Copies the samples. `invalid_shape` for fewer than 2 x 2 samples, an infinite height, or a
  /// spacing that is not positive and finite or makes the field exceed the range of float;
  /// `size_mismatch` if `heights` is too short; `invalid_argument` for a row stride below the
  /// number of columns; `too_many_objects` beyond 2^28 triangles. After an error, also
  /// `out_of_memory`, the field is unchanged. O(n).
  Status build(const HeightSamples& samples);
  /// Replaces the heights of the samples [column, column + samples.columns) x [row, row +
  /// samples.rows); `spacing` is ignored. `invalid_argument` if they are not all in the field;
  /// other errors as for `build`. O(samples).
  Status update(std::uint32_t column, std::uint32_t row, const HeightSamples& samples);

  /// Appends a snapshot of spacing and heights. pipeline/FORMATS.md has the format.
  /// `out_of_memory` leaves `out` unchanged. O(n).
  Status save(Column<std::byte>& out) const;
  /// Replaces the field by a snapshot. `invalid_argument` if the bytes are not a valid snapshot
  /// (untrusted bytes are safe); it and `out_of_memory` leave the field unchanged. O(n).
  Status load(std::span<const std::byte> saved);

  /// Returns the box of all squares: x and y include holes, z does not. Empty if all squares are
  /// holes.
  [[nodiscard]] Aabb bounds() const noexcept;
  /// Returns an upper bound on the distance of the triangles' points from the origin. 0 without
  /// triangles.
  [[nodiscard]] double radius() const noexcept;
  /// Returns the number of samples along x; 0 before the first build.
  [[nodiscard]] std::uint32_t columns() const noexcept;
  /// Returns the number of samples along y; 0 before the first build.
  [[nodiscard]] std::uint32_t rows() const noexcept;
  /// Returns the number of triangles, including triangles of holes.
  [[nodiscard]] std::uint32_t triangles() const noexcept;
  /// Writes a triangle. Returns false for a triangle of a hole, or a number out of range.
  [[nodiscard]] bool triangle(std::uint32_t number, TriangleShape& shape) const noexcept;
  /// Returns which edges of a triangle are active, bit k for edge k: edges that bend outward (down
  /// on both sides) by more than the default angle of MeshOptions, and edges without another
  /// triangle. All edges for a triangle of a hole.
  [[nodiscard]] std::uint8_t active_edges(std::uint32_t number) const noexcept;

  /// Returns the bytes of heights and pyramid: exactly what is allocated from the resource.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  /// Returns the field as traversals read it.
  friend HeightGrid grid_of(const HeightField& field) noexcept;
  struct State;

  std::pmr::memory_resource* memory_;
  /// Null until something is built.
  State* state_ = nullptr;
};

}  // namespace winnow
