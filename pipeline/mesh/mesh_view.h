#pragma once

// The data of a TriangleMesh as kernels read it: plain structs and functions that read them.

#include <cstddef>
#include <cstdint>

namespace winnow {

class TriangleMesh;

/// Triangles of a leaf, and children of a node.
inline constexpr std::uint32_t kMeshFanout = 16;
/// Levels of a 16-ary tree over at most 2^28 triangles.
inline constexpr std::uint32_t kMaxMeshLevels = 7;
/// `MeshView::triangle` has flags of active edges in its top bits: bit 28 + k for edge k. The bits
/// below are the caller's triangle number.
inline constexpr std::uint32_t kActiveEdgeShift = 28;
inline constexpr std::uint32_t kMaxTriangles = 1U << kActiveEdgeShift;
inline constexpr std::uint32_t kTriangleNumberMask = kMaxTriangles - 1U;
/// The largest quantised bound of a node.
inline constexpr std::uint32_t kMaxNodeBound = 65535;
/// Bits of a quantised vertex coordinate in the box of its leaf, and its largest value.
inline constexpr std::uint32_t kLeafPointBits = 10;
inline constexpr std::uint32_t kMaxLeafPoint = (1U << kLeafPointBits) - 1U;

/// Constants of a mesh that every ray needs.
struct MeshSpan {
  /// MeshView::origin and step in double, and node units per length: 1 / step.
  double low[3];
  double step[3];
  double units[3];
  /// The box of all nodes, grown by one step on each side.
  double least[3];
  double most[3];
  /// `units`, and `step * pace`, as floats. `float_units` is infinite if the mesh is so thin that
  /// `float_inverse` may be too small for float. The fourth element pads vector loads.
  float float_units[4];
  float float_inverse[4];
  /// The longest side of the box [least, most], and its inverse: tau per unit of t (see ReadyRays).
  double extent;
  double pace;
  /// Product of `units` over the axes.
  double units_volume;
};

/// Frame of a surface (mesh or height field) in the world.
struct SurfaceFrame {
  double position[3];           ///< position of the surface's origin in the world
  double world_to_local[3][3];  ///< columns of the matrix from world vectors to the frame
  bool is_rotated;              ///< false if that matrix is the identity
  double reach;                 ///< upper bound of the surface's coordinates in the frame
  double size;                  ///< upper bound of them in world axes, about the origin
};

/// A hit of a ray on a part of a composite shape.
struct PartHit {
  bool found = false;    ///< false: the other members are not set
  bool has_unit_normal;  ///< false, during the traversal only, if normalising may overflow
  std::uint32_t part;    ///< number of the triangle or child
  double t;              ///< parameter of the caller's ray
  double normal[3];      ///< unit normal of the surface in the world, against the ray
};

/// A triangle mesh as its traversals read it. A slot is a position in the order of the tree: leaf i
/// has slots [16 i, 16 i + 16). Columns indexed by slot are padded to a multiple of 16 with copies
/// of the last slot, levels with empty boxes.
///
/// Corners are in `corner`, or in lists of vertices by leaf (`leaf_vertex`, `leaf_place`) unless
/// most leaves have more than sixteen vertices. If a mesh has more vertices than triangles, few
/// triangles share a vertex, and each slot has a box (`box`). Otherwise rays test the quantised
/// vertices of such lists (`leaf_point`), or the corners if the mesh has none.
struct MeshView {
  /// x, y and z of each vertex, vertex by vertex, plus one extra float, because vertices may be
  /// read four floats at a time.
  const float* vertex = nullptr;
  std::uint32_t vertex_count = 0;
  /// Vertex numbers of the corners, by slot; null if leaves list their vertices.
  const std::uint32_t* corner[3] = {};
  /// The distinct vertices of leaf i begin at 16 i. If the leaf has more than sixteen, the
  /// remaining vertices are from 16 (leaves + leaf_more[i]) to 16 (leaves + leaf_more[i + 1]);
  /// `leaf_more` is null if no leaf has more. Each block of sixteen is padded with its last vertex.
  const std::uint32_t* leaf_vertex = nullptr;
  const std::uint32_t* leaf_more = nullptr;
  /// Quantised position of each listed vertex in the box of its leaf: 0 at the lower bounds of the
  /// node, kMaxLeafPoint at the upper ones, rounded to nearest; x in the lowest bits. Null if
  /// triangles have boxes.
  const std::uint32_t* leaf_point = nullptr;
  /// At 48 i + 16 k + l: the index, in the vertex list of leaf i, of corner k of slot 16 i + l.
  const std::uint8_t* leaf_place = nullptr;
  /// The caller's triangle number in the low 28 bits, and the active edges.
  const std::uint32_t* triangle = nullptr;
  std::uint32_t triangle_count = 0;
  /// A quantised bound q is decoded as origin + q * step in double. Lower bounds are rounded down
  /// and upper bounds up, so that a box contains its content.
  float origin[3] = {};
  float step[3] = {};
  MeshSpan span = {};
  /// Node i of level 0 bounds leaf i, node i of level l + 1 bounds nodes [16 i, 16 i + 16) of level
  /// l. The top level has at most 16 nodes. Each block of sixteen nodes stores six columns, lower
  /// bounds before upper bounds.
  std::uint32_t levels = 0;
  std::uint32_t count[kMaxMeshLevels] = {};
  const std::uint16_t* node[kMaxMeshLevels] = {};
  /// Boxes of all slots in the same layout; null if triangles have no boxes.
  const std::uint16_t* box = nullptr;
};

/// Returns the index of bound `bound` of a node in its level. In a block of nodes, equal bounds of
/// consecutive nodes are consecutive.
[[nodiscard]] constexpr std::size_t place_of_bound(std::uint32_t node, std::size_t bound) {
  return std::size_t{6} * (node / kMeshFanout * kMeshFanout) + bound * kMeshFanout +
         node % kMeshFanout;
}

[[nodiscard]] inline std::uint16_t bound_of(const MeshView& mesh, std::uint32_t level,
                                            std::uint32_t node, std::size_t bound) {
  return mesh.node[level][place_of_bound(node, bound)];
}

/// The list indices of corners k of a leaf.
[[nodiscard, gnu::always_inline]] inline const std::uint8_t* places_of(const MeshView& mesh,
                                                                       std::size_t leaf,
                                                                       std::size_t k) {
  return mesh.leaf_place + kMeshFanout * (3 * leaf + k);
}

/// The vertex number of corner k of a slot.
[[nodiscard, gnu::always_inline]] inline std::uint32_t corner_of(const MeshView& mesh,
                                                                 std::size_t k, std::size_t slot) {
  if (mesh.corner[0] != nullptr) return mesh.corner[k][slot];
  const std::size_t leaf = slot / kMeshFanout;
  const std::size_t place = places_of(mesh, leaf, k)[slot % kMeshFanout];
  if (place < kMeshFanout) return mesh.leaf_vertex[leaf * kMeshFanout + place];
  const std::size_t block = std::size_t{mesh.count[0]} + mesh.leaf_more[leaf];
  return mesh.leaf_vertex[(block - 1) * kMeshFanout + place];
}

[[nodiscard]] inline float coordinate(const MeshView& mesh, std::uint32_t vertex,
                                      std::size_t axis) {
  return mesh.vertex[std::size_t{3} * vertex + axis];
}

/// Reads the corners of the triangle of a slot.
inline void put_corners(const MeshView& mesh, std::size_t slot, double (&corner)[3][3]) {
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t number = corner_of(mesh, k, slot);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      corner[k][axis] = static_cast<double>(coordinate(mesh, number, axis));
    }
  }
}

