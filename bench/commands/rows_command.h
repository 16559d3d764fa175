#pragma once

#include "bench/commands/command.h"
#include "bench/common/progress.h"
#include "bench/rows/results.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace winnow::bench {

/// Base of commands that measure rows step by step into tables, print them and write them as JSON.
class RowsCommand {
 public:
  RowsCommand() = default;
  RowsCommand(const RowsCommand&) = delete;
  RowsCommand& operator=(const RowsCommand&) = delete;
  virtual ~RowsCommand() = default;

  /// Returns the exit status.
  int run();

 protected:
  /// Adds --isa and --json.
  void add_rows_options(CLI::App& app);
  /// Declares tables, runs steps and prints.
  virtual void measure() = 0;

  /// Sets the number of steps; call before the first step.
  void plan(std::size_t steps) { progress_.emplace(steps); }
  /// Runs one step. Passes on an ArgumentError; after any other exception prints it and continues,
  /// and the command ends with kFailed.
  void step(const std::string& what, const std::function<void()>& measure_rows);
  /// Prints the rows of a table, with all values or the named ones.
  void print(const std::string& table, const std::vector<std::string>& values = {});

  /// The document written by --json; by default all rows, and the facts of the machine.
  [[nodiscard]] virtual Json document();
  [[nodiscard]] bool is_written() const noexcept { return !json_.empty(); }
  /// Makes the command end with kFailed.
  void fail() noexcept { failed_ = true; }

  Results results;

 private:
  std::string isa_;
  std::string json_;
  std::optional<Progress> progress_;
  bool failed_ = false;
};

}  // namespace winnow::bench
