#pragma once

#include "bench/common/json.h"

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace winnow::bench {

/// A folder of its own name, gone with this.
class TemporaryFolder {
 public:
  /// Throws std::runtime_error.
  TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder();

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

/// This tool once more in a process of its own, which ends with this. What it prints is dropped,
/// but for errors, and what a terminal's interrupt asks of this process is not asked of it; `quiet`
/// drops errors, too, and lets interrupts through.
class OwnProcess {
 public:
  /// A subcommand and its options. Throws std::runtime_error if it cannot be started.
  explicit OwnProcess(std::vector<std::string> arguments, bool quiet = false);
  OwnProcess(const OwnProcess&) = delete;
  OwnProcess& operator=(const OwnProcess&) = delete;
  ~OwnProcess() { kill(); }

  /// Exit status once it has ended; -1 if a signal ended it.
  int wait();
  void kill();
  [[nodiscard]] bool runs();

 private:
  pid_t process_ = 0;  // 0: it has ended
};

/// What such a process writes with --json. Throws std::runtime_error if it cannot be run or wrote
/// nothing, whatever its exit status.
[[nodiscard]] Json run_own(std::vector<std::string> arguments);

}  // namespace winnow::bench
