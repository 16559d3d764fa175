// Rows about frames of partitions: races of update and self_pairs, the ratios derived from them
// (SIMD, threads, growth with size), and the limit set by memory. bench/commands, bench/goals and
// bench/report call these functions; bench/measure takes the times.

#include "bench/rows/frame_rows.h"

#include "bench/common/sample.h"
#include "bench/measure/core_distance.h"
#include "bench/measure/frame_limit.h"
#include "bench/peers/yardstick.h"
#include "bench/rows/machine.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <stdexcept>

namespace winnow::bench {
namespace {

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

void add_run(Results& results, const NamedScene& scene, const Measurement& measured, const Run& run,
             double distance_ns, std::string command) {
  const std::vector<double> ms = without_first(run.frame_ms);
  const std::vector<double> update_ms = without_first(run.update_ms);
  const auto n = static_cast<double>(measured.objects);
  Json row{{"scene", scene.name},
           {"objects", measured.objects},
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
           {"command", std::move(command)}};
  if (run.median_update_ms() > 0.0) {  // some libraries do not time the update separately
    row["update_ms"] = to_value(update_ms);
    row["update_share"] = run.median_update_ms() / median_of(ms);
  }
  if (const auto settled = run.settled_ms(); !settled.empty()) {
    row["worst_ms"] = *std::max_element(settled.begin(), settled.end());
  }
  if (run.bytes != 0) row["bytes_per_object"] = static_cast<double>(run.bytes) / n;
  if (run.threads > 1) row["core_distance_ns"] = distance_ns;
  results.add("throughput", std::move(row));
}

/// A copy of a row's members, because adding rows invalidates pointers to rows.
struct ThroughputTime {
  std::string id;
  Json objects;
  Json partition;
  Json threads;
  Json isa;
  std::string command;
  double ms = 0.0;
};

Json throughput_commands(const std::vector<const ThroughputTime*>& times) {
  std::string commands;
  for (const ThroughputTime* one : times) {
    commands += (commands.empty() ? "" : " && ") + one->command;
  }
  return commands;
}

std::vector<ThroughputTime> times_of(const Results& results, const Json& where) {
  std::vector<ThroughputTime> times;
  for (const Json* row : results.rows("throughput", where)) {
    const double ms = value_of(*row, "frame_ms");
    if (!(ms > 0.0)) continue;
    times.push_back({(*row)["id"], (*row)["objects"], (*row)["partition"], (*row)["threads"],
                     (*row)["isa"], row->value("command", ""), ms});
  }
  return times;
}

const ThroughputTime* time_where(const std::vector<ThroughputTime>& times,
                                 const std::function<bool(const ThroughputTime&)>& holds) {
  const auto at = std::find_if(times.begin(), times.end(), holds);
  return at == times.end() ? nullptr : &*at;
}

/// Returns the narrowest instruction set of this machine that was measured.
Json narrowest_isa(const Results& results, const std::vector<ThroughputTime>& times) {
  for (const Json& isa : results.document()["machine"]["isas"]) {
    if (time_where(times, [&](const ThroughputTime& one) { return one.isa == isa; })) return isa;
  }
  return nullptr;
}

void derive_simd(Results& results, const std::string& scene,
                 const std::vector<ThroughputTime>& times) {
  const Json narrowest = narrowest_isa(results, times);
  for (const ThroughputTime& wide : times) {
    const ThroughputTime* narrow = time_where(times, [&](const ThroughputTime& one) {
      return one.isa == narrowest && one.partition == wide.partition && one.threads == wide.threads;
    });
    if (narrow == nullptr || wide.isa == narrowest) continue;
    results.add("throughput_simd",
                {{"scene", scene},
                 {"objects", wide.objects},
                 {"partition", wide.partition},
                 {"threads", wide.threads},
                 {"isa", wide.isa},
                 {"speedup", narrow->ms / wide.ms},
                 {"command", throughput_commands({narrow, &wide})},
                 {"from", derived("speedup", "ratio", "frame_ms", {narrow->id, wide.id})}});
  }
}

void derive_threads(Results& results, const std::string& scene,
                    const std::vector<ThroughputTime>& times) {
  for (const ThroughputTime& many : times) {
    const ThroughputTime* one_thread = time_where(times, [&](const ThroughputTime& one) {
      return one.threads == 1 && one.partition == many.partition;
    });
    if (one_thread == nullptr || many.threads == 1) continue;
    results.add("throughput_threads",
                {{"scene", scene},
                 {"objects", many.objects},
                 {"partition", many.partition},
                 {"threads", many.threads},
                 {"speedup", one_thread->ms / many.ms},
                 {"command", throughput_commands({one_thread, &many})},
                 {"from", derived("speedup", "ratio", "frame_ms", {one_thread->id, many.id})}});
  }
}

void derive_growth(Results& results, const std::string& scene,
                   const std::vector<ThroughputTime>& times) {
  for (const ThroughputTime& first : times) {
    std::vector<std::string> ids;
    std::vector<const ThroughputTime*> sizes;
    std::vector<GrowthPoint> points;
    for (const ThroughputTime& one : times) {
      if (one.partition != first.partition || one.threads != first.threads) continue;
      ids.push_back(one.id);
      sizes.push_back(&one);
      points.push_back({one.objects.get<double>(), one.ms});
    }
    if (ids.size() < 2 || ids.front() != first.id) continue;
    results.add("throughput_growth", {{"scene", scene},
                                      {"partition", first.partition},
                                      {"threads", first.threads},
                                      {"exponent", fitted_exponent(points)},
                                      {"command", throughput_commands(sizes)},
                                      {"from", derived("exponent", "exponent", "frame_ms", ids)}});
  }
}

}  // namespace

void declare_frames(Results& results) {
  results.declare(
      {"throughput",
       "throughput",
       "a frame of every partition and library",
       {"scene", "objects", "partition", "threads", "isa"},
       {{"frame_ms", "frame", "ms", Better::less},
        {"us_per_object", "frame", "us/object"},
        {"update_ms", "of it update", "ms"},
        {"update_share", "share of the update", "", Better::neither, Format::percent},
        {"worst_ms", "worst frame", "ms"},
        {"first_ms", "first frame", "ms", Better::less},
        {"pairs", "pairs", "", Better::neither, Format::count},
        {"pairs_per_s", "pairs", "million/s", Better::more},
        {"bytes_per_object", "memory", "bytes/object", Better::less},
        {"frames", "frames", "", Better::neither, Format::count},
        {"core_distance_ns", "from core to core", "ns"},
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
                   "skipped partitions, and the reason",
                   {"objects", "skipped"},
                   {}});
}

Measurement add_frame_race(Results& results, const NamedScene& scene, MeasureOptions options,
                           bool only_peers) {
  options.scene = scene.argument;
  options.recording = scene.recording.get();
  Measurement measured = measure(options);
  const bool shared = std::any_of(measured.runs.begin(), measured.runs.end(),
                                  [](const Run& run) { return run.threads > 1; });
  const double distance_ns = shared ? core_distance_ns() : 0.0;
  const auto command = [&](const Run& run, const std::string& partition) {
    return scene.words(measured.objects, options.seed) + " --threads " +
           std::to_string(run.threads) + " --isa " + to_string(run.isa) + " --partition " +
           partition + " --frames " + std::to_string(run.frame_ms.size());
  };
  for (const Run& run : measured.partitions()) {
    if (only_peers) break;
    add_run(results, scene, measured, run, distance_ns,
            "bench/run dev throughput" + command(run, run.engine));
  }
  for (const Run& run : measured.peers()) {
    // A library is raced together with a partition that must find the same pairs.
    const std::string beside =
        measured.partition_runs > 0 ? measured.runs.front().engine : std::string("LinearBvh");
    add_run(results, scene, measured, run, distance_ns,
            (run.engine == kYardstickName ? "bench/run dev throughput --yardstick"
                                          : "bench/run --with-peers dev throughput --peers") +
                command(run, beside));
  }
  note_skipped(results, measured.objects, measured.skipped, options.peers);
  if (!all_agree(measured.runs)) throw std::runtime_error("not all found the same pairs");
  return measured;
}

void note_skipped(Results& results, std::size_t objects, const std::vector<std::string>& skipped,
                  bool peers) {
  for (const std::string& text : skipped) {
    results.add("throughput_skipped",
                {{"objects", objects},
                 {"skipped", text},
                 {"command", "bench/run dev throughput --objects " + std::to_string(objects) +
                                 (peers ? " --peers" : "")}});
  }
}

void derive_frames(Results& results, const std::string& scene, std::size_t objects) {
  const Json isa = results.document()["machine"]["isa"];
  derive_simd(results, scene, times_of(results, {{"scene", scene}, {"objects", objects}}));
  derive_threads(results, scene,
                 times_of(results, {{"scene", scene}, {"objects", objects}, {"isa", isa}}));
  derive_growth(results, scene, times_of(results, {{"scene", scene}, {"isa", isa}}));
}

void declare_limits(Results& results) {
  results.declare(
      {"limits",
       "throughput",
       "a frame over the time of its memory accesses if everything moves and nothing is kept",
       {"scene", "objects"},
       {{"bandwidth_ms", "boxes read, written, read", "ms"},
        {"sort_ms", "a key each sorted", "ms"},
        {"permute_ms", "boxes fetched in another order", "ms"},
        {"emission_ms", "pairs written", "ms"},
        {"limit_ms", "all four", "ms"},
        {"partition", "best partition", "", Better::neither, Format::text},
        {"frame_ms", "its frame", "ms", Better::less},
        {"ratio", "frame / all four", "times", Better::less}}});
}

void add_limit(Results& results, const std::string& scene, std::size_t objects) {
  const Json where{
      {"scene", scene}, {"objects", objects}, {"threads", 1}, {"isa", to_string(active_isa())}};
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
                         {"partition", (*best)["partition"]},
                         {"frame_ms", ms},
                         {"ratio", ms / limit.total()},
                         {"command", "bench/run report --section throughput"}});
}

}  // namespace winnow::bench
