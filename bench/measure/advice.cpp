#include "bench/measure/advice.h"

#include "bench/contenders/partition_engine.h"

#include <algorithm>
#include <cstdio>
#include <numeric>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace winnow::bench {
namespace {

constexpr std::string_view kAuto = "AutoPartition";

/// Formats to about two significant digits.
std::string about(double value) {
  char text[32];
  std::snprintf(text, sizeof text, value < 10.0 ? "%.1f" : "%.0f", value);
  return text;
}

/// Description of a partition, for the reason of its speed.
struct SceneNature {
  std::string_view partition;
  std::string_view what;
};

constexpr SceneNature kNatures[] = {
    {"NSquared", "reports all pairs without a look at the boxes"},
    {"BoundsNSquared", "tests each object against every other, with no structure to keep"},
    {"SweepAndPrune", "sweeps strips that are kept sorted"},
    {"FlatGrid", "sorts objects into cells of one size"},
    {"HierarchicalGrid", "has a grid for each class of sizes"},
    {"LooseOctree", "has loose cells of each size in three dimensions"},
    {"LooseQuadtree", "has loose cells of each size in two dimensions"},
    {"LinearBvh", "refits a tree over objects in the order of median cuts"},
    {"StaticBvh", "refits a tree over objects in an order that takes long to find"},
};

/// Converts the name of a structure to the function that makes it: "LinearBvh" to linear_bvh.
std::string function_of(std::string_view name) {
  std::string function;
  for (const char c : name) {
    const bool upper = c >= 'A' && c <= 'Z';
    if (upper && !function.empty()) function += '_';
    function += upper ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return function;
}

std::string why(const Partition& partition, const Run& run, double median_ms) {
  if (partition.name() == kAuto) {
    const StructureChoice choice = partition.choice();
    return "holds " + std::string(choice.structure.name()) + ", " + std::string(choice.reason) +
           (choice.changes == 0
                ? ""
                : ", after " + std::to_string(choice.changes) + " changes of structure");
  }
  const Statistics s = partition.statistics();
  const auto n = static_cast<double>(std::max<std::size_t>(1, s.objects));
  std::string text(partition.name());
  for (const SceneNature& nature : kNatures) {
    if (nature.partition == partition.name()) text = nature.what;
  }
  text += ": " + about(static_cast<double>(s.last_tests) / n) + " tests of 16 boxes an object";
  const double apart = 100.0 * static_cast<double>(s.irregular) / n;
  if (apart >= 1.0) text += ", " + about(apart) + " % of the objects do not suit its order";
  if (s.builds > 1) {
    text += ", built " + std::to_string(s.builds) + " times in " +
            std::to_string(run.frame_ms.size()) + " frames";
  }
  if (run.frame_ms.front() > 8.0 * median_ms) {
    text += ", and a build takes as long as " + about(run.frame_ms.front() / median_ms) + " frames";
  }
  return text;
}

/// Returns the frame times after settling, or after the first frame if fewer than three are left.
std::vector<double> settled_frames(const Run& run) {
  const auto settled = run.settled_ms();
  if (settled.size() >= 3) return {settled.begin(), settled.end()};
  const std::size_t first = std::min<std::size_t>(1, run.frame_ms.size() - 1);
  return {run.frame_ms.begin() + static_cast<std::ptrdiff_t>(first), run.frame_ms.end()};
}

}  // namespace

const Advised& Advice::best() const {
  const auto at = std::find_if(ranking.begin(), ranking.end(),
                               [](const Advised& one) { return one.partition != kAuto; });
  if (at == ranking.end()) throw std::invalid_argument("there is nothing to choose from");
  return *at;
}

std::string Advice::code() const {
  return "winnow::Partition partition(winnow::" + function_of(best().partition) +
         "(), {.execution = winnow::Execution::" + (threads == 1 ? "serial" : "parallel") + "()});";
}

Advice advise(FrameSource& source, const std::vector<std::string>& partitions, std::size_t frames,
              int threads) {
  std::vector<Contender> contenders;
  std::vector<const Partition*> raced;
  for (const std::string& name : partitions) {
    auto engine = std::make_unique<PartitionEngine>(name, threads);
    raced.push_back(&engine->partition());
    contenders.push_back({std::move(engine), threads, active_isa()});
  }
  RaceOptions options;
  options.frames = frames;
  const std::vector<Run> runs = race(source, contenders, options);

  Advice advice;
  advice.scene = source.name();
  advice.objects = source.objects();
  advice.threads = threads;
  advice.same_pairs = all_agree(runs);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    std::vector<double> settled = settled_frames(runs[i]);
    const double ms = median_of(settled);
    advice.ranking.push_back({.partition = runs[i].engine,
                              .first_ms = runs[i].frame_ms.front(),
                              .settled = std::move(settled),
                              .median_ms = ms,
                              .bytes = runs[i].bytes,
                              .why = why(*raced[i], runs[i], ms)});
    advice.frames = runs[i].frame_ms.size();
    advice.pairs = runs[i].pairs_a_frame();
    advice.moving =
        std::reduce(runs[i].changed.begin(), runs[i].changed.end(), 0.0) /
        static_cast<double>(std::max<std::size_t>(1, (advice.frames - 1) * advice.objects));
    if (raced[i]->name() == kAuto) {
      const StructureChoice choice = raced[i]->choice();
      advice.chosen = choice.structure.name();
      advice.reason = choice.reason;
      advice.features = choice.features;
    }
  }
  std::stable_sort(advice.ranking.begin(), advice.ranking.end(),
                   [](const Advised& a, const Advised& b) { return a.median_ms < b.median_ms; });
  const double least = advice.best().median_ms;
  for (Advised& one : advice.ranking) one.times_best = one.median_ms / least;
  return advice;
}

}  // namespace winnow::bench
