#pragma once

#include "bench/contenders/ray_engine.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace winnow::bench {

/// Options of a race of rays at one mesh, on one thread.
struct RayRaceOptions {
  /// "terrain": rays from above it to below. "soup": random triangles in a cube; rays from around
  /// it.
  std::string mesh = "terrain";
  /// Approximate number; a terrain has a square number of cells.
  std::size_t triangles = 100'000;
  std::size_t rays = 4'000;
  std::size_t rounds = 9;
  bool peers = true;
  std::uint64_t seed = 1;
  bool machine_clock = true;
};

/// Results of one engine for one kind of ray query, single or batched.
struct RayTiming {
  std::string engine;
  RayQueryType query_type = RayQueryType::closest;
  QueryMode mode = QueryMode::single;
  /// ns per ray, one entry per round.
  std::vector<double> ns{};
  /// Rays with a hit, and rays whose result differs from winnow's: one of the two has no hit, or t
  /// differs by more than the rounding of float.
  std::size_t hits = 0;
  std::size_t differ = 0;
};

struct RayMeasurement {
  std::vector<RayTiming> timings;  ///< winnow first
  std::size_t triangles = 0;
  double bytes_per_triangle = 0.0;  ///< of winnow
  double machine_ms = 0.0;          ///< of the MachineClock, before and after the race, if enabled
};

/// Races all engines. Throws std::runtime_error for an unknown mesh.
[[nodiscard]] RayMeasurement measure_rays(const RayRaceOptions& options);

}  // namespace winnow::bench
