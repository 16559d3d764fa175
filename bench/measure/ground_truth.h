#pragma once

#include "bench/scenes/pair_set.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace winnow::bench {

/// Reference result of a pair.
struct PairTruth {
  bool known = false;
  bool overlap = false;
  long double distance = 0.0L;
  double normal[3] = {};
  /// The normal is unique to 0.1 degrees.
  bool normal_unique = false;
  /// Sum of the radii of balls that contain the shapes; errors are relative to it.
  double size = 0.0;
};

/// The source of reference results.
enum class TruthSource : std::uint8_t {
  oracle,     ///< 100 digits, see bench/oracle
  reference,  ///< winnow's tier of this name, which in turn is tested against the oracle
};

/// Returns true if the tool was built with the oracle.
[[nodiscard]] bool has_oracle() noexcept;

/// Returns the reference results of all pairs of a set, computed on all cores. Without the oracle
/// the tier `reference` is used, which sets no normals.
[[nodiscard]] std::vector<PairTruth> truths_of(const PairSet& set, TruthSource judge);

}  // namespace winnow::bench
