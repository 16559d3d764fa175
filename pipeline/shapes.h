#pragma once

// Plain structs on purpose: kernel files read them straight from a ShapePool.

#include <winnow/core/export.h>

#include <cstddef>
#include <cstdint>

namespace winnow {

/// The kinds of convex shape, in the order in which pairs of different kinds are sorted.
enum class ShapeKind : std::uint8_t {
  sphere,      ///< SphereShape
  capsule,     ///< CapsuleShape
  box,         ///< BoxShape
  cylinder,    ///< CylinderShape
  cone,        ///< ConeShape
  hull,        ///< HullShape
  triangle,    ///< TriangleShape
  half_space,  ///< HalfSpaceShape
  // Numbers between are those of CompositeKind.
  ellipsoid = 11,   ///< EllipsoidShape
  tapered_capsule,  ///< TaperedCapsuleShape
  support,          ///< SupportShape
};

/// The kinds of shape made of many convex ones, held by a CompositePool. No number is one of
/// ShapeKind, which their ids share the space with.
enum class CompositeKind : std::uint8_t {
  mesh = 8,      ///< TriangleMesh
  compound,      ///< CompoundChild, several
  height_field,  ///< HeightField
};

/// The numbers of all kinds, convex and composite, are below this.
inline constexpr std::uint32_t kShapeKinds = 14;

/// All of ShapeKind, in their order.
inline constexpr ShapeKind kConvexKinds[] = {
    ShapeKind::sphere,          ShapeKind::capsule,    ShapeKind::box,
    ShapeKind::cylinder,        ShapeKind::cone,       ShapeKind::hull,
    ShapeKind::triangle,        ShapeKind::half_space, ShapeKind::ellipsoid,
    ShapeKind::tapered_capsule, ShapeKind::support};

/// The enumerator's name. Never null.
[[nodiscard]] WINNOW_API const char* to_string(ShapeKind kind) noexcept;

/// A shape in a ShapePool: its kind and its place among those of the kind.
struct ShapeId {
  /// The upper bits of an id are its kind, so many lower ones its place.
  static constexpr std::uint32_t kIndexBits = 28;
  std::uint32_t bits = ~0U;  ///< kind << kIndexBits | index; the default is no shape

