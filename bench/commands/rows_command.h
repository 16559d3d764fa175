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

/// A command that measures rows step by step into tables, which it prints and writes.
class RowsCommand {
 public:
  RowsCommand() = default;
  RowsCommand(const RowsCommand&) = delete;
  RowsCommand& operator=(const RowsCommand&) = delete;
  virtual ~RowsCommand() = default;

  /// The exit status.
  int run();

 protected:
  /// --isa, and --json.
  void add_rows_options(CLI::App& app);
  /// Declares tables, makes steps and prints.
  virtual void measure() = 0;

  /// Before the first step.
  void plan(std::size_t steps) { progress_.emplace(steps); }
  /// Something that was found wrong is told, and ends the command with kFailed.
  void step(const std::string& what, const std::function<void()>& measure_rows);
  /// The rows of a table, all values or these.
  void print(const std::string& table, const std::vector<std::string>& values = {});

  /// What is written: all rows.
  [[nodiscard]] virtual Json document() const;
  [[nodiscard]] bool is_written() const noexcept { return !json_.empty(); }
  /// Ends the command with kFailed.
  void fail() noexcept { failed_ = true; }

  Results results;

 private:
  std::string isa_;
  std::string json_;
  std::optional<Progress> progress_;
  bool failed_ = false;
};

}  // namespace winnow::bench
