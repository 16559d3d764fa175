#pragma once

#include "bench/common/arena.h"
#include "bench/common/sample.h"

namespace winnow::bench {

/// Returns the milliseconds of `work`: CPU time of the thread if `threads` is 1, otherwise
/// wall-clock time in an arena.
double timed(int threads, Arenas& arenas, const auto& work) {
  if (threads == 1) {
    const ThreadStopwatch own_clock;
    work();
    return own_clock.ms();
  }
  double ms = 0.0;
  arenas.run(threads, [&] {
    const Stopwatch clock;
    work();
    ms = clock.ms();
  });
  return ms;
}

}  // namespace winnow::bench
