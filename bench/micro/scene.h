#pragma once

#include <winnow/core/aabb.h>
#include "core/memory/bounds_pool.h"
#include "partitions/rows/row_view.h"
#include "partitions/structures/cells/cells.kernel.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <vector>

namespace winnow::bench {

/// `count` unit cubes at random in a world that holds two per unit volume, as in the scene
/// `uniform`: about two pairs an object.
[[nodiscard]] std::vector<Aabb> random_cubes(std::size_t count);

/// The same cubes, each moved by up to `step` along every axis.
[[nodiscard]] std::vector<Aabb> moved_cubes(const std::vector<Aabb>& cubes, float step);

/// What kernels take: boxes in the columns of a pool, padded, ordered by cells.
struct KernelScene {
  /// How the three axes are divided. One cell on axis 0 makes strips, which are swept along it.
  struct Cells {
    std::array<std::uint32_t, 3> count{1, 1, 1};
  };

  KernelScene(const std::vector<Aabb>& boxes, const Cells& cells, Volume volume = Volume::aabb);

  [[nodiscard]] RowView rows() const;
  [[nodiscard]] std::uint32_t row_count() const { return static_cast<std::uint32_t>(pool.rows()); }
  /// All rows as a batch of queries. Boxes only.
  [[nodiscard]] QueryBatch all_rows() const;

  BoundsPool pool;
  std::array<CellAxis, 3> axis;
  std::vector<std::uint32_t> start;  ///< first row of each cell, and the end
  std::vector<float> key;            ///< lower end of each row on axis 0

 private:
  void lay_cells(const std::vector<Aabb>& boxes, const Cells& cells);
  [[nodiscard]] std::vector<std::uint32_t> order_by_cells(const std::vector<Aabb>& boxes);

  std::array<std::vector<float>, 3> from_;
  std::array<std::vector<float>, 3> to_;
};

/// Room for the pairs of one kernel call, made once.
class SinkBuffer {
 public:
  SinkBuffer() : ids_(2 * (kPairs + kSinkSlack)) {}

  /// An empty sink that cannot grow.
  [[nodiscard]] PairSink sink();

  static constexpr std::size_t kPairs = std::size_t{1} << 18U;

 private:
  std::vector<std::uint32_t> ids_;
};

}  // namespace winnow::bench
