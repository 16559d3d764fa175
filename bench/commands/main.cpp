#include "bench/commands/command.h"
#include "bench/common/table.h"
#include "bench/recordings/recording.h"
#include "bench/rows/build_facts.h"
#include "bench/rows/machine.h"

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

namespace winnow::bench {
namespace {

constexpr const char* kDev = "dev";

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

/// Returns the number of insertions, deletions, replacements and swaps of neighbours that change
/// one word into the other.
std::size_t edit_distance(std::string_view from, std::string_view to) {
  std::vector<std::size_t> before(to.size() + 1);
  std::vector<std::size_t> row(to.size() + 1);
  std::vector<std::size_t> next(to.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= from.size(); ++i) {
    next[0] = i;
    for (std::size_t k = 1; k <= to.size(); ++k) {
      const bool same = from[i - 1] == to[k - 1];
      next[k] = std::min({row[k] + 1, next[k - 1] + 1, row[k - 1] + (same ? 0 : 1)});
      const bool swapped = i > 1 && k > 1 && from[i - 1] == to[k - 2] && from[i - 2] == to[k - 1];
      if (swapped) next[k] = std::min(next[k], before[k - 2] + 1);
    }
    before.swap(row);
    row.swap(next);
  }
  return row.back();
}

/// Returns the nearest command as a user writes it, for example "dev goals"; "" if none is similar.
std::string nearest_command(const CLI::App& app, const std::string& given) {
  std::string nearest;
  std::size_t least = (given.size() + 2) / 3 + 1;
  const auto consider = [&](const CLI::App& group, const std::string& before) {
    for (const CLI::App* const one : group.get_subcommands([](const CLI::App*) { return true; })) {
      const std::size_t distance = edit_distance(given, one->get_name());
      if (distance >= least) continue;
      least = distance;
      nearest = before + one->get_name();
    }
  };
  consider(app, "");
  consider(*app.get_subcommand(kDev), std::string(kDev) + " ");
  return nearest;
}

/// Throws ArgumentError if a word precedes the command, or is in place of it.
void refuse_unknown_commands(const CLI::App& app) {
  const CLI::App& dev = *app.get_subcommand(kDev);
  for (const CLI::App* const group : {&app, &dev}) {
    const std::vector<std::string> words = group->remaining();
    if (words.empty() || words.front().starts_with('-')) continue;
    const std::string before = group == &dev ? std::string(kDev) + " " : "";
    const std::string nearest = nearest_command(app, words.front());
    throw ArgumentError("no command '" + before + words.front() + "'. " +
                        (nearest.empty() ? "`winnow " + before + "--help` lists all."
                                         : "Did you mean '" + nearest + "'?"));
  }
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
  CLI::App& dev = *app.add_subcommand(kDev,
                                      "Measures single parts, and checks winnow and its "
                                      "documents: `winnow dev --help` lists the commands");
  add_fit(dev);
  add_trust(dev);
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
    refuse_unknown_commands(app);
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
