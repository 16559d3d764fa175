#include "core/memory/guarded.h"
#include "pipeline/shapes/hull_builder.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#ifdef WINNOW_HAVE_QHULL
extern "C" {
#include <libqhull_r/qhull_ra.h>
}
#endif

namespace winnow {
namespace {

// Sets that are thinner than this, in units of their extent, are flat.
constexpr double kFlat = 1e-13;

using Points = std::pmr::vector<Eigen::Vector3d>;

// Points around their middle, the largest coordinate in [1, 2): qhull's tolerances are relative to
// the largest coordinate, and squares of very small or large numbers leave double.
Points centred(std::span<const Eigen::Vector3d> points, std::pmr::memory_resource* memory) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : points) box.extend(p);
  const Eigen::Vector3d middle = 0.5 * box.min() + 0.5 * box.max();
  const double half = (0.5 * box.max() - 0.5 * box.min()).maxCoeff();
  const int exponent = half > 0.0 ? std::ilogb(half) : 0;
  Points result(memory);
  result.reserve(points.size());
  for (const Eigen::Vector3d& p : points) {
    Eigen::Vector3d q = p - middle;
    for (double& x : q) x = std::ldexp(x, -exponent);
    result.push_back(q);
  }
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

// Outline of points near a plane, by monotone chain (Andrew 1979) over the two axes on which the
// plane is least steep: a projection along an axis moves no coordinate.
void add_polygon(const Points& points, const Eigen::Vector3d& normal, HullSurface& surface) {
  int drop = 0;
  normal.cwiseAbs().maxCoeff(&drop);
  int u = (drop + 1) % 3;
  int v = (drop + 2) % 3;
  if (normal[drop] < 0.0) std::swap(u, v);
  std::pmr::vector<std::uint32_t> order(points.size(), points.get_allocator());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(points[a][u], points[a][v]) < std::pair(points[b][u], points[b][v]);
  });
  const auto turns_left = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const Eigen::Vector3d ab = points[b] - points[a];
    const Eigen::Vector3d ac = points[c] - points[a];
    return ab[u] * ac[v] - ab[v] * ac[u] > kFlat;
  };
  std::pmr::vector<std::uint32_t> chain(points.get_allocator());
  const auto extend = [&](std::uint32_t i, std::size_t keep) {
    while (chain.size() >= keep + 2 && !turns_left(chain[chain.size() - 2], chain.back(), i)) {
      chain.pop_back();
    }
    chain.push_back(i);
  };
  for (const std::uint32_t i : order) extend(i, 0);
  const std::size_t lower = chain.size() - 1;
  for (std::size_t i = order.size() - 1; i-- > 0;) extend(order[i], lower);
  chain.pop_back();
  surface.loops.assign(chain.begin(), chain.end());
  surface.end_face();
  surface.loops.insert(surface.loops.end(), chain.rbegin(), chain.rend());
  surface.end_face();
}

#ifdef WINNOW_HAVE_QHULL

class Qhull {
 public:
  Qhull() : errors_(std::tmpfile()) { qh_zero(&state_, errors_); }
  ~Qhull() {
    qh_freeqhull(&state_, !qh_ALL);
    int left = 0;
    int total = 0;
    qh_memfreeshort(&state_, &left, &total);
    if (errors_ != nullptr) std::fclose(errors_);
  }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;

  Status run(Points& points, HullSurface& surface) {
    char options[] = "qhull Pp";
    const int error = qh_new_qhull(&state_, 3, static_cast<int>(points.size()), points[0].data(),
                                   False, options, nullptr, errors_);
    if (error != 0) return error == qh_ERRmem ? Status::out_of_memory : Status::invalid_shape;
    qhT* const qh = &state_;
    facetT* facet = nullptr;
    FORALLfacets {
      setT* vertices = qh_facet3vertex(qh, facet);
      const std::size_t begin = surface.loops.size();
      vertexT* vertex = nullptr;
      vertexT** vertexp = nullptr;
      FOREACHvertex_(vertices) {
        surface.loops.push_back(static_cast<std::uint32_t>(qh_pointid(qh, vertex->point)));
      }
      qh_settempfree(qh, &vertices);
      orient(points, Eigen::Vector3d(facet->normal), surface, begin);
      surface.end_face();
    }
    return Status::ok;
  }

 private:
  static void orient(const Points& points, const Eigen::Vector3d& normal, HullSurface& surface,
                     std::size_t begin) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    const Eigen::Vector3d origin = points[surface.loops[begin]];
    for (std::size_t i = begin + 1; i + 1 < surface.loops.size(); ++i) {
      sum += (points[surface.loops[i]] - origin).cross(points[surface.loops[i + 1]] - origin);
    }
    if (sum.dot(normal) < 0.0) {
      std::reverse(surface.loops.begin() + static_cast<std::ptrdiff_t>(begin), surface.loops.end());
    }
  }

  qhT state_{};
  std::FILE* errors_;
};

#endif

Status surface_of(Points& points, HullSurface& surface) {
#ifdef WINNOW_HAVE_QHULL
  return Qhull().run(points, surface);
#else
  static_cast<void>(points);
  static_cast<void>(surface);
  return Status::unsupported;
#endif
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
  const Eigen::Vector3d normal = along.cross(points[i2] - p0);
  if (normal.norm() <= kFlat * along.squaredNorm()) {
    const std::size_t i0 = farthest(points, [&](const auto& p) { return 100.0 - along.dot(p); });
    const std::size_t end = farthest(points, [&](const auto& p) { return 100.0 + along.dot(p); });
    const Eigen::Vector3d ends[2] = {given[i0], given[end]};
    return assemble_hull(ends, surface, memory, hull);
  }
  const Eigen::Vector3d unit = normal.normalized();
  const std::size_t i3 =
      farthest(points, [&](const auto& p) { return std::abs(unit.dot(p - p0)); });
  if (std::abs(unit.dot(points[i3] - p0)) <= kFlat) {
    add_polygon(points, unit, surface);
    return assemble_hull(given, surface, memory, hull);
  }
  Status status = surface_of(points, surface);
  if (status == Status::ok) status = merge_coplanar(points, surface);
  return status == Status::ok ? assemble_hull(given, surface, memory, hull) : status;
}

}  // namespace

Status hull_of_points(const PointView& all, std::pmr::memory_resource* memory, HullShape& hull) {
  return guarded([&] { return build_of_points(all, memory, hull); }, Status::out_of_memory);
}

}  // namespace winnow
