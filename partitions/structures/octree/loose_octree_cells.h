#pragma once

#include "core/memory/bounds_pool.h"
#include "partitions/structures/cells/cell_layout.h"

#include <array>
#include <cstdint>

namespace winnow {

/// The cells of a loose octree, or of a quadtree if two axes are divided. Cells of level l are the
/// root halved l times along each divided axis. A cell is loose: boxes may extend beyond it on
/// either side by half of (loose factor - 1) of its edge.
///
/// A box belongs to the cell of its centre on the finest level whose loose cells can contain boxes
/// of its size. On the finest level, cells contain 16 objects on average: objects that are small
/// compared with their distances need no finer levels.
class LooseOctreeCells {
 public:
  /// Places the root over the bulk of a scene. If `axes` is 2, it divides the two axes with the
  /// most room in units of the objects' edges; if `axes` is 3, it divides all axes, except one
  /// along which the world is at most two of the finest cells thick. Returns false if there are too
  /// few objects, or all are at one place.
  [[nodiscard]] bool choose(const SceneSample& sample, std::size_t axes, float loose) noexcept;

  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;
  /// Cells are loose by this additional share of their edge, so that a box that barely fits may
  /// still move. A box that has moved this far widens its block of rows, but the additional tests
  /// cost less than a build.
  static constexpr double kSpare = 0.75;
  /// Writes the sort key of each row of [begin, end): the level, coarse levels first, and within a
  /// level the place on a Hilbert curve through cells much finer than the level's. kNone if the box
  /// is too large or outside the root.
  void find_keys(const BoundsPool& pool, std::size_t begin, std::size_t end,
                 std::uint32_t* key) const noexcept;
  /// The number of low bits in which keys of one cell may differ.
  [[nodiscard]] unsigned bits_within_cell(std::uint32_t key) const noexcept;

  /// Returns the level and Morton code (the linear code of Gargantini, "An effective way to
  /// represent quadtrees", CACM 25(12), 1982) of a key's cell.
  [[nodiscard]] std::uint32_t code_of(std::uint32_t key) const noexcept;

  /// Bounds for the boxes of a cell, by divided axis.
  struct CellBounds {
    std::array<float, 3> low;
    std::array<float, 3> high;
  };
  /// Returns the bounds of the cell with this code (see code_of). loose_bounds returns the bounds
  /// of the loose cell, which is larger on each side by reach_ + kSpare times the cell's edge.
  [[nodiscard]] CellBounds cell_bounds(std::uint32_t code) const noexcept {
    return bounds_of(code, 0.0);
  }
  [[nodiscard]] CellBounds loose_bounds(std::uint32_t code) const noexcept {
    return bounds_of(code, reach_ + kSpare);
  }

  /// True if the boxes of rows [begin, end) are within the bounds. Empty rows always are.
  [[nodiscard]] bool contains_rows(const CellBounds& bounds, const BoundsPool& pool,
                                   std::size_t begin, std::size_t end) const noexcept;

  /// As above, for one box.
  [[nodiscard]] bool contains_box(const CellBounds& bounds,
                                  const Structure::ObjectBox& box) const noexcept;

  /// The number of divided axes; axis(k) is the axis of entry k of CellBounds.
  [[nodiscard]] std::size_t axes() const noexcept { return axes_; }
  [[nodiscard]] std::uint32_t axis(std::size_t k) const noexcept { return axis_[k]; }
  [[nodiscard]] std::uint32_t levels() const noexcept { return finest_ + 1; }

 private:
  [[nodiscard]] CellBounds bounds_of(std::uint32_t code, double reach) const noexcept;
  using BoxColumns = std::array<const float*, 6>;  // lower bounds, then upper bounds
  [[nodiscard]] std::uint32_t level_of(float longest) const noexcept;
  template <typename Curve>
  void find_some_keys(const BoxColumns& box, std::size_t first, std::size_t count,
                      std::uint32_t* key) const noexcept;

  static constexpr std::size_t kMaxLevels = 15;
  static constexpr std::size_t kTogether = 128;

  std::array<std::uint32_t, 3> axis_{};
  std::array<double, 3> origin_{};
  double edge_ = 0.0;                         // of the root
  double scale_ = 0.0;                        // finest places per unit of length
  double reach_ = 1.0;                        // beyond a cell on either side, in its edges
  std::array<double, kMaxLevels> longest_{};  // maximum edge of a box, by level
  std::size_t axes_ = 3;
  unsigned bits_ = 9;  // of a place, by axis
  std::uint32_t finest_ = 0;
};

}  // namespace winnow
