// Hull of a point set: classifies it as point, segment, polygon or solid, computes the surface
// (exact_hull for solids, monotone chain for polygons) and passes it to assemble_hull
// (hull_builder.cpp).

#include "core/memory/catch_bad_alloc.h"
#include "pipeline/shapes/accurate_cross.h"
#include "pipeline/shapes/exact_hull.h"
#include "pipeline/shapes/hull_builder.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace winnow {
namespace {

// Point sets thinner than this, relative to their extent, count as flat.
constexpr double kFlat = 1e-13;

using Points = std::pmr::vector<Eigen::Vector3d>;

// Scales by a power of two so that the largest coordinate is in [1, 2). Tolerances are relative to
// it, and squares of very small or large numbers would leave the range of double.
void scale(Points& points) {
  double largest = 0.0;
  for (const Eigen::Vector3d& p : points) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  const int exponent = largest > 0.0 ? std::ilogb(largest) : 0;
  for (Eigen::Vector3d& p : points) {
    for (double& x : p) x = std::ldexp(x, -exponent);
  }
}

// The points relative to the centre of their AABB, scaled.
Points centred(std::span<const Eigen::Vector3d> points, std::pmr::memory_resource* memory) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : points) box.extend(p);
  const Eigen::Vector3d middle = 0.5 * box.min() + 0.5 * box.max();
  Points result(memory);
  result.reserve(points.size());
  for (const Eigen::Vector3d& p : points) result.push_back(p - middle);
  scale(result);
  return result;
}

template <typename Measure>
std::size_t farthest(const Points& points, Measure&& measure) {
  std::size_t best = 0;
  double most = -1.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double m = measure(points[i]);
    if (m > most) {
      most = m;
      best = i;
    }
  }
  return best;
}

using Chain = std::pmr::vector<std::uint32_t>;

// Drops corners of a convex outline that lie, within the tolerance, on the line between corners
// that stay.
Chain simplified(const Points& points, const Chain& outline, int u, int v) {
  const auto at = [&](std::size_t i) -> const Eigen::Vector3d& {
    return points[outline[i % outline.size()]];
  };
  const auto counts = [&](std::size_t from, std::size_t to, std::size_t i) {
    const Eigen::Vector2d line(at(to)[u] - at(from)[u], at(to)[v] - at(from)[v]);
    const Eigen::Vector2d way(at(i)[u] - at(from)[u], at(i)[v] - at(from)[v]);
    // A thin outline can run backwards along its own line.
    if (!(way.dot(line) >= 0.0 && way.dot(line) <= line.squaredNorm())) return true;
    const double across = difference_of_products(line.x(), way.y(), line.y(), way.x());
    return std::abs(across) > kFlat * line.norm();
  };
  Chain kept(1, outline[0], outline.get_allocator());
  std::size_t from = 0;
  for (std::size_t to = 2; to <= outline.size(); ++to) {
    bool any = false;
    for (std::size_t i = from + 1; i < to && !any; ++i) any = counts(from, to, i);
    if (!any) continue;
    from = to - 1;
    kept.push_back(outline[from]);
  }
  if (kept.size() < 3) kept = outline;
  return kept;
}

// Outline of points near a plane, by monotone chain (Andrew 1979), on the two axes on which the
// plane is least steep: dropping a coordinate does not round the others.
void add_polygon(const Points& points, const Eigen::Vector3d& normal, HullSurface& surface) {
  int drop = 0;
  normal.cwiseAbs().maxCoeff(&drop);
  int u = (drop + 1) % 3;
  int v = (drop + 2) % 3;
  if (normal[drop] < 0.0) std::swap(u, v);
  Chain order(points.size(), points.get_allocator());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(points[a][u], points[a][v]) < std::pair(points[b][u], points[b][v]);
  });
  Chain chain(points.get_allocator());
  const auto extend = [&](std::uint32_t i, std::size_t keep) {
    const auto last_turns_left = [&] {
      return turn_in_plane(points[chain[chain.size() - 2]], points[chain.back()], points[i], u, v) >
             0;
    };
    while (chain.size() >= keep + 2 && !last_turns_left()) chain.pop_back();
    chain.push_back(i);
  };
  for (const std::uint32_t i : order) extend(i, 0);
  const std::size_t lower = chain.size() - 1;
  for (std::size_t i = order.size() - 1; i-- > 0;) extend(order[i], lower);
  chain.pop_back();
  chain = simplified(points, chain, u, v);
  surface.loops.assign(chain.begin(), chain.end());
  surface.end_face();
  surface.loops.insert(surface.loops.end(), chain.rbegin(), chain.rend());
  surface.end_face();
}

// Assembles the hull with nearly coplanar triangles merged, if the result is convex; else from the
// triangles themselves, which are always convex.
Status assemble_solid(std::span<const Eigen::Vector3d> given, const Points& points,
                      const HullSurface& triangles, std::pmr::memory_resource* memory,
                      HullShape& hull) {
  HullSurface joined(triangles.loops.get_allocator().resource());
  joined.loops = triangles.loops;
  joined.first = triangles.first;
  Status status = merge_coplanar(points, joined);
  if (status == Status::ok) status = assemble_hull(given, joined, memory, hull);
  return status == Status::invalid_shape ? assemble_hull(given, triangles, memory, hull) : status;
}

[[nodiscard]] Status build_of_points(const PointView& all, std::pmr::memory_resource* memory,
                                     HullShape& hull) {
  std::pmr::monotonic_buffer_resource scratch(memory);
  const Points given = copied(all, &scratch);
  const auto finite = [](const Eigen::Vector3d& p) { return p.allFinite(); };
  if (given.empty() || !std::ranges::all_of(given, finite)) return Status::invalid_shape;
  Points points = centred(given, &scratch);
  HullSurface surface(&scratch);
  const Eigen::Vector3d p0 = points[0];
  const std::size_t i1 = farthest(points, [&](const auto& p) { return (p - p0).squaredNorm(); });
  const Eigen::Vector3d p1 = points[i1];
  const Eigen::Vector3d along = p1 - p0;
  if (along.isZero()) return assemble_hull({given.data(), 1}, surface, memory, hull);
  const std::size_t i2 =
      farthest(points, [&](const auto& p) { return along.cross(p - p0).squaredNorm(); });
  const Eigen::Vector3d normal = accurate_cross(along, points[i2] - p0);
  if (normal.norm() <= kFlat * along.squaredNorm()) {
    const std::size_t i0 = farthest(points, [&](const auto& p) { return 100.0 - along.dot(p); });
    const std::size_t end = farthest(points, [&](const auto& p) { return 100.0 + along.dot(p); });
    const Eigen::Vector3d ends[2] = {given[i0], given[end]};
    return assemble_hull(ends, surface, memory, hull);
  }
  const Eigen::Vector3d unit = normal.normalized();
  const std::size_t i3 =
      farthest(points, [&](const auto& p) { return std::abs(unit.dot(p - p0)); });
  if (std::abs(unit.dot(points[i3] - p0)) > kFlat) {
    // Uses the original points, because subtracting the centre rounds.
    Points exact(given, &scratch);
    scale(exact);
    if (exact_hull(exact, surface)) return assemble_solid(given, points, surface, memory, hull);
  }
  add_polygon(points, unit, surface);
  return assemble_hull(given, surface, memory, hull);
}

}  // namespace

Status hull_of_points(const PointView& all, std::pmr::memory_resource* memory, HullShape& hull) {
  return catch_bad_alloc([&] { return build_of_points(all, memory, hull); }, Status::out_of_memory);
}

}  // namespace winnow
