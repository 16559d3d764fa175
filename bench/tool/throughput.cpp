#include "tool/arguments.h"
#include "tool/command.h"
#include "tool/measure.h"
#include "tool/output.h"
#include "tool/progress.h"
#include "tool/table.h"
#include "tool/target.h"

#include <iostream>

namespace winnow::bench {
namespace {

struct Throughput {
  Choice choice;
  bool peers = false;
  std::size_t frames = 0;
  std::string json;

  int run();

 private:
  std::vector<MeasureOptions> races(const std::vector<Target>& targets) const;
};

/// Those of a recording come once, whatever the numbers of objects.
std::vector<MeasureOptions> Throughput::races(const std::vector<Target>& targets) const {
  std::vector<MeasureOptions> all;
  for (const std::size_t objects : choice.objects) {
    for (const Target& target : targets) {
      if (target.recording() != nullptr && objects != choice.objects.front()) continue;
      for (const int threads : choice.threads) {
        MeasureOptions options;
        options.scene = target.name;
        options.recording = target.recording();
        options.objects = target.recording() != nullptr ? target.recording()->objects() : objects;
        options.seed = choice.seed;
        options.partitions = choice.partitions;
        options.threads = {threads};
        options.peers = peers;
        options.frames = frames;
        all.push_back(std::move(options));
      }
    }
  }
  return all;
}

void print(const Measurement& measured, int threads) {
  std::cout << '\n'
            << measured.scene << ", " << grouped(measured.objects) << " objects, " << threads
            << (threads == 1 ? " thread, " : " threads, ") << isa_name() << ", "
            << measured.runs.front().frame_ms.size() << " frames\n";
  const Run* peer = measured.fastest_peer(threads);
  std::vector<std::string> header{"engine", "min ms",  "median ms",    "max ms",
                                  "update", "pairs/s", "bytes/object", "same pairs"};
  if (peer != nullptr) header.emplace_back("best peer / this");
  Table table(std::move(header));
  for (const Run& run : measured.runs) {
    const Spread ms = run.frame_spread();
    const double pairs_a_second = ms.median > 0.0 ? run.pairs_a_frame() / ms.median * 1e3 : 0.0;
    std::vector<std::string> row{
        run.engine,
        short_number(ms.min),
        short_number(ms.median),
        short_number(ms.max),
        short_number(run.median_update_ms()),
        grouped(static_cast<std::size_t>(pairs_a_second)),
        run.bytes != 0 ? short_number(measured.bytes_per_object(run)) : "-",
        run.same_pairs(measured.runs.front()) ? "yes" : "NO"};
    if (peer != nullptr) row.push_back(short_number(peer->median_ms() / ms.median) + "x");
    table.add(std::move(row));
  }
  std::cout << table << skipped_line(measured.skipped) << std::flush;
}

int Throughput::run() {
  choose_isa(choice.isa);
  if (choice.scenes.empty()) choice.scenes = main_scenes();
  if (choice.objects.empty()) choice.objects = {10'000, 100'000};
  if (choice.threads.empty()) choice.threads = usual_threads();
  if (peers && !has_peers()) {
    throw ArgumentError(
        "--peers: this tool was built without other libraries; "
        "bench/run --with-peers installs and builds them");
  }
  const std::vector<Target> targets = open_targets(choice.scenes);
  const std::vector<MeasureOptions> all = races(targets);
  Json json_runs = Json::array();
  bool same = true;
  Progress progress(all.size());
  for (const MeasureOptions& options : all) {
    progress.step(options.scene + ", " + grouped(options.objects) + " objects, " +
                  std::to_string(options.threads.front()) +
                  (options.threads.front() == 1 ? " thread" : " threads"));
    const Measurement measured = measure(options);
    progress.clear();
    if (measured.runs.empty()) continue;
    print(measured, options.threads.front());
    for (const Run& one : measured.runs) {
      json_runs.push_back(to_json(one, measured.scene, measured.objects));
    }
    if (!all_agree(measured.runs)) {
      same = false;
      std::cerr << "winnow: " << measured.scene << ": not all found the same pairs\n";
    }
  }
  write_json(json, json_runs);
  return same ? kDone : kFailed;
}

}  // namespace

Command add_throughput(CLI::App& app) {
  auto throughput = std::make_shared<Throughput>();
  CLI::App* sub = app.add_subcommand(
      "throughput",
      "Races partitions, and other libraries, frame by frame interleaved; all must find the same "
      "pairs");
  add_targets_option(*sub, throughput->choice);
  add_objects_option(*sub, throughput->choice);
  add_threads_option(*sub, throughput->choice);
  add_partitions_option(*sub, throughput->choice);
  add_isa_option(*sub, throughput->choice);
  add_seed_option(*sub, throughput->choice);
  sub->add_flag("--peers", throughput->peers, "Race other libraries too");
  add_frames_option(*sub, throughput->frames);
  add_json_option(*sub, throughput->json);
  return {sub, [throughput] { return throughput->run(); }};
}

}  // namespace winnow::bench
