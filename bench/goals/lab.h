#pragma once

#include "bench/common/sample.h"
#include "bench/rows/results.h"

#include <cstddef>
#include <map>
#include <string>

namespace winnow::bench {

/// What came of a measurement.
struct Measured {
  Results results;
  double machine_ms = 0.0;  ///< of the reference sweep in the same run; 0: it was not timed
  std::string fault{};      ///< why there is no answer
  bool absent = false;      ///< this machine has not got what is asked about
};

/// Measures what goals ask about, each thing once.
class Lab {
 public:
  /// `worst_of`: among how many frames the worst is looked for.
  explicit Lab(std::size_t worst_of = kWorstOf) : worst_of_(worst_of) {}

  /// By {NAME: options}, see measurements.h. Throws std::runtime_error if there is none of the
  /// name.
  const Measured& measured(const Json& request);

  /// The reference sweep in every measurement so far. Far apart, the run was disturbed.
  [[nodiscard]] Spread machine_ms() const;

  [[nodiscard]] std::size_t worst_of() const noexcept { return worst_of_; }

  static constexpr std::size_t kWorstOf = 300;

 private:
  std::size_t worst_of_;
  std::map<std::string, Measured> measured_;  // by the text of the request
};

}  // namespace winnow::bench
