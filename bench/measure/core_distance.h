#pragma once

namespace winnow::bench {

/// Returns the nanoseconds from a write by one thread until another thread, which spins on the
/// variable, reads the value: the median of eleven tries, about 10 ms in total. The speedup by a
/// second thread depends on this time. On a virtual machine it changes while programs run: about 50
/// if both cores share a cache, 200 to 300 if not. 0 on a machine with one core.
[[nodiscard]] double core_distance_ns();

}  // namespace winnow::bench
