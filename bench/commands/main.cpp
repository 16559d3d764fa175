#include "bench/commands/command.h"
#include "bench/recordings/recording.h"

#include <iostream>
#include <vector>

namespace winnow::bench {
namespace {

int run_tool(int argc, char** argv) {
  CLI::App app{"winnow: collision detection, measured. Without a subcommand: the report.",
               "winnow"};
  app.require_subcommand(0, 1);
  const Command report = add_report(app);
  std::vector<Command> commands{report,          add_compare(app),  add_results(app),
                                add_fit(app),    add_scenes(app),   add_record(app),
                                add_replay(app), add_query(app),    add_goals(app),
                                add_draw(app),   add_simulate(app), add_advise(app)};
  for (Command& one : add_measurements(app)) commands.push_back(std::move(one));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const bool asked_for_help = error.get_exit_code() == 0;
    app.exit(error);
    return asked_for_help ? kDone : kBadArgument;
  }
  for (const Command& command : commands) {
    if (command.app->parsed()) return command.run();
  }
  return report.run();
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
