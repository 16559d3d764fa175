#include "report/sections/throughput.h"

#include "engine/partition_engine.h"
#include "report/scene_words.h"
#include "report/section.h"
#include "tool/arguments.h"
#include "tool/measure.h"
#include "tool/table.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace winnow::bench {
namespace {

constexpr std::size_t kLargestForPeers = 150'000;
/// Above it the structures of all instruction sets would fill the memory if they raced at once.
constexpr std::size_t kLargestForOneRace = 300'000;

void declare_throughput(Results& results) {
  results.declare(
      {"throughput",
       "throughput",
       "a frame of every partition and library",
       {"scene", "objects", "partition", "threads", "isa"},
       {{"frame_ms", "frame", "ms", Better::less},
        {"us_per_object", "frame", "us/object"},
        {"update_ms", "of it update", "ms"},
        {"update_share", "share of the update", "", Better::neither, Format::percent},
        {"first_ms", "first frame", "ms", Better::less},
        {"pairs", "pairs", "", Better::neither, Format::count},
        {"pairs_per_s", "pairs", "million/s", Better::more},
        {"bytes_per_object", "memory", "bytes/object", Better::less},
        {"frames", "frames", "", Better::neither, Format::count},
        {"fingerprint", "pairs of the first 3 frames", "", Better::neither, Format::text}}});
  results.declare({"throughput_growth",
                   "throughput",
                   "exponents of growth: time = a * objects^exponent",
                   {"scene", "partition", "threads"},
                   {{"exponent", "exponent", "", Better::less}}});
  results.declare({"throughput_simd",
                   "throughput",
                   "speedup by wider instruction sets",
                   {"scene", "objects", "partition", "threads", "isa"},
                   {{"speedup", "speedup", "times", Better::more}}});
  results.declare({"throughput_threads",
                   "throughput",
                   "speedup by threads",
                   {"scene", "objects", "partition", "threads"},
                   {{"speedup", "speedup", "times", Better::more}}});
  results.declare({"throughput_skipped",
                   "throughput",
                   "what was not run, because it would take too long",
                   {"objects", "skipped"},
                   {}});
}

/// What is measured at one size of one scene.
struct ThroughputCell {
  const ReportOptions& options;
  const ReportScene& scene;
  std::size_t objects;

  [[nodiscard]] MeasureOptions race(std::vector<std::string> partitions, std::size_t frames) const {
    return {.scene = scene.argument,
            .recording = scene.recording.get(),
            .objects = objects,
            .seed = options.seed,
            .partitions = std::move(partitions),
            .threads = options.threads,
            .isas = options.isas,
            .frames = frames};
  }
  void add(Results& results, const Run& run, const std::string& command) const;
  [[nodiscard]] std::string command(const Run& run, const std::string& partition) const {
    return scene_words(options, scene, objects) + " --threads " + std::to_string(run.threads) +
           " --isa " + to_string(run.isa) + " --partition " + partition + " --frames " +
           std::to_string(run.frame_ms.size());
  }
};

std::string throughput_fingerprint(const Run& run) {
  const std::size_t frames = std::min(kFingerprintFrames, run.pairs.size());
  return to_hex(std::accumulate(
      run.pairs.begin(), run.pairs.begin() + static_cast<std::ptrdiff_t>(frames), std::uint64_t{0},
      [](std::uint64_t sum, const PairSummary& frame) { return sum + frame.fingerprint; }));
}

std::vector<double> without_first(std::vector<double> values) {
  if (values.size() > 1) values.erase(values.begin());
  return values;
}

std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& value : values) value *= factor;
  return values;
}

void ThroughputCell::add(Results& results, const Run& run, const std::string& command) const {
  const std::vector<double> ms = without_first(run.frame_ms);
  const std::vector<double> update_ms = without_first(run.update_ms);
  const auto n = static_cast<double>(objects);
  Json row{{"scene", scene.name},
           {"objects", objects},
           {"partition", run.engine},
           {"threads", run.threads},
           {"isa", to_string(run.isa)},
           {"frame_ms", to_value(ms)},
           {"us_per_object", to_value(scaled(ms, 1e3 / n))},
           {"first_ms", run.frame_ms.front()},
           {"pairs", run.pairs_a_frame()},
           {"pairs_per_s", 1e-3 * run.pairs_a_frame() / median_of(ms)},
           {"frames", run.frame_ms.size()},
           {"fingerprint", throughput_fingerprint(run)},
           {"command", command}};
  if (run.median_update_ms() > 0.0) {  // not every library can tell
    row["update_ms"] = to_value(update_ms);
    row["update_share"] = run.median_update_ms() / median_of(ms);
  }
  if (run.bytes != 0) row["bytes_per_object"] = static_cast<double>(run.bytes) / n;
  results.add("throughput", std::move(row));
}

