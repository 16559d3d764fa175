#include "pipeline/solver/core.h"

#include <algorithm>

namespace winnow::solver {
namespace {

Vec hull_point(const Core& core, std::uint32_t i) noexcept {
  const Vec local(core.hull->vertex[0][i], core.hull->vertex[1][i], core.hull->vertex[2][i]);
  return core.rotation * (local * core.unit[0] * core.unit[1]);
}

/// The corners of a box's faces, counter-clockwise seen from outside; bit i of a corner's number
/// is set on the positive side of axis i. Face 2 i + 1 is the positive one of axis i.
constexpr std::uint32_t kBoxFace[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                          {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};

/// Edge 4 i + k runs along axis i.
constexpr std::array<std::uint32_t, 2> kBoxEdge[12] = {
    {0, 1}, {2, 3}, {4, 5}, {6, 7}, {0, 2}, {1, 3}, {4, 6}, {5, 7}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};

std::uint32_t box_edge_of(std::uint32_t p, std::uint32_t q) noexcept {
  for (std::uint32_t e = 0; e < 12; ++e) {
    if (kBoxEdge[e][0] == std::min(p, q) && kBoxEdge[e][1] == std::max(p, q)) return e;
  }
  return 0;
}

Vec triangle_normal(const Core& core) noexcept {
  // From the longest edge, which is the one known best, and the shortest.
  std::array<double, 3> length{};
  for (std::size_t i = 0; i < 3; ++i) {
    length[i] = (core.corner[(i + 1) % 3] - core.corner[i]).squaredNorm();
  }
  const auto longest =
      static_cast<std::size_t>(std::max_element(length.begin(), length.end()) - length.begin());
  const std::size_t next = (longest + 1) % 3;
  const std::size_t last = (longest + 2) % 3;
  const bool next_is_shorter = length[next] < length[last];
  return perpendicular(core.side[longest],
                       next_is_shorter ? core.side[next] : Vec(-core.side[last]));
}

}  // namespace

std::uint32_t vertex_count(const Core& core) noexcept {
  switch (core.kind) {
    case CoreKind::segment:
      return 2;
    case CoreKind::triangle:
      return 3;
    case CoreKind::box:
      return 8;
    case CoreKind::hull:
      return core.hull->vertex_count;
    default:
      return 1;
  }
}

Vec vertex(const Core& core, std::uint32_t i) noexcept {
  const Vec& h = core.half;
  switch (core.kind) {
    case CoreKind::segment:
      return core.center + core.rotation.col(2) * (i == 0 ? -h.z() : h.z());
    case CoreKind::triangle:
      return core.center + core.corner[i];
    case CoreKind::box:
      return core.center + core.rotation * Vec((i & 1U) != 0 ? h.x() : -h.x(),
                                               (i & 2U) != 0 ? h.y() : -h.y(),
                                               (i & 4U) != 0 ? h.z() : -h.z());
    case CoreKind::hull:
      return core.center + hull_point(core, i);
    default:
      return core.center;
  }
}

std::uint32_t edge_count(const Core& core) noexcept {
  switch (core.kind) {
    case CoreKind::segment:
      return 1;
    case CoreKind::triangle:
      return 3;
    case CoreKind::box:
      return 12;
    case CoreKind::hull:
      return core.hull->edge_count;
    default:
      return 0;
  }
}

std::array<std::uint32_t, 2> edge(const Core& core, std::uint32_t i) noexcept {
  switch (core.kind) {
    case CoreKind::triangle:
      return {i, i == 2 ? 0U : i + 1};
    case CoreKind::box:
      return kBoxEdge[i];
    case CoreKind::hull:
      return {core.hull->edges[i].vertex[0], core.hull->edges[i].vertex[1]};
    default:
      return {0, 1};
  }
}

std::uint32_t direction_count(const Core& core) noexcept {
  if (core.kind == CoreKind::box) return 3;
  if (core.kind == CoreKind::cylinder || core.kind == CoreKind::cone) return 1;
  return edge_count(core);
}

Vec direction(const Core& core, std::uint32_t i) noexcept {
  switch (core.kind) {
    case CoreKind::box:
      return core.rotation.col(i);
    case CoreKind::triangle:
      return core.side[i];
    case CoreKind::hull: {
      const HullShape& hull = *core.hull;
      const auto [p, q] = edge(core, i);
      const Vec local(hull.vertex[0][q] - hull.vertex[0][p], hull.vertex[1][q] - hull.vertex[1][p],
                      hull.vertex[2][q] - hull.vertex[2][p]);
      return core.rotation * unit(local);
    }
    default:
      return core.rotation.col(2);
  }
}

std::uint32_t normal_count(const Core& core) noexcept {
  switch (core.kind) {
    case CoreKind::box:
      return 3;
    case CoreKind::triangle:
    case CoreKind::cylinder:
    case CoreKind::cone:
      return 1;
    case CoreKind::hull:
      return core.hull->face_count;
    default:
      return 0;
  }
}

Vec normal(const Core& core, std::uint32_t i) noexcept {
  switch (core.kind) {
    case CoreKind::box:
      return core.rotation.col(i);
    case CoreKind::triangle:
      return triangle_normal(core);
    case CoreKind::hull:
      return face_normal(core, i);
    default:
      return core.rotation.col(2);
  }
}

std::uint32_t face_count(const Core& core) noexcept {
  switch (core.kind) {
    case CoreKind::box:
      return 6;
    case CoreKind::triangle:
      return 1;
    case CoreKind::hull:
      return core.hull->face_count;
    default:
      return 0;
  }
}

std::uint32_t face_size(const Core& core, std::uint32_t face) noexcept {
  if (core.kind == CoreKind::box) return 4;
  return core.kind == CoreKind::hull ? core.hull->faces[face].count : 3;
}

std::uint32_t face_vertex(const Core& core, std::uint32_t face, std::uint32_t i) noexcept {
  if (core.kind == CoreKind::box) return kBoxFace[face][i];
  return core.kind == CoreKind::hull ? core.hull->loop[core.hull->faces[face].first + i] : i;
}

std::uint32_t face_edge(const Core& core, std::uint32_t face, std::uint32_t i) noexcept {
  if (core.kind == CoreKind::box) {
    return box_edge_of(kBoxFace[face][i], kBoxFace[face][(i + 1) % 4]);
  }
  return core.kind == CoreKind::hull ? core.hull->loop_edge[core.hull->faces[face].first + i] : i;
}

Vec face_normal(const Core& core, std::uint32_t face) noexcept {
  switch (core.kind) {
    case CoreKind::box:
      return (face & 1U) != 0 ? Vec(core.rotation.col(face / 2))
                              : Vec(-core.rotation.col(face / 2));
    case CoreKind::hull:
      return core.rotation * Eigen::Map<const Vec>(core.hull->faces[face].normal);
    default:
      return triangle_normal(core);
  }
}

}  // namespace winnow::solver
