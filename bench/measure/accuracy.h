#pragma once

#include "bench/contenders/engines.h"
#include "bench/oracle/oracle.h"
#include "bench/scenes/pair_set.h"

#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace winnow::bench {

/// Returns the reference results of all pairs of a set, computed on all cores. Without the oracle
/// the tier `reference` is used, which sets no normals.
[[nodiscard]] std::vector<oracle::Truth> truths_of(const PairSet& set);

/// Returns "100 digits", or the name of that tier.
[[nodiscard]] std::string judge_name();

/// Error of an engine on one pair with a reference result.
struct PairError {
  /// Reference: |distance| over the pair's size, and whether the bodies overlap.
  double gap = 0.0;
  bool overlap = false;
  bool wrong = false;         ///< the verdict differs from the reference
  bool missing = false;       ///< no finite distance or no normal, at a level that has them
  bool beyond_bound = false;  ///< the error exceeds the engine's error bound
  /// |distance - truth| / (size + |truth|); NaN if there is no distance.
  double error = std::numeric_limits<double>::quiet_NaN();
  /// Angle between the normals; NaN if the true normal is not unique to 0.1 degrees, or if the
  /// engine returns no normal.
  double degrees = std::numeric_limits<double>::quiet_NaN();
};

/// Distribution of a set of errors; all zero for an empty set.
struct ErrorSpread {
  std::size_t count = 0;
  double median = 0.0;
  double p99 = 0.0;  ///< 99th percentile
  double worst = 0.0;
};

/// Errors of one engine on some pairs.
struct Accuracy {
  std::size_t pairs = 0;  ///< number of pairs with a reference result
  std::size_t wrong = 0;
  /// At level manifold, only overlapping pairs count.
  std::size_t missing = 0;
  ErrorSpread all{};    ///< errors of distances and depths
  ErrorSpread apart{};  ///< errors of pairs that do not overlap
  ErrorSpread depth{};  ///< errors of pairs that overlap
  ErrorSpread degrees{};
  std::size_t beyond_bound = 0;
  std::size_t normals_off = 0;  ///< normals off by more than 0.01 degrees
};

/// Returns the errors of the engine's last run, which must have covered all pairs of the set: one
/// entry for each pair with a reference result.
[[nodiscard]] std::vector<PairError> errors_of(const NarrowEngine& engine, ContactLevel level,
                                               const PairSet& set,
                                               std::span<const oracle::Truth> truths);

/// Summarizes errors.
[[nodiscard]] Accuracy summary_of(std::span<const PairError> errors);

/// Value of PairSetOptions::nearest of pairs whose errors are measured: the smallest gap or depth,
/// in radii of the smaller body.
inline constexpr double kNearestPairs = 1e-6;

}  // namespace winnow::bench
