// Rows about frames of partitions and of other libraries: races of update and self_pairs, what is
// derived from them (SIMD, threads, growth with size, the limit set by memory), first frames, and
// frames on a pool of threads. bench/measure takes the times.

#include "bench/rows/rows.h"

#include "bench/contenders/partitions.h"
#include "bench/measure/cold_frames.h"
#include "bench/measure/core_distance.h"
#include "bench/measure/frame_limit.h"
#include "bench/measure/host_race.h"
#include "bench/peers/yardstick.h"
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

/// Returns the frames after the first, or the first if it is the only one.
std::span<const double> after_first(std::span<const double> ms) {
  return ms.subspan(ms.size() > 1 ? 1 : 0);
}

void add_run(Results& results, const NamedScene& scene, const Measurement& measured, const Run& run,
             double distance_ns, std::string command) {
  const auto ms = after_first(run.frame_ms);
  Json row{{"scene", scene.name},
           {"objects", measured.objects},
           {"partition", run.engine},
           {"threads", run.threads},
           {"isa", to_string(run.isa)},
           {"frame_ms", to_value(ms)},
           {"first_ms", run.frame_ms.front()},
           {"pairs", run.pairs_a_frame()},
           {"pairs_per_s", 1e-3 * run.pairs_a_frame() / median_of(ms)},
           {"frames", run.frame_ms.size()},
           {"fingerprint", throughput_fingerprint(run)},
           {"command", std::move(command)}};
  if (run.median_update_ms() > 0.0) {  // some libraries do not time the update separately
    row["update_ms"] = to_value(after_first(run.update_ms));
    row["update_share"] = run.median_update_ms() / median_of(ms);
  }
  if (const auto settled = run.settled_ms(); !settled.empty()) {
    row["worst_ms"] = spread_of(settled).max;
  }
  if (run.bytes != 0) {
    row["bytes_per_object"] =
        static_cast<double>(run.bytes) / static_cast<double>(measured.objects);
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

/// The frames of a race by which a library is compared.
struct JudgedFrames {
  std::size_t first = 1;
  std::size_t count = 0;
  bool mean = false;
  std::string name;

  JudgedFrames(const Run& peer, bool grows) : mean(grows) {
    const std::size_t finished = peer.frame_ms.size();
    if (finished > 1) {
      count = finished - 1;
      name = grows ? "mean frame" : "median frame";
      if (peer.gave_up_ms > 0.0) name += " until it gave up";
    } else if (peer.gave_up_ms > 0.0) {
      first = finished;
      count = 1;
      name = first == 0 ? "first frame, given up" : "second frame, given up";
    }
  }

  [[nodiscard]] double of(const Run& run) const {
    if (!are_in(run)) return run.gave_up_ms;
    const auto ms = std::span(run.frame_ms).subspan(first, count);
    if (!mean) return median_of(ms);
    return std::accumulate(ms.begin(), ms.end(), 0.0) / static_cast<double>(count);
  }
  [[nodiscard]] bool are_in(const Run& run) const noexcept {
    return first + count <= run.frame_ms.size();
  }
};

/// Returns the fastest partition with this many threads; null if none ran all of these frames.
const Run* best_of(const Measurement& raced, int threads, const JudgedFrames& frames) {
  const Run* best = nullptr;
  for (const Run& run : raced.partitions()) {
    if (run.threads != threads || !frames.are_in(run)) continue;
    if (best == nullptr || frames.of(run) < frames.of(*best)) best = &run;
  }
  return best;
}

/// Returns the median time of a partition's first frame on pages that were used before.
double touched_ms(const ColdRace& race, const std::string& partition) {
  const auto one = std::ranges::find_if(race.frames, [&](const ColdFrames& frames) {
    return frames.partition == partition && frames.memory == kTouched;
  });
  return median_of(one->total_ms);
}

}  // namespace

Measurement add_frame_race(Results& results, const NamedScene& scene, MeasureOptions options,
                           bool only_peers) {
  Measurement measured = race_on(scene, options);
  const bool shared =
      std::ranges::any_of(measured.runs, [](const Run& run) { return run.threads > 1; });
  const double distance_ns = shared ? core_distance_ns() : 0.0;
  const auto add = [&](const Run& run, const char* command, const std::string& partition) {
    add_run(results, scene, measured, run, distance_ns,
            command_text(command, scene.words(measured.objects, options.seed),
                         settings_text(run.threads, run.isa), " --partition ", partition,
                         " --frames ", run.frame_ms.size()));
  };
  for (const Run& run : measured.partitions()) {
    if (!only_peers) add(run, "dev throughput", run.engine);
  }
  for (const Run& run : measured.peers()) {
    // A library is raced together with a partition that must find the same pairs.
    add(run,
        run.engine == kYardstickName ? "dev throughput --yardstick"
                                     : "--with-peers dev throughput --peers",
        measured.partition_runs > 0 ? measured.runs.front().engine : "LinearBvh");
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
    Json row{{"scene", scene.name},
             {"objects", raced.objects},
             {"partition", run.engine},
             {"threads", run.threads},
             {"median_ms", settled.median},
             {"worst_ms", settled.max},
             {"first_ms", run.frame_ms.front()},
             {"worst_ratio", settled.max / settled.median},
             {"pairs", run.pairs_a_frame()},
             {"command",
              command_text("dev throughput", scene.words(raced.objects, options.seed),
                           settings_text(run.threads, run.isa), " --frames ", run.frame_ms.size(),
                           " --partition ",
                           run.engine == kYardstickName ? "LinearBvh --yardstick" : run.engine)}};
    if (yardstick_ms > 0.0) row["over_yardstick"] = settled.median / yardstick_ms;
    results.add("every_scene", std::move(row));
  }
  require_same_pairs(raced);
}

void add_beside_peers(Results& results, const NamedScene& scene, MeasureOptions options) {
  options.peers = true;
  const Measurement raced = race_on(scene, options);
  for (const Run& peer : raced.peers()) {
    const JudgedFrames frames(peer, raced.grows);
    const Run* best = frames.count > 0 ? best_of(raced, peer.threads, frames) : nullptr;
    if (best == nullptr) continue;
    results.add("beside_peers",
                {{"scene", scene.name},
                 {"objects", raced.objects},
                 {"partition", peer.engine},
                 {"threads", peer.threads},
                 {"of", frames.name},
                 {"times", frames.of(peer) / frames.of(*best)},
                 {"ms", frames.of(peer)},
                 {"best_ms", frames.of(*best)},
                 {"best", best->engine},
                 {"frames", frames.count},
                 {"command", command_text("--with-peers dev throughput --peers",
                                          scene.words(raced.objects, options.seed), " --threads ",
                                          peer.threads, " --partition ", best->engine, " --frames ",
                                          frames.first + frames.count)}});
  }
  require_same_pairs(raced);
}

void add_cold(Results& results, const NamedScene& scene, std::size_t objects, std::uint64_t seed,
              const std::vector<std::string>& partitions, int threads, std::size_t rounds,
              bool yardstick) {
  const auto source = scene.source(objects, seed);
  const std::size_t count = source->objects();
  const ColdRace race = race_cold_frames(source->boxes(), partitions, threads, rounds, yardstick);
  for (const ColdFrames& one : race.frames) {
    Json row{{"scene", scene.name},
             {"objects", count},
             {"partition", one.partition},
             {"memory", one.memory},
             {"threads", threads},
             {"insert_ms", to_value(one.insert_ms)},
             {"build_ms", to_value(one.build_ms)},
             {"pairs_ms", to_value(one.pairs_ms)},
             {"total_ms", to_value(one.total_ms)},
             {"command", command_text("dev cold", scene.words(count, seed), settings_text(threads),
                                      " --partition ", one.partition)}};
    if (!one.ready_ms.empty()) {
      row["reserved_ms"] = to_value(one.reserved_ms);
      row["ready_ms"] = to_value(one.ready_ms);
      row["reserve_ms"] = to_value(one.reserve_ms);
      row["pages_ms"] = to_value(one.pages_ms);
      row["over_pages"] =
          (median_of(one.total_ms) - touched_ms(race, one.partition)) / median_of(one.pages_ms);
    }
    if (!race.yardstick_ms.empty()) {
      row["yardstick_ms"] = to_value(race.yardstick_ms);
      row["over_yardstick"] = median_of(one.total_ms) / median_of(race.yardstick_ms);
    }
    results.add("cold", std::move(row));
  }
}

void add_hosts(Results& results, const NamedScene& scene, std::size_t objects, std::uint64_t seed,
               const std::vector<std::string>& partitions, int threads, std::size_t frames) {
  for (const std::string& partition : partitions) {
    const auto source = scene.source(objects, seed);
    const std::size_t count = source->objects();
    const HostRace race = race_hosts(*source, partition, threads, frames);
    results.add("hosts",
                {{"scene", scene.name},
                 {"objects", count},
                 {"partition", partition},
                 {"threads", threads},
                 {"arena_ms", to_value(race.arena_ms)},
                 {"pool_ms", to_value(race.pool_ms)},
                 {"over_arena", median_of(race.pool_ms) / median_of(race.arena_ms)},
                 {"command", command_text("dev hosts", scene.words(count, seed),
                                          settings_text(threads), " --partition ", partition)}});
  }
}

}  // namespace winnow::bench
