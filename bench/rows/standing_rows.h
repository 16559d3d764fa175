#pragma once

#include "bench/rows/results.h"
#include "bench/simulation/standing.h"

#include <string>
#include <vector>

namespace winnow::bench {

/// What stands drifts by less than this, of edges of about 1, once it has settled.
inline constexpr double kStandingDrift = 0.02;

struct StandingQuestion {
  StandingScene scene = StandingScene::stack;
  bool reduced = false;
  double seconds = 60.0;
  int threads = 1;
};

/// standing: structures that a solver keeps upright.
void declare_standing(Results& results);
/// Lets one stand. False if it did not.
bool add_standing(Results& results, const StandingQuestion& asked);

[[nodiscard]] std::vector<std::string> standing_names();
/// Throws std::invalid_argument if there is none of the name.
[[nodiscard]] StandingScene standing_named(const std::string& name);

}  // namespace winnow::bench
