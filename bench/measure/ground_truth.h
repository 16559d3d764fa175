#pragma once

#include "bench/scenes/pair_set.h"

#include <cstddef>
#include <string>
#include <vector>

namespace winnow::bench {

/// Reference result of a pair.
struct PairTruth {
  bool known = false;
  bool overlap = false;
  long double distance = 0.0L;
  Vec3d normal{};
  /// The normal is unique to 0.1 degrees.
  bool normal_unique = false;
  /// Sum of the radii of balls that contain the shapes; errors are relative to it.
  double size = 0.0;
};

/// Returns the reference results of all pairs of a set, computed on all cores. Without the oracle
/// the tier `reference` is used, which sets no normals.
[[nodiscard]] std::vector<PairTruth> truths_of(const PairSet& set);

/// Returns "100 digits", or the name of that tier.
[[nodiscard]] std::string judge_name();

}  // namespace winnow::bench
