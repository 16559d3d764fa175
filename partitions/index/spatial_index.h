#pragma once

#include <winnow/partitions/structures.h>
#include "partitions/index/departure_forecast.h"
#include "partitions/index/order_plan.h"
#include "partitions/index/query_view.h"
#include "partitions/index/rebuild_planner.h"
#include "partitions/index/structure_store.h"
#include "partitions/rows/rows.h"
#include "partitions/structures/structure.h"
#include "partitions/tree/block_tree.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

struct Statistics;

/// Finds rows: owns the structure over the regular rows (see RowRegions) and a block tree over all
/// other rows, and keeps both up to date while rows change. PartitionState calls it. Refreshes and
/// queries are in spatial_index.cpp, builds in rebuild.cpp, exchanges of the structure in
/// exchange.cpp.
///
/// All rows behind the regular rows are in the leaves of the block tree: objects that do not suit
/// the structure (oversize, unbounded, in overfull cells), objects inserted since the last build,
/// and objects that moved out of their cells since then. So no input makes a structure degenerate:
/// the tree prunes the objects that do not suit the structure.
///
/// Queries other than pairs use block trees only. The cells and strips of a structure are ranges of
/// rows, so these queries use a second block tree over the regular rows. It is built for the first
/// such query and recomputed after changes; a scene without such queries does not pay for it.
///
/// Filters are tested after boxes. Tree nodes store a summary of the filters below them, so that a
/// query skips subtrees that its filter excludes. Flat structures have such nodes without boxes for
/// this purpose. If more than one environment is in use, a build groups the rows by environment, so
/// that n worlds at the same place cost no more than n worlds at n places.
///
/// A build permutes the rows themselves, so there is no sorted copy of them. RebuildPlanner decides
/// when. If a build was foreseen, its order was planned in stages over the refreshes before it (see
/// OrderPlan), while the old order was in use, so that no frame pays for all of it. Rows that moved
/// after they were planned are found once the rows are in the new order, like objects that leave
/// their cells in any frame. A build that was not foreseen completes the plan at once.
class SpatialIndex {
 public:
  /// `build_budget` as in PartitionOptions.
  SpatialIndex(std::pmr::memory_resource* memory, Rows& rows, std::size_t build_budget) noexcept;
  ~SpatialIndex();
  SpatialIndex(const SpatialIndex&) = delete;
  SpatialIndex& operator=(const SpatialIndex&) = delete;

  /// Replaces the structure; the next refresh orders the rows. Returns false and changes nothing if
  /// an allocation fails.
  [[nodiscard]] bool set_structure(StructureKind kind) noexcept;
  [[nodiscard]] StructureKind kind() const noexcept { return kind_; }
  [[nodiscard]] const Structure& structure() const noexcept { return *structure_; }
  [[nodiscard]] const RebuildPlanner& planner() const noexcept { return planner_; }

  /// Makes room for a build of `objects` objects at any positions and for the pair queries that
  /// follow, with the current structure and with each structure in `later`. Filters are not
  /// included. The room lasts until `release_memory`. Returns false if an allocation fails.
  /// O(pages) if `pages` are touched.
  [[nodiscard]] bool reserve(std::size_t objects, Pages pages,
                             std::span<const StructureKind> later) noexcept;
  /// Updates everything that pair queries read. A step that fails is repeated by the next refresh.
  Status refresh();
  /// Refreshes with another structure. The structure is replaced at once if a build is due or is
  /// not planned ahead, else after further refreshes have planned its order. If its memory cannot
  /// be allocated, sets `refused` and refreshes with the current structure.
  Status refresh_as(StructureKind kind, bool& refused);
  /// True while the order of another structure is being planned. The plan is dropped if the rows
  /// are reordered in the meantime.
  [[nodiscard]] bool swap_is_planned() const noexcept { return next_.structure != nullptr; }
  /// True if the last refresh dropped that plan because an allocation failed.
  [[nodiscard]] bool swap_refused() const noexcept { return swap_refused_; }

  /// True if one thread has to call `refresh_query_trees` before queries other than pairs.
  [[nodiscard]] bool query_trees_stale() const noexcept {
    return query_trees_stale_.load(std::memory_order_acquire) && !structure_->is_flat();
  }
  /// Updates the trees that only queries other than pairs use.
  Status refresh_query_trees() const;
  /// Fills in the rows and trees that queries other than pairs read.
  void view(QueryView& view) const noexcept;

  /// The tree over the rows behind the regular ones.
  [[nodiscard]] const BlockTree& tree() const noexcept { return tree_; }
  /// Passes all hits of a batch to the sink. Returns false if the sink could not grow.
  bool query(const QueryBatch& batch, PairSink& sink) const noexcept;

  void add_statistics(Statistics& statistics) const noexcept;
  void add_bytes(Footprint& footprint) const noexcept;
  /// Frees scratch memory; frees everything if there are no objects.
  void release_memory() noexcept;

 private:
  [[nodiscard]] RowNumbers numbers() const noexcept;

  // Refresh.
  Status absorb_changes(bool all);
  Status find_outliers(const RowNumbers& n);
  Status move_outliers_to_tail(std::size_t tail);
  bool move_to_tail(std::span<const std::uint32_t> rows) noexcept;
  bool sort_tail() noexcept;
  bool refit_trees() noexcept;
  bool refit(BlockTree& tree, std::size_t first, std::size_t blocks,
             BlockTree::NodeContent nodes) noexcept;

  // Builds, in rebuild.cpp.
  Status build();
  Status apply_plan(bool foreseen);
  Status build_flat();
  [[nodiscard]] bool start_plan(Structure& structure) noexcept;
  void continue_planning() noexcept;
  void drop_plan() noexcept;
  [[nodiscard]] BlockTree::NodeContent node_content() const noexcept;

  // Exchange of the structure, in exchange.cpp.
  void install(Structure* structure, StructureKind kind) noexcept;
  void install_planned_structure() noexcept;
  [[nodiscard]] bool reserve_order(std::size_t rows, std::size_t behind, Pages pages) noexcept;
  void release_scratch() noexcept;

  Rows& rows_;
  StructureKind kind_;
  Structure* structure_ = nullptr;
  BlockTree tree_;
  // The tree over the regular rows, for all queries other than pairs. It is built for the first of
  // these queries, except if the structure prunes rows or is flat.
  mutable BlockTree regular_tree_;
  mutable float leaf_edge_ = 0.0F;  // edge of a typical block
  mutable std::atomic<bool> query_trees_stale_{true};
  // Rows of the tail changed that are not in Rows::stale: they were sorted, or moved there.
  bool tail_changed_ = false;
  bool order_changed_ = false;  // so did rows before the tail

  RebuildPlanner planner_;
  OrderPlan plan_;
  DepartureForecast departures_;
  StructureStore structures_;
  OwnedStructure next_;    // the structure of the plan, if it will replace the current one
  bool reserved_ = false;  // memory is reserved for every structure, and kept if one is replaced
  bool swap_refused_ = false;

  Column<float> spare_;               // scratch for permuting columns
  Column<std::uint32_t> tail_order_;  // scratch for sorting the tail
};

}  // namespace winnow
