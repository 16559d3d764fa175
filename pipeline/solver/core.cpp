// Support functions, projections and features (vertices, edges, faces) of the cores of all shapes;
// the other files of this folder build on them.

#include "pipeline/solver/core.h"

#include "pipeline/kinds/hypotenuse.h"

#include <algorithm>
#include <cmath>

namespace winnow::solver {
namespace {

Vec rim(const Core& core, const Vec& local, double z) noexcept {
  const double length = hypotenuse(local.x(), local.y());
  if (length == 0.0) return {0.0, 0.0, z};
  // Divide by the length first: for very short directions, radius / length may overflow.
  return {core.half.x() * (local.x() / length), core.half.x() * (local.y() / length), z};
}

double radial(const Core& core, const Vec& local) noexcept {
  return core.half.x() * hypotenuse(local.x(), local.y());
}

/// Relative to the center, in the core's axes; `d` is unit.
Vec farthest_point(const Core& core, const Vec& d) noexcept {
  return core.farthest.farthest(d) * core.unit[0] * core.unit[1];
}

}  // namespace

Vec unit(const Vec& v) noexcept {
  const double largest = v.cwiseAbs().maxCoeff();
  if (!(largest > 0.0)) return Vec::Zero();
  // Vectors in this range need no scaling: their squares neither overflow nor underflow, and
  // scaling by a power of two would not change the result.
  constexpr double kSafe = 1e140;
  if (largest > 1.0 / kSafe && largest < kSafe) return v / v.norm();
  int exponent = 0;
  std::frexp(largest, &exponent);
  const int half = exponent / 2;
  const Vec scaled = v * std::ldexp(1.0, -half) * std::ldexp(1.0, half - exponent);
  return scaled / scaled.norm();
}

Vec perpendicular(const Vec& e, const Vec& f) noexcept {
  return without(unit(e.cross(f)), e);
}

Vec without(const Vec& v, const Vec& e) noexcept {
  const Vec once = unit(v - e * e.dot(v));
  return unit(once - e * e.dot(once));
}

// The maximum of eight products is computed first, then compared with the best so far: only one
// comparison in eight depends on the vertices before.
std::uint32_t farthest_vertex(const HullShape& hull, const Vec& d, double& value) noexcept {
  constexpr int kBlock = 8;
  using Block = Eigen::Array<double, kBlock, 1>;
  double best = -std::numeric_limits<double>::infinity();
  std::uint32_t best_at = 0;
  for (std::uint32_t i = 0; i < hull.vertex_count; i += kBlock) {
    const Block dot = Block::Map(hull.vertex[0] + i) * d.x() +
                      Block::Map(hull.vertex[1] + i) * d.y() +
                      Block::Map(hull.vertex[2] + i) * d.z();
    const double top = dot.maxCoeff();
    if (!(top > best)) continue;
    best = top;
    int k = 0;
    while (k + 1 < kBlock && dot[k] != top) ++k;
    best_at = i + static_cast<std::uint32_t>(k);
  }
  value = best;
  // The columns are padded with copies of vertex 0.
  return best_at < hull.vertex_count ? best_at : 0;
}

Vec support(const Core& core, const Vec& direction) noexcept {
  switch (core.kind) {
    case CoreKind::point:
      return core.center;
    case CoreKind::triangle: {
      const double d0 = core.corner[0].dot(direction);
      const double d1 = core.corner[1].dot(direction);
      const double d2 = core.corner[2].dot(direction);
      return core.center + core.corner[d0 >= d1 && d0 >= d2 ? 0 : (d1 >= d2 ? 1 : 2)];
    }
    default:
      break;
  }
  const Vec d = core.rotation.transpose() * direction;
  const Vec& h = core.half;
  const double z = d.z() < 0.0 ? -h.z() : h.z();
  Vec local = Vec::Zero();
  switch (core.kind) {
    case CoreKind::segment:
      local.z() = z;
      break;
    case CoreKind::box:
      local = {d.x() < 0.0 ? -h.x() : h.x(), d.y() < 0.0 ? -h.y() : h.y(), z};
      break;
    case CoreKind::cylinder:
      local = rim(core, d, z);
      break;
    case CoreKind::cone:
      local = h.z() * d.z() >= radial(core, d) - h.z() * d.z() ? Vec(0.0, 0.0, h.z())
                                                               : rim(core, d, -h.z());
      break;
    case CoreKind::support:
      local = farthest_point(core, unit(d));
      break;
    default: {
      double value = 0.0;
      return vertex(core, farthest_vertex(*core.hull, d, value));
    }
  }
  return core.center + core.rotation * local;
}

AxisRange project(const Core& core, const Vec& n) noexcept {
  switch (core.kind) {
    case CoreKind::point:
      return {0.0, 0.0};
    case CoreKind::triangle: {
      const double d0 = core.corner[0].dot(n);
      const double d1 = core.corner[1].dot(n);
      const double d2 = core.corner[2].dot(n);
      return {std::min({d0, d1, d2}), std::max({d0, d1, d2})};
    }
    default:
      break;
  }
  const Vec d = core.rotation.transpose() * n;
  const double along = std::abs(d.z()) * core.half.z();
  switch (core.kind) {
    case CoreKind::segment:
      return {-along, along};
    case CoreKind::box: {
      const double reach = d.cwiseAbs().dot(core.half);
      return {-reach, reach};
    }
    case CoreKind::cylinder: {
      const double reach = radial(core, d) + along;
      return {-reach, reach};
    }
    case CoreKind::cone: {
      const double tip = core.half.z() * d.z();
      const double side = radial(core, d);
      return {std::min(tip, -side - tip), std::max(tip, side - tip)};
    }
    case CoreKind::support: {
      const Vec u = unit(d);
      return {d.dot(farthest_point(core, -u)), d.dot(farthest_point(core, u))};
    }
    default: {
      AxisRange range{};
      farthest_vertex(*core.hull, d, range.high);
      farthest_vertex(*core.hull, -d, range.low);
      range.low = -range.low * core.unit[0] * core.unit[1];
      range.high = range.high * core.unit[0] * core.unit[1];
      return range;
    }
  }
}

double highest(const Core& core, const Vec& n) noexcept {
  if (core.kind != CoreKind::hull) return project(core, n).high;
  double value = 0.0;
  farthest_vertex(*core.hull, core.rotation.transpose() * n, value);
  return value * core.unit[0] * core.unit[1];
}

double separation(const Core& a, const Core& b, const Vec& axis) noexcept {
  return axis.dot(b.center - a.center) + project(b, axis).low - project(a, axis).high;
}

Core meridian(const Core& core, const Vec& direction) noexcept {
  if (core.kind != CoreKind::cylinder && core.kind != CoreKind::cone) return core;
  const Vec d = core.rotation.transpose() * direction;
  // Along the axis all meridian planes are alike.
  if (hypotenuse(d.x(), d.y()) <= 1e-7 * std::abs(d.z())) return core;
  const double h = core.half.z();
  const Vec low = rim(core, d, -h);
  const Vec high = core.kind == CoreKind::cone ? Vec(0.0, 0.0, h) : rim(core, d, h);
  const Vec middle(0.0, 0.0, core.kind == CoreKind::cylinder && d.z() > 0.0 ? h : -h);
  Core triangle = core;
  triangle.kind = CoreKind::triangle;
  triangle.corner = {core.rotation * low, core.rotation * high, core.rotation * middle};
  for (std::size_t i = 0; i < 3; ++i) {
    triangle.side[i] = unit(triangle.corner[(i + 1) % 3] - triangle.corner[i]);
  }
  return triangle;
}

namespace {

Vec hull_point(const Core& core, std::uint32_t i) noexcept {
  const Vec local(core.hull->vertex[0][i], core.hull->vertex[1][i], core.hull->vertex[2][i]);
  return core.rotation * (local * core.unit[0] * core.unit[1]);
}

/// The corners of a box's faces, counter-clockwise seen from outside. Bit i of a corner's number is
/// set on the positive side of axis i. Face 2 i is the negative, face 2 i + 1 the positive face of
/// axis i.
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
  // Use the longest side, which has the most accurate direction, and the shortest.
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
      return core.rotation.col(static_cast<Eigen::Index>(i));
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
      return core.rotation.col(static_cast<Eigen::Index>(i));
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
