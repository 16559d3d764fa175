#pragma once

#include "bench/common/json.h"

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace winnow::bench {

/// A temporary folder with a unique name, removed by the destructor.
class TemporaryFolder {
 public:
  /// Throws std::runtime_error if the folder cannot be created.
  TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder();

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

/// Runs this tool in a second process, which the destructor kills. Its standard output is dropped.
/// By default it has its own process group, so that an interrupt from the terminal does not reach
/// it; with `quiet`, it stays in this group and its errors are dropped as well.
class OwnProcess {
 public:
  /// Starts the tool with a subcommand and its options. Throws std::runtime_error if it cannot
  /// start.
  explicit OwnProcess(std::vector<std::string> arguments, bool quiet = false);
  OwnProcess(const OwnProcess&) = delete;
  OwnProcess& operator=(const OwnProcess&) = delete;
  ~OwnProcess() { kill(); }

  /// Waits for the end and returns the exit status; -1 if a signal ended it.
  int wait();
  void kill();
  [[nodiscard]] bool runs();

 private:
  pid_t process_ = 0;  // 0 after the process has ended
};

/// Runs the tool with --json and returns what it wrote, whatever its exit status. Throws
/// std::runtime_error if it cannot start or wrote nothing.
[[nodiscard]] Json run_own(std::vector<std::string> arguments);

}  // namespace winnow::bench
