#pragma once

#include "bench/contenders/ray_engine.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace winnow::bench {

/// Rays through one mesh, one thread.
struct RayRaceOptions {
  /// "terrain": rays from above it to below; "soup", triangles without order or neighbours in a
  /// cube: rays from around it.
  std::string mesh = "terrain";
  /// About so many: a terrain is square.
  std::size_t triangles = 100'000;
  std::size_t rays = 4'000;
  std::size_t rounds = 9;
  bool peers = true;
  std::uint64_t seed = 1;
  bool machine_clock = true;
};

/// One engine that was asked for one thing in one manner.
struct RayTiming {
  std::string engine;
  RayWant want = RayWant::closest;
  Asking asking = Asking::single;
  /// A ray, one entry a round.
  std::vector<double> ns{};
  /// Rays that meet something, and those that do for this engine or for winnow alone or whose t
  /// differ by more than float makes of them.
  std::size_t hits = 0;
  std::size_t differ = 0;
};

struct RayMeasurement {
  std::vector<RayTiming> timings;  ///< winnow's come first
  std::size_t triangles = 0;
  double bytes_per_triangle = 0.0;  ///< of winnow
  double machine_ms = 0.0;          ///< of the MachineClock, before and after, if asked for
};

/// All engines in turns. Throws std::runtime_error for a mesh of another name.
[[nodiscard]] RayMeasurement measure_rays(const RayRaceOptions& options);

}  // namespace winnow::bench
