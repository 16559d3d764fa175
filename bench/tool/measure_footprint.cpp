#include "tool/measure_footprint.h"

#include "engine/arena.h"
#include "engine/partition_engine.h"
#include "tool/resident_set.h"

#include <numeric>

namespace winnow::bench {

Held measure_held(const std::string& partition, FrameSource& source, int threads) {
  Held held;
  held.partition = partition;
  held.objects = source.boxes().size();
  PartitionEngine engine(partition, threads);
  std::vector<std::uint32_t> rows(held.objects);
  std::iota(rows.begin(), rows.end(), 0U);
  Arenas(threads).run(threads, [&] {
    engine.start(source.boxes());
    held.peak_first = engine.memory().peak();
    engine.forget_peak();
    for (std::size_t f = 1; f < kFootprintFrames && source.advance(); ++f) {
      engine.frame(rows, source.boxes());
    }
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

Json to_json(const Held& held, const std::string& scene, int threads) {
  Json row{{"scene", scene},
           {"objects", held.objects},
           {"partition", held.partition},
           {"threads", threads}};
  for (const Purpose& purpose : kPurposes) {
    const Bytes& bytes = held.footprint.*purpose.bytes;
    row[purpose.name] = {{"used", bytes.used}, {"reserved", bytes.reserved}};
  }
  const Bytes total = held.footprint.total();
  const std::size_t bytes = total.reserved - held.footprint.results.reserved;
  row["bytes"] = bytes;
  row["bytes_per_object"] = static_cast<double>(bytes) / static_cast<double>(held.objects);
  row["total"] = {{"used", total.used}, {"reserved", total.reserved}};
  row["pair_buffer"] = held.buffer.total().reserved;
  row["allocated"] = held.outstanding;
  row["peak_first"] = held.peak_first;
  row["peak_later"] = held.peak_later;
  row["resident"] = held.resident;
  row["exact"] = held.exact();
  return row;
}

}  // namespace winnow::bench
