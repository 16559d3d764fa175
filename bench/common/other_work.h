#pragma once

#include "bench/common/sample.h"

#include <optional>

namespace winnow::bench {

/// Measures the load of all other processes from construction on. This process and child processes
/// that have ended are not counted.
class OtherWork {
 public:
  OtherWork();
  /// Returns the average number of cores that were busy, or nothing on systems without /proc/stat.
  [[nodiscard]] std::optional<double> cores() const;

 private:
  Stopwatch clock_;
  std::optional<double> busy_before_;
  double own_before_;
};

}  // namespace winnow::bench
