#include "bench/commands/command.h"
#include "bench/common/table.h"
#include "bench/recordings/recording.h"
#include "bench/rows/machine.h"

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <string>

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

void add_commands(CLI::App& app) {
  add_report(app);
  add_advise(app);
  add_view(app);
  add_replay(app);
  add_record(app);
  add_query(app);
  add_simulate(app);
  add_cluster(app);
  add_micro(app);
  add_scenes(app);
  CLI::App& dev = *app.add_subcommand("dev",
                                      "Measures single parts, and checks winnow and its "
                                      "documents: `winnow dev --help` lists the commands");
  add_fit(dev);
  add_measurements(dev);
  dev.group("For work on winnow");  // commands that are added later would inherit it
  for (CLI::App* const group : {&app, &dev}) {
    group->require_subcommand(0, 1);
    group->callback([group] {
      if (group->get_subcommands().empty()) throw CLI::CallForHelp();
    });
  }
}

int run_tool(int argc, char** argv) {
  CLI::App app{"winnow: benchmarks and tools for the collision-detection library winnow.",
               "winnow"};
  app.set_version_flag("--version", std::string("winnow ") + kVersion + " (" + kCommit + ")");
  app.parse_complete_callback(check_isa_of_environment);
  add_commands(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::RuntimeError& status) {
    return status.get_exit_code();
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == kDone ? kDone : kBadArgument;
  }
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
