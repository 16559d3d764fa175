#include "engine/sample.h"
#include "report/sections/throughput.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace winnow::bench {
namespace {

/// What is needed of a row: rows themselves do not stay where they are while others are added.
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

/// The first of the machine's instruction sets, narrowest first, that was measured.
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

void derive_throughput(Results& results, const std::string& scene, std::size_t objects) {
  const Json isa = results.document()["machine"]["isa"];
  derive_simd(results, scene, times_of(results, {{"scene", scene}, {"objects", objects}}));
  derive_threads(results, scene,
                 times_of(results, {{"scene", scene}, {"objects", objects}, {"isa", isa}}));
  derive_growth(results, scene, times_of(results, {{"scene", scene}, {"isa", isa}}));
}

}  // namespace winnow::bench
