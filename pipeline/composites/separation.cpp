#include "pipeline/composites/separation.h"
#include "pipeline/shapes/extent.h"

#include <algorithm>
#include <cmath>

namespace winnow::mid {
namespace {

/// A plane through a triangle: its normal, not of unit length, and what rounding does to heights
/// above it, for each unit of length of what is asked.
struct Plane {
  explicit Plane(const Corners& t) noexcept
      : normal(t.edge[0].cross(t.edge[1])),
        length(normal.norm()),
        noise(kSlack * t.edge[0].lpNorm<1>() * t.edge[1].lpNorm<1>()) {}

  Vec normal;
  double length;
  double noise;
};

// All above or all below `low` and `high`, in units of the plane's normal.
[[nodiscard]] bool is_beyond(const Plane& plane, double low, double high, double scale,
                             double margin) noexcept {
  return std::max(low, -high) > margin * plane.length + plane.noise * scale;
}

/// From the point of a triangle that is closest to a point; both relative to its first corner.
/// (Ericson, Real-Time Collision Detection, 5.1.5.) Rounding makes it another direction, no more.
[[nodiscard]] Vec way_to(const Vec& point, const Corners& triangle) noexcept {
  const Vec& ab = triangle.edge[0];
  const Vec& ac = triangle.edge[1];
  const double d1 = ab.dot(point);
  const double d2 = ac.dot(point);
  if (d1 <= 0.0 && d2 <= 0.0) return point;
  const double aa = ab.squaredNorm();
  const double cc = ac.squaredNorm();
  const double bc = ab.dot(ac);
  const double d3 = d1 - aa;
  const double d4 = d2 - bc;
  if (d3 >= 0.0 && d4 <= d3) return point - ab;
  const double d5 = d1 - bc;
  const double d6 = d2 - cc;
  if (d6 >= 0.0 && d5 <= d6) return point - ac;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return point - ab * (d1 / (d1 - d3));
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return point - ac * (d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    const double along = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return point - ab - (ac - ab) * along;
  }
  const Vec normal = ab.cross(ac);
  return normal.dot(point) < 0.0 ? Vec(-normal) : normal;
}

[[nodiscard]] bool half_space_apart(const HalfSpaceShape& shape, const Part& part, const Corners& t,
                                    double margin) noexcept {
  const Vec normal = part.rotation * Eigen::Map<const Vec>(shape.normal);
  const Vec from = t.first - part.position;
  const double base = normal.dot(from);
  const double rise[2] = {normal.dot(t.edge[0]), normal.dot(t.edge[1])};
  const double scale = from.lpNorm<1>() + t.edge[0].lpNorm<1>() + t.edge[1].lpNorm<1>();
  return base + std::min({0.0, rise[0], rise[1]}) - shape.offset >
         margin + kSlack * (scale + std::abs(shape.offset));
}

[[nodiscard]] bool corners_beyond(const Corners& plane_of, const Corners& t,
                                  double margin) noexcept {
  const Plane plane(plane_of);
  const Vec from = t.first - plane_of.first;
  const double base = plane.normal.dot(from);
  const double one = plane.normal.dot(t.edge[0]);
  const double two = plane.normal.dot(t.edge[1]);
  return is_beyond(
      plane, base + std::min({0.0, one, two}), base + std::max({0.0, one, two}),
      from.lpNorm<1>() + t.edge[0].lpNorm<1>() + t.edge[1].lpNorm<1>() + plane_of.first.lpNorm<1>(),
      margin);
}

// A level of a mesh's tree as seen along a normal.
struct LevelWalk {
  const MeshView& mesh;
  const Vec& normal;
  double offset;
  double noise;

  // The least of normal . x over a node's box.
  [[nodiscard]] bool reaches(std::uint32_t level, std::uint32_t node) const noexcept {
    double least = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const int bound = normal[axis] < 0.0 ? axis + 3 : axis;
      const double q = mesh.node[level][bound][node];
      least += normal[axis] *
               (static_cast<double>(mesh.origin[axis]) + q * static_cast<double>(mesh.step[axis]));
    }
    return !(least > offset + noise);
  }
};

}  // namespace