/// Frames that give a steady median in little time.
std::size_t throughput_frames(const ReportOptions& options, std::size_t objects) {
  if (options.quick) return 4;
  if (objects <= 2'000) return 31;
  if (objects <= 20'000) return 21;
  return objects <= kLargestForOneRace ? 11 : 6;
}

std::size_t frames_of_slow(const ReportOptions& options, std::size_t objects) {
  if (options.quick) return kFingerprintFrames;
  return objects <= 20'000 ? 6 : kFingerprintFrames;
}

void note_skipped(Results& results, std::size_t objects, const std::vector<std::string>& skipped,
                  const std::string& option) {
  for (const std::string& text : skipped) {
    results.add("throughput_skipped", {{"objects", objects},
                                       {"skipped", text},
                                       {"command", "bench/run throughput --objects " +
                                                       std::to_string(objects) + option}});
  }
}

/// Partitions that suit the size: those that suit any first, then those that take longer.
struct SplitPartitions {
  std::vector<std::string> fast;
  std::vector<std::string> slow;
};

SplitPartitions split_partitions(Results& results, std::size_t objects) {
  const Partitions partitions = partitions_for({"all"}, objects);
  SplitPartitions split;
  for (const std::string& name : partitions.taken) {
    const bool limited =
        PartitionEngine::largest_for(name) != std::numeric_limits<std::size_t>::max();
    (limited ? split.slow : split.fast).push_back(name);
  }
  note_skipped(results, objects, partitions.skipped, "");
  return split;
}

void run_partitions(Results& results, const ThroughputCell& cell,
                    const std::vector<std::string>& partitions, std::size_t frames) {
  if (partitions.empty()) return;
  std::vector<MeasureOptions> races{cell.race(partitions, frames)};
  if (cell.objects > kLargestForOneRace) {
    races.clear();
    for (const Isa isa : cell.options.isas) {
      races.push_back(cell.race(partitions, frames));
      races.back().isas = {isa};
    }
  }
  for (const MeasureOptions& race : races) {
    const Measurement measured = measure(race);
    for (const Run& run : measured.runs) {
      cell.add(results, run, "bench/run throughput" + cell.command(run, run.engine));
    }
    if (!all_agree(measured.runs)) throw std::runtime_error("not all found the same pairs");
  }
}

/// With as many threads as may be, beside a partition whose pairs theirs must equal.
void run_peers(Results& results, const ThroughputCell& cell, const std::string& beside) {
  MeasureOptions race = cell.race({beside}, frames_of_slow(cell.options, cell.objects));
  race.peers = true;
  race.threads = {cell.options.threads.back()};
  race.isas = {cell.options.isas.back()};
  const Measurement measured = measure(race);
  for (const Run& run : measured.peers()) {
    cell.add(results, run, "bench/run --with-peers throughput --peers" + cell.command(run, beside));
  }
  note_skipped(results, cell.objects, measured.skipped, " --peers");
  if (!all_agree(measured.runs)) throw std::runtime_error("a library found other pairs");
}

bool wants_peers(const ReportOptions& options, std::size_t objects) {
  return options.peers && objects <= kLargestForPeers;
}

void measure_throughput(Results& results, const ReportOptions& options, const ReportScene& scene,
                        std::size_t objects) {
  const ThroughputCell cell{options, scene, objects};
  const SplitPartitions split = split_partitions(results, objects);
  run_partitions(results, cell, split.fast, throughput_frames(options, objects));
  run_partitions(results, cell, split.slow, frames_of_slow(options, objects));
  derive_throughput(results, scene.name, objects);
  const Json where{{"scene", scene.name}, {"objects", objects}};
  if (distinct(results.rows("throughput", where), "fingerprint").size() > 1) {
    throw std::runtime_error("not all found the same pairs");
  }
}

void measure_peers(Results& results, const ReportOptions& options, const ReportScene& scene,
                   std::size_t objects) {
  run_peers(results, {options, scene, objects}, "LinearBvh");
  derive_throughput(results, scene.name, objects);
}

std::vector<ReportStep> plan_throughput(const ReportOptions& options) {
  std::vector<ReportStep> steps;
  for (const ReportScene& scene : options.scenes) {
    for (const std::size_t asked : options.objects) {
      const std::size_t objects = objects_of(scene, asked);
      const auto n = static_cast<double>(objects);
      const std::string what = scene.name + ", " + grouped(objects) + " objects";
      steps.push_back({what, options.quick ? 0.1 : 0.4 + n * 5.5e-5, [=](Results& results) {
                         measure_throughput(results, options, scene, objects);
                       }});
      if (wants_peers(options, objects)) {
        steps.push_back({what + ", other libraries", n * 6e-5, [=](Results& results) {
                           measure_peers(results, options, scene, objects);
                         }});
      }
      if (scene.recording) break;
    }
  }
  return steps;
}

}  // namespace

const ReportSection kThroughputSection{"throughput", "Throughput", declare_throughput,
                                       plan_throughput, show_throughput};

}  // namespace winnow::bench
