#include "bench/commands/command.h"
#include "bench/common/table.h"
#include "bench/recordings/recording.h"
#include "bench/rows/build_facts.h"
#include "bench/rows/machine.h"

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

namespace winnow::bench {
namespace {

/// Throws ArgumentError if WINNOW_ISA names no available instruction set. The library itself would
/// fall back to the widest one without an error.
void check_isa_of_environment() {
  const char* name = std::getenv("WINNOW_ISA");
  const auto names = isa_names();
  if (name == nullptr || *name == '\0' || std::ranges::find(names, name) != names.end()) return;
  throw ArgumentError(
      std::string("WINNOW_ISA=") + name +
      " is not available in this build or on this machine; available: " + listed(names));
}

int run_tool(int argc, char** argv) {
  CLI::App app{"winnow: benchmarks and tools for the collision-detection library winnow.",
               "winnow"};
  app.require_subcommand(0, 1);
  app.set_version_flag("--version", std::string("winnow ") + kVersion + " (" + kCommit + ")");
  std::vector<Command> commands{add_report(app),  add_fit(app),      add_scenes(app),
                                add_record(app),  add_replay(app),   add_query(app),
                                add_draw(app),    add_simulate(app), add_advise(app),
                                add_cluster(app), add_trust(app)};
  for (Command& one : add_measurements(app)) commands.push_back(std::move(one));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const bool is_help = error.get_exit_code() == 0;
    app.exit(error);
    return is_help ? kDone : kBadArgument;
  }
  check_isa_of_environment();
  for (const Command& command : commands) {
    if (command.app->parsed()) return command.run();
  }
  std::cout << app.help();
  return kDone;
}

}  // namespace
}  // namespace winnow::bench

int main(int argc, char** argv) {
  using namespace winnow::bench;
  try {
    return run_tool(argc, argv);
  } catch (const ArgumentError& error) {
    std::cerr << "winnow: " << error.what() << '\n';
    return kBadArgument;
  } catch (const RecordingError& error) {
    std::cerr << "winnow: " << error.what() << '\n';
    return kBadArgument;
  } catch (const std::exception& error) {
    std::cerr << "winnow: " << error.what() << '\n';
    return kFailed;
  }
}
