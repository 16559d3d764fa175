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
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress() { clear(); }

  /// Announces the next step.
  void step(const std::string& what);
  /// Clears the line, so that other output can be printed.
  void clear();

 private:
  std::size_t steps_;
  std::size_t done_ = 0;
  std::size_t width_ = 0;
  Stopwatch clock_;
};

}  // namespace winnow::bench