/// The view of a mesh; it has no triangles if nothing is built.
[[nodiscard]] const MeshView& view_of(const TriangleMesh& mesh) noexcept;

/// x -> matrix x + offset: from the frame of one mesh to the frame of another, scales included.
struct MeshPlacement {
  double matrix[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  double offset[3] = {0, 0, 0};
};

/// Receives the slots that a traversal finds. `size` continues to count when `slot` is full; the
/// caller then enlarges `slot` to `size` and repeats the call.
struct SlotSink {
  std::uint32_t* slot = nullptr;
  std::uint64_t capacity = 0;
  std::uint64_t size = 0;
};

inline void put_slot(SlotSink& out, std::uint32_t slot) {
  if (out.size < out.capacity) out.slot[out.size] = slot;
  ++out.size;
}

/// Receives the pairs of slots that a traversal finds, like SlotSink. If `take` is set, one
/// traversal can find any number of pairs: it calls `take` if fewer than 16 places are free, and
/// `take` processes the pairs and sets `size` to 0. The capacity must then be at least 16, and the
/// caller processes the pairs left at the end. If `is_done` is set, the traversal ends after the
/// current pair of nodes.
struct SlotPairSink {
  std::uint32_t* first = nullptr;
  std::uint32_t* second = nullptr;
  std::uint64_t capacity = 0;
  std::uint64_t size = 0;
  void (*take)(void* context, SlotPairSink& sink) = nullptr;
  void* context = nullptr;
  bool is_done = false;
};

/// Receives pairs of slots, roughly nearest first; `visit` returns the new limit.
struct SlotPairVisitor {
  double (*visit)(void* context, std::uint32_t a, std::uint32_t b, double limit) = nullptr;
  void* context = nullptr;
  /// Unit vector in the frame of a, from a to b, that separates the nearest pair found up to now;
  /// zero if there is none. Read again after each visit.
  const float* direction = nullptr;
  /// If true, the visitor ignores some pairs. The distance of two corners is then no upper bound on
  /// the limit.
  bool leaves_out = false;
};

/// Receives the slots found by an ordered traversal, up to 16 at a time; `visit` returns the new
/// limit.
struct SlotVisitor {
  double (*visit)(void* context, const std::uint32_t* slots, std::uint32_t count,
                  double limit) = nullptr;
  void* context = nullptr;
};

}  // namespace winnow
