#pragma once

#include "engine/sample.h"

#include <cstddef>
#include <string>

namespace winnow::bench {

/// Says on stderr how far long work is: one line that is written over on a terminal, a line a step
/// elsewhere.
class Progress {
 public:
  explicit Progress(std::size_t steps) : steps_(steps) {}
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress() { clear(); }

  /// Announces the next step.
  void step(const std::string& what);
  /// Clears the line, for something else to be printed.
  void clear();

 private:
  std::size_t steps_;
  std::size_t done_ = 0;
  std::size_t width_ = 0;
  Stopwatch clock_;
};

}  // namespace winnow::bench
