#include "advice/advice.h"
#include "tool/arguments.h"
#include "tool/command.h"
#include "tool/output.h"
#include "tool/table.h"
#include "tool/target.h"

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

void print(const Advice& advice, const std::string& skipped) {
  const SceneFeatures& f = advice.features;
  std::cout << advice.scene << ", " << grouped(advice.objects) << " objects, " << advice.frames
            << " frames, " << advice.threads << (advice.threads == 1 ? " thread, " : " threads, ")
            << isa_name() << '\n'
            << short_number(100.0 * advice.moving) << " % of the objects move in a frame; "
            << short_number(advice.pairs / static_cast<double>(advice.objects))
            << " pairs an object";
  // Known where AutoPartition took part.
  if (!advice.chosen.empty()) {
    std::cout << "; the large ones have " << short_number(std::exp2(f.size_spread))
              << " times the edges of the small ones; room for " << short_number(f.room[0]) << " x "
              << short_number(f.room[1]) << " x " << short_number(f.room[2])
              << " of them; crowding " << short_number(std::exp2(f.crowding));
  }
  std::cout << "\n\n";
  Table table({"partition", "ms a frame", "x best", "first ms", "bytes", "bytes/object", "why"});
  table.flush_left(6);
  for (const Advised& one : advice.ranking) {
    table.add({one.partition, short_number(one.median_ms), short_number(one.times_best),
               short_number(one.first_ms), grouped(one.bytes),
               short_number(static_cast<double>(one.bytes) / static_cast<double>(advice.objects)),
               one.why});
  }
  std::cout << table << skipped;
  if (!advice.chosen.empty()) {
    std::cout << "\nAutoPartition chose " << advice.chosen << ": " << advice.reason << '\n';
  }
  std::cout << "\n  #include <winnow/partitions/partition.h>\n  " << advice.code() << '\n';
}

Json to_json(const Advice& advice) {
  Json ranking = Json::array();
  for (const Advised& one : advice.ranking) {
    ranking.push_back({{"partition", one.partition},
                       {"median_ms", one.median_ms},
                       {"times_best", one.times_best},
                       {"first_ms", one.first_ms},
                       {"bytes", one.bytes},
                       {"why", one.why}});
  }
  Json json{{"scene", advice.scene},     {"objects", advice.objects}, {"frames", advice.frames},
            {"threads", advice.threads}, {"moving", advice.moving},   {"pairs", advice.pairs},
            {"ranking", ranking},        {"code", advice.code()}};
  if (!advice.chosen.empty()) {
    const SceneFeatures& f = advice.features;
    json["room"] = f.room;
    json["size_spread"] = f.size_spread;
    json["crowding"] = f.crowding;
    json["chosen"] = advice.chosen;
    json["reason"] = advice.reason;
  }
  return json;
}

int Advise::run() {
  choose_isa(choice.isa);
  target.open();
  const auto source = target.source();
  const Partitions partitions = partitions_for(choice.partitions, source->boxes().size());
  if (frames == 0) {
    frames = target.recording() ? std::min(target.recording()->frames.size(), kMostFrames)
                                : kAdviceFrames;
  }
  const Advice advice = advise(*source, partitions.taken, frames, threads);
  print(advice, skipped_line(partitions.skipped));
  write_json(json, to_json(advice));
  if (advice.same_pairs) return kDone;
  std::cerr << "winnow: the partitions did not find the same pairs\n";
  return kFailed;
}

}  // namespace

Command add_advise(CLI::App& app) {
  auto advise = std::make_shared<Advise>();
  CLI::App* sub = app.add_subcommand(
      "advise",
      "Races the partitions on a recording or scene, frame by frame interleaved, and says which to "
      "take, why, and how. Medians leave out the first six frames.");
  sub->add_option("target", advise->target.name,
                  "A recording (.aabbs, .aabbs.xz) or a scene's name")
      ->required();
  sub->add_option("--objects", advise->target.objects, "Number of objects of a scene (10000)")
      ->check(CLI::Range(std::size_t{1}, std::size_t{100'000'000}));
  sub->add_option("--seed", advise->target.seed, "What a scene is drawn from (1)");
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
