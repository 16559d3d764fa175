#pragma once

#include <winnow/core/execution.h>
#include <winnow/core/memory.h>
#include "core/memory/bounds_pool.h"
#include "partitions/structures/cells/cells.kernel.h"
#include "partitions/structures/structure.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory_resource>

namespace winnow {

/// The bound of an axis or box without an end.
inline constexpr float kEndless = std::numeric_limits<float>::infinity();

/// Positions and sizes of a sample of a scene's objects, for the layout of cells.
struct SceneSample {
  static constexpr std::size_t kMinSampled = 256;
  static constexpr std::size_t kMaxSampled = 2048;

  /// Samples the pool, of which `live` rows have an object.
  SceneSample(const BoundsPool& pool, std::size_t live, const Execution& execution) noexcept;

  std::size_t objects = 0;  ///< live rows of the pool
  std::size_t count = 0;    ///< rows in the sample
  std::array<std::array<float, kMaxSampled>, 3> edge;
  std::array<float, 3> low{};  ///< range of lower bounds, without outliers
  std::array<float, 3> high{};
  std::array<double, 3> mean_edge{};  ///< of the bounded edges

  [[nodiscard]] double range(std::size_t axis) const noexcept {
    return static_cast<double>(high[axis]) - static_cast<double>(low[axis]);
  }

 private:
  void choose_rows(const BoundsPool& pool, std::array<std::uint32_t, kMaxSampled>& rows) noexcept;
  void sample_along(std::size_t axis, const BoundsPool& pool,
                    const std::array<std::uint32_t, kMaxSampled>& rows) noexcept;
};

/// Requirements of a structure for its layout.
struct CellRequirements {
  double slack_share = 0.3;      ///< of the reach: how far objects may drift on either side
  double cells_per_object = 2;   ///< at most, except with few objects
  bool sweep_fast_axis = false;  ///< the fast axis is sorted, not divided
  /// Number of rows that are tested together. On axes other than the fast one, cells are at least
  /// as wide as a cube that contains this many rows. If it is 0, there is no limit.
  double rows_per_block = 0;

  /// The maximum number of cells for `objects` objects.
  [[nodiscard]] double max_cells(double objects) const noexcept {
    return std::max(8.0, cells_per_object * objects);
  }
};

/// Cells over three axes: their size, the order of axes, and the maximum edge of objects in cells.
/// Cells are wide enough that boxes two cells apart cannot touch.
class CellLayout {
 public:
  explicit CellLayout(std::pmr::memory_resource* memory) noexcept : edges_(memory) {}

  /// Chooses the layout with the lowest estimated cost. Returns false if an allocation fails.
  /// `usable()` is false afterwards if no layout is better than keeping all objects in the tree.
  [[nodiscard]] bool choose(const SceneSample& sample, const CellRequirements& demand) noexcept;

  /// Makes room for a layout of `cells` cells. Returns false if an allocation fails.
  [[nodiscard]] bool reserve(std::size_t cells, Pages pages) noexcept;

  [[nodiscard]] bool usable() const noexcept { return usable_; }
  /// Returns axis `speed` in the order in which cells are numbered: cells along axis 0 (the fast
  /// axis) are consecutive.
  [[nodiscard]] const CellAxis& axis(std::size_t speed) const noexcept { return axes_[speed]; }
  [[nodiscard]] std::size_t cells() const noexcept {
    return std::size_t{axes_[0].count} * axes_[1].count * axes_[2].count;
  }
  /// How far an object may drift along the fast axis if that axis is swept.
  [[nodiscard]] float drift() const noexcept { return drift_; }

  static constexpr std::uint32_t kNoCell = 0xFFFFFFFFU;
  /// Writes cell_of() of every row, and kNoCell for empty rows. `cell` has room for whole blocks.
  void find_cells(const BoundsPool& pool, std::uint32_t* cell,
                  const Execution& execution) const noexcept;
  /// Returns the cell for a box, or kNoCell if the box is too large.
  [[nodiscard]] std::uint32_t cell_of(const Structure::ObjectBox& box) const noexcept;
  /// True if the box may stay in the cell.
  [[nodiscard]] bool fits(const Structure::ObjectBox& box, std::uint32_t cell) const noexcept;
  /// As above for the cell of the row; cell c contains rows [start[c], start[c + 1]).
  [[nodiscard]] bool fits(const Structure::ObjectBox& box, std::size_t row,
                          const Column<std::uint32_t>& start) const noexcept;

  /// Swaps two layouts with the same memory resource.
  void swap(CellLayout& other) noexcept;

  void release() noexcept;
  [[nodiscard]] Bytes bytes() const noexcept { return edges_.bytes(); }

 private:
  struct LayoutTrial;
  [[nodiscard]] bool lay_edges(const LayoutTrial& trial, const SceneSample& sample) noexcept;
  void set_axis_pointers() noexcept;

  std::array<CellAxis, 3> axes_;
  Column<float> edges_;
  float drift_ = 0.0F;
  bool usable_ = false;
};

}  // namespace winnow
