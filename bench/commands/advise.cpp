#include "bench/commands/arguments.h"
#include "bench/commands/rows_run.h"
#include "bench/commands/target.h"
#include "bench/common/table.h"
#include "bench/contenders/partitions.h"
#include "bench/rows/advice_rows.h"

#include <algorithm>
#include <cmath>
#include <iostream>

namespace winnow::bench {
namespace {

constexpr std::size_t kAdviceFrames = 41;
constexpr std::size_t kMostFrames = 201;

struct Advise {
  Target target;
  std::size_t frames = 0;  // 0: as many as suit
  int threads = 1;
  Choice choice;
  std::string json;

  int run();
};

void print_choice(const Advice& advice) {
  const SceneFeatures& f = advice.features;
  std::cout << '\n'
            << short_number(100.0 * advice.moving) << " % of the objects move in a frame; "
            << short_number(advice.pairs / static_cast<double>(advice.objects))
            << " pairs an object";
  // Known where AutoPartition took part.
  if (!advice.chosen.empty()) {
    std::cout << "; the large ones have " << short_number(std::exp2(f.size_spread))
              << " times the edges of the small ones; room for " << short_number(f.room[0]) << " x "
              << short_number(f.room[1]) << " x " << short_number(f.room[2])
              << " of them; crowding " << short_number(std::exp2(f.crowding))
              << "\nAutoPartition chose " << advice.chosen << ": " << advice.reason;
  }
  std::cout << "\n\n  #include <winnow/partitions/partition.h>\n  " << advice.code() << '\n';
}

int Advise::run() {
  choose_isa(choice.isa);
  const NamedScene scene = target.named();
  const std::size_t count = scene.objects(target.objects.value_or(kSceneObjects));
  const Partitions partitions = partitions_for(choice.partitions, count);
  if (frames == 0) {
    frames = scene.is_recording() ? std::min(scene.recording->frames.size(), kMostFrames)
                                  : kAdviceFrames;
  }
  RowsRun run(1);
  declare_advice(run.results());
  Advice advice;
  run.step(scene.name, [&](Results& results) {
    advice = add_advice(results, scene, count, target.seed.value_or(1), partitions.taken, frames,
                        threads);
  });
  run.print("advice_ranking");
  if (!partitions.skipped.empty()) std::cout << "skipped: " << listed(partitions.skipped) << '\n';
  if (!advice.ranking.empty()) print_choice(advice);
  return run.end(json);
}

}  // namespace

Command add_advise(CLI::App& app) {
  auto advise = std::make_shared<Advise>();
  CLI::App* sub = app.add_subcommand(
      "advise",
      "Races the partitions on a recording or scene, frame by frame interleaved, and says which to "
      "take, why, and how. Medians leave out the first six frames.");
  advise->target.add_to(*sub);
  sub->add_option("--threads", advise->threads, "Threads")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  add_partitions_option(*sub, advise->choice);
  add_isa_option(*sub, advise->choice);
  add_frames_option(*sub, advise->frames);
  add_json_option(*sub, advise->json);
  return {sub, [advise] { return advise->run(); }};
}

}  // namespace winnow::bench
