#pragma once

#include <winnow/core/column.h>
#include <winnow/core/execution.h>
#include "core/memory/bounds_pool.h"
#include "partitions/tree/kd_order.kernel.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

/// Floats of scratch that it takes to cut so many rows.
[[nodiscard]] constexpr std::size_t kd_scratch(std::size_t rows) noexcept {
  return 6 * rows;
}

/// How rows are cut. To blocks of 16; or to parts of some thousand, which are put in tiles (see
/// tile_order.kernel.h): a quarter of the time, and some percent more tests. Or first to cells by
/// counting, where rows lie about evenly (see coarse_cut.h), which suits many threads: some percent
/// less time again, and as many more tests.
enum class KdParts : std::uint8_t { blocks, tiles, cells };

/// Puts rows in order for a block tree over them: sets of rows are cut in two from the top down, at
/// the middle of the axis along which their centres reach farthest, and only where the first side
/// fills its subtrees of 16^k blocks, so that every node of the implicit tree is one such set
/// (overlap minimizing top-down bulk loading: Lee and Lee, "OMT: overlap minimizing top-down bulk
/// loading algorithm for R-tree", CAiSE 2003). Boxes of all sizes mix well: a cut follows where
/// they lie, and a large box widens no more than the one block that it is in. Rows that lie in
/// heaps are cut to blocks in any case.
///
/// Rows are live, their boxes in the pool's first six columns; `room` is for as many. O(n log n);
/// the same result on any number of threads and any instruction set. False, and `rows` unchanged,
/// if memory is refused.
[[nodiscard]] bool sort_by_kd_cuts(const BoundsPool& pool, std::span<std::uint32_t> rows,
                                   std::uint32_t* room, Column<float>& scratch,
                                   const Execution& execution, KdParts parts = KdParts::tiles);

/// The same in parts, between which the boxes may change: it goes by where they were at the start.
class KdCuts {
 public:
  /// Begins. Rows and scratch stay where they are until the end, and are nobody else's. False if
  /// memory is refused.
  [[nodiscard]] bool start(const BoundsPool& pool, std::span<std::uint32_t> rows,
                           std::uint32_t* room, Column<float>& scratch, const Execution& execution,
                           KdParts parts = KdParts::tiles);
  /// Goes on with about `work` cuts of a row each; true when the rows are sorted.
  bool advance(std::size_t work, const Execution& execution);

 private:
  static constexpr std::size_t kMostSets = 64;

  /// A part of the rows that is still to be cut.
  struct Set {
    std::uint32_t begin;
    std::uint32_t count;
  };
  [[nodiscard]] KdSet part_of(const Set& part) const noexcept;
  [[nodiscard]] bool tile_whole(std::size_t& work);
  void cut_coarsely(std::size_t& work, const Execution& execution);
  [[nodiscard]] bool cut_widest(std::size_t& work, const Execution& execution);

  std::span<std::uint32_t> rows_;
  std::uint32_t* room_ = nullptr;
  float* at_[3] = {};
  float* at_room_[3] = {};
  std::array<Set, kMostSets> sets_;
  std::size_t open_ = 0;
  KdParts parts_ = KdParts::tiles;
  // All rows may be put in tiles at once; or, of more, in cells that are then cut further.
  bool whole_ = false;
  bool coarse_ = false;
};

}  // namespace winnow
