// Micro benchmarks of every kernel and partition on every instruction set, in sizes that stay in
// the cache. Takes Google Benchmark's options; by default repetitions are interleaved at random, so
// that drift of the machine falls on all rows alike, and a summary is printed at the end. With
// --benchmark_format the library's own reporter prints instead.

#include "bench/micro/suite.h"
#include "bench/micro/summary.h"

#include <benchmark/benchmark.h>

#include <array>
#include <string_view>
#include <vector>

int main(int argc, char** argv) {
  using namespace winnow::bench;

  // Before the caller's own, which then win.
  std::array<char[64], 3> defaults{"--benchmark_enable_random_interleaving=true",
                                   "--benchmark_repetitions=9", "--benchmark_min_time=0.02"};
  std::vector<char*> arguments{argv[0]};
  for (char* option : defaults) arguments.push_back(option);
  bool own_format = false;
  for (int i = 1; i < argc; ++i) {
    arguments.push_back(argv[i]);
    own_format |= std::string_view(argv[i]).starts_with("--benchmark_format");
  }
  int count = static_cast<int>(arguments.size());
  arguments.push_back(nullptr);

  add_flat_kernels();
  add_tree_kernels();
  add_cell_kernels();
  add_partitions();
  add_narrow_kernels();
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 1;
  if (own_format) {
    benchmark::RunSpecifiedBenchmarks();
  } else {
    SummaryReporter summary;
    benchmark::RunSpecifiedBenchmarks(&summary);
  }
  benchmark::Shutdown();
  return 0;
}
