#include "bench/measure/ray_race.h"

#include "bench/common/interleaved_runs.h"
#include "bench/common/random.h"
#include "bench/common/timed.h"
#include "bench/contenders/reference_sweep.h"
#include "bench/contenders/winnow_rays.h"
#include "bench/peers/peers.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

namespace winnow::bench {
namespace {

constexpr double kRelief = 20.0;

Triangles make_mesh(const RayRaceOptions& options) {
  if (options.mesh == "soup") return make_soup(options.triangles, options.seed);
  if (options.mesh != "terrain") throw std::runtime_error("no mesh is called " + options.mesh);
  const double cells = std::round(std::sqrt(static_cast<double>(options.triangles) / 2.0));
  return make_terrain(make_hills(static_cast<std::uint32_t>(cells), 1.0, kRelief, options.seed));
}

/// Returns a ray between random points of two boxes; all numbers are floats, which some engines
/// need.
ShapeRay ray_between(Random& random, const Eigen::AlignedBox3d& from,
                     const Eigen::AlignedBox3d& to) {
  ShapeRay ray;
  for (int axis = 0; axis < 3; ++axis) {
    const auto start = static_cast<float>(random.in(from.min()[axis], from.max()[axis]));
    const auto end = static_cast<float>(random.in(to.min()[axis], to.max()[axis]));
    ray.origin[axis] = static_cast<double>(start);
    ray.direction[axis] = static_cast<double>(end - start);
  }
  ray.max_t = std::numeric_limits<double>::infinity();
  return ray;
}

/// Rays start above a terrain, up to half its width, or outside one of the six sides of a soup.
std::vector<ShapeRay> make_rays(const RayRaceOptions& options, const Triangles& mesh) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& vertex : mesh.vertices) box.extend(vertex);
  const Eigen::Vector3d size = box.sizes();
  Random random(options.seed + 1);
  std::vector<ShapeRay> rays;
  for (std::size_t i = 0; i < options.rays; ++i) {
    const int axis = options.mesh == "terrain" ? 2 : static_cast<int>(random.below(3));
    const bool below = options.mesh != "terrain" && random.below(2) == 0;
    const double away = 0.5 * size.maxCoeff();
    Eigen::AlignedBox3d from = box;
    from.min()[axis] = below ? box.min()[axis] - away : box.max()[axis];
    from.max()[axis] = below ? box.min()[axis] : box.max()[axis] + away;
    Eigen::AlignedBox3d to(box.min() + 0.05 * size, box.max() - 0.05 * size);
    to.min()[axis] = below ? box.max()[axis] : box.min()[axis] - 0.1 * away;
    to.max()[axis] = to.min()[axis];
    rays.push_back(ray_between(random, from, to));
  }
  return rays;
}

std::size_t count_differing(const std::vector<double>& expected, const std::vector<double>& found) {
  constexpr double kFloat = 1e-4;
  std::size_t differ = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (expected[i] == found[i]) continue;
    if (!(std::abs(expected[i] - found[i]) <= kFloat * expected[i])) ++differ;
  }
  return differ;
}

}  // namespace

RayMeasurement measure_rays(const RayRaceOptions& options) {
  const Triangles mesh = make_mesh(options);
  const std::vector<ShapeRay> rays = make_rays(options, mesh);
  std::vector<std::unique_ptr<RayEngine>> engines;
  engines.push_back(make_winnow_rays());
  if (options.peers) {
    for (std::unique_ptr<RayEngine>& peer : make_ray_peers()) engines.push_back(std::move(peer));
  }
  for (const std::unique_ptr<RayEngine>& engine : engines) engine->start(mesh);
  RayMeasurement measured;
  measured.triangles = mesh.size();
  measured.bytes_per_triangle =
      static_cast<double>(engines.front()->bytes()) / static_cast<double>(mesh.size());
  MachineClock clock(options.machine_clock);
  clock.tick();
  Arenas arenas(1);
  for (const RayQueryType query_type :
       {RayQueryType::closest, RayQueryType::any, RayQueryType::all}) {
    for (const QueryMode mode : {QueryMode::single, QueryMode::batch}) {
      auto ms = run_interleaved(engines.size(), options.rounds, 1, [&](std::size_t, std::size_t i) {
        engines[i]->take(rays);
        return timed(1, arenas, [&] { engines[i]->run(query_type, mode); });
      });
      const std::vector<double> expected = engines.front()->hits();
      for (std::size_t i = 0; i < engines.size(); ++i) {
        RayTiming timing{.engine = engines[i]->name(), .query_type = query_type, .mode = mode};
        for (const double one : ms[i]) {
          timing.ns.push_back(1e6 * one / static_cast<double>(rays.size()));
        }
        const std::vector<double> hits = engines[i]->hits();
        timing.hits = static_cast<std::size_t>(
            std::count_if(hits.begin(), hits.end(), [](double t) { return std::isfinite(t); }));
        timing.differ = count_differing(expected, hits);
        measured.timings.push_back(std::move(timing));
      }
    }
  }
  clock.tick();
  measured.machine_ms = clock.median_ms();
  return measured;
}

}  // namespace winnow::bench
