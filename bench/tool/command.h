#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <stdexcept>

namespace winnow::bench {

/// A subcommand: how it is called, and what it does, which gives the exit status.
struct Command {
  CLI::App* app = nullptr;
  std::function<int()> run;
};

/// A wrong argument that only shows when the command runs. Ends the tool with kBadArgument.
class ArgumentError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

inline constexpr int kDone = 0;
inline constexpr int kFailed = 1;  ///< something did not hold
inline constexpr int kBadArgument = 2;

// One file each.
Command add_scenes(CLI::App& app);
Command add_record(CLI::App& app);
Command add_replay(CLI::App& app);
Command add_throughput(CLI::App& app);
Command add_footprint(CLI::App& app);
Command add_keys(CLI::App& app);
Command add_crossover(CLI::App& app);
Command add_queries(CLI::App& app);
Command add_narrow(CLI::App& app);
Command add_accuracy(CLI::App& app);
Command add_goals(CLI::App& app);
Command add_draw(CLI::App& app);
Command add_query(CLI::App& app);
Command add_pipeline(CLI::App& app);
Command add_simulate(CLI::App& app);
Command add_volumes(CLI::App& app);
Command add_advise(CLI::App& app);
Command add_growth(CLI::App& app);
Command add_limits(CLI::App& app);
Command add_report(CLI::App& app);
Command add_compare(CLI::App& app);
Command add_tables(CLI::App& app);

}  // namespace winnow::bench
