#pragma once

#include "bench/common/sample.h"
#include "bench/contenders/narrow_engine.h"
#include "bench/measure/truths.h"
#include "bench/scenes/pair_set.h"

#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace winnow::bench {

/// How wrong an engine is about one pair of which the truth is known.
struct PairError {
  /// In truth: |distance| over the pair's size, and whether they overlap.
  double gap = 0.0;
  bool overlap = false;
  bool wrong = false;         ///< the verdict
  bool missing = false;       ///< no finite distance, or no normal, though the level has them
  bool beyond_bound = false;  ///< off by more than the answer says
  /// |distance - truth| / (size + |truth|); NaN: there is none.
  double error = std::numeric_limits<double>::quiet_NaN();
  /// Between the normals; NaN: it is not unique to 0.1 degrees, or there is none.
  double degrees = std::numeric_limits<double>::quiet_NaN();
};

/// Of a set of errors. All zero if there is none.
struct ErrorSpread {
  std::size_t count = 0;
  double median = 0.0;
  double p99 = 0.0;  ///< what 99 of 100 do not exceed
  double worst = 0.0;
};

/// How wrong one engine is about the pairs of a set at a level, and how long it takes.
struct Accuracy {
  std::string engine;
  ContactLevel level{};
  std::size_t pairs = 0;  ///< those of which the truth is known
  std::size_t wrong = 0;
  /// Other libraries are not asked for manifolds of pairs that do not overlap.
  std::size_t missing = 0;
  ErrorSpread all{};    ///< of distances, negative ones too
  ErrorSpread apart{};  ///< of them, those of pairs that do not overlap
  ErrorSpread depth{};  ///< and those of pairs that do
  ErrorSpread degrees{};
  std::size_t beyond_bound = 0;
  std::size_t normals_off = 0;  ///< by more than 0.01 degrees
  std::vector<double> ns{};     ///< a pair, on one thread, one entry a run over the set
  double recomputed = std::numeric_limits<double>::quiet_NaN();
};

/// What was wrong in the engine's last run, which was over all pairs of the set: an entry for each
/// pair of which the truth is known.
[[nodiscard]] std::vector<PairError> errors_of(const NarrowEngine& engine, ContactLevel level,
                                               const PairSet& set,
                                               std::span<const PairTruth> truths);

/// The figures of some pairs, without the engine, the level and the times.
[[nodiscard]] Accuracy summary_of(std::span<const PairError> errors);

/// Runs a started engine over all pairs of the set several times and compares what it says with the
/// truth.
[[nodiscard]] Accuracy judge_engine(NarrowEngine& engine, ContactLevel level, const PairSet& set,
                                    std::span<const PairTruth> truths, std::size_t runs = 3);

/// The nearest to touching that pairs are brought, in radii of the smaller body, unless said
/// otherwise.
inline constexpr double kNearestPairs = 1e-6;

/// Pairs of one kind, and who is asked about them.
struct AccuracyOptions {
  PairKind kind;
  PairSetOptions set{.pairs = 400, .nearest = kNearestPairs};
  std::vector<ContactLevel> levels{ContactLevel::distance};
  std::vector<NarrowTier> tiers{NarrowTier::robust, NarrowTier::reference};
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

}  // namespace winnow::bench
