#pragma once

// The interface between a partition and its structure. A structure stores the order of rows of
// bounding volumes; the partition handles objects, queries, pairs and events. SpatialIndex
// (index/spatial_index.h) calls the structure.

#include <winnow/core/debug_draw.h>
#include <winnow/core/memory.h>
#include <winnow/partitions/structures.h>
#include "core/memory/bounds_pool.h"
#include "core/memory/new_in.h"
#include "partitions/rows/row_view.h"
#include "partitions/rows/rows.h"
#include "partitions/tree/block_tree.h"
#include "partitions/tree/kd_order.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>
#include <string_view>

namespace winnow {

class Chooser;
class Structure;
struct StructureCosts;

/// With fewer objects the tree finds all pairs sooner than cells are built.
inline constexpr std::size_t kMinInCells = 256;

/// Constructor arguments of a structure: the rows, and the tree over the regular rows, which
/// SpatialIndex maintains. Both outlive the structure.
struct StructureInput {
  std::pmr::memory_resource* memory;
  const Rows& rows;
  const BlockTree& regular_tree;
  float parameter;  ///< of the StructureKind
};

/// Static description of a kind of structure: a constant in the structure's source file.
struct StructureInfo {
  std::string_view name;
  /// Returns null if an allocation fails.
  Structure* (*make)(const StructureInput&) noexcept;
  /// Destroys a structure that `make` returned, with the same memory resource.
  void (*destroy)(Structure*, std::pmr::memory_resource*) noexcept;
  /// The sizeof of the structure.
  std::size_t bytes;
  /// Costs for the automatic choice; null: never chosen.
  const StructureCosts* costs = nullptr;
  /// Makes the chooser of the automatic structure, or returns null if an allocation fails. Null for
  /// all other structures.
  Chooser* (*make_chooser)(std::pmr::memory_resource*) noexcept = nullptr;
};

template <typename T>
[[nodiscard]] constexpr StructureInfo structure_info(
    std::string_view name, const StructureCosts* costs = nullptr) noexcept {
  return {.name = name,
          .make = [](const StructureInput& input) noexcept -> Structure* {
            return new_in<T>(input.memory, input);
          },
          .destroy =
              [](Structure* structure, std::pmr::memory_resource* memory) noexcept {
                delete_in(memory, static_cast<T*>(structure));
              },
          .bytes = sizeof(T),
          .costs = costs};
}

/// An object that was moved behind all others while a plan is underway, and its former row.
struct RowMove {
  std::uint32_t row;
  ObjectId id;
};

/// The rows of a plan, and its output.
struct RowPlan {
  /// The plan covers rows below `rows`, of which `objects` had an object at its start. Rows may be
  /// added behind them meanwhile.
  std::size_t rows;
  std::size_t objects;
  /// Output: the regular rows in their order; entries of kNoObject become holes. Has room for every
  /// row.
  Column<std::uint32_t>& regular;
  /// Output: all other live rows. Has room for every row.
  Column<std::uint32_t>& rest;
  /// Scratch for sorting, and one entry per row. Both keep their contents between stages until the
  /// rows are in the planned order.
  Column<std::uint64_t>& items;
  Column<std::uint32_t>& list;
  /// Objects moved since the start, by ascending rows.
  std::span<const RowMove> moves;
};

/// The size of a build to reserve memory for, and the scratch columns to reserve.
struct BuildRoom {
  std::size_t objects;  ///< in rows without holes
  Pages pages;
  /// Scratch for sort keys, for entries per row, and for positions.
  Column<std::uint64_t>& items;
  Column<std::uint32_t>& list;
  Column<float>& points;
};

/// Result of a stage of a plan.
enum class PlanStatus : std::uint8_t { out_of_memory, unfinished, done };

class Structure {
 public:
  explicit Structure(const StructureInput& input) noexcept
      : rows_(input.rows), regular_tree_(input.regular_tree) {}
  Structure(const Structure&) = delete;
  Structure& operator=(const Structure&) = delete;

  /// True if all rows are one unordered regular region.
  [[nodiscard]] virtual bool is_flat() const noexcept { return false; }
  /// True if pairs of regular rows are found by the boxes of their blocks. The tree over these
  /// blocks is then rebuilt by each build and refitted by each refresh.
  [[nodiscard]] virtual bool prunes_rows() const noexcept { return false; }
  /// False if the structure reports pairs without testing their volumes.
  [[nodiscard]] virtual bool tests_volumes() const noexcept { return true; }

  // Ordering rows.

  /// Makes room for a build of `room.objects` objects at any positions, so that the build does not
  /// allocate. Returns false if an allocation fails. The default implementation reserves scratch
  /// for k-d cuts of all rows.
  [[nodiscard]] virtual bool reserve(const BuildRoom& room) noexcept {
    return room.points.reserve(kd_scratch(room.objects), room.pages);
  }
  /// The maximum number of holes that a plan leaves.
  [[nodiscard]] virtual std::size_t max_holes() const noexcept { return 0; }

