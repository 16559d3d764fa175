#pragma once

#include "bench/common/sample.h"

#include <cstddef>
#include <string>

namespace winnow::bench {

/// Says on stderr how far long work is: one line that is written over on a terminal, a line a step
/// elsewhere.
class Progress {
 public:
  explicit Progress(std::size_t steps) : steps_(steps) {}
  /// Also tells how much time is left of steps that take about so many seconds together.
  Progress(std::size_t steps, double seconds) : steps_(steps), expected_(seconds) {}
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress() { clear(); }

  /// Announces the next step, which takes about so long.
  void step(const std::string& what, double seconds = 0.0);
  /// Clears the line, for something else to be printed.
  void clear();

 private:
  std::size_t steps_;
  std::size_t done_ = 0;
  std::size_t width_ = 0;
  double expected_ = 0.0;  // seconds of all steps
  double begun_ = 0.0;     // of those announced
  Stopwatch clock_;
};

}  // namespace winnow::bench
