#pragma once

#include "bench/common/sample.h"

#include <cstddef>
#include <string>

namespace winnow::bench {

/// Prints progress to stderr: on a terminal one line that is overwritten, otherwise one line per
/// step.
class Progress {
 public:
  explicit Progress(std::size_t steps) : steps_(steps) {}
  /// Also prints the time left; `seconds` is the estimated time of all steps.
  Progress(std::size_t steps, double seconds) : steps_(steps), expected_(seconds) {}
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress() { clear(); }

  /// Announces the next step; `seconds` is its estimated time.
  void step(const std::string& what, double seconds = 0.0);
  /// Clears the line, so that other output can be printed.
  void clear();

 private:
  std::size_t steps_;
  std::size_t done_ = 0;
  std::size_t width_ = 0;
  double expected_ = 0.0;  // estimated seconds of all steps
  double begun_ = 0.0;     // estimated seconds of the steps announced so far
  Stopwatch clock_;
};

}  // namespace winnow::bench
