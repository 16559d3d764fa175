#pragma once

#include <winnow/pipeline/narrow_phase.h>

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "tests/pipeline/pair_scenes.h"

namespace winnow::test {

/// The results of a NarrowResult for one pair.
struct PairResults {
  bool overlap = false;
  double distance = 0.0;
  double error_bound = 0.0;
  Eigen::Vector3d normal{0, 0, 0};
  /// Closest or deepest point on a, relative to the position of a.
  Eigen::Vector3d point{0, 0, 0};
  std::vector<ContactPoint> contacts;
};

/// Returns true if all numbers are equal. Zeros of either sign are equal.
[[nodiscard]] bool same(const PairResults& p, const PairResults& q);

/// Returns answers in the order of the pairs. Fails the test unless each pair has exactly one.
[[nodiscard]] std::vector<PairResults> answers_of(const NarrowResult& result, std::size_t pairs);

/// Runs a new NarrowPhase. Fails the test if it refuses the input.
[[nodiscard]] std::vector<PairResults> compute_results(const PairScene& scene,
                                                       const NarrowOptions& options);

}  // namespace winnow::test
