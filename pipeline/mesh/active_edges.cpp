#include "pipeline/mesh/edge_bend.h"
#include "pipeline/mesh/mesh_neighbours.h"

#include <cstddef>

namespace winnow {
namespace {

constexpr std::uint32_t kEdgeBits = 7U << kActiveEdgeShift;

void read(const MeshView& mesh, std::size_t slot, std::size_t corner, double (&point)[3]) {
  const std::uint32_t vertex = mesh.corner[corner][slot];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    point[axis] = static_cast<double>(mesh.vertex[axis][vertex]);
  }
}

bool is_active(const MeshView& mesh, const EdgeBend& bend, std::size_t slot, std::size_t edge,
               std::uint32_t neighbour) {
  double u[3];
  double v[3];
  double p[3];
  double q[3];
  read(mesh, slot, edge, u);
  read(mesh, slot, (edge + 1) % 3, v);
  read(mesh, slot, (edge + 2) % 3, p);
  const std::uint32_t other = neighbour & ~kSameWay;
  read(mesh, other >> 2U, ((other & 3U) + 2) % 3, q);
  return bend.is_active(u, v, p, q, (neighbour & kSameWay) == 0);
}

}  // namespace

void mark_active_edges(const MeshView& mesh, const Column<std::uint32_t>& neighbours, double angle,
                       std::uint32_t* triangle) noexcept {
  const EdgeBend bend(angle);
  for (std::size_t slot = 0; slot < mesh.triangle_count; ++slot) triangle[slot] |= kEdgeBits;
  for (std::size_t slot = 0; slot < mesh.triangle_count; ++slot) {
    for (std::size_t edge = 0; edge < 3; ++edge) {
      const std::uint32_t neighbour = neighbours[3 * slot + edge];
      if (neighbour == kNoNeighbour) continue;
      if (neighbour == kCoveredEdge) {
        triangle[slot] &= ~(1U << (kActiveEdgeShift + edge));
        continue;
      }
      // Each pair once: both triangles get the same answer.
      const std::uint32_t other = neighbour & ~kSameWay;
      if (other < 4 * slot + edge || is_active(mesh, bend, slot, edge, neighbour)) continue;
      triangle[slot] &= ~(1U << (kActiveEdgeShift + edge));
      triangle[other >> 2U] &= ~(1U << (kActiveEdgeShift + (other & 3U)));
    }
  }
  // Padding repeats the last slot.
  const std::size_t last = mesh.triangle_count - 1;
  for (std::size_t slot = last + 1; slot % kMeshFanout != 0; ++slot)
    triangle[slot] = triangle[last];
}

}  // namespace winnow
