// Rows about the choice of a partition: the advice for a scene, the first frames of AutoPartition
// and its frames after a scene changes, compared with the best partition, and the worst frames of
// any partition, compared with the median.

#include "bench/rows/rows.h"

#include "bench/contenders/partitions.h"
#include "bench/scenes/scene.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <numeric>
#include <span>
#include <stdexcept>
#include <utility>

namespace winnow::bench {
namespace {

constexpr const char* kChooser = "AutoPartition";

/// Races all partitions several times on the same frames and keeps each frame's minimum. Other work
/// on the machine may disturb a frame in one of these races, but seldom the same frame in all. A
/// single disturbed frame would falsify a sum of few frames, or the worst of many.
std::vector<Run> race_minima(const std::function<std::unique_ptr<FrameSource>()>& make_source,
                             std::size_t frames, int threads) {
  constexpr int kRounds = 3;
  std::vector<Run> runs;
  for (int round = 0; round < kRounds; ++round) {
    const std::unique_ptr<FrameSource> source = make_source();
    std::vector<Contender> contenders =
        make_contenders(partitions_for({"all"}, source->objects()).taken, threads);
    RaceOptions options;
    options.frames = frames;
    options.block = 1;
    std::vector<Run> again = race(*source, contenders, options);
    if (runs.empty()) runs = again;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      for (std::size_t f = 0; f < runs[i].frame_ms.size(); ++f) {
        runs[i].frame_ms[f] = std::min(runs[i].frame_ms[f], again[i].frame_ms[f]);
      }
    }
  }
  return runs;
}

/// Sums of the times of AutoPartition and of the fastest other partition over a range of frames.
struct OwnAndBest {
  double own_ms = 0.0;
  double best_ms = 0.0;
  std::string best{};

  OwnAndBest(const std::vector<Run>& runs, std::size_t begin, std::size_t end) {
    for (const Run& run : runs) {
      const auto at = run.frame_ms.begin();
      const auto stop = static_cast<std::ptrdiff_t>(std::min(end, run.frame_ms.size()));
      const double ms = std::accumulate(at + static_cast<std::ptrdiff_t>(begin), at + stop, 0.0);
      if (run.engine == kChooser) {
        own_ms = ms;
      } else if (best.empty() || ms < best_ms) {
        best_ms = ms;
        best = run.engine;
      }
    }
  }
};

/// Returns the times of the frames after settling in which something moved. Frames without motion
/// are much cheaper and would distort the median.
std::vector<double> working_frames(const Run& run) {
  std::vector<double> working;
  for (std::size_t f = kSettlingFrames; f < run.frame_ms.size(); ++f) {
    if (run.changed[f] != 0) working.push_back(run.frame_ms[f]);
  }
  return working;
}

/// Returns the greatest ratio of a frame to the median of the frames around it. The work of a scene
/// may grow manyfold during a run, so a frame far above the median of all frames need not be a
/// hitch.
double worst_hitch(std::span<const double> frames) {
  constexpr std::size_t kAround = 30;  // on each side
  double worst = 0.0;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const std::size_t begin = f - std::min(f, kAround);
    const std::size_t end = std::min(frames.size(), f + kAround + 1);
    worst = std::max(worst, frames[f] / median_of(frames.subspan(begin, end - begin)));
  }
  return worst;
}

}  // namespace

