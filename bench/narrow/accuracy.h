#pragma once

#include "narrow/truths.h"
#include "peers/narrow_engine.h"

#include <cstddef>
#include <span>
#include <string>

namespace winnow::bench {

/// How wrong one engine is about the pairs of a set at a level, and how long it takes.
struct Accuracy {
  std::string engine;
  NarrowLevel level{};
  std::size_t pairs = 0;  ///< those of which the truth is known
  std::size_t wrong = 0;  ///< verdicts
  /// Pairs without a finite distance or normal though the level has them. Other libraries are not
  /// asked for manifolds of pairs that do not overlap.
  std::size_t missing = 0;
  /// Of |distance - truth| / (size + |truth|), over `measured` pairs.
  double worst_error = 0.0;
  double p99_error = 0.0;
  std::size_t measured = 0;
  /// Errors beyond the bound that the answer carries.
  std::size_t beyond_bound = 0;
  /// Normals more than 0.01 degrees off where they are unique to 0.1 degrees, of `normals`.
  std::size_t normals_off = 0;
  double worst_degrees = 0.0;
  std::size_t normals = 0;
  double ns = 0.0;  ///< a pair, on one thread
  double recomputed = 0.0;
};

/// Runs a started engine over all pairs of the set and compares what it says with the truth.
[[nodiscard]] Accuracy judge_engine(NarrowEngine& engine, NarrowLevel level, const PairSet& set,
                                    std::span<const PairTruth> truths);

}  // namespace winnow::bench