  /// Computes the regular rows and their order, one stage per call, starting with stage 0. Each
  /// stage takes about as long as one pass over all rows. The default implementation makes every
  /// live row part of the rest.
  ///
  /// Between two stages objects may move and rows may become empty, but no row is reused for
  /// another object. The decisions of a plan may be out of date when it is done: rows that no
  /// longer fit are found then. Until `finish_build` the structure answers queries in the order of
  /// the last build. An unfinished plan is dropped.
  [[nodiscard]] virtual PlanStatus plan(const RowPlan& plan, unsigned) noexcept {
    append_all_to_rest(plan);
    return PlanStatus::done;
  }
  /// Makes every live row part of the rest.
  void append_all_to_rest(const RowPlan& plan) const noexcept;
  /// Returns the current row of the object that was in `row` when the plan was started, or `row` if
  /// the object was removed. O(log moves) for rows that have become empty.
  [[nodiscard]] std::size_t current_row(const RowPlan& plan, std::size_t row) const noexcept;
  /// Appends the rows of `rest` to `order` in the order of the tree's blocks of 16. Called only if
  /// environments are not in use; may reorder `rest`. If it returns `RestOrder::none`, the caller
  /// orders the rows by k-d cuts.
  enum class RestOrder : std::uint8_t { none, done, out_of_memory };
  [[nodiscard]] virtual RestOrder order_rest(std::span<std::uint32_t>,
                                             Column<std::uint32_t>&) noexcept {
    return RestOrder::none;
  }
  /// Precision of the rest's order in the first build if there were no queries for rays or regions.
  [[nodiscard]] virtual KdPrecision first_precision() const noexcept { return KdPrecision::tiles; }
  /// The price of a build in tests of 16 volumes per object, for comparison with wear. The default
  /// was measured.
  [[nodiscard]] virtual std::uint64_t build_price() const noexcept { return 12; }
  /// The approximate number of passes over all rows in a plan, including the order of the rest.
  [[nodiscard]] virtual std::size_t plan_passes() const noexcept { return 4; }
  /// Called when the rows are in the planned order. `foreseen`: the plan was started in an earlier
  /// refresh, so that objects may have moved since.
  virtual void finish_build(const RowPlan&, bool /*foreseen*/) noexcept {}

  // Rows that no longer fit.

  /// A box, current or predicted.
  struct ObjectBox {
    std::array<float, 3> low;
    std::array<float, 3> high;
  };
  [[nodiscard]] ObjectBox box_of_row(std::size_t row) const noexcept {
    ObjectBox place;
    for (std::size_t a = 0; a < 3; ++a) {
      place.low[a] = pool().column(a)[row];
      place.high[a] = pool().column(3 + a)[row];
    }
    return place;
  }
  /// True if a box fits the cell of this regular row, so that an object with this box may keep the
  /// row.
  [[nodiscard]] virtual bool fits(std::size_t, const ObjectBox&) const noexcept { return true; }
  /// Appends the regular rows that no longer fit, after any rows may have changed. `room` has space
  /// for all regular rows. Returns false and appends nothing if there are more than `most`, or if a
  /// sample predicts more.
  virtual bool find_misfits(std::uint32_t* /*room*/, Column<std::uint32_t>&,
                            std::size_t /*most*/) noexcept {
    return true;
  }

  // Pairs.

  /// Pairs within the regular region are found in pair_tasks() independent tasks. run_pair_task
  /// returns false if the sink could not grow.
  [[nodiscard]] virtual std::size_t pair_tasks() const noexcept { return 0; }
  virtual bool run_pair_task(std::size_t, PairSink&) const noexcept { return true; }
  /// Passes the hits of a batch in the regular region to the sink.
  virtual bool query(const QueryBatch&, PairSink&) const noexcept { return true; }

  // Inspection.

  /// Draws the cells or strips of the regular region.
  virtual void draw(DebugDraw&) const {}
  /// The number of cells, strips or nodes of the regular region; 0 if it has only leaf blocks.
  [[nodiscard]] virtual std::size_t cells() const noexcept { return 0; }
  [[nodiscard]] virtual std::size_t levels() const noexcept { return 0; }
  /// Frees memory that only builds use.
  virtual void release_scratch() noexcept {}
  /// Frees the memory of an empty structure.
  virtual void release_memory() noexcept {}
  virtual void add_bytes(Footprint&) const noexcept {}

 protected:
  ~Structure() = default;

  [[nodiscard]] const BoundsPool& pool() const noexcept { return rows_.pool(); }
  [[nodiscard]] const Execution& execution() const noexcept { return rows_.execution(); }
  [[nodiscard]] std::size_t objects() const noexcept { return rows_.size(); }
  [[nodiscard]] std::size_t regular_rows() const noexcept { return rows_.regions().regular; }
  [[nodiscard]] RowView row_view() const noexcept { return rows_.view(); }
  /// The tree over the regular rows: with boxes if `prunes_rows`, with filters if filters are in
  /// use.
  [[nodiscard]] TreeView regular_tree() const noexcept { return regular_tree_.view(row_view()); }

 private:
  const Rows& rows_;
  const BlockTree& regular_tree_;
};

}  // namespace winnow
