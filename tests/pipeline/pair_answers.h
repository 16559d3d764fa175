#pragma once

#include <winnow/pipeline/narrow_phase.h>

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "tests/pipeline/pair_scenes.h"

namespace winnow::test {

/// What a NarrowResult says about one pair.
struct PairAnswers {
  bool overlap = false;
  double distance = 0.0;
  double error_bound = 0.0;
  Eigen::Vector3d normal{0, 0, 0};
  /// On a, relative to its position.
  Eigen::Vector3d point{0, 0, 0};
  std::vector<ContactPoint> contacts;
};

/// True if all numbers are the same; zeros of either sign are.
[[nodiscard]] bool same(const PairAnswers& p, const PairAnswers& q);

/// Answers in the order of the pairs; a test failure unless all of them are there once.
[[nodiscard]] std::vector<PairAnswers> answers_of(const NarrowResult& result, std::size_t pairs);

/// Asks a new NarrowPhase; a test failure if it refuses.
[[nodiscard]] std::vector<PairAnswers> ask(const PairScene& scene, const NarrowOptions& options);

}  // namespace winnow::test
