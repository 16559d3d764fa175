// Edges of a mesh: welds vertices by position, finds the neighbour of each edge by a counting sort,
// and marks active edges. triangle_mesh.cpp calls these functions when a mesh is built or refitted.

#include "pipeline/mesh/mesh_edges.h"

#include "pipeline/mesh/edge_bend.h"

#include <algorithm>
#include <bit>
#include <cstddef>

namespace winnow {
namespace {

constexpr std::uint32_t kEmpty = ~0U;

/// Adding 0 turns -0 into 0, which is the same position.
std::uint32_t bits_of(float x) {
  return std::bit_cast<std::uint32_t>(x + 0.0F);
}

std::size_t hash(const MeshView& mesh, std::uint32_t vertex) {
  std::uint64_t h = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    h = (h ^ bits_of(coordinate(mesh, vertex, axis))) * 0x9E3779B97F4A7C15ULL;
    h ^= h >> 32U;
  }
  return static_cast<std::size_t>(h);
}

bool same_place(const MeshView& mesh, std::uint32_t u, std::uint32_t v) {
  return coordinate(mesh, u, 0) == coordinate(mesh, v, 0) &&
         coordinate(mesh, u, 1) == coordinate(mesh, v, 1) &&
         coordinate(mesh, u, 2) == coordinate(mesh, v, 2);
}

/// Sets place[v] to the lowest vertex number at the position of v. The size of `table` is a power
/// of two.
void weld(const MeshView& mesh, Column<std::uint32_t>& table, Column<std::uint32_t>& place) {
  std::fill(table.begin(), table.end(), kEmpty);
  const std::size_t mask = table.size() - 1;
  for (std::uint32_t v = 0; v < mesh.vertex_count; ++v) {
    std::size_t at = hash(mesh, v) & mask;
    while (table[at] != kEmpty && !same_place(mesh, table[at], v)) at = (at + 1) & mask;
    if (table[at] == kEmpty) table[at] = v;
    place[v] = table[at];
  }
}

/// Sort key of an edge: the higher of the places of its two ends (see `weld`) in the upper half,
/// and these bits in the lower half.
constexpr std::uint32_t kUpward = 1U << 30U;   ///< from the lower place to the higher
constexpr std::uint32_t kSegment = 1U << 31U;  ///< of a triangle with fewer than three places
constexpr std::uint32_t kCode = kUpward - 1U;  ///< 4 * slot + edge

struct CornerPlaces {
  std::uint32_t at[3];

  CornerPlaces(const MeshView& mesh, const Column<std::uint32_t>& place, std::size_t slot) {
    for (std::size_t k = 0; k < 3; ++k) at[k] = place[corner_of(mesh, k, slot)];
  }
  [[nodiscard]] std::uint32_t low(std::size_t edge) const {
    return std::min(at[edge], at[(edge + 1) % 3]);
  }
  [[nodiscard]] bool is_segment() const {
    return at[0] == at[1] || at[1] == at[2] || at[2] == at[0];
  }
  [[nodiscard]] std::uint64_t entry(std::size_t slot, std::size_t edge) const {
    const std::uint32_t from = at[edge];
    const std::uint32_t to = at[(edge + 1) % 3];
    const std::uint32_t code = static_cast<std::uint32_t>(4 * slot + edge) |
                               (from < to ? kUpward : 0U) | (is_segment() ? kSegment : 0U);
    return static_cast<std::uint64_t>(std::max(from, to)) << 32U | code;
  }
};

std::uint32_t& neighbour_of(Column<std::uint32_t>& neighbours, std::uint64_t entry) {
  const auto code = static_cast<std::uint32_t>(entry) & kCode;
  return neighbours[std::size_t{code >> 2U} * 3 + (code & 3U)];
}

/// Links all entries of one edge; entries of segments come last.
void join(const std::uint64_t* begin, const std::uint64_t* end, Column<std::uint32_t>& neighbours) {
  const auto is_segment = [](std::uint64_t entry) { return (entry & kSegment) != 0; };
  const std::uint64_t* segments = std::find_if(begin, end, is_segment);
  if (segments - begin == 2) {
    const auto first = static_cast<std::uint32_t>(begin[0]);
    const auto second = static_cast<std::uint32_t>(begin[1]);
    const std::uint32_t same = ((first ^ second) & kUpward) == 0 ? kSameDirection : 0U;
    neighbour_of(neighbours, begin[0]) = (second & kCode) | same;
    neighbour_of(neighbours, begin[1]) = (first & kCode) | same;
  }
  if (segments == begin) return;
  for (const std::uint64_t* e = segments; e != end; ++e) {
    std::uint32_t* edge = &neighbour_of(neighbours, *e);
    // The edge between corners at one position is covered, too.
    std::fill_n(edge - (*e & 3U), 3, kCoveredEdge);
  }
}

void join_all(std::size_t vertices, const Column<std::uint32_t>& first,
              Column<std::uint64_t>& edges, Column<std::uint32_t>& neighbours) {
  for (std::size_t v = 0; v < vertices; ++v) {
    std::uint64_t* begin = edges.data() + first[v];
    std::uint64_t* const end = edges.data() + first[v + 1];
    // The sort puts the segments of an edge last, because kSegment is the highest bit.
    std::sort(begin, end);
    while (begin != end) {
      std::uint64_t* next = begin;
      while (next != end && *next >> 32U == *begin >> 32U) ++next;
      join(begin, next, neighbours);
      begin = next;
    }
  }
}

}  // namespace

