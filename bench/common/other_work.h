#pragma once

#include "bench/common/sample.h"

#include <optional>

namespace winnow::bench {

/// What the machine does beside this process and those that it has waited for, from when it is
/// made. Known where there is a /proc/stat.
class OtherWork {
 public:
  OtherWork();
  /// Cores that it kept busy on average.
  [[nodiscard]] std::optional<double> cores() const;

 private:
  Stopwatch clock_;
  std::optional<double> busy_before_;
  double own_before_;
};

}  // namespace winnow::bench
