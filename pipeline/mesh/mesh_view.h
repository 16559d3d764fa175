#pragma once

// Plain structs: kernel files include this.

#include <cstddef>
#include <cstdint>

namespace winnow {

class TriangleMesh;

/// Triangles of a leaf, and children of a node.
inline constexpr std::uint32_t kMeshFanout = 16;
/// Levels of a 16-ary tree over at most 2^28 triangles.
inline constexpr std::uint32_t kMaxMeshLevels = 7;
/// Where `MeshView::triangle` keeps which edges are active: bit 28 + k for edge k. Below are the
/// caller's numbers of triangles.
inline constexpr std::uint32_t kActiveEdgeShift = 28;
inline constexpr std::uint32_t kMaxTriangles = 1U << kActiveEdgeShift;
inline constexpr std::uint32_t kTriangleNumberMask = kMaxTriangles - 1U;
/// The largest bound of a node.
inline constexpr std::uint32_t kMaxNodeBound = 65535;
/// The largest coordinate of a vertex in the box of its leaf, of which each takes so many bits.
inline constexpr std::uint32_t kLeafPointBits = 10;
inline constexpr std::uint32_t kMaxLeafPoint = (1U << kLeafPointBits) - 1U;

/// What every ray needs of a mesh.
struct MeshSpan {
  double low[3];
  double step[3];
  double units[3];
  /// Of the box of all nodes, with a step to spare on each side.
  double least[3];
  double most[3];
  /// Units, and steps times the pace, once more: infinite units where the mesh is so thin that
  /// these may be too small for float. The last of four is for loads of them all.
  float float_units[4];
  float float_inverse[4];
  /// The longest side of that box, and tau for each t.
  double extent;
  double pace;
  /// Of units on all axes.
  double units_volume;
};

/// A triangle mesh as its traversals read it. A slot is a place in the order of the tree: leaf i
/// holds slots [16 i, 16 i + 16). Columns of slots are padded to a multiple of 16 by copies of the
/// last one, levels by empty boxes.
struct MeshView {
  /// x, y and z of every vertex, one vertex after another, and one number more: vertices may be
  /// read four numbers at a time.
  const float* vertex = nullptr;
  std::uint32_t vertex_count = 0;
  /// Numbers of the corners, by slot; null where leaves list their vertices.
  const std::uint32_t* corner[3] = {};
  /// The vertices of leaf i, each once, from 16 i on; if there are more than sixteen, the others
  /// from 16 (leaves + leaf_more[i]) to 16 (leaves + leaf_more[i + 1]); null if no leaf has. Each
  /// sixteen are filled up by the last.
  const std::uint32_t* leaf_vertex = nullptr;
  const std::uint32_t* leaf_more = nullptr;
  /// Where each of them is in the box of its leaf, as nodes have it: at 0 on its lower bounds, at
  /// kMaxLeafPoint on its upper ones, rounded to the nearest; x in the lowest bits. Null where
  /// triangles have boxes.
  const std::uint32_t* leaf_point = nullptr;
  /// Which of them corner k of slot 16 i + l is, at 48 i + 16 k + l.
  const std::uint8_t* leaf_place = nullptr;
  /// The caller's number of the triangle in the low 28 bits, and its active edges.
  const std::uint32_t* triangle = nullptr;
  std::uint32_t triangle_count = 0;
  /// A quantised bound q stands for origin + q * step in double arithmetic; lower bounds are
  /// rounded down and upper ones up, so that the box contains what is below it.
  float origin[3] = {};
  float step[3] = {};
  MeshSpan span = {};
  /// Node i of level 0 bounds leaf i, node i of level l + 1 nodes [16 i, 16 i + 16) of level l. The
  /// top level has at most 16 nodes. Six columns of sixteen nodes, lower bounds before upper ones,
  /// lie behind each other, then those of the next sixteen.
  std::uint32_t levels = 0;
  std::uint32_t count[kMaxMeshLevels] = {};
  const std::uint16_t* node[kMaxMeshLevels] = {};
  /// The same of every slot, in the place of nodes; null where triangles have no boxes.
  const std::uint16_t* box = nullptr;
};

/// Where column `bound` of a node lies in its level; of the first of sixteen those of the others
/// follow.
[[nodiscard]] constexpr std::size_t place_of_bound(std::uint32_t node, std::size_t bound) {
  return std::size_t{6} * (node / kMeshFanout * kMeshFanout) + bound * kMeshFanout +
         node % kMeshFanout;
}

[[nodiscard]] inline std::uint16_t bound_of(const MeshView& mesh, std::uint32_t level,
                                            std::uint32_t node, std::size_t bound) {
  return mesh.node[level][place_of_bound(node, bound)];
}

/// The places of the corners k of a leaf.
[[nodiscard, gnu::always_inline]] inline const std::uint8_t* places_of(const MeshView& mesh,
                                                                       std::size_t leaf,
                                                                       std::size_t k) {
  return mesh.leaf_place + kMeshFanout * (3 * leaf + k);
}

/// The number of corner k of a slot.
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

/// The corners of the triangle of a slot.
inline void put_corners(const MeshView& mesh, std::size_t slot, double (&corner)[3][3]) {
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t number = corner_of(mesh, k, slot);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      corner[k][axis] = static_cast<double>(coordinate(mesh, number, axis));
    }
  }
}

/// That of a mesh with nothing built has no triangles.
[[nodiscard]] const MeshView& view_of(const TriangleMesh& mesh) noexcept;

/// x -> matrix x + offset: from the frame of one mesh to that of another, scales included.
struct MeshPlacement {
  double matrix[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  double offset[3] = {0, 0, 0};
};

/// Where a traversal writes the slots that it finds. `size` counts on where there is no room: make
/// room for that many and ask again.
struct SlotSink {
  std::uint32_t* slot = nullptr;
  std::uint64_t capacity = 0;
  std::uint64_t size = 0;
};

inline void put_slot(SlotSink& out, std::uint32_t slot) {
  if (out.size < out.capacity) out.slot[out.size] = slot;
  ++out.size;
}

/// The same for pairs of slots; or, with `take`, for any number of them in one traversal: it is
/// called where there is no room for 16 more, uses up what is there and sets size to 0. The
/// capacity is 16 at least then, and what is left when it ends is for the caller to use up. Once
/// `is_done` is set the traversal ends soon.
struct SlotPairSink {
  std::uint32_t* first = nullptr;
  std::uint32_t* second = nullptr;
  std::uint64_t capacity = 0;
  std::uint64_t size = 0;
  void (*take)(void* context, SlotPairSink& sink) = nullptr;
  void* context = nullptr;
  bool is_done = false;
};

/// Is shown pairs of slots, roughly the nearest first; gives back the new limit.
struct SlotPairVisitor {
  double (*visit)(void* context, std::uint32_t a, std::uint32_t b, double limit) = nullptr;
  void* context = nullptr;
  /// The direction, a unit vector in the frame of a, from a to b along which the nearest pair so
  /// far is apart; zero if there is none. Read again after each visit.
  const float* direction = nullptr;
  /// Whether some pairs do not count, so that the corners of any two say nothing of the limit.
  bool leaves_out = false;
};

/// Is shown the slots that a traversal in order finds, 16 or fewer at a time; gives back the new
/// limit.
struct SlotVisitor {
  double (*visit)(void* context, const std::uint32_t* slots, std::uint32_t count,
                  double limit) = nullptr;
  void* context = nullptr;
};

}  // namespace winnow
