#include "bench/commands/command.h"
#include "bench/commands/options.h"
#include "bench/commands/run_json.h"
#include "bench/common/progress.h"
#include "bench/common/table.h"
#include "bench/contenders/partitions.h"
#include "bench/measure/race.h"

#include <iostream>

namespace winnow::bench {
namespace {

struct Replay {
  Target target;
  std::size_t frames = 0;  // see Target::frames
  std::string json;
  std::vector<std::string> names{"all"};
  std::string isa;
  int threads = 1;

  void add_options(CLI::App& app) {
    target.add_to(app);
    add_partitions_option(app, names);
    add_threads_option(app, threads);
    add_isa_option(app, isa);
    add_frames_option(app, frames);
    add_json_option(app, json);
  }
  int run();

 private:
  static bool print_answers(const Recording& recording);
  void print(const std::vector<Run>& runs, const std::string& scene, std::size_t count) const;
};

int Replay::run() {
  choose_isa(isa);
  const NamedScene scene = target.named();
  const auto first = target.source(scene);
  const std::size_t count = first->objects();
  const Partitions partitions = partitions_for(names, count);
  RaceOptions options;
  options.frames = Target::frames(scene, frames);

  std::vector<Run> runs;
  {
    Progress progress(partitions.taken.size());
    for (const std::string& name : partitions.taken) {
      progress.step(target.name + ": " + name);
      // A new source for every partition, so that one run does not disturb another.
      const auto source = target.source(scene);
      std::vector<Contender> contenders = make_contenders({name}, threads);
      runs.push_back(std::move(race(*source, contenders, options).front()));
    }
  }
  print(runs, first->name(), count);
  if (!partitions.skipped.empty()) std::cout << "skipped: " << listed(partitions.skipped) << '\n';
  write_json(json,
             list_of(runs, [&](const Run& one) { return run_json(one, first->name(), count); }));
  if (scene.is_recording() && !print_answers(*scene.recording)) return kFailed;
  if (all_agree(runs)) return kDone;
  std::cerr << "winnow: the partitions did not find the same pairs\n";
  return kFailed;
}

/// Prints how many recorded queries returned the recorded results; false if any differed.
bool Replay::print_answers(const Recording& recording) {
  if (!recording.program) return true;
  const Recording::Program& program = *recording.program;
  std::cout << "recorded: " << grouped(program.calls) << " calls, "
            << grouped(program.questions - program.differences) << " of "
            << grouped(program.questions) << " queries returned the recorded results, bit for bit"
            << (program.is_whole ? "\n" : "; the recording was not closed\n");
  if (program.differences == 0) return true;
  std::cerr << "winnow: some queries returned other results than recorded\n";
  return false;
}

void Replay::print(const std::vector<Run>& runs, const std::string& scene,
                   std::size_t count) const {
  if (runs.empty()) return;
  std::cout << scene << ", " << grouped(count) << " objects, " << runs.front().frame_ms.size()
            << " frames, " << threads_text(threads) << ", " << isa_name() << '\n';
  Table table({"partition", "build ms", "frame ms", "max ms", "update ms", "pairs a frame",
               "reported", "bytes/object", "same pairs"});
  for (const Run& run : runs) {
    const Spread spread = run.frame_spread();
    table.add({run.engine, short_number(run.frame_ms.front()), short_number(spread.median),
               short_number(spread.max), short_number(run.median_update_ms()),
               grouped(static_cast<std::size_t>(run.pairs_a_frame())),
               grouped(static_cast<std::size_t>(run.reported_a_frame())),
               short_number(static_cast<double>(run.bytes) / static_cast<double>(count)),
               run.same_pairs(runs.front()) ? "yes" : "NO"});
  }
  std::cout << table;
}

}  // namespace

void add_replay(CLI::App& app) {
  command<Replay>(
      app, "replay",
      "Finds all pairs in every frame of a recording or scene, and compares all structures",
      "The time of a frame includes one bulk update of the changed boxes (the structure is given "
      "the list of changes, as in a simulation) and writing all pairs into one buffer; medians "
      "exclude the first frame. A program's own recording is also played call by call, and every "
      "result is compared with the recorded one.");
}

}  // namespace winnow::bench
