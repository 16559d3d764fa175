#pragma once

#include "bench/common/errors.h"

#include <CLI/CLI.hpp>
#include <functional>

namespace winnow::bench {

/// A subcommand: how it is called, and what it does, which gives the exit status.
struct Command {
  CLI::App* app = nullptr;
  std::function<int()> run;
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
Command add_report(CLI::App& app);
Command add_compare(CLI::App& app);
Command add_results(CLI::App& app);

}  // namespace winnow::bench
