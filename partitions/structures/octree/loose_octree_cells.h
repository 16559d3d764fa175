#pragma once

#include "core/memory/bounds_pool.h"
#include "partitions/structures/cells/cell_layout.h"

#include <array>
#include <cstdint>

namespace winnow {

/// The cells of a loose octree, or of a quadtree where two axes are divided: cells of level l are
/// the root, halved l times along each divided axis. A cell is loose: boxes may reach out of it on
/// either side by half of (loose factor - 1) of its edge.
///
/// A box belongs to the cell of its centre on the finest level whose loose cells are sure to hold
/// boxes of its size, but on none finer than cells that hold 16 objects on average: what is smaller
/// than the distance between objects needs no level of its own.
class LooseOctreeCells {
 public:
  /// Lays the root over the bulk of a scene. Of 2 `axes` those are divided that have the most room
  /// in units of the objects' edges; of 3 all, but for one along which the world is no thicker than
  /// two of the finest cells. False if the objects are too few, or at one place.
  [[nodiscard]] bool choose(const SceneSample& sample, std::size_t axes, float loose) noexcept;

  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;
  /// Cells are loose by this much of their edge more, so that a box which only just fits may move.
  /// A box that has moved so far widens the block that it is in, and wear tells what that costs: a
  /// build for it would cost more.
  static constexpr double kSpare = 0.75;
  /// Writes where each of the rows [begin, end) stands in the order: by level, coarse ones first,
  /// and within a level along Hilbert's curve through cells much finer than its own. kNone if it is
  /// too large, or lies outside of the root.
  void find_keys(const BoundsPool& pool, std::size_t begin, std::size_t end,
                 std::uint32_t* key) const noexcept;
  /// Keys are of one cell that differ in no more than so many of their lowest bits.
  [[nodiscard]] unsigned bits_within_cell(std::uint32_t key) const noexcept;

  /// Level and Morton code (the linear code of Gargantini, "An effective way to represent
  /// quadtrees", CACM 25(12), 1982) of a key's cell.
  [[nodiscard]] std::uint32_t code_of(std::uint32_t key) const noexcept;

  /// What the boxes of a cell keep to, by divided axis.
  struct Bounds {
    std::array<float, 3> low;
    std::array<float, 3> high;
  };
  /// Bounds of the cell with this level and Morton code, or of the loose cell around it.
  [[nodiscard]] Bounds cell_bounds(std::uint32_t code) const noexcept {
    return bounds_of(code, 0.0);
  }
  [[nodiscard]] Bounds loose_bounds(std::uint32_t code) const noexcept {
    return bounds_of(code, reach_ + kSpare);
  }

  /// True if the boxes of rows [begin, end) lie within the bounds; empty rows do everywhere.
  [[nodiscard]] bool hold(const Bounds& bounds, const BoundsPool& pool, std::size_t begin,
                          std::size_t end) const noexcept;

  /// The same for one box.
  [[nodiscard]] bool holds(const Bounds& bounds, const Structure::Place& box) const noexcept;

  /// Number of divided axes, and the one that bounds have at k.
  [[nodiscard]] std::size_t axes() const noexcept { return axes_; }
  [[nodiscard]] std::uint32_t axis(std::size_t k) const noexcept { return axis_[k]; }
  [[nodiscard]] std::uint32_t levels() const noexcept { return finest_ + 1; }

 private:
  [[nodiscard]] Bounds bounds_of(std::uint32_t code, double reach) const noexcept;
  using BoxColumns = std::array<const float*, 6>;  // lower ends, then upper ends
  [[nodiscard]] std::uint32_t level_of(float longest) const noexcept;
  template <typename Curve>
  void find_some_keys(const BoxColumns& box, std::size_t first, std::size_t count,
                      std::uint32_t* key) const noexcept;

  static constexpr std::size_t kMostLevels = 15;
  static constexpr std::size_t kTogether = 128;

  std::array<std::uint32_t, 3> axis_{};
  std::array<double, 3> origin_{};
  double edge_ = 0.0;                          // of the root
  double scale_ = 0.0;                         // finest places on the root's edge, by its length
  double reach_ = 1.0;                         // out of a cell on either side, in its edges
  std::array<double, kMostLevels> longest_{};  // edge of a box by level, at most
  std::size_t axes_ = 3;
  unsigned bits_ = 9;  // of a place, by axis
  std::uint32_t finest_ = 0;
};

}  // namespace winnow
