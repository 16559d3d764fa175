#pragma once

#include <winnow/core/export.h>
#include <winnow/core/memory.h>
#include <winnow/core/point_view.h>
#include <winnow/core/pose.h>
#include <winnow/core/status.h>
#include <winnow/core/volumes.h>
#include <winnow/pipeline/shapes.h>

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

/// Surface of a hull: face i consists of the next `sizes[i]` entries of `indices`, which refer to
/// points, counter-clockwise as seen from outside. Coplanar faces may be given as several
/// triangles.
struct HullFaces {
  std::span<const std::uint32_t> indices;  ///< indices of points, face after face
  std::span<const std::uint32_t> sizes;    ///< number of vertices of each face, 3 or more
};

namespace detail {

/// The shapes of one kind in a pool, by index.
template <typename Shape>
struct ShapeRows {
  explicit ShapeRows(std::pmr::memory_resource* memory) noexcept
      : shapes(memory), live(memory), free(memory) {}
  void swap(ShapeRows& other) noexcept {
    shapes.swap(other.shapes);
    live.swap(other.live);
    free.swap(other.free);
  }

  Column<Shape> shapes;
  Column<std::uint8_t> live;
  Column<std::uint32_t> free;
};

}  // namespace detail

/// The convex shapes of a simulation, each kind in its own table. Bodies refer to shapes by id and
/// may share them. A kind that is not used takes no memory. While a thread changes a pool, no other
/// thread may use it.
class WINNOW_API ShapePool {
 public:
  /// Creates an empty pool. Every allocation comes from `memory`, which must outlive the pool.
  explicit ShapePool(std::pmr::memory_resource* memory = default_memory()) noexcept;
  ~ShapePool();
  /// Takes the shapes of another pool, with their ids, and its resource. The other pool is then
  /// empty.
  ShapePool(ShapePool&&) noexcept;

  /// Adds a shape. `invalid_shape` for a length that is negative, NaN or infinite, or a half-space
  /// without a normal; `too_many_objects` beyond 2^28 shapes of a kind. O(1).
  /// @{
  Answer<ShapeId> add(const SphereShape& shape);
  Answer<ShapeId> add(const CapsuleShape& shape);
  Answer<ShapeId> add(const BoxShape& shape);
  Answer<ShapeId> add(const CylinderShape& shape);
  Answer<ShapeId> add(const ConeShape& shape);
  Answer<ShapeId> add(const TriangleShape& shape);
  Answer<ShapeId> add(const HalfSpaceShape& shape);
  Answer<ShapeId> add(const EllipsoidShape& shape);
  Answer<ShapeId> add(const TaperedCapsuleShape& shape);
  /// @}
  /// Adds a user shape; calls its function along 26 directions. `invalid_shape` also if there is no
  /// function, or a returned point is not finite, beyond the radius, or violates convexity by more
  /// than 1e-9 of the radius.
  Answer<ShapeId> add(const SupportShape& shape);

  /// Adds the convex hull of points, computed without rounding; any finite points are valid input.
  /// Faces that are coplanar to 1e-13 of the hull's size are merged; points inside, on faces or on
  /// edges (to the same tolerance) are dropped. A flat set becomes a polygon, a segment or a point.
  /// `invalid_shape` if there is no point or one is not finite. O(points log points) for most
  /// inputs.
  Answer<ShapeId> add_hull(const PointView& points, double rounding = 0.0);
  /// Adds the hull bounded by `faces`. `invalid_shape` unless they are closed, consistently
  /// oriented and convex to 1e-9 of the hull's size. Coplanar adjacent faces are merged.
  Answer<ShapeId> add_hull(const PointView& points, const HullFaces& faces, double rounding = 0.0);

  /// Adds a hull that was read from a pool, given by its vertices and its faces in order; the pool
  /// stores it bit for bit. Without faces: a segment or a point. `invalid_shape` if no pool can
  /// contain such a hull.
  Answer<ShapeId> add_built_hull(const PointView& points, const HullFaces& faces, double rounding);

  /// Removes a shape. Bodies must not use its id any more: a later shape of the same kind gets its
  /// index. Until then the table has the default shape at this index: a point, or for a half-space
  /// the points with z <= 0.
  Status remove(ShapeId id);

  /// True if the pool contains the shape.
  [[nodiscard]] bool contains(ShapeId id) const noexcept;
  /// Returns the number of shapes of a kind, without removed ones.
  [[nodiscard]] std::size_t size(ShapeKind kind) const noexcept;

  /// Returns a float box that contains the shape at a valid pose, rounded outward: at most 1e-6 of
  /// its size larger than the tightest box. The box of a half-space is infinite.
  [[nodiscard]] Aabb bounds(ShapeId id, const Pose& pose) const noexcept;

  /// Appends a snapshot of all shapes and free indices. pipeline/FORMATS.md has the format.
  /// `unsupported` if the pool contains user shapes; this and `out_of_memory` leave `out`
  /// unchanged. O(bytes).
  Status save(Column<std::byte>& out) const;
  /// Replaces the shapes by a snapshot, with the ids that they had; results equal the results of
  /// the saved pool bit for bit. If a scene or a composite pool uses shapes that the pool no longer
  /// contains, load it too before it is used again. `invalid_argument` if the bytes are not a valid
  /// snapshot (untrusted bytes are safe); it and `out_of_memory` change nothing. Links the kernels
  /// of all kinds. O(bytes).
  Status load(std::span<const std::byte> saved);

  /// Returns the shapes for reading: sphere `id` is tables().spheres[id.index()]. Valid until the
  /// next change.
  [[nodiscard]] const ShapeTables& tables() const noexcept { return tables_; }

  /// Returns the bytes of shapes and data derived from them: exactly what is allocated from the
  /// resource.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  friend struct PoolRows;

  std::pmr::memory_resource* memory_;
  /// @cond The tables: spheres_, capsules_ and so on.
#define WINNOW_TABLE(kind, Shape, table) detail::ShapeRows<Shape> table##_{memory_};
  WINNOW_CONVEX_SHAPES(WINNOW_TABLE)
#undef WINNOW_TABLE
  /// @endcond
  ShapeTables tables_;
};

}  // namespace winnow