Advice add_advice(Results& results, const NamedScene& scene, std::size_t objects,
                  std::uint64_t seed, const std::vector<std::string>& partitions,
                  std::size_t frames, int threads) {
  Advice advice = advise(*scene.source(objects, seed), partitions, frames, threads);
  const Json keys{{"scene", scene.name}, {"objects", advice.objects}, {"threads", threads}};
  const std::string size =
      " --objects " + std::to_string(objects) + " --seed " + std::to_string(seed);
  const std::string command =
      command_text("advise ", shell_word(scene.argument), scene.is_recording() ? "" : size,
                   settings_text(threads), " --frames ", frames);
  Json row = keys;
  row["take"] = word_of(advice.best().partition);
  row["moving"] = advice.moving;
  row["pairs_per_object"] = advice.pairs / static_cast<double>(advice.objects);
  row["why"] = advice.best().why;
  row["code"] = advice.code();
  row["command"] = command;
  for (const Advised& one : advice.ranking) {  // fastest first
    Json ranked = keys;
    ranked["partition"] = one.partition;
    ranked["frame_ms"] = to_value(one.settled);
    ranked["first_ms"] = one.first_ms;
    ranked["bytes_per_object"] =
        static_cast<double>(one.bytes) / static_cast<double>(advice.objects);
    ranked["why"] = one.why;
    ranked["command"] = command;
    results.add("advice_ranking", std::move(ranked));
    if (one.partition == kChooser) {
      row["auto_over_best"] = one.times_best;
      row["auto_holds"] = word_of(advice.chosen);
      row["auto_why"] = advice.reason;
    } else if (one.partition != advice.best().partition && !row.contains("next")) {
      row["next"] = word_of(one.partition);
      row["next_over_best"] = one.times_best;
    }
  }
  results.add("advice", std::move(row));
  if (!advice.same_pairs) throw std::runtime_error("not all found the same pairs");
  return advice;
}

void add_first_frames(Results& results, const NamedScene& scene, std::size_t objects, int threads) {
  const auto runs = race_minima([&] { return scene.source(objects, 1); }, kSettlingFrames, threads);
  const OwnAndBest of(runs, 0, kSettlingFrames);
  results.add("first_frames", {{"scene", scene.name},
                               {"objects", objects},
                               {"threads", threads},
                               {"ratio", of.own_ms / of.best_ms},
                               {"ms", of.own_ms},
                               {"best", word_of(of.best)},
                               {"best_ms", of.best_ms}});
}

void add_changes(Results& results, std::size_t objects, std::size_t frames_each) {
  const std::vector<std::string> scenes{"uniform", "wall", "sleepy", "mixed", "pile"};
  Recording turns;
  for (const std::string& scene : scenes) {
    const auto source = scene_or_error(scene, objects, 1);
    turns.world.merge(source->world());
    for (std::size_t frame = 0; frame < frames_each; ++frame) {
      turns.frames.emplace_back(source->boxes().begin(), source->boxes().end());
      source->advance();
    }
  }
  const auto runs = race_minima([&] { return play(turns); }, frames_each * scenes.size(), 1);
  for (std::size_t turn = 1; turn < scenes.size(); ++turn) {
    const OwnAndBest of(runs, turn * frames_each, (turn + 1) * frames_each);
    const double frame = of.best_ms / static_cast<double>(frames_each);
    results.add("changes", {{"from", scenes[turn - 1]},
                            {"into", scenes[turn]},
                            {"objects", objects},
                            {"threads", 1},
                            {"frames_lost", (of.own_ms - of.best_ms) / frame},
                            {"best", word_of(of.best)}});
  }
}

void add_worst_frames(Results& results, const NamedScene& scene, std::size_t objects,
                      std::size_t frames) {
  const auto runs =
      race_minima([&] { return scene.source(objects, 1); }, kSettlingFrames + frames, 1);
  for (const Run& run : runs) {
    const std::vector<double> working = working_frames(run);
    if (working.empty()) continue;
    const Spread settled = spread_of(working);
    results.add("worst_frames", {{"scene", scene.name},
                                 {"objects", objects},
                                 {"partition", run.engine},
                                 {"threads", 1},
                                 {"ratio", settled.max / settled.median},
                                 {"hitch", worst_hitch(working)},
                                 {"worst_ms", settled.max},
                                 {"median_ms", settled.median},
                                 {"frames", working.size()}});
  }
}

}  // namespace winnow::bench
