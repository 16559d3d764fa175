#pragma once

#include <cstddef>
#include <cstdint>

namespace winnow::bench {

/// What a frame in which every box moves and all pairs are found anew costs at least if nothing is
/// kept from frame to frame, part by part: each is timed as a plain loop on this machine, one
/// thread, on data of the scene's size. Milliseconds.
struct FrameLimit {
  double bandwidth = 0.0;  ///< boxes read, columns written, columns read, once each
  double sort = 0.0;       ///< one key an object, radix sort
  double permute = 0.0;    ///< boxes fetched in another order than they lie in
  double emission = 0.0;   ///< pairs written

  [[nodiscard]] double total() const { return bandwidth + sort + permute + emission; }
};

/// The least of `repeats` measurements.
[[nodiscard]] FrameLimit measure_frame_limit(std::size_t objects, std::size_t pairs,
                                             int repeats = 9);

}  // namespace winnow::bench
