#pragma once

#include "bench/rows/results.h"
#include "bench/simulation/standing.h"

#include <string>
#include <vector>

namespace winnow::bench {

/// A stable structure with edges of about 1 drifts by less than this after it has settled.
inline constexpr double kStandingDrift = 0.02;

struct StandingRowOptions {
  StandingScene scene = StandingScene::stack;
  bool reduced = false;
  double seconds = 60.0;
  int threads = 1;
};

/// Simulates one structure and adds its row. Returns false if it moved too far.
bool add_standing(Results& results, const StandingRowOptions& row_options);

[[nodiscard]] std::vector<std::string> standing_names();
/// Throws std::invalid_argument if there is no structure of this name.
[[nodiscard]] StandingScene standing_named(const std::string& name);

}  // namespace winnow::bench
