#include "bench/commands/command.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <vector>

namespace winnow::bench {
namespace {

/// Replaces this process by winnow_micro, which is in the folder of this program.
[[noreturn]] void start(std::vector<std::string> words) {
  const std::filesystem::path folder =
      std::filesystem::read_symlink("/proc/self/exe").parent_path();
  words.insert(words.begin(), (folder / "winnow_micro").string());
  become(words);
  if (errno == ENOENT) {
    throw ArgumentError(words.front() +
                        " is not built. Build it with: bench/run micro, or cmake --build " +
                        folder.parent_path().string() + " --target winnow_micro");
  }
  throw ArgumentError(words.front() + ": " + std::strerror(errno));
}

}  // namespace

void add_micro(CLI::App& app) {
  CLI::App* micro = app.add_subcommand(
      "micro", "Measures single calls with Google Benchmark; all options go to it, as --help");
  micro->set_help_flag();
  micro->prefix_command();
  micro->callback([micro] { start(micro->remaining()); });
}

}  // namespace winnow::bench
