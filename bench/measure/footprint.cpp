#include "bench/measure/footprint.h"

#include "bench/common/arena.h"
#include "bench/contenders/partition_engine.h"

#include <fstream>
#include <numeric>
#include <string>

#ifdef __linux__
#include <sys/prctl.h>
#endif
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace winnow::bench {
namespace {

/// Gives freed memory back to the system, and returns the bytes of anonymous memory, without mapped
/// files, that are then resident; 0 if the system does not provide the number.
std::size_t resident_bytes() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
  // From the page tables: /proc/self/status lags behind by some pages per thread.
  std::ifstream file("/proc/self/smaps_rollup");
  const std::string name = "Anonymous:";
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with(name)) return 1024 * std::stoull(line.substr(name.size()));
  }
  return 0;
}

}  // namespace

void keep_resident_set_exact() {
#ifdef __GLIBC__
  constexpr int kPage = 4096;
  mallopt(M_MMAP_THRESHOLD, kPage);
  mallopt(M_TRIM_THRESHOLD, kPage);
#endif
#ifdef __linux__
  prctl(PR_SET_THP_DISABLE, 1, 0, 0, 0);
#endif
}

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
