#pragma once

#include <winnow/core/column.h>
#include <winnow/core/execution.h>
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

/// Where an axis, or a box, has no end.
inline constexpr float kEndless = std::numeric_limits<float>::infinity();

/// Where and how large the objects of a scene are, from a sample: enough to lay out cells.
struct SceneSample {
  static constexpr std::size_t kLeast = 256;
  static constexpr std::size_t kMost = 2048;

  /// `live` rows of the pool are objects.
  SceneSample(const BoundsPool& pool, std::size_t live, const Execution& execution) noexcept;

  std::size_t objects = 0;  ///< live rows in all
  std::size_t count = 0;    ///< rows in the sample
  std::array<std::array<float, kMost>, 3> edge;
  std::array<float, 3> low{};  ///< of the lower ends, outliers clipped
  std::array<float, 3> high{};
  std::array<double, 3> mean_edge{};  ///< of the bounded ones

  [[nodiscard]] double range(std::size_t axis) const noexcept {
    return static_cast<double>(high[axis]) - static_cast<double>(low[axis]);
  }

 private:
  void choose_rows(const BoundsPool& pool, std::array<std::uint32_t, kMost>& rows) noexcept;
  void look_along(std::size_t axis, const BoundsPool& pool,
                  const std::array<std::uint32_t, kMost>& rows) noexcept;
};

/// What a layout is asked to weigh up.
struct CellDemand {
  double slack_share = 0.3;      ///< of the reach, that objects may drift by on either side
  double cells_per_object = 2;   ///< at most, but for the fewest objects
  bool sweep_fast_axis = false;  ///< the fast axis is sorted, not divided
  /// Objects that ask together: beside the fast axis cells are at least as wide as a cube of them.
  double rows_per_block = 0;

  /// Cells of a layout for so many objects, at most.
  [[nodiscard]] double most_cells(double objects) const noexcept {
    return std::max(8.0, cells_per_object * objects);
  }
};

/// Cells over three axes: which objects are small enough, how large the cells are, which axis runs
/// fastest. Cells of an axis are wide enough that boxes two cells apart cannot touch.
class CellLayout {
 public:
  explicit CellLayout(std::pmr::memory_resource* memory) noexcept : edges_(memory) {}

  /// Lays out cells for the objects of a pool. False if memory is refused; `usable()` is false
  /// afterwards if no layout beats keeping every object in the tree.
  [[nodiscard]] bool choose(const SceneSample& sample, const CellDemand& demand) noexcept;

  /// Makes room for a layout of so many cells. False if memory is refused.
  [[nodiscard]] bool reserve(std::size_t cells, Pages pages) noexcept;

  [[nodiscard]] bool usable() const noexcept { return usable_; }
  /// Axes by how fast they run: 0 is the one along which cells of a run follow each other.
  [[nodiscard]] const CellAxis& axis(std::size_t speed) const noexcept { return axes_[speed]; }
  [[nodiscard]] std::size_t cells() const noexcept {
    return std::size_t{axes_[0].count} * axes_[1].count * axes_[2].count;
  }
  /// How far an object may drift along the fast axis if that is swept.
  [[nodiscard]] float drift() const noexcept { return drift_; }

  static constexpr std::uint32_t kNoCell = 0xFFFFFFFFU;
  /// Writes the cell of every row, as cell_of says; kNoCell for empty rows. There is room for whole
  /// blocks.
  void find_cells(const BoundsPool& pool, std::uint32_t* cell,
                  const Execution& execution) const noexcept;
  /// The cell for a box, or kNoCell if it does not suit any.
  [[nodiscard]] std::uint32_t cell_of(const Structure::Place& box) const noexcept;
  /// True if the box may stay in the cell.
  [[nodiscard]] bool fits(const Structure::Place& box, std::uint32_t cell) const noexcept;
  /// The same for the cell that holds the box's row: cell c holds rows [start[c], start[c + 1]).
  [[nodiscard]] bool fits(const Structure::Place& box, std::size_t row,
                          const Column<std::uint32_t>& start) const noexcept;

  /// Exchanges two layouts of the same memory resource.
  void swap(CellLayout& other) noexcept;

  void release() noexcept;
  [[nodiscard]] Bytes bytes() const noexcept { return edges_.bytes(); }

 private:
  struct Trial;
  [[nodiscard]] bool lay_edges(const Trial& trial, const SceneSample& sample) noexcept;
  void aim_axes() noexcept;

  std::array<CellAxis, 3> axes_;
  Column<float> edges_;
  float drift_ = 0.0F;
  bool usable_ = false;
};

}  // namespace winnow
