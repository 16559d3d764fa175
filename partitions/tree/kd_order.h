#pragma once

#include <winnow/core/execution.h>
#include <winnow/core/memory.h>
#include "core/memory/bounds_pool.h"
#include "partitions/tree/kd_order.kernel.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace winnow {

/// The number of floats of scratch for cutting `rows` rows.
[[nodiscard]] constexpr std::size_t kd_scratch(std::size_t rows) noexcept {
  return 6 * rows;
}

/// How far a set is cut. `blocks`: down to blocks of 16. `tiles`: to sets of some thousand rows,
/// which are sorted in tiles (tile_order.kernel.h); this is faster and costs some percent more
/// tests. `cells`: evenly spread rows are first divided into cells by counting (coarse_cut.h),
/// if they are more than kMaxInTiles, which parallelizes better and costs some percent more
/// tests again.
enum class KdPrecision : std::uint8_t { blocks, tiles, cells };

/// Sorts rows for a block tree over them by k-d cuts: sets of rows are cut in two from the top
/// down, near the median of the axis along which their centres have the largest range. A cut always
/// fills the subtrees of 16^k blocks on its first side, so every node of the implicit tree is one
/// set (Lee and Lee, "OMT: overlap minimizing top-down bulk loading algorithm for R-tree", CAiSE
/// 2003). Boxes of mixed sizes cost little: cuts follow the centres, and a large box widens only
/// its own block and the nodes above. Rows that are concentrated in few places are cut to blocks in
/// any case.
///
/// Rows must be live; their boxes are the pool's first six columns. `room` has space for
/// rows.size() elements. O(n log n). The result is the same for any number of threads and any
/// instruction set. Returns false and leaves `rows` unchanged if an allocation fails.
[[nodiscard]] bool sort_by_kd_cuts(const BoundsPool& pool, std::span<std::uint32_t> rows,
                                   std::uint32_t* room, Column<float>& scratch,
                                   const Execution& execution,
                                   KdPrecision precision = KdPrecision::tiles);

/// As sort_by_kd_cuts, in steps between which boxes may change: the order uses the boxes at the
/// start.
class KdCuts {
 public:
  /// Starts. `rows`, `room` and `scratch` must stay in place and unused by others until the end.
  /// Returns false if an allocation fails.
  [[nodiscard]] bool start(const BoundsPool& pool, std::span<std::uint32_t> rows,
                           std::uint32_t* room, Column<float>& scratch, const Execution& execution,
                           KdPrecision precision = KdPrecision::tiles);
  /// Continues with about `work` cuts of one row each; returns true when the rows are sorted.
  bool advance(std::size_t work, const Execution& execution);

 private:
  static constexpr std::size_t kMaxSets = 64;

  /// A range of rows that is still to be cut.
  struct RowRange {
    std::uint32_t begin;
    std::uint32_t count;
  };
  [[nodiscard]] KdSet set_of(const RowRange& range) const noexcept;
  [[nodiscard]] bool tile_whole(std::size_t& work);
  void cut_coarsely(std::size_t& work, const Execution& execution);
  [[nodiscard]] bool cut_each_in_two(std::size_t& work, const Execution& execution);

  std::span<std::uint32_t> rows_;
  std::uint32_t* room_ = nullptr;
  float* at_[3] = {};
  float* at_room_[3] = {};
  std::array<RowRange, kMaxSets> sets_;
  std::size_t open_ = 0;
  KdPrecision precision_ = KdPrecision::tiles;
  // Pending first steps: tile all rows at once; or, if there are more, divide them into cells.
  bool whole_ = false;
  bool coarse_ = false;
};

}  // namespace winnow
