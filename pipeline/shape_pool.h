#pragma once

#include <winnow/core/aabb.h>
#include <winnow/core/column.h>
#include <winnow/core/export.h>
#include <winnow/core/footprint.h>
#include <winnow/core/large_pages.h>
#include <winnow/core/point_view.h>
#include <winnow/core/pose.h>
#include <winnow/core/status.h>
#include <winnow/pipeline/shapes.h>

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

/// A hull given by its surface: face i is the next `sizes[i]` of `indices` into `points`,
/// counter-clockwise seen from outside. Faces may be triangles of what is coplanar.
struct HullFaces {
  std::span<const std::uint32_t> indices;  ///< numbers of points, face after face
  std::span<const std::uint32_t> sizes;    ///< corners of each face, 3 or more
};

/// The convex shapes of a simulation, each kind in its own table; bodies refer to them by id and
/// may share them. A kind that is not used takes no memory. Not for use from two threads while one
/// of them changes it.
class WINNOW_API ShapePool {
 public:
  /// An empty pool. Every allocation comes from `memory`, which must outlive it.
  explicit ShapePool(std::pmr::memory_resource* memory = default_memory()) noexcept;
  ~ShapePool();
  /// Takes over all shapes, whose ids stay, and the resource; what was moved from is empty.
  ShapePool(ShapePool&&) noexcept;
  ShapePool(const ShapePool&) = delete;
  ShapePool& operator=(const ShapePool&) = delete;
  ShapePool& operator=(ShapePool&&) = delete;

  /// Adds a shape. `invalid_shape` for a length that is negative, NaN or infinite, or a half-space
  /// without a normal; `too_many_objects` beyond 2^28 of a kind. O(1).
  /// @{
  Status add(const SphereShape& shape, ShapeId& id);
  Status add(const CapsuleShape& shape, ShapeId& id);
  Status add(const BoxShape& shape, ShapeId& id);
  Status add(const CylinderShape& shape, ShapeId& id);
  Status add(const ConeShape& shape, ShapeId& id);
  Status add(const TriangleShape& shape, ShapeId& id);
  Status add(const HalfSpaceShape& shape, ShapeId& id);
  Status add(const EllipsoidShape& shape, ShapeId& id);
  Status add(const TaperedCapsuleShape& shape, ShapeId& id);
  /// @}
  /// The same; asks the function along 26 directions. `invalid_shape` also where there is none, or
  /// what it answers is not finite, beyond the radius or, by more than 1e-9 of that, not convex.
  Status add(const SupportShape& shape, ShapeId& id);

  /// The same for who asks the id: the default one, which is no shape and which every call refuses,
  /// if the shape was refused.
  template <typename Shape>
  [[nodiscard]] ShapeId add(const Shape& shape) {
    ShapeId id;
    return add(shape, id) == Status::ok ? id : ShapeId{};
  }

  /// The convex hull of points, computed without rounding: of any that are finite, whatever they
  /// are like. Faces that are coplanar to 1e-13 of the hull's size are merged; points inside, on
  /// faces or on edges, to as much, fall away; flat sets make a polygon, a segment or a point.
  /// `invalid_shape` if there is no point or one is not finite. O(points log points) for most.
  Status add_hull(const PointView& points, double rounding, ShapeId& id);
  /// The hull that `faces` bound. `invalid_shape` unless they are closed, consistently oriented and
  /// convex to 1e-9 of the hull's size. Coplanar neighbours are merged.
  Status add_hull(const PointView& points, const HullFaces& faces, double rounding, ShapeId& id);

  /// A hull as a pool has it, given by its vertices and by its faces in their order, which it keeps
  /// to the bit; without faces a segment or a point. `invalid_shape` for what no pool can have.
  Status add_built_hull(const PointView& points, const HullFaces& faces, double rounding,
                        ShapeId& id);

  /// Takes a shape out; its place is given to the next one of its kind. Bodies must not use the id
  /// any more: until then its place holds a point.
  Status remove(ShapeId id);

  /// True for ids of shapes that are there.
  [[nodiscard]] bool contains(ShapeId id) const noexcept;
  /// Shapes of a kind, removed ones excluded.
  [[nodiscard]] std::size_t size(ShapeKind kind) const noexcept;

  /// A float box that contains the shape at the pose, rounded outward, at most 1e-6 of its size
  /// larger than the smallest; a half-space's reaches to infinity. `pose` is valid.
  [[nodiscard]] Aabb bounds(ShapeId id, const Pose& pose) const noexcept;

  /// Appends all shapes, and which places are free, to bytes; pipeline/CONTRACT.md has the format.
  /// `unsupported` while it holds support functions; that and `out_of_memory` leave `out` as it
  /// was. O(bytes).
  Status save(Column<std::byte>& out) const;
  /// Becomes the pool that was saved: shapes have the ids that they had, and answer to the bit.
  /// Whoever uses the pool and has shapes that were not there has to be loaded, too, before it is
  /// asked again. `invalid_argument` for anything that was not saved so, whoever made it, and
  /// `out_of_memory`, leave the pool as it was. Links the kernels of all kinds. O(bytes).
  Status load(std::span<const std::byte> saved);

  /// The shapes themselves, to be read: sphere `id` is tables().spheres[id.index()]. Valid until
  /// the next change.
  [[nodiscard]] const ShapeTables& tables() const noexcept { return tables_; }

  /// Shapes and what is made of them, to the byte what the resource gave.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  /// @cond Doxygen lists private classes, too.
  template <typename Shape>
  struct Table {
    explicit Table(std::pmr::memory_resource* memory) noexcept
        : shapes(memory), live(memory), free(memory) {}
    Column<Shape> shapes;
    Column<std::uint8_t> live;
    Column<std::uint32_t> free;
  };
  /// @endcond

  template <typename Shape>
  Status put(Table<Shape>& table, ShapeKind kind, const Shape& shape, ShapeId& id);
  template <typename Make>
  Status put_hull(double rounding, ShapeId& id, Make&& make);
  /// Calls `body` with the table of a kind.
  template <typename Pool, typename Body>
  static decltype(auto) with_table(Pool& pool, ShapeKind kind, Body&& body);
  /// Calls visit(table, the same of another pool) for each kind.
  template <typename Pool, typename Visit>
  static void for_tables(Pool& pool, Pool& other, Visit&& visit);
  void refresh_tables() noexcept;

  std::pmr::memory_resource* memory_;
  Table<SphereShape> spheres_;
  Table<CapsuleShape> capsules_;
  Table<BoxShape> boxes_;
  Table<CylinderShape> cylinders_;
  Table<ConeShape> cones_;
  Table<HullShape> hulls_;
  Table<TriangleShape> triangles_;
  Table<HalfSpaceShape> half_spaces_;
  Table<EllipsoidShape> ellipsoids_;
  Table<TaperedCapsuleShape> tapered_capsules_;
  Table<SupportShape> supports_;
  ShapeTables tables_;
};

}  // namespace winnow
