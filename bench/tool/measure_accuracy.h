#pragma once

#include "narrow/accuracy.h"
#include "narrow/pair_set.h"
#include "tool/output.h"

#include <string>
#include <vector>

namespace winnow::bench {

/// The nearest to touching that pairs are brought, in radii of the smaller body, unless said
/// otherwise.
inline constexpr double kNearestPairs = 1e-6;

/// Pairs of one kind, and who is asked about them.
struct AccuracyOptions {
  PairKind kind;
  PairSetOptions set{.pairs = 400, .nearest = kNearestPairs};
  std::vector<ContactLevel> levels{ContactLevel::distance};
  std::vector<NarrowTier> tiers{NarrowTier::fast, NarrowTier::robust, NarrowTier::reference};
  bool peers = true;  ///< other libraries too, where the tool was built with them
  TruthSource judge = TruthSource::oracle;
  std::size_t runs = 3;  ///< that are timed
};

/// The errors of the pairs whose |distance| over their size begins with this power of ten.
struct AccuracyAtGap {
  double gap = 0.0;  ///< 1e-3: from it up to 1e-2
  Accuracy accuracy;
};

struct AccuracyMeasurement {
  std::vector<Accuracy> engines;      ///< by level, winnow's tiers first
  std::vector<AccuracyAtGap> by_gap;  ///< of each of them from the smallest gap, touching left out
};

/// Of an engine that throws, all answers are missing.
[[nodiscard]] AccuracyMeasurement measure_accuracy(const AccuracyOptions& options);

/// "100 digits", or the tier that takes their place where the tool was built without.
[[nodiscard]] std::string judge_name(TruthSource judge);

/// The line by which `winnow accuracy` measures this again, of all engines.
[[nodiscard]] std::string accuracy_command(const AccuracyOptions& options);

/// The figures by name; those of which there are none are left out.
[[nodiscard]] Json to_json(const Accuracy& accuracy);

}  // namespace winnow::bench
