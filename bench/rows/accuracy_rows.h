#pragma once

#include "bench/measure/accuracy.h"
#include "bench/measure/narrow_race.h"
#include "bench/rows/results.h"

#include <string>
#include <vector>

namespace winnow::bench {

// Pairs of shapes: what an answer costs, and how wrong it is.

/// Logarithmic axes have no 0: plots show errors that are smaller than this as this.
inline constexpr double kLeastErrorShown = 1e-17;

/// What the rows of a race or of errors are told apart by.
enum class PairKeys {
  kind,      ///< kind, level and engine
  settings,  ///< besides: pairs and threads of a race; ratio and gap of errors
};

/// narrow_speed, and narrow_best: the tier robust against the fastest other library that is right.
void declare_pair_times(Results& results, PairKeys keys = PairKeys::kind);
NarrowMeasurement add_pair_times(Results& results, const NarrowMeasureOptions& options,
                                 PairKeys keys = PairKeys::kind);

/// narrow_error.
void declare_pair_errors(Results& results, PairKeys keys = PairKeys::kind);
/// With `by_gap` also the errors of the pairs of each power of ten of |distance| over size: in rows
/// of their own if a gap is a key, else at level distance in `narrow_gap`.
void add_pair_errors(Results& results, const AccuracyOptions& options, bool by_gap,
                     PairKeys keys = PairKeys::kind);

/// Curves of errors have few columns and many rows.
void declare_error_curve(Results& results, const std::string& table, const std::string& section,
                         const std::string& title, const std::vector<std::string>& keys);
/// A row of distances for each engine; `keys` are those but for the engine's.
void add_error_curve(Results& results, const std::string& table, const Json& keys,
                     const AccuracyOptions& options);

}  // namespace winnow::bench
