#pragma once

#include "bench/commands/command.h"
#include "bench/common/progress.h"
#include "bench/rows/results.h"

#include <functional>
#include <string>
#include <vector>

namespace winnow::bench {

/// What a command does that measures rows: step by step into tables, which it prints and writes.
class RowsRun {
 public:
  explicit RowsRun(std::size_t steps) : progress_(steps) {}

  [[nodiscard]] Results& results() noexcept { return results_; }
  /// Something that was found wrong is told, and ends the command with kFailed.
  void step(const std::string& what, const std::function<void(Results&)>& measure);
  /// The rows of a table, all values or these.
  void print(const std::string& table, const std::vector<std::string>& values = {});
  /// Writes all rows to a file, unless the path is empty; the exit status.
  [[nodiscard]] int end(const std::string& json);

 private:
  Results results_;
  Progress progress_;
  bool failed_ = false;
};

}  // namespace winnow::bench