bool is_apart(const ShapeTables& tables, const Part& part, const Corners& triangle,
              double margin) noexcept {
  if (part.shape.kind() == ShapeKind::half_space) {
    return half_space_apart(tables.half_spaces[part.shape.index()], part, triangle, margin);
  }
  // The way from the triangle's closest point to the middle of the part: a triangle's plane where
  // that is above its inside, and a better axis where it is not.
  const Vec from = part.position - triangle.first;
  const Vec axis = way_to(from + part.middle, triangle);
  const double length = axis.norm();
  const double scale = from.lpNorm<1>() + triangle.first.lpNorm<1>() + part.radius +
                       triangle.edge[0].lpNorm<1>() + triangle.edge[1].lpNorm<1>();
  const double enough = (margin + kSlack * scale) * length;
  const double top = std::max({0.0, axis.dot(triangle.edge[0]), axis.dot(triangle.edge[1])});
  const double middle = axis.dot(from + part.middle) - top;
  if (middle - part.reach * length > enough) return true;
  if (middle - part.inner * length <= enough) return false;
  return axis.dot(from) - top + lowest(tables, part.shape, part.rotation.transpose() * axis) >
         enough;
}
bool is_apart(const Corners& a, const Corners& b, double margin) noexcept {
  for (int i = 0; i < 3; ++i) {
    const double low = std::min({0.0, a.edge[0][i], a.edge[1][i]});
    const double high = std::max({0.0, a.edge[0][i], a.edge[1][i]});
    const double low_b = std::min({0.0, b.edge[0][i], b.edge[1][i]});
    const double high_b = std::max({0.0, b.edge[0][i], b.edge[1][i]});
    const double out =
        margin +
        4.0 * kSlack * (std::abs(a.first[i]) + std::abs(b.first[i]) + high - low + high_b - low_b);
    const double from = b.first[i] - a.first[i];
    if (from + low_b - high > out || low - high_b - from > out) return true;
  }
  return corners_beyond(a, b, margin) || corners_beyond(b, a, margin);
}

void mesh_below(const MeshView& mesh, const Vec& normal, double offset, SlotSink& out) noexcept {
  double noise = std::abs(offset);
  for (int axis = 0; axis < 3; ++axis) {
    const double step = 65536.0 * static_cast<double>(mesh.step[axis]);
    noise += std::abs(normal[axis]) * (std::abs(static_cast<double>(mesh.origin[axis])) + step);
  }
  const LevelWalk walk{mesh, normal, offset, kSlack * noise};
  // Children of a node are taken from the last to the first, so that slots come out ascending.
  std::uint32_t level_of[kMaxMeshLevels * kMeshFanout];
  std::uint32_t stack[kMaxMeshLevels * kMeshFanout];
  std::uint32_t depth = 0;
  const auto push = [&](std::uint32_t level, std::uint32_t first, std::uint32_t end) {
    for (std::uint32_t node = end; node-- > first;) {
      if (!walk.reaches(level, node)) continue;
      level_of[depth] = level;
      stack[depth++] = node;
    }
  };
  if (mesh.levels == 0) return;
  push(mesh.levels - 1, 0, mesh.count[mesh.levels - 1]);
  while (depth != 0) {
    const std::uint32_t level = level_of[--depth];
    const std::uint32_t first = stack[depth] * kMeshFanout;
    if (level != 0) {
      push(level - 1, first, std::min(first + kMeshFanout, mesh.count[level - 1]));
      continue;
    }
    const std::uint32_t end = std::min(first + kMeshFanout, mesh.triangle_count);
    for (std::uint32_t slot = first; slot < end; ++slot) {
      if (out.size < out.capacity) out.slot[out.size] = slot;
      ++out.size;
    }
  }
}

}  // namespace winnow::mid
