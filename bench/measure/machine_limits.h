#pragma once

#include <cstddef>
#include <cstdint>

namespace winnow::bench {

/// Lower bounds, in milliseconds, for a frame in which every box moves and all pairs are found
/// without data from earlier frames. Each part is timed as a simple loop on one thread of this
/// machine, on data of the scene's size.
struct FrameLimit {
  double bandwidth = 0.0;  ///< reads boxes, writes columns and reads columns, once each
  double sort = 0.0;       ///< radix sort with one key per object
  double permute = 0.0;    ///< reads boxes in random order
  double emission = 0.0;   ///< writes pairs

  [[nodiscard]] double total() const { return bandwidth + sort + permute + emission; }
};

/// Measures the limits; each is the minimum of `repeats` measurements.
[[nodiscard]] FrameLimit measure_frame_limit(std::size_t objects, std::size_t pairs,
                                             int repeats = 9);

/// Returns the nanoseconds from a write by one thread until another thread, which spins on the
/// variable, reads the value: the median of eleven tries, about 10 ms in total. The speedup by a
/// second thread depends on this time. On a virtual machine it changes while programs run: about 50
/// if both cores share a cache, 200 to 300 if not. 0 on a machine with one core.
[[nodiscard]] double core_distance_ns();

}  // namespace winnow::bench
