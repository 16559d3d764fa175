#include "bench/measure/footprint.h"

#include "bench/common/arena.h"
#include "bench/contenders/partition_engine.h"
#include "bench/measure/resident_set.h"

#include <numeric>

namespace winnow::bench {

Held measure_held(const std::string& partition, FrameSource& source, int threads) {
  Held held;
  held.partition = partition;
  PartitionEngine engine(partition, threads);
  std::vector<std::uint32_t> rows(source.objects());
  std::iota(rows.begin(), rows.end(), 0U);
  Arenas(threads).run(threads, [&] {
    engine.start(source.boxes());
    held.peak_first = engine.memory().peak();
    engine.forget_peak();
    for (std::size_t f = 1; f < kFootprintFrames; ++f) {
      const std::size_t known = source.boxes().size();
      if (!source.advance()) break;
      engine.frame(std::span(rows).first(known), source.boxes());
    }
    held.objects = source.boxes().size();
    held.peak_later = engine.memory().peak();
  });
  held.footprint = engine.partition().footprint();
  held.buffer = engine.buffer().footprint();
  held.outstanding = engine.memory().outstanding();
  const std::size_t with = resident_bytes();
  engine.drop_partition();
  const std::size_t without = resident_bytes();
  held.resident = with > without ? with - without : 0;
  return held;
}

}  // namespace winnow::bench