bool find_neighbours(const MeshView& mesh, Column<std::uint32_t>& neighbours) {
  const std::size_t count = mesh.triangle_count;
  std::pmr::memory_resource* memory = neighbours.memory();
  Column<std::uint32_t> place(memory);
  Column<std::uint32_t> first(memory);
  Column<std::uint64_t> edges(memory);
  const std::size_t table_size = std::bit_ceil(std::size_t{2} * mesh.vertex_count);
  if (!neighbours.resize(3 * count) || !place.resize(mesh.vertex_count) ||
      !first.resize(std::max(table_size, std::size_t{mesh.vertex_count} + 2)) ||
      !edges.resize(3 * count)) {
    neighbours.release();
    return false;
  }
  first.set_size(table_size);
  weld(mesh, first, place);
  std::fill(neighbours.begin(), neighbours.end(), kNoNeighbour);

  // Counting sort of edges by their lower place v. At first, first[v + 2] is the number of edges
  // with this place; then first[v + 1] is the index of the next edge to write; at the end it is the
  // end of these edges.
  first.set_size(std::size_t{mesh.vertex_count} + 2);
  std::fill(first.begin(), first.end(), 0U);
  for (std::size_t slot = 0; slot < count; ++slot) {
    const CornerPlaces corners(mesh, place, slot);
    for (std::size_t edge = 0; edge < 3; ++edge) ++first[corners.low(edge) + std::size_t{2}];
  }
  for (std::size_t v = 2; v < first.size(); ++v) first[v] += first[v - 1];
  for (std::size_t slot = 0; slot < count; ++slot) {
    const CornerPlaces corners(mesh, place, slot);
    for (std::size_t edge = 0; edge < 3; ++edge) {
      edges[first[corners.low(edge) + std::size_t{1}]++] = corners.entry(slot, edge);
    }
  }
  join_all(mesh.vertex_count, first, edges, neighbours);
  return true;
}

namespace {

constexpr std::uint32_t kEdgeBits = 7U << kActiveEdgeShift;

void read(const MeshView& mesh, std::size_t slot, std::size_t corner, double (&point)[3]) {
  const std::uint32_t vertex = corner_of(mesh, corner, slot);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    point[axis] = static_cast<double>(coordinate(mesh, vertex, axis));
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
  const std::uint32_t other = neighbour & ~kSameDirection;
  read(mesh, other >> 2U, ((other & 3U) + 2) % 3, q);
  return bend.is_active(u, v, p, q, (neighbour & kSameDirection) == 0);
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
      // Visit each pair once; both triangles get the same result.
      const std::uint32_t other = neighbour & ~kSameDirection;
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
