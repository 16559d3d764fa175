#pragma once

#include "bench/micro/scene.h"

#include <benchmark/benchmark.h>

namespace winnow::bench {

/// Times `kernel(sink)`, which writes pairs; an item is one test of a box against a box.
template <typename Kernel>
void run_pair_kernel(benchmark::State& state, SinkBuffer& buffer, Kernel&& kernel) {
  std::uint64_t tests = 0;
  std::int64_t pairs = 0;
  for (auto _ : state) {
    PairSink sink = buffer.sink();
    const std::uint32_t* const begin = sink.cursor;
    if (!kernel(sink)) {
      state.SkipWithError("the room for pairs does not suffice");
      return;
    }
    benchmark::DoNotOptimize(sink.cursor);
    benchmark::ClobberMemory();
    tests += 16 * sink.tests;
    pairs = (sink.cursor - begin) / 2;
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(tests));
  state.counters["pairs"] = static_cast<double>(pairs);
}

}  // namespace winnow::bench
