#pragma once

// The convex shapes and their ids. ShapePool (shape_pool.h) stores them; every phase of the
// pipeline reads them. They are plain structs, because kernel files read them directly from a
// ShapePool.

#include <winnow/core/export.h>
#include <winnow/core/vectors.h>

#include <cstdint>

namespace winnow {

/// Kinds of convex shapes. Results are sorted by the numbers of the two kinds of a pair.
enum class ShapeKind : std::uint8_t {
  sphere,      ///< SphereShape
  capsule,     ///< CapsuleShape
  box,         ///< BoxShape
  cylinder,    ///< CylinderShape
  cone,        ///< ConeShape
  hull,        ///< HullShape
  triangle,    ///< TriangleShape
  half_space,  ///< HalfSpaceShape
  // The numbers from 8 to 10 are kinds of CompositeKind.
  ellipsoid = 11,   ///< EllipsoidShape
  tapered_capsule,  ///< TaperedCapsuleShape
  support,          ///< SupportShape
};

/// Kinds of composite shapes, which consist of many convex ones and are stored in a CompositePool.
/// Ids of both enums share one range of numbers, so no number occurs in both.
enum class CompositeKind : std::uint8_t {
  mesh = 8,      ///< TriangleMesh
  compound,      ///< several CompoundChild
  height_field,  ///< HeightField
};

/// All kind numbers, convex and composite, are below this.
inline constexpr std::uint32_t kShapeKinds = 14;

/// The kinds of convex shapes in order, as WINNOW_X(enumerator of ShapeKind, struct, member of
/// ShapeTables).
#define WINNOW_CONVEX_SHAPES(WINNOW_X)                             \
  WINNOW_X(sphere, SphereShape, spheres)                           \
  WINNOW_X(capsule, CapsuleShape, capsules)                        \
  WINNOW_X(box, BoxShape, boxes)                                   \
  WINNOW_X(cylinder, CylinderShape, cylinders)                     \
  WINNOW_X(cone, ConeShape, cones)                                 \
  WINNOW_X(hull, HullShape, hulls)                                 \
  WINNOW_X(triangle, TriangleShape, triangles)                     \
  WINNOW_X(half_space, HalfSpaceShape, half_spaces)                \
  WINNOW_X(ellipsoid, EllipsoidShape, ellipsoids)                  \
  WINNOW_X(tapered_capsule, TaperedCapsuleShape, tapered_capsules) \
  WINNOW_X(support, SupportShape, supports)

/// All enumerators of ShapeKind, in order.
inline constexpr ShapeKind kConvexKinds[] = {
#define WINNOW_ENUMERATOR(kind, Shape, table) ShapeKind::kind,
    WINNOW_CONVEX_SHAPES(WINNOW_ENUMERATOR)
#undef WINNOW_ENUMERATOR
};

/// Returns the enumerator's name; never null.
[[nodiscard]] WINNOW_API const char* to_string(ShapeKind kind) noexcept;

/// Id of a shape in a ShapePool or CompositePool: its kind, and its index among the shapes of that
/// kind.
struct ShapeId {
  /// Number of low bits that contain the index; the kind is in the bits above.
  static constexpr std::uint32_t kIndexBits = 28;
  std::uint32_t bits = ~0U;  ///< kind << kIndexBits | index; the default is no shape

