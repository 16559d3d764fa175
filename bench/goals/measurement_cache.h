#pragma once

#include "bench/common/sample.h"
#include "bench/rows/results.h"

#include <cstddef>
#include <map>
#include <string>

namespace winnow::bench {

/// The result of a measurement.
struct Measured {
  Results results;
  double machine_ms = 0.0;  ///< of the reference sweep in the same run; 0 if not timed
  std::string fault{};      ///< the error, if the measurement failed
  bool absent = false;      ///< this machine lacks what is measured
};

/// Runs the measurements that goals need, each at most once.
class MeasurementCache {
 public:
  /// `worst_of`: number of frames among which the worst one is searched.
  explicit MeasurementCache(std::size_t worst_of = kWorstOf) : worst_of_(worst_of) {}

  /// Runs {NAME: options}, see measurements.h, or returns the earlier result. Throws
  /// std::runtime_error if the name is unknown.
  const Measured& measured(const Json& request);

  /// Spread of the reference sweep over all measurements so far. A wide spread means that the run
  /// was disturbed.
  [[nodiscard]] Spread machine_ms() const;

  [[nodiscard]] std::size_t worst_of() const noexcept { return worst_of_; }

  static constexpr std::size_t kWorstOf = 300;

 private:
  std::size_t worst_of_;
  std::map<std::string, Measured> measured_;  // by the text of the request
};

}  // namespace winnow::bench
