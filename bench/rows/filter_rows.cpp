#include "bench/rows/filter_rows.h"

#include <winnow/simd/isa.h>
#include "bench/measure/filter_race.h"

#include <stdexcept>

namespace winnow::bench {

void add_filters(Results& results, const NamedScene& scene, std::size_t objects, std::uint64_t seed,
                 const std::vector<std::string>& partitions, std::size_t rounds) {
  const std::size_t count = scene.source(objects, seed)->objects();
  bool wrong = false;
  for (const std::string& partition : partitions) {
    const auto frames = [&] { return scene.source(objects, seed); };
    for (const FilterRow& one : race_filters(frames, partition, rounds)) {
      wrong = wrong || one.wrong != 0;
      results.add("filters", {{"scene", scene.name},
                              {"objects", count},
                              {"partition", partition},
                              {"filters", one.filters},
                              {"question", one.question},
                              {"plain_ms", to_value(one.plain_ms)},
                              {"filtered_ms", to_value(one.filtered_ms)},
                              {"over_plain", one.over_plain()},
                              {"wrong", one.wrong},
                              {"command", "bench/run filters" + scene.words(count, seed) +
                                              " --rounds " + std::to_string(rounds) + " --isa " +
                                              isa_name() + " --partition " + partition}});
    }
  }
  if (wrong) throw std::runtime_error("a query with filters returned a wrong result");
}

}  // namespace winnow::bench