  /// Returns the id of a convex shape; `index` is below 2^28.
  [[nodiscard]] static constexpr ShapeId of(ShapeKind kind, std::uint32_t index) noexcept {
    return {static_cast<std::uint32_t>(kind) << kIndexBits | index};
  }
  /// Returns the id of a composite shape; `index` is below 2^28.
  [[nodiscard]] static constexpr ShapeId of(CompositeKind kind, std::uint32_t index) noexcept {
    return {static_cast<std::uint32_t>(kind) << kIndexBits | index};
  }
  /// Returns the number of a ShapeKind or a CompositeKind; 15 for the default id.
  [[nodiscard]] constexpr std::uint32_t kind_index() const noexcept { return bits >> kIndexBits; }
  /// True for meshes, compounds and height fields.
  [[nodiscard]] constexpr bool is_composite() const noexcept {
    return kind_index() >= static_cast<std::uint32_t>(CompositeKind::mesh) &&
           kind_index() <= static_cast<std::uint32_t>(CompositeKind::height_field);
  }
  /// Returns the kind of a composite shape; call it only if `is_composite()`.
  [[nodiscard]] constexpr CompositeKind composite_kind() const noexcept {
    return static_cast<CompositeKind>(kind_index());
  }
  /// Returns the kind of a convex shape.
  [[nodiscard]] constexpr ShapeKind kind() const noexcept {
    return static_cast<ShapeKind>(kind_index());
  }
  /// Returns the index among the shapes of the kind.
  [[nodiscard]] constexpr std::uint32_t index() const noexcept {
    return bits & ((1U << kIndexBits) - 1U);
  }
  /// True unless this is the default id, which is of no shape.
  [[nodiscard]] explicit constexpr operator bool() const noexcept { return bits != ~0U; }
  /// True if kind and index are equal.
  friend constexpr bool operator==(const ShapeId&, const ShapeId&) noexcept = default;
};

// Every shape is a closed set, given in its own frame. Except for half-spaces and tapered capsules,
// it contains all points within `rounding` (or `radius`) of its core. Lengths are finite and >= 0.
// An extent may be 0: a box with half.z = 0 is a plate, a triangle may be a segment or a point.

/// Core: the point (0, 0, 0).
struct SphereShape {
  double radius = 0.0;  ///< >= 0; 0 is a point
};

/// Core: the segment of points (0, 0, z) with |z| <= half_length.
struct CapsuleShape {
  double radius = 0.0;       ///< greatest distance from the core
  double half_length = 0.0;  ///< from the centre to the centre of a cap
};

/// Core: |x_i| <= half_i.
struct BoxShape {
  Vec3d half{};           ///< from the centre to the faces, along x, y, z
  double rounding = 0.0;  ///< radius of rounded edges and corners, added outside
};

/// Core: x^2 + y^2 <= radius^2, |z| <= half_length.
struct CylinderShape {
  double radius = 0.0;       ///< of the discs of the core
  double half_length = 0.0;  ///< from the centre to a disc, along z
  double rounding = 0.0;     ///< added outside
};

/// Core: the cone with its apex at z = half_length and a disc of `radius` at z = -half_length.
struct ConeShape {
  double radius = 0.0;       ///< of the disc
  double half_length = 0.0;  ///< half of the height, along z
  double rounding = 0.0;     ///< added outside
};

/// Core: the triangle. Two-sided, without interior.
struct TriangleShape {
  Vec3d vertex[3]{};      ///< corners
  double rounding = 0.0;  ///< greatest distance from the core
};

/// The points with normal . x <= offset, an unbounded set. The normal may be any finite vector
/// except zero; a ShapePool divides both members by the length of the normal.
struct HalfSpaceShape {
  Vec3d normal = {0.0, 0.0, 1.0};  ///< outward; a unit vector in a ShapePool
  double offset = 0.0;             ///< distance of the plane from the origin, times |normal|
};

/// Core: (x / radius[0])^2 + (y / radius[1])^2 + (z / radius[2])^2 <= 1; flat along axes whose
/// radius is 0.
struct EllipsoidShape {
  Vec3d radius{};         ///< semi-axes along x, y, z
  double rounding = 0.0;  ///< added outside
};

/// The convex hull of two balls on the z axis. One ball may contain the other.
struct TaperedCapsuleShape {
  double radius[2] = {0.0, 0.0};  ///< of the balls at z = -half_length and z = half_length
  double half_length = 0.0;       ///< from the centre to the centre of a ball
};

/// Support function: writes a point of a convex set that is farthest along a unit direction. The
/// direction and the point are in the frame of the shape. It must return the same point for the
/// same direction. It may be called from any thread, also concurrently, so it must not change
/// anything; it must not throw or call back into the library object that calls it.
using SupportFunction = void (*)(const void* context, const double direction[3], double point[3]);

/// A user shape: a convex set given by its support function. Core: the set of `function`.
///
/// Error bounds hold if the points are exact to a few rounding errors of `radius` and belong to a
/// convex set. With any other function, calls still end and results are finite: a point that is not
/// finite counts as (0, 0, 0), a point beyond `radius` as the nearest point within it, and if
/// points contradict each other, results refer to some of them.
struct SupportShape {
  SupportFunction function = nullptr;  ///< called as long as the shape exists
  const void* context = nullptr;       ///< passed to `function`, never read; must outlive the shape
  double radius = 0.0;                 ///< greatest distance of a point from (0, 0, 0)
  double rounding = 0.0;               ///< added outside
};

/// A face of a hull; coplanar adjacent faces are merged. normal . x <= offset for every vertex. Its
/// vertices are `loop[first + i]`, counter-clockwise as seen from outside.
struct HullFace {
  Vec3d normal{};       ///< unit, outward
  double offset;        ///< distance of the plane from the origin
  std::uint32_t first;  ///< index in `loop`
  std::uint32_t count;  ///< number of vertices
};

/// An edge of a hull: counter-clockwise around face[0] it runs from vertex[0] to vertex[1], around
/// face[1] in the opposite direction.
struct HullEdge {
  std::uint32_t vertex[2];  ///< indices of its ends
  std::uint32_t face[2];    ///< indices of its faces; ~0U for a segment
};

/// A convex polytope as a ShapePool stores it. By `dimension`: 3 is a solid, 2 a convex polygon
/// with two faces of opposite normals, 1 a segment (two vertices, one edge, no face: edge.face is
/// ~0U), 0 a point. Vertex columns are 64-byte aligned and padded to a multiple of 16 with copies
/// of vertex 0; face columns likewise with face 0.
struct HullShape {
  std::uint32_t vertex_count = 0;  ///< number of vertices
  std::uint32_t face_count = 0;    ///< number of faces after merging
  std::uint32_t edge_count = 0;    ///< number of edges, each counted once
  std::uint32_t dimension = 0;     ///< 0 to 3
  double rounding = 0.0;           ///< added outside
  /// Mean of the vertices; inside the hull.
  Vec3d center{};
  double radius = 0.0;           ///< greatest distance of a vertex from `center`
  double inner_radius = 0.0;     ///< radius of a ball about `center` inside the hull; 0 if flat
  const double* vertex[3] = {};  ///< columns x, y, z
  /// The same columns, rounded to the nearest float.
  const float* vertex_float[3] = {};
  const HullFace* faces = nullptr;  ///< face_count of them
  /// Columns of the faces' normals (x, y, z) and offsets, as floats.
  const float* plane_float[4] = {};
  const HullEdge* edges = nullptr;  ///< edge_count of them
  /// Vertices of all faces, face after face; `loop_edge` has the edge from each to the next vertex.
  const std::uint32_t* loop = nullptr;
  const std::uint32_t* loop_edge = nullptr;  ///< as many entries as `loop`
  /// Vertices adjacent to vertex v: neighbour[neighbour_first[v] .. neighbour_first[v + 1]).
  const std::uint32_t* neighbour_first = nullptr;
  const std::uint32_t* neighbour = nullptr;  ///< vertex indices, two per edge
};

/// Arrays of shapes by kind: shape `id` is table[id.index()]. ShapePool::tables returns the arrays
/// of a pool. To use shapes stored elsewhere, replace a pointer and its count.
struct ShapeTables {
  /// Shapes of one kind, by ShapeId::index; null if there are none.
  /// @{
  const SphereShape* spheres = nullptr;
  const CapsuleShape* capsules = nullptr;
  const BoxShape* boxes = nullptr;
  const CylinderShape* cylinders = nullptr;
  const ConeShape* cones = nullptr;
  const HullShape* hulls = nullptr;
  const TriangleShape* triangles = nullptr;
  const HalfSpaceShape* half_spaces = nullptr;
  const EllipsoidShape* ellipsoids = nullptr;
  const TaperedCapsuleShape* tapered_capsules = nullptr;
  const SupportShape* supports = nullptr;
  /// @}
  std::uint32_t count[kShapeKinds] = {};  ///< entries of each table, by ShapeKind; 0 for others
};

}  // namespace winnow
