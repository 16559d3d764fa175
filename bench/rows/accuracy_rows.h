#pragma once

#include "bench/measure/accuracy.h"
#include "bench/measure/narrow_race.h"
#include "bench/rows/results.h"

#include <string>
#include <vector>

namespace winnow::bench {

// Pairs of shapes: the time and the error of a narrow-phase result.

/// Plots replace smaller errors by this value, because logarithmic axes have no 0.
inline constexpr double kMinErrorShown = 1e-17;

/// Keys that identify the rows of a race or of errors.
enum class PairKeys {
  kind,      ///< kind, level and engine
  settings,  ///< also the pairs and threads of a race, or the ratio and gap of errors
};

NarrowMeasurement add_pair_times(Results& results, const NarrowMeasureOptions& options,
                                 PairKeys keys = PairKeys::kind);

/// Adds the errors. With `by_gap` it also adds the errors for each power of ten of |distance| over
/// size: in separate rows if the gap is a key, else at level distance in `narrow_gap`.
void add_pair_errors(Results& results, const AccuracyOptions& options, bool by_gap,
                     PairKeys keys = PairKeys::kind);

/// Adds a row of distance errors for each engine; `keys` are the row's keys except the engine.
void add_error_curve(Results& results, const std::string& table, const Json& keys,
                     const AccuracyOptions& options);

}  // namespace winnow::bench
