#pragma once

#include "bench/common/errors.h"

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <vector>

namespace winnow::bench {

/// A subcommand. `run` returns the exit status.
struct Command {
  CLI::App* app = nullptr;
  std::function<int()> run;
};

inline constexpr int kDone = 0;
inline constexpr int kFailed = 1;  ///< a check or comparison failed
inline constexpr int kBadArgument = 2;

/// Makes a subcommand from a class whose members are the options: `Subcommand` has
/// `add_options(app)` and `run()`.
template <typename Subcommand>
Command command(CLI::App& app, const char* name, const char* what) {
  auto subcommand = std::make_shared<Subcommand>();
  CLI::App* sub = app.add_subcommand(name, what);
  subcommand->add_options(*sub);
  return {sub, [subcommand] { return subcommand->run(); }};
}

// Each of these is defined in a file of its own, named after the command.
Command add_scenes(CLI::App& app);
Command add_record(CLI::App& app);
Command add_replay(CLI::App& app);
Command add_draw(CLI::App& app);
Command add_query(CLI::App& app);
Command add_simulate(CLI::App& app);
Command add_advise(CLI::App& app);
Command add_cluster(CLI::App& app);
Command add_report(CLI::App& app);
Command add_fit(CLI::App& app);
Command add_trust(CLI::App& app);

/// Commands that only measure rows.
std::vector<Command> add_measurements(CLI::App& app);

}  // namespace winnow::bench
