#include "tool/arguments.h"
#include "tool/command.h"
#include "tool/output.h"
#include "tool/progress.h"
#include "tool/table.h"
#include "tool/target.h"

#include <iostream>

namespace winnow::bench {
namespace {

constexpr std::size_t kSceneFrames = 30;

struct Replay {
  Target target;
  std::size_t frames = 0;  // 0: all of a recording, kSceneFrames of a scene
  std::string json;
  Choice choice;
  int threads = 1;

  int run();

 private:
  void print(const std::vector<Run>& runs, const std::string& scene, std::size_t count) const;
};

int Replay::run() {
  choose_isa(choice.isa);
  target.open();
  const auto first = target.source();
  const std::size_t count = first->boxes().size();
  const Partitions partitions = partitions_for(choice.partitions, count);
  RaceOptions options;
  options.frames = frames != 0          ? frames
                   : target.recording() ? target.recording()->frames.size()
                                        : kSceneFrames;

  std::vector<Run> runs;
  {
    Progress progress(partitions.taken.size());
    for (const std::string& name : partitions.taken) {
      progress.step(target.name + ": " + name);
      // Every partition gets the frames anew, so that one run does not disturb another.
      const auto source = target.source();
      std::vector<Contender> contenders = make_contenders({name}, threads);
      runs.push_back(std::move(race(*source, contenders, options).front()));
    }
  }
  print(runs, first->name(), count);
  std::cout << skipped_line(partitions.skipped);
  Json json_runs = Json::array();
  for (const Run& run : runs) json_runs.push_back(to_json(run, first->name(), count));
  write_json(json, json_runs);
  if (all_agree(runs)) return kDone;
  std::cerr << "winnow: the partitions did not find the same pairs\n";
  return kFailed;
}

void Replay::print(const std::vector<Run>& runs, const std::string& scene,
                   std::size_t count) const {
  if (runs.empty()) return;
  std::cout << scene << ", " << grouped(count) << " objects, " << runs.front().frame_ms.size()
            << " frames, " << threads << (threads == 1 ? " thread, " : " threads, ") << isa_name()
            << '\n';
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

Command add_replay(CLI::App& app) {
  auto replay = std::make_shared<Replay>();
  CLI::App* sub = app.add_subcommand(
      "replay",
      "Finds all pairs in every frame of a recording or scene. The frame's time is one bulk update "
      "of what changed (told to the partition, as a simulation knows it) and all pairs into one "
      "buffer; medians leave out the first frame.");
  sub->add_option("target", replay->target.name,
                  "A recording (.aabbs, .aabbs.xz) or a scene's name")
      ->required();
  sub->add_option("--objects", replay->target.objects, "Number of objects of a scene (10000)")
      ->check(CLI::Range(std::size_t{1}, std::size_t{100'000'000}));
  sub->add_option("--seed", replay->target.seed, "What a scene is drawn from (1)");
  add_partitions_option(*sub, replay->choice);
  sub->add_option("--threads", replay->threads, "Threads")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  add_isa_option(*sub, replay->choice);
  add_frames_option(*sub, replay->frames);
  add_json_option(*sub, replay->json);
  return {sub, [replay] { return replay->run(); }};
}

}  // namespace winnow::bench
