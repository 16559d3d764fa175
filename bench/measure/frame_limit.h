#pragma once

#include <cstddef>
#include <cstdint>

namespace winnow::bench {

/// What a frame in which every box moves and all pairs are found anew costs at least if nothing is
/// kept from frame to frame, part by part: each is timed as a plain loop on this machine, one
/// thread, on data of the scene's size. Milliseconds.
///
/// What was tried at these limits:
/// - Sort: median cuts cost about half as much again as one sort along Hilbert's curve by classes
/// of
///   size, and save 15 to 45 % of the tests of every frame until the next build. Surface-area cuts
///   save 0 to 10 % more at ten times the cost: that is StaticBvh.
/// - Permute: an update that transposes sixteen boxes in registers and writes six columns takes 0.6
///   of the time of one float after another. What is left is the fetch of a box that lies anywhere.
/// - Tests: sixteen rows ask with one box before they ask one by one, which made frames of grids a
///   third shorter and those of the sweep half as long. Blocks of candidates in registers and dense
///   candidate lists gained nothing more in trees, whose leaves are tighter.
/// - Emission: hits are compressed and written without a branch, 16 at a time with slack behind; on
///   `mixed` a quarter of the frame.
/// - Sizes of 100:1 and 1000:1: median cuts let one large box widen no more than one block, so
/// trees
///   need no classes of size. A grid of levels asks across levels, a loose octree keeps to the
///   order of cells; both win again where sizes lie denser (90 pairs an object).
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
