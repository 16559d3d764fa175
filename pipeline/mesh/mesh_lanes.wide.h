#pragma once

// Loads of sixteen nodes or sixteen triangles of a mesh into SIMD lanes, for the traversals of this
// folder.

#include "pipeline/mesh/mesh_view.h"
#include "simd/lanes/boxes.h"
#include "simd/lanes/compress.h"
#include "simd/lanes/permute.h"
#include "simd/lanes/rows.h"

namespace winnow::WINNOW_ISA_NAME::mesh {

/// The lanes among [first, first + 16) that are below `count`.
inline Mask16 present(std::uint32_t count, std::uint32_t first_lane) {
  const std::uint32_t rest = count - first_lane;
  return lanes_below(rest < kLanes ? rest : kLanes);
}

/// Nodes [first_node, first_node + 16) of a level, in node units. The caller masks the lanes beyond
/// the level's count.
[[gnu::always_inline]] inline Box16 load_nodes(const MeshView& mesh, std::uint32_t level,
                                               std::uint32_t first_node) {
  const std::uint16_t* const bounds = mesh.node[level] + std::size_t{6} * first_node;
  Box16 box;
  for (int axis = 0; axis < 3; ++axis) {
    box.low[axis] = load_short(bounds + axis * kLanes);
    box.high[axis] = load_short(bounds + (3 + axis) * kLanes);
  }
  return box;
}

/// Loads into lane l the point of three floats at base + 3 * index[l]. Reads one float beyond each
/// point.
[[gnu::always_inline]] inline void load_points(const float* base, const std::uint32_t* index,
                                               Floats (&point)[3]) {
#if defined(WINNOW_ISA_IS_neon64)
  alignas(64) float stage[3][kLanes];
  for (int lane = 0; lane < kLanes; ++lane) {
    for (int k = 0; k < 3; ++k) stage[k][lane] = base[std::size_t{3} * index[lane] + k];
  }
  for (int k = 0; k < 3; ++k) point[k] = Floats::load(stage[k]);
#else
  const auto at = [&](int lane) { return base + std::size_t{3} * index[lane]; };
  for (int part = 0; part < Floats::kParts; ++part) {
    const BoxQuads quads(at, part * Floats::kPartLanes, 0);
    point[0].part[part] = BoxQuads::even(quads.low01, quads.low23);
    point[1].part[part] = BoxQuads::odd(quads.low01, quads.low23);
    point[2].part[part] = BoxQuads::even(quads.high01, quads.high23);
  }
#endif
}

/// The corners of the triangles of a leaf, by corner and axis.
struct Corners16 {
  Floats at[3][3];
};

/// Returns the number of blocks of sixteen that contain the vertex list of a leaf, 1 or 2. Returns
/// 0 if leaves have no lists or the list is longer.
[[gnu::always_inline]] inline int vertex_blocks(const MeshView& mesh, std::uint32_t leaf) {
  if (mesh.corner[0] != nullptr) return 0;
  const std::uint8_t* const places = places_of(mesh, leaf, 0);
  if (are_below<kLanes>(places)) return 1;
  return are_below<2 * kLanes>(places) ? 2 : 0;
}

/// Index of a block of a leaf's vertex list.
[[gnu::always_inline]] inline std::size_t block_of(const MeshView& mesh, std::uint32_t leaf,
                                                   int block) {
  return block == 0 ? leaf : std::size_t{mesh.count[0]} + mesh.leaf_more[leaf];
}

/// Calls visit(block, its vertices) for each block.
template <int Blocks, typename Visit>
[[gnu::always_inline]] inline void each_vertex_block(const MeshView& mesh, std::uint32_t leaf,
                                                     Visit&& visit) {
  for (int block = 0; block < Blocks; ++block) {
    Floats vertex[3];
    load_points(mesh.vertex, mesh.leaf_vertex + block_of(mesh, leaf, block) * kMeshFanout, vertex);
    visit(block, vertex);
  }
}

/// Gathers corners k of a leaf, each from its own vertex.
[[gnu::always_inline]] inline void load_corners(const MeshView& mesh, std::uint32_t leaf,
                                                std::size_t k, Floats (&corner)[3]) {
  const std::size_t first_slot = std::size_t{leaf} * kMeshFanout;
  if (mesh.corner[0] != nullptr)
    return load_points(mesh.vertex, mesh.corner[k] + first_slot, corner);
  std::uint32_t number[kLanes];
  for (std::size_t lane = 0; lane < kMeshFanout; ++lane) {
    number[lane] = corner_of(mesh, k, first_slot + lane);
  }
  load_points(mesh.vertex, number, corner);
}

template <int Blocks>
[[gnu::always_inline]] inline Corners16 pick_corners(const MeshView& mesh, std::uint32_t leaf) {
  Floats at[3][Blocks];
  each_vertex_block<Blocks>(mesh, leaf, [&](int block, const Floats(&vertex)[3]) {
    for (int axis = 0; axis < 3; ++axis) at[axis][block] = vertex[axis];
  });
  Corners16 corners;
  for (std::size_t k = 0; k < 3; ++k) {
    const LanePermutation places(places_of(mesh, leaf, k));
    for (int axis = 0; axis < 3; ++axis) corners.at[k][axis] = places.pick(at[axis]);
  }
  return corners;
}

[[gnu::always_inline]] inline Corners16 load_corners(const MeshView& mesh, std::uint32_t leaf) {
  const int blocks = vertex_blocks(mesh, leaf);
  if (blocks == 1) return pick_corners<1>(mesh, leaf);
  if (blocks == 2) return pick_corners<2>(mesh, leaf);
  Corners16 corners;
  for (std::size_t k = 0; k < 3; ++k) load_corners(mesh, leaf, k, corners.at[k]);
  return corners;
}

[[gnu::always_inline]] inline Box16 box_of(const Corners16& corners) {
  Box16 box;
  for (int axis = 0; axis < 3; ++axis) {
    const Floats& a = corners.at[0][axis];
    const Floats& b = corners.at[1][axis];
    const Floats& c = corners.at[2][axis];
    box.low[axis] = min(min(a, b), c);
    box.high[axis] = max(max(a, b), c);
  }
  return box;
}

/// Writes the slots of the set lanes; if there is no room, only counts them.
inline void put_slots(const Uints& slots, Mask16 hits, SlotSink& out) {
  if (out.size + kLanes <= out.capacity) {
    out.size += compress_store(hits, slots, out.slot + out.size);
    return;
  }
  alignas(64) std::uint32_t lane[kLanes];
  slots.store_unaligned(lane);
  for (; hits != 0; hits &= hits - 1, ++out.size) {
    if (out.size < out.capacity) out.slot[out.size] = lane[first(hits)];
  }
}

/// Eight of sixteen boxes, in double.
struct Box8 {
  Doubles low[3];
  Doubles high[3];
};

template <int Half>
[[gnu::always_inline]] inline Box8 in_double(const Box16& box) {
  Box8 r;
  for (int axis = 0; axis < 3; ++axis) {
    r.low[axis] = to_double<Half>(box.low[axis]);
    r.high[axis] = to_double<Half>(box.high[axis]);
  }
  return r;
}

/// Converts boxes from node units to the mesh's frame.
[[gnu::always_inline]] inline void decode(const MeshView& mesh, Box8& box) {
  for (int axis = 0; axis < 3; ++axis) {
    const Doubles origin(static_cast<double>(mesh.origin[axis]));
    const Doubles step(static_cast<double>(mesh.step[axis]));
    box.low[axis] = origin + box.low[axis] * step;
    box.high[axis] = origin + box.high[axis] * step;
  }
}

}  // namespace winnow::WINNOW_ISA_NAME::mesh
