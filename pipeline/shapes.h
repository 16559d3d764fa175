#pragma once

// Plain structs on purpose: kernel files read them straight from a ShapePool.

#include <winnow/core/export.h>

#include <cstddef>
#include <cstdint>

namespace winnow {

/// The kinds of convex shape, in the order in which pairs of different kinds are sorted.
enum class ShapeKind : std::uint8_t {
  sphere,
  capsule,
  box,
  cylinder,
  cone,
  hull,
  triangle,
  half_space,
};
inline constexpr std::uint32_t kShapeKinds = 8;

/// The kinds of shape made of many convex ones, held by a CompositePool. Numbered after those of
/// ShapeKind, which their ids share the space with.
enum class CompositeKind : std::uint8_t { mesh = 8, compound, height_field };
inline constexpr std::uint32_t kAllShapeKinds = 11;

/// The enumerator's name. Never null.
[[nodiscard]] WINNOW_API const char* to_string(ShapeKind kind) noexcept;

/// A shape in a ShapePool: its kind and its place among those of the kind.
struct ShapeId {
  static constexpr std::uint32_t kIndexBits = 28;
  std::uint32_t bits = ~0U;

  [[nodiscard]] static constexpr ShapeId of(ShapeKind kind, std::uint32_t index) noexcept {
    return {static_cast<std::uint32_t>(kind) << kIndexBits | index};
  }
  [[nodiscard]] static constexpr ShapeId of(CompositeKind kind, std::uint32_t index) noexcept {
    return {static_cast<std::uint32_t>(kind) << kIndexBits | index};
  }
  /// A ShapeKind below kShapeKinds, a CompositeKind below kAllShapeKinds; 15 for the default id,
  /// which is no shape.
  [[nodiscard]] constexpr std::uint32_t kind_index() const noexcept { return bits >> kIndexBits; }
  [[nodiscard]] constexpr bool is_composite() const noexcept {
    return kind_index() >= kShapeKinds && kind_index() < kAllShapeKinds;
  }
  [[nodiscard]] constexpr CompositeKind composite_kind() const noexcept {
    return static_cast<CompositeKind>(kind_index());
  }
  [[nodiscard]] constexpr ShapeKind kind() const noexcept {
    return static_cast<ShapeKind>(kind_index());
  }
  [[nodiscard]] constexpr std::uint32_t index() const noexcept {
    return bits & ((1U << kIndexBits) - 1U);
  }
  friend constexpr bool operator==(const ShapeId&, const ShapeId&) noexcept = default;
};

// Every shape is closed, stands in its own frame, and is all points within `rounding` (or the
// radius) of its core. Lengths are finite and >= 0; zero extents are legal: a box with half.z = 0
// is a plate, a triangle may be a segment or a point.

struct SphereShape {
  double radius = 0.0;
};

/// Core: the segment of points (0, 0, z) with |z| <= half_length.
struct CapsuleShape {
  double radius = 0.0;
  double half_length = 0.0;
};

/// Core: |x_i| <= half_i.
struct BoxShape {
  double half[3] = {0.0, 0.0, 0.0};
  double rounding = 0.0;
};

/// Core: x^2 + y^2 <= radius^2, |z| <= half_length.
struct CylinderShape {
  double radius = 0.0;
  double half_length = 0.0;
  double rounding = 0.0;
};

/// Core: the cone with its apex at z = half_length and a disc of `radius` at z = -half_length.
struct ConeShape {
  double radius = 0.0;
  double half_length = 0.0;
  double rounding = 0.0;
};

/// Two-sided, without inside.
struct TriangleShape {
  double vertex[3][3] = {};
  double rounding = 0.0;
};

/// normal . x <= offset, reaching to infinity. Any finite normal but zero; a ShapePool divides both
/// by its length.
struct HalfSpaceShape {
  double normal[3] = {0.0, 0.0, 1.0};
  double offset = 0.0;
};

/// A face of a hull, coplanar neighbours merged: unit outward normal, normal . x <= offset for
/// every vertex, and its vertices counter-clockwise seen from outside: `loop[first + i]`.
struct HullFace {
  double normal[3];
  double offset;
  std::uint32_t first;
  std::uint32_t count;
};

/// An edge of a hull: face[0] runs from vertex[0] to vertex[1], face[1] back.
struct HullEdge {
  std::uint32_t vertex[2];
  std::uint32_t face[2];
};

/// A convex polytope as a ShapePool holds it. By `dimension`: 3 a solid, 2 a convex polygon with
/// two faces of opposite normals, 1 a segment (two vertices, one edge, no face: edge.face is ~0U),
/// 0 a point. Vertex columns are 64-byte aligned and padded to a multiple of 16 by copies of vertex
/// 0; face columns likewise by face 0.
struct HullShape {
  std::uint32_t vertex_count = 0;
  std::uint32_t face_count = 0;
  std::uint32_t edge_count = 0;
  std::uint32_t dimension = 0;
  double rounding = 0.0;
  /// Mean of the vertices, inside the hull; all vertices lie within `radius` of it, and a ball of
  /// `inner_radius` about it lies inside (0 if flat).
  double center[3] = {0.0, 0.0, 0.0};
  double radius = 0.0;
  double inner_radius = 0.0;
  const double* vertex[3] = {};
  /// The same, rounded to the nearest float.
  const float* vertex_float[3] = {};
  const HullFace* faces = nullptr;
  /// Normal x, y, z and offset of the faces as float columns.
  const float* plane_float[4] = {};
  const HullEdge* edges = nullptr;
  /// Vertices of all faces one after another, and for each the edge to the next one.
  const std::uint32_t* loop = nullptr;
  const std::uint32_t* loop_edge = nullptr;
  /// Neighbours of vertex v along edges: neighbour[neighbour_first[v] .. neighbour_first[v + 1]).
  const std::uint32_t* neighbour_first = nullptr;
  const std::uint32_t* neighbour = nullptr;
};

/// Where shapes lie, by kind: shape `id` is table[id.index()]. A ShapePool gives those of its own;
/// who asks about shapes that lie elsewhere puts another pointer and count in their place.
struct ShapeTables {
  const SphereShape* spheres = nullptr;
  const CapsuleShape* capsules = nullptr;
  const BoxShape* boxes = nullptr;
  const CylinderShape* cylinders = nullptr;
  const ConeShape* cones = nullptr;
  const HullShape* hulls = nullptr;
  const TriangleShape* triangles = nullptr;
  const HalfSpaceShape* half_spaces = nullptr;
  std::uint32_t count[kShapeKinds] = {};
};

}  // namespace winnow
