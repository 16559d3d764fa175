#pragma once

#include "bench/common/errors.h"

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <vector>

namespace winnow::bench {

/// A subcommand: how it is called, and what it does, which gives the exit status.
struct Command {
  CLI::App* app = nullptr;
  std::function<int()> run;
};

inline constexpr int kDone = 0;
inline constexpr int kFailed = 1;  ///< something did not hold
inline constexpr int kBadArgument = 2;

/// A subcommand that `Asked` adds the options of, which are its members, and runs.
template <typename Asked>
Command command(CLI::App& app, const char* name, const char* what) {
  auto asked = std::make_shared<Asked>();
  CLI::App* sub = app.add_subcommand(name, what);
  asked->add_options(*sub);
  return {sub, [asked] { return asked->run(); }};
}

// One file each.
Command add_scenes(CLI::App& app);
Command add_record(CLI::App& app);
Command add_replay(CLI::App& app);
Command add_goals(CLI::App& app);
Command add_draw(CLI::App& app);
Command add_query(CLI::App& app);
Command add_simulate(CLI::App& app);
Command add_advise(CLI::App& app);
Command add_cluster(CLI::App& app);
Command add_report(CLI::App& app);
Command add_compare(CLI::App& app);
Command add_results(CLI::App& app);
Command add_fit(CLI::App& app);
Command add_trust(CLI::App& app);

/// Those that only measure rows.
std::vector<Command> add_measurements(CLI::App& app);

}  // namespace winnow::bench