  /// The id of a convex shape; `index` is below 2^28.
  [[nodiscard]] static constexpr ShapeId of(ShapeKind kind, std::uint32_t index) noexcept {
    return {static_cast<std::uint32_t>(kind) << kIndexBits | index};
  }
  /// The id of a composite shape; `index` is below 2^28.
  [[nodiscard]] static constexpr ShapeId of(CompositeKind kind, std::uint32_t index) noexcept {
    return {static_cast<std::uint32_t>(kind) << kIndexBits | index};
  }
  /// A ShapeKind or a CompositeKind; 15 for the default id, which is no shape.
  [[nodiscard]] constexpr std::uint32_t kind_index() const noexcept { return bits >> kIndexBits; }
  /// True for ids of meshes, compounds and height fields.
  [[nodiscard]] constexpr bool is_composite() const noexcept {
    return kind_index() >= static_cast<std::uint32_t>(CompositeKind::mesh) &&
           kind_index() <= static_cast<std::uint32_t>(CompositeKind::height_field);
  }
  /// Of an id for which `is_composite` holds.
  [[nodiscard]] constexpr CompositeKind composite_kind() const noexcept {
    return static_cast<CompositeKind>(kind_index());
  }
  /// Of an id of a convex shape.
  [[nodiscard]] constexpr ShapeKind kind() const noexcept {
    return static_cast<ShapeKind>(kind_index());
  }
  /// Place among the shapes of its kind.
  [[nodiscard]] constexpr std::uint32_t index() const noexcept {
    return bits & ((1U << kIndexBits) - 1U);
  }
  /// Same kind, same place.
  friend constexpr bool operator==(const ShapeId&, const ShapeId&) noexcept = default;
};

// Every shape is closed, stands in its own frame, and is all points within `rounding` (or the
// radius) of its core. Lengths are finite and >= 0; zero extents are legal: a box with half.z = 0
// is a plate, a triangle may be a segment or a point.

/// Core: the point (0, 0, 0).
struct SphereShape {
  double radius = 0.0;  ///< >= 0; 0 is a point
};

/// Core: the segment of points (0, 0, z) with |z| <= half_length.
struct CapsuleShape {
  double radius = 0.0;       ///< distance from the segment
  double half_length = 0.0;  ///< from the middle to the centre of a cap
};

/// Core: |x_i| <= half_i.
struct BoxShape {
  double half[3] = {0.0, 0.0, 0.0};  ///< extent from the centre along x, y, z
  double rounding = 0.0;             ///< by which edges and corners are rounded, added outside
};

/// Core: x^2 + y^2 <= radius^2, |z| <= half_length.
struct CylinderShape {
  double radius = 0.0;       ///< of the core's discs
  double half_length = 0.0;  ///< from the middle to a disc, along z
  double rounding = 0.0;     ///< added outside
};

/// Core: the cone with its apex at z = half_length and a disc of `radius` at z = -half_length.
struct ConeShape {
  double radius = 0.0;       ///< of the disc
  double half_length = 0.0;  ///< half of the height, along z
  double rounding = 0.0;     ///< added outside
};

/// Two-sided, without inside.
struct TriangleShape {
  double vertex[3][3] = {};  ///< [corner][axis]
  double rounding = 0.0;     ///< distance from the triangle up to which points belong to it
};

/// normal . x <= offset, reaching to infinity. Any finite normal but zero; a ShapePool divides both
/// by its length.
struct HalfSpaceShape {
  double normal[3] = {0.0, 0.0, 1.0};  ///< outward; unit once it is in a ShapePool
  double offset = 0.0;                 ///< distance of its plane from the origin, times |normal|
};

/// Core: (x / radius[0])^2 + (y / radius[1])^2 + (z / radius[2])^2 <= 1; flat along axes with a
/// radius of 0.
struct EllipsoidShape {
  double radius[3] = {0.0, 0.0, 0.0};  ///< half of its length along x, y, z
  double rounding = 0.0;               ///< added outside
};

/// The convex hull of two balls on the z axis. One may lie within the other.
struct TaperedCapsuleShape {
  double radius[2] = {0.0, 0.0};  ///< of the balls at z = -half_length and z = half_length
  double half_length = 0.0;       ///< from the middle to the centre of a ball
};

/// Gives a point of a convex set that is farthest along a direction of length 1, both in the frame
/// of the shape. The same direction gets the same point, whoever asks: it is called from any
/// thread, also at once, and changes nothing. It must not throw, nor call what asks it.
using SupportFunction = void (*)(const void* context, const double direction[3], double point[3]);

/// A convex set of the program's own. Core: the points that `function` speaks of.
///
/// Bounds of errors hold as far as its points are exact to a few roundings of `radius`, and of a
/// convex set. Whatever else it answers, calls end and results are finite: a point that is not
/// finite counts as (0, 0, 0), one beyond `radius` as the nearest within, and where points
/// contradict each other, answers are about some of them.
struct SupportShape {
  SupportFunction function = nullptr;  ///< asked as long as the shape is there
  const void* context = nullptr;       ///< passed on, never read; outlives the shape
  double radius = 0.0;                 ///< no point is farther from (0, 0, 0)
  double rounding = 0.0;               ///< added outside
};

/// A face of a hull, coplanar neighbours merged: unit outward normal, normal . x <= offset for
/// every vertex, and its vertices counter-clockwise seen from outside: `loop[first + i]`.
struct HullFace {
  double normal[3];     ///< unit, outward
  double offset;        ///< distance of the plane from the origin, along the normal
  std::uint32_t first;  ///< place in `loop`
  std::uint32_t count;  ///< corners
};

/// An edge of a hull: face[0] runs from vertex[0] to vertex[1], face[1] back.
struct HullEdge {
  std::uint32_t vertex[2];  ///< numbers of its ends
  std::uint32_t face[2];    ///< ~0U of a segment
};

/// A convex polytope as a ShapePool holds it. By `dimension`: 3 a solid, 2 a convex polygon with
/// two faces of opposite normals, 1 a segment (two vertices, one edge, no face: edge.face is ~0U),
/// 0 a point. Vertex columns are 64-byte aligned and padded to a multiple of 16 by copies of vertex
/// 0; face columns likewise by face 0.
struct HullShape {
  std::uint32_t vertex_count = 0;  ///< of the polytope
  std::uint32_t face_count = 0;    ///< after merging
  std::uint32_t edge_count = 0;    ///< each counted once
  std::uint32_t dimension = 0;     ///< 0 to 3
  double rounding = 0.0;           ///< added outside of the polytope
  /// Mean of the vertices, inside the hull.
  double center[3] = {0.0, 0.0, 0.0};
  double radius = 0.0;           ///< greatest distance of a vertex from `center`
  double inner_radius = 0.0;     ///< of a ball about `center` that lies inside; 0 if flat
  const double* vertex[3] = {};  ///< columns x, y, z
  /// The same, rounded to the nearest float.
  const float* vertex_float[3] = {};
  const HullFace* faces = nullptr;  ///< face_count of them
  /// Normal x, y, z and offset of the faces as float columns.
  const float* plane_float[4] = {};
  const HullEdge* edges = nullptr;  ///< edge_count of them
  /// Vertices of all faces one after another, and for each the edge to the next one.
  const std::uint32_t* loop = nullptr;
  const std::uint32_t* loop_edge = nullptr;  ///< as many as `loop`
  /// Neighbours of vertex v along edges: neighbour[neighbour_first[v] .. neighbour_first[v + 1]).
  const std::uint32_t* neighbour_first = nullptr;
  const std::uint32_t* neighbour = nullptr;  ///< numbers of vertices, two for each edge
};

/// Where shapes lie, by kind: shape `id` is table[id.index()]. A ShapePool gives those of its own;
/// who asks about shapes that lie elsewhere puts another pointer and count in their place.
struct ShapeTables {
  /// Shapes of one kind, by ShapeId::index; null where there are none.
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
  std::uint32_t count[kShapeKinds] = {};  ///< entries of each table, by ShapeKind; else 0
};

}  // namespace winnow
