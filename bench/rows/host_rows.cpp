#include "bench/rows/host_rows.h"

#include <winnow/simd/isa.h>
#include "bench/common/sample.h"
#include "bench/measure/host_race.h"

namespace winnow::bench {

void add_hosts(Results& results, const NamedScene& scene, std::size_t objects, std::uint64_t seed,
               const std::vector<std::string>& partitions, int threads, std::size_t frames) {
  for (const std::string& partition : partitions) {
    const auto source = scene.source(objects, seed);
    const std::size_t count = source->objects();
    const HostRace race = race_hosts(*source, partition, threads, frames);
    results.add("hosts", {{"scene", scene.name},
                          {"objects", count},
                          {"partition", partition},
                          {"threads", threads},
                          {"arena_ms", to_value(race.arena_ms)},
                          {"pool_ms", to_value(race.pool_ms)},
                          {"over_arena", median_of(race.pool_ms) / median_of(race.arena_ms)},
                          {"command", "bench/run dev hosts" + scene.words(count, seed) +
                                          " --threads " + std::to_string(threads) + " --isa " +
                                          isa_name() + " --partition " + partition}});
  }
}

}  // namespace winnow::bench
