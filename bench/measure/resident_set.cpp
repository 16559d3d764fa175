#include "bench/measure/resident_set.h"

#include <fstream>
#include <string>

#ifdef __linux__
#include <sys/prctl.h>
#endif
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace winnow::bench {
namespace {

#ifdef __GLIBC__
constexpr int kPage = 4096;
#endif

void give_back_freed() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

}  // namespace

void keep_resident_set_exact() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, kPage);
  mallopt(M_TRIM_THRESHOLD, kPage);
#endif
#ifdef __linux__
  prctl(PR_SET_THP_DISABLE, 1, 0, 0, 0);
#endif
}

std::size_t resident_bytes() {
  give_back_freed();
  // From the page tables: /proc/self/status lags behind by some pages per thread.
  std::ifstream file("/proc/self/smaps_rollup");
  const std::string name = "Anonymous:";
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with(name)) return 1024 * std::stoull(line.substr(name.size()));
  }
  return 0;
}

}  // namespace winnow::bench
