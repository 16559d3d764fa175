// Rows about frames of partitions and of other libraries: races of update and self_pairs, what is
// derived from them (SIMD, threads, growth with size, the limit set by memory), first frames, and
// frames on a pool of threads. bench/measure takes the times.

#include "bench/rows/rows.h"

#include "bench/common/thread_pool.h"
#include "bench/contenders/partition_engine.h"
#include "bench/measure/cold_frames.h"
#include "bench/measure/machine_limits.h"
#include "bench/peers/peers.h"
#include "bench/rows/machine.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <stdexcept>

namespace winnow::bench {
namespace {

Measurement race_on(const NamedScene& scene, MeasureOptions options) {
  options.scene = scene.argument;
  options.recording = scene.recording.get();
  return measure(options);
}

void require_same_pairs(const Measurement& measured) {
  if (!all_agree(measured.runs)) throw std::runtime_error("not all found the same pairs");
}

std::string throughput_fingerprint(const Run& run) {
  std::uint64_t sum = 0;
  for (std::size_t f = 0; f < std::min(kFingerprintFrames, run.pairs.size()); ++f) {
    sum += run.pairs[f].fingerprint;
  }
  return to_hex(sum);
}

/// Returns the members that rows of runs share.
Json row_of_run(const NamedScene& scene, const Measurement& measured, std::uint64_t seed,
                const Run& run) {
  const bool is_yardstick = run.engine == kYardstickName;
  const char* const command = is_yardstick          ? "dev throughput --yardstick"
                              : is_peer(run.engine) ? "--with-peers dev throughput --peers"
                                                    : "dev throughput";
  // A library is raced together with a partition that must find the same pairs.
  const std::string partition = !is_peer(run.engine)          ? run.engine
                                : measured.partition_runs > 0 ? measured.runs.front().engine
                                                              : "LinearBvh";
  return {{"scene", scene.name},
          {"objects", measured.objects},
          {"partition", run.engine},
          {"threads", run.threads},
          {"first_ms", run.frame_ms.front()},
          {"pairs", run.pairs_a_frame()},
          {"command", command_text(command, scene.words(measured.objects, seed),
                                   settings_text(run.threads, run.isa), " --partition ", partition,
                                   " --frames ", run.frame_ms.size())}};
}

/// Adds the members of a row of `throughput` and the row.
void add_run(Results& results, Json row, const Run& run, double distance_ns) {
  const auto ms = run.later_ms();
  row.update({{"isa", to_string(run.isa)},
              {"frame_ms", to_value(ms)},
              {"pairs_per_s", 1e-3 * run.pairs_a_frame() / median_of(ms)},
              {"frames", run.frame_ms.size()},
              {"fingerprint", throughput_fingerprint(run)}});
  if (run.median_update_ms() > 0.0) {  // some libraries do not time the update separately
    row["update_ms"] = to_value(run.later_update_ms());
    row["update_share"] = run.median_update_ms() / median_of(ms);
  }
  if (const auto settled = run.settled_ms(); !settled.empty()) {
    row["worst_ms"] = spread_of(settled).max;
  }
  if (run.bytes != 0) {
    row["bytes_per_object"] = static_cast<double>(run.bytes) / row["objects"].get<double>();
  }
  if (run.threads > 1) row["core_distance_ns"] = distance_ns;
  results.add("throughput", std::move(row));
}

Json keys_of_row(const Json& row, const std::string& family) {
  Json keys;
  for (const std::string& key : keys_of(family)) keys[key] = row[key];
  return keys;
}

std::string commands_of(const std::vector<const Json*>& rows) {
  std::string commands;
  for (const Json* row : rows) {
    commands += (commands.empty() ? "" : " && ") + (*row)["command"].get<std::string>();
  }
  return commands;
}

/// Adds the speedup of each row over the row that differs from it only in `by`, which is `base`
/// there.
void derive_speedups(Results& results, const std::string& family, const Json& where,
                     const std::string& by, const Json& base) {
  for (const Json* row : results.rows("throughput", where)) {
    Json base_keys = keys_of_row(*row, "throughput");
    base_keys[by] = base;
    const Json* slow = results.row("throughput", base_keys);
    if (slow == nullptr || slow == row) continue;
    Json speedup = keys_of_row(*row, family);
    speedup["speedup"] = value_of(*slow, "frame_ms") / value_of(*row, "frame_ms");
    speedup["command"] = commands_of({slow, row});
    results.add(family, std::move(speedup));
  }
}

void derive_growth(Results& results, Json where) {
  for (const Json* first : results.rows("throughput", where)) {
    for (const char* key : {"partition", "threads"}) where[key] = (*first)[key];
    const auto sizes = results.rows("throughput", where);
    if (sizes.size() < 2 || sizes.front() != first) continue;
    std::vector<GrowthPoint> points;
    for (const Json* row : sizes) {
      points.push_back({value_of(*row, "objects"), value_of(*row, "frame_ms")});
    }
    Json growth = keys_of_row(*first, "throughput_growth");
    growth["exponent"] = fitted_exponent(points);
    growth["command"] = commands_of(sizes);
    results.add("throughput_growth", std::move(growth));
  }
}

/// Returns the spread of the frames after a partition has settled; if there are none, of the frames
/// after the first.
Spread settled_spread(const Run& run) {
  const auto settled = run.settled_ms();
  return settled.empty() ? run.frame_spread() : spread_of(settled);
}

/// Returns the median time of a partition's first frame on pages that were used before.
double touched_ms(const ColdRace& race, const std::string& partition) {
  const auto one = std::ranges::find_if(race.frames, [&](const ColdFrames& frames) {
    return frames.partition == partition && frames.memory == kTouched;
  });
  return median_of(one->times.at("total_ms"));
}

}  // namespace

Measurement add_frame_race(Results& results, const NamedScene& scene, MeasureOptions options,
                           bool only_peers) {
  Measurement measured = race_on(scene, options);
  const bool shared =
      std::ranges::any_of(measured.runs, [](const Run& run) { return run.threads > 1; });
  const double distance_ns = shared ? core_distance_ns() : 0.0;
  for (const Run& run : only_peers ? measured.peers() : std::span<const Run>(measured.runs)) {
    add_run(results, row_of_run(scene, measured, options.seed, run), run, distance_ns);
  }
  note_skipped(results, measured.objects, measured.skipped, options.peers);
  require_same_pairs(measured);
  return measured;
}

void note_skipped(Results& results, std::size_t objects, const std::vector<std::string>& skipped,
                  bool peers) {
  for (const std::string& text : skipped) {
    results.add(
        "throughput_skipped",
        {{"objects", objects},
         {"skipped", text},
         {"command", command_text("dev throughput --objects ", objects, peers ? " --peers" : "")}});
  }
}

void derive_frames(Results& results, const std::string& scene, std::size_t objects) {
  const Json size{{"scene", scene}, {"objects", objects}};
  for (const std::string& narrowest : isa_names()) {
    Json where = size;
    where["isa"] = narrowest;
    if (results.row("throughput", where) == nullptr) continue;
    derive_speedups(results, "throughput_simd", size, "isa", narrowest);
    break;
  }
  derive_speedups(results, "throughput_threads",
                  {{"scene", scene}, {"objects", objects}, {"isa", isa_name()}}, "threads", 1);
  derive_growth(results, {{"scene", scene}, {"isa", isa_name()}});
}

void add_limit(Results& results, const std::string& scene, std::size_t objects) {
  const Json where{{"scene", scene}, {"objects", objects}, {"threads", 1}, {"isa", isa_name()}};
  const Json* best = nullptr;
  for (const Json* row : results.rows("throughput", where)) {
    if (is_peer((*row)["partition"].get<std::string>())) continue;
    if (best == nullptr || value_of(*row, "frame_ms") < value_of(*best, "frame_ms")) best = row;
  }
  if (best == nullptr) return;
  const FrameLimit limit =
      measure_frame_limit(objects, static_cast<std::size_t>(value_of(*best, "pairs")));
  const double ms = value_of(*best, "frame_ms");
  results.add("limits", {{"scene", scene},
                         {"objects", objects},
                         {"bandwidth_ms", limit.bandwidth},
                         {"sort_ms", limit.sort},
                         {"permute_ms", limit.permute},
                         {"emission_ms", limit.emission},
                         {"limit_ms", limit.total()},
                         {"partition", word_of((*best)["partition"].get<std::string>())},
                         {"frame_ms", ms},
                         {"ratio", ms / limit.total()},
                         {"command", "bench/run report --section throughput"}});
}

void add_every_scene(Results& results, const NamedScene& scene, MeasureOptions options) {
  options.partitions = unlimited_partitions();
  const Measurement raced = race_on(scene, options);
  const Run& last = raced.runs.back();
  const double yardstick_ms = last.engine == kYardstickName ? settled_spread(last).median : 0.0;
  for (const Run& run : raced.runs) {
    const Spread settled = settled_spread(run);
    Json row = row_of_run(scene, raced, options.seed, run);
    row.update({{"median_ms", settled.median},
                {"worst_ms", settled.max},
                {"worst_ratio", settled.max / settled.median}});
    if (yardstick_ms > 0.0) row["over_yardstick"] = settled.median / yardstick_ms;
    results.add("every_scene", std::move(row));
  }
  require_same_pairs(raced);
}

std::string partition_command(const std::string& command, const NamedScene& scene,
                              const MeasureOptions& options, const std::string& partition) {
  return command_text(command, scene.words(scene.objects(options.objects), options.seed),
                      settings_text(options.threads.front()), " --partition ", partition);
}

void add_throughput(Results& results, const NamedScene& scene, const MeasureOptions& options) {
  add_frame_race(results, scene, options);
  derive_frames(results, scene.name, options.objects);
}

void add_cold(Results& results, const NamedScene& scene, const MeasureOptions& options) {
  constexpr std::size_t kRounds = 7;
  const int threads = options.threads.front();
  const auto source = scene.source(options.objects, options.seed);
  const std::size_t count = source->objects();
  const ColdRace race =
      race_cold_frames(source->boxes(), partitions_for(options.partitions, count).taken, threads,
                       options.frames != 0 ? options.frames : kRounds, options.yardstick);
  for (const ColdFrames& one : race.frames) {
    Json row{{"scene", scene.name},
             {"objects", count},
             {"partition", one.partition},
             {"memory", one.memory},
             {"threads", threads},
             {"command", partition_command("dev cold", scene, options, one.partition)}};
    for (const auto& [name, ms] : one.times) row[name] = to_value(ms);
    const double total = median_of(one.times.at("total_ms"));
    if (one.memory != kTouched) {
      row["over_pages"] =
          (total - touched_ms(race, one.partition)) / median_of(one.times.at("pages_ms"));
    }
    if (!race.yardstick_ms.empty()) {
      row["yardstick_ms"] = to_value(race.yardstick_ms);
      row["over_yardstick"] = total / median_of(race.yardstick_ms);
    }
    results.add("cold", std::move(row));
  }
}

void add_hosts(Results& results, const NamedScene& scene, const MeasureOptions& options) {
  constexpr std::size_t kFrames = 101;
  constexpr std::size_t kWarmingFrames = 5;
  const int threads = options.threads.front();
  const std::size_t objects = scene.objects(options.objects);
  for (const std::string& partition : partitions_for(options.partitions, objects).taken) {
    const auto source = scene.source(options.objects, options.seed);
    ThreadPool pool(static_cast<std::size_t>(threads));
    std::vector<Contender> contenders;
    contenders.push_back({std::make_unique<PartitionEngine>(partition, threads), threads});
    contenders.push_back(
        {std::make_unique<PartitionEngine>(partition, Execution::on(pool.jobs())), 1});
    const std::size_t frames = options.frames != 0 ? options.frames : kFrames;
    const std::vector<Run> runs =
        race(*source, contenders, {.frames = kWarmingFrames + frames, .block = 1});
    if (!all_agree(runs)) throw std::runtime_error("the threads of a pool find other pairs");
    const auto ms_of = [&](const Run& run) {
      return std::span(run.frame_ms).subspan(std::min(kWarmingFrames, run.frame_ms.size()));
    };
    results.add("hosts", {{"scene", scene.name},
                          {"objects", objects},
                          {"partition", partition},
                          {"threads", threads},
                          {"arena_ms", to_value(ms_of(runs[0]))},
                          {"pool_ms", to_value(ms_of(runs[1]))},
                          {"over_arena", median_of(ms_of(runs[1])) / median_of(ms_of(runs[0]))},
                          {"command", partition_command("dev hosts", scene, options, partition)}});
  }
}

}  // namespace winnow::bench
