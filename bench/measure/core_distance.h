#pragma once

namespace winnow::bench {

/// Nanoseconds from a write of one thread to when another, which waits for it, has read it: the
/// median of eleven tries, about 10 ms in all. What two threads gain depends on it, and on a
/// virtual machine it changes while programs run: about 50 where both cores share a cache, and 200
/// to 300 where they do not. 0 on a machine of one core.
[[nodiscard]] double core_distance_ns();

}  // namespace winnow::bench
