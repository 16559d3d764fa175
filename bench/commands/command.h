#pragma once

#include "bench/common/errors.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace winnow::bench {

inline constexpr int kDone = 0;
inline constexpr int kFailed = 1;  ///< a check or comparison failed
inline constexpr int kBadArgument = 2;

/// Adds a subcommand from a class whose members are the options: `Subcommand` has
/// `add_options(app)` and `run()`, which returns the exit status. CLI11 calls `run` after it has
/// parsed all arguments. The help of the subcommand ends with `details`.
template <typename Subcommand, typename... Arguments>
void command(CLI::App& app, const char* name, const char* what, const std::string& details = "",
             Arguments&&... arguments) {
  auto subcommand = std::make_shared<Subcommand>(std::forward<Arguments>(arguments)...);
  CLI::App* sub = app.add_subcommand(name, what);
  subcommand->add_options(*sub);
  sub->footer(details);
  sub->callback([subcommand] {
    if (const int status = subcommand->run(); status != kDone) throw CLI::RuntimeError(status);
  });
}

/// Replaces this process by another program; returns only if that fails.
inline void become(std::vector<std::string> words) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  execvp(arguments.front(), arguments.data());
}

// Each of these is defined in a file named after the command; `record` is in scenes.cpp.
void add_report(CLI::App& app);
void add_advise(CLI::App& app);
void add_view(CLI::App& app);
void add_replay(CLI::App& app);
void add_record(CLI::App& app);
void add_query(CLI::App& app);
void add_simulate(CLI::App& app);
void add_cluster(CLI::App& app);
void add_micro(CLI::App& app);
void add_scenes(CLI::App& app);

// Subcommands of `winnow dev`.
void add_fit(CLI::App& app);
/// Adds the commands that only measure rows.
void add_measurements(CLI::App& app);

}  // namespace winnow::bench
