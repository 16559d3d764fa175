#include "bench/rows/cold_rows.h"

#include <winnow/simd/isa.h>
#include "bench/common/sample.h"
#include "bench/measure/cold_frames.h"

#include <algorithm>

namespace winnow::bench {
namespace {

// Returns the median time of a partition's first frame on pages that were used before.
double touched_ms(const ColdRace& race, const std::string& partition) {
  const auto one = std::ranges::find_if(race.frames, [&](const ColdFrames& frames) {
    return frames.partition == partition && frames.memory == kTouched;
  });
  return median_of(one->total_ms);
}

}  // namespace

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
             {"command", "bench/run dev cold" + scene.words(count, seed) + " --threads " +
                             std::to_string(threads) + " --isa " + isa_name() + " --partition " +
                             one.partition}};
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

}  // namespace winnow::bench
