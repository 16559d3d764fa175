#pragma once

#include <winnow/core/debug_draw.h>
#include <winnow/partitions/structures.h>
#include "partitions/index/order_plan.h"
#include "partitions/index/query_view.h"
#include "partitions/index/rebuild_forecast.h"
#include "partitions/rows/rows.h"
#include "partitions/structures/structure.h"
#include "partitions/tree/block_tree.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

struct Statistics;

/// Finds rows: owns the structure over the regular rows (see RowRegions) and a block tree over all
/// other rows, and keeps both up to date while rows change. PartitionState calls it; rebuild.cpp,
/// structure_swap.cpp, outliers.cpp and debug_draw.cpp implement parts of it.
///
/// All rows behind the regular rows are in the leaves of the block tree: objects that do not suit
/// the structure (oversize, unbounded, in overfull cells), objects inserted since the last build,
/// and objects that moved out of their cells since then. So no input makes a structure degenerate:
/// the tree prunes the objects that do not suit the structure.
///
/// Queries other than pairs use block trees only. The cells and strips of a structure are ranges of
/// rows, so these queries use a second block tree over the regular rows. It is built for the first
/// such query and refitted after changes; a scene without such queries does not pay for it.
///
/// Filters are tested after boxes. Tree nodes store a summary of the filters below them, so that a
/// query skips subtrees that its filter excludes. Flat structures have such nodes without boxes for
/// this purpose. If more than one environment is in use, a build groups the rows by environment, so
/// that n worlds at the same place cost no more than n worlds at n places.
///
/// A build permutes the rows themselves, so there is no sorted copy of them. A build is due if the
/// share of new rows, moved rows or holes exceeds a limit, if an update scatters the objects (see
/// Rows), or if wear exceeds the price of a build. Wear is the number of extra tests since the last
/// build, compared with a fresh structure. The total cost of wear and builds is at most twice the
/// cost of the best schedule known in hindsight (the ski-rental bound; Karlin et al., Algorithmica
/// 3, 1988). Decisions count tests, never time, so every machine builds in the same frame.
///
/// Most of a build is spent on the order. A build can be foreseen if objects approach the borders
/// of their cells, or if the tail or the wear grows. Then the order is planned in stages over the
/// refreshes before the build (see OrderPlan), while the old order is in use, so that no frame pays
/// for all of it. Rows that moved after they were planned are found once the rows are in the new
/// order, like objects that leave their cells in any frame. A build that was not foreseen completes
/// the plan at once.
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
  [[nodiscard]] std::size_t build_budget() const noexcept { return build_budget_; }

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

  /// To be called before queries other than pairs that follow a change.
  void note_query() const noexcept {
    queried_refreshes_.fetch_add(1, std::memory_order_relaxed);
    queried_.store(true, std::memory_order_relaxed);
  }
  /// True if one thread has to call `refresh_queries` before queries other than pairs.
  [[nodiscard]] bool queries_stale() const noexcept {
    return queries_stale_.load(std::memory_order_acquire) && !structure_->is_flat();
  }
  Status refresh_queries() const;
  /// Fills in the rows and trees that queries other than pairs read.
  void view(QueryView& view) const noexcept;

  /// The tree over the rows behind the regular ones.
  [[nodiscard]] const BlockTree& tree() const noexcept { return tree_; }
  /// Passes all hits of a batch to the sink. Returns false if the sink could not grow.
  bool query(const QueryBatch& batch, PairSink& sink) const noexcept;

  /// Adds the cost of `queries` pair queries, in tests of 16 volumes, to the wear. `all`: every
  /// object was queried; `moved`: only objects that moved.
  enum class PairQueryKind : std::uint8_t { all, moved };
  void note_work(std::uint64_t tests, std::uint64_t queries, PairQueryKind kind) const noexcept;
  /// Wear: extra tests of pair queries since the last build, compared with a fresh structure.
  [[nodiscard]] std::uint64_t excess_tests() const noexcept {
    return excess_.load(std::memory_order_relaxed);
  }

  /// A build is due if the tail has more rows than this.
  [[nodiscard]] std::size_t tail_limit() const noexcept { return tail_limit(rows_.size()); }

  /// Draws the structure, and the tree down to `max_depth` levels below the root.
  void draw(DebugDraw& draw, std::size_t max_depth) const;
  void draw_objects(DebugDraw& draw, const DebugDrawOptions& options) const;
  [[nodiscard]] std::uint64_t builds() const noexcept { return builds_; }
  void add_statistics(Statistics& statistics) const noexcept;
  void add_bytes(Footprint& footprint) const noexcept;
  /// Frees scratch memory; frees everything if there are no objects.
  void release_memory() noexcept;

 private:
  /// A structure and its kind; `structure` may be null.
  struct OwnedStructure {
    StructureKind kind{};
    Structure* structure = nullptr;
  };
  [[nodiscard]] Structure* make(StructureKind kind) noexcept;
  void destroy(const OwnedStructure& one) noexcept;
  void stash(const OwnedStructure& one) noexcept;
  [[nodiscard]] bool reserve_order(std::size_t rows, std::size_t behind, Pages pages) noexcept;
  [[nodiscard]] bool store_spare(const OwnedStructure& one) noexcept;
  [[nodiscard]] bool make_spares(std::span<const StructureKind> kinds) noexcept;
  void destroy_spares() noexcept;
  void install(Structure* structure, StructureKind kind) noexcept;
  [[nodiscard]] bool needs_build() const noexcept;
  [[nodiscard]] static std::size_t tail_limit(std::size_t objects) noexcept {
    return objects / 16 + 64;
  }
  /// The maximum size of a tail, which contains no object twice.
  [[nodiscard]] static std::size_t max_in_tail(std::size_t objects) noexcept {
    return std::min(tail_limit(objects), objects);
  }
  /// Rows that a build reserves for the tail.
  [[nodiscard]] static std::size_t spare_rows(const Structure& structure,
                                              std::size_t objects) noexcept {
    return (structure.prunes_rows() ? 2 : 1) * max_in_tail(objects);
  }
  [[nodiscard]] std::size_t spare_rows(const Structure& structure) const noexcept {
    return spare_rows(structure, rows_.size());
  }
  [[nodiscard]] std::size_t tail() const noexcept;
  [[nodiscard]] bool needs_grouping() const noexcept;
  Status build();
  /// `moved`: objects may have moved since the plan was started.
  Status apply_plan(bool moved);
  [[nodiscard]] bool start_plan(Structure& structure) noexcept;
  [[nodiscard]] KdParts needed_parts(const Structure& structure) const noexcept;
  void install_planned_structure() noexcept;
  Status build_flat();
  Status absorb_changes(bool all);
  [[nodiscard]] bool is_next_frame() const noexcept;
  [[nodiscard]] bool is_scattered() const noexcept;
  [[nodiscard]] bool make_room_for_misfits() noexcept;
  [[nodiscard]] bool collect_misfits(bool any_row, std::size_t most) noexcept;
  [[nodiscard]] std::size_t ordered_blocks() const noexcept;
  [[nodiscard]] std::size_t wide_blocks() const noexcept;
  Status find_outliers();
  [[nodiscard]] bool collect_outliers(std::size_t limit) noexcept;
  Status move_outliers_to_tail();
  bool move_to_tail(std::span<const std::uint32_t> rows) noexcept;
  bool sort_tail() noexcept;
  bool sort_by_place(std::span<std::uint32_t> rows, std::uint32_t* room) noexcept;
  bool refit_trees() noexcept;
  bool refit(BlockTree& tree, std::size_t first, std::size_t blocks,
             BlockTree::NodeContent nodes) noexcept;
  [[nodiscard]] BlockTree::NodeContent node_content() const noexcept;
  void release_scratch() noexcept;

  // Planning ahead.
  [[nodiscard]] bool plans_ahead() const noexcept;
  [[nodiscard]] std::size_t planning_work(const Structure& structure) const noexcept;
  [[nodiscard]] std::size_t changed() const noexcept;
  void note_quiet_refresh() noexcept;
  [[nodiscard]] bool plan_paused() const noexcept;
  void continue_planning() noexcept;
  [[nodiscard]] bool build_is_near() const noexcept;
  [[nodiscard]] std::uint64_t max_wear() const noexcept;
  void drop_plan() noexcept;

  std::pmr::memory_resource* memory_;
  Rows& rows_;
  StructureKind kind_;
  Structure* structure_ = nullptr;
  BlockTree tree_;

  // The tree over the regular rows, for all queries other than pairs. It is built for the first of
  // these queries, except if the structure prunes rows or is flat.
  mutable BlockTree regular_tree_;
  Column<OwnedStructure> spare_structures_;  // reserved structures for later use, with their memory
  mutable float leaf_edge_ = 0.0F;           // edge of a typical block
  mutable std::atomic<bool> queries_stale_{true};
  // Refreshes for queries other than pairs since the last build.
  mutable std::atomic<std::size_t> queried_refreshes_{0};
  mutable std::atomic<bool> queried_{false};  // any query since the last refresh

  float built_edge_ = 0.0F;      // edge of a typical leaf of the tree after the build
  std::size_t known_wide_ = 0;   // blocks that are wide, but not because of outliers
  std::size_t built_holes_ = 0;  // padding that the build put between the regions
  bool tail_changed_ = false;    // rows of the tail were reordered
  bool order_changed_ = false;   // other rows were reordered, too
  bool reserved_ = false;        // memory is reserved for every structure
  bool swap_refused_ = false;

  Column<float> spare_;               // scratch for permuting columns
  Column<std::uint32_t> tail_order_;  // scratch for sorting the tail

  // Planning ahead.
  const std::size_t build_budget_;
  OrderPlan plan_;
  OwnedStructure next_;  // the structure of the plan, if it will replace the current one
  DepartureForecast departures_;
  GrowthForecast tail_growth_;
  GrowthForecast wear_growth_;
  std::size_t refreshes_before_plan_ = 0;  // refreshes from the last build to the start of the plan
  std::size_t changed_at_plan_ = 0;        // objects changed in the refresh that started the plan
  std::size_t quiet_refreshes_ = 0;        // consecutive refreshes with far fewer changes
  std::size_t builds_without_planning_ = 0;  // builds until plans are made ahead again

  // Wear, in tests of 16 volumes: the cost of one query on a fresh structure (for all objects, for
  // moved objects), and the excess of the queries since then.
  mutable std::atomic<std::uint64_t> full_base_{0};
  mutable std::atomic<std::uint64_t> moved_base_{0};
  mutable std::atomic<std::uint64_t> excess_{0};

  std::uint64_t builds_ = 0;
  std::uint64_t planned_builds_ = 0;
  std::uint64_t refits_ = 0;
};

}  // namespace winnow
