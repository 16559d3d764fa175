#pragma once

#include "bench/scenes/pair_set.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace winnow::bench {

/// What is held to be true of a pair.
struct PairTruth {
  bool known = false;
  bool overlap = false;
  long double distance = 0.0L;
  double normal[3] = {};
  /// Unique to 0.1 degrees.
  bool normal_unique = false;
  /// What errors are relative to: the sum of the radii of balls that hold the shapes.
  double size = 0.0;
};

/// Who knows.
enum class TruthSource : std::uint8_t {
  oracle,     ///< arithmetic of 100 digits, about 0.1 ms a pair and more of hulls
  reference,  ///< winnow's tier of this name, which is itself judged by the oracle
};

/// True where the tool was built with the oracle.
[[nodiscard]] bool has_oracle() noexcept;

/// The truth about all pairs of a set, on all cores. Without the oracle its place is taken by the
/// tier `reference`, which does not say whether normals are unique.
[[nodiscard]] std::vector<PairTruth> truths_of(const PairSet& set, TruthSource judge);

}  // namespace winnow::bench
