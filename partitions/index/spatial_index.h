#pragma once

#include <winnow/core/debug_draw.h>
#include <winnow/partitions/structures.h>
#include "partitions/index/departures.h"
#include "partitions/index/order_plan.h"
#include "partitions/index/query_view.h"
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

/// How rows are found: a structure over the regular rows, a block tree over all others, and what
/// keeps both right while rows change.
///
/// Behind the regular rows every row is a leaf of a block tree: objects that do not suit the
/// structure (oversize, unbounded, in overfull cells), objects inserted since the last build, and
/// objects that moved out of where the build put them. So no input can make a structure degenerate:
/// what does not fit it is pruned by the tree.
///
/// Queries other than pairs go through blocks of rows, whatever region these lie in: cells and
/// strips are runs of rows, so a second block tree over the regular rows leads to them. It is made
/// when such a query first comes, and refitted after changes; a scene that never asks does not pay
/// for it.
///
/// Filters are looked up where a test hits. Nodes know what the filters below them have between
/// them, so that subtrees which a filter cannot meet are not entered; the blocks of flat structures
/// have such nodes, without boxes, for that alone. Where more than one environment is in use a
/// build puts each one's rows together: worlds at the same place cost no more than their sum.
///
/// A build permutes the rows themselves, so the pool is the sorted copy. It happens when the share
/// of new rows, moved rows or holes passes a limit, when an update scatters the objects (see Rows),
/// or when the extra tests that a worn structure has cost since the last build exceed the price of
/// a build: at most twice the cost of the best schedule known in hindsight (the ski-rental bound;
/// Karlin et al., Algorithmica 3, 1988). The decision counts tests, never time, so every machine
/// takes it at the same frame.
///
/// Most of a build is finding the order. Where a build can be seen coming, because objects near the
/// edge of their cells, the tail grows or wear does, the order is planned in stages over the
/// refreshes before it, while the old one serves (see OrderPlan): no frame pays for all of it. What
/// moved since a row was planned is found when the rows stand in the new order, as what leaves its
/// cell in any frame is. A build that comes unforeseen does what is left of the plan at once.
class SpatialIndex {
 public:
  /// `build_budget` is that of PartitionOptions.
  SpatialIndex(std::pmr::memory_resource* memory, Rows& rows, std::size_t build_budget) noexcept;
  ~SpatialIndex();
  SpatialIndex(const SpatialIndex&) = delete;
  SpatialIndex& operator=(const SpatialIndex&) = delete;

  /// Exchanges the structure; the next refresh orders the rows. False, and nothing changed, if
  /// memory is refused.
  [[nodiscard]] bool set_structure(StructureKind kind) noexcept;
  [[nodiscard]] StructureKind kind() const noexcept { return kind_; }
  [[nodiscard]] const Structure& structure() const noexcept { return *structure_; }
  [[nodiscard]] std::size_t build_budget() const noexcept { return build_budget_; }

  /// Makes room for a build of so many objects, wherever they lie, and for what pair queries then
  /// read, with the structure that is there and with each of those that may be taken `later`. It
  /// lasts until `release_memory`. What objects have in filters is not counted in. False if memory
  /// is refused. O(pages) if they are touched.
  [[nodiscard]] bool reserve(std::size_t objects, Pages pages,
                             std::span<const StructureKind> later) noexcept;
  /// Brings everything up to date that pair queries read. What fails is tried again by the next
  /// refresh.
  Status refresh();
  /// The same with another structure: at once where a build is due, else when further refreshes
  /// have planned its order. Where it does not get the memory it needs, with the one that is there;
  /// `refused` says so.
  Status refresh_as(StructureKind kind, bool& refused);
  /// True while another structure is planned. It is given up where the rows are put elsewhere in
  /// the meantime.
  [[nodiscard]] bool exchanging() const noexcept { return next_.structure != nullptr; }
  /// True if the last refresh gave it up because memory was refused.
  [[nodiscard]] bool exchange_refused() const noexcept { return exchange_refused_; }

  /// Queries other than pairs are about to come, after changes.
  void note_asked() const noexcept {
    asked_.fetch_add(1, std::memory_order_relaxed);
    questioned_.store(true, std::memory_order_relaxed);
  }
  /// True if `refresh_queries` has to be called, by one thread, before queries other than pairs.
  [[nodiscard]] bool queries_stale() const noexcept {
    return queries_stale_.load(std::memory_order_acquire) && !structure_->is_flat();
  }
  Status refresh_queries() const;
  /// How queries other than pairs see the rows.
  void view(QueryView& view) const noexcept;

  /// Over the rows behind the regular ones.
  [[nodiscard]] const BlockTree& tree() const noexcept { return tree_; }
  /// All hits of a batch.
  bool query(const QueryBatch& batch, PairSink& sink) const noexcept;

  /// What answering so many pair queries has cost, in tests of 16 volumes. Of objects that asked
  /// for all their pairs, or of those that asked because they moved.
  enum class Asked : std::uint8_t { all, moved };
  void note_work(std::uint64_t tests, std::uint64_t queries, Asked asked) const noexcept;
  /// What pair queries since the last build have cost beyond what they do on a fresh structure.
  [[nodiscard]] std::uint64_t excess_tests() const noexcept {
    return excess_.load(std::memory_order_relaxed);
  }

  /// Rows that may stand behind the built ones before a build is due.
  [[nodiscard]] std::size_t tail_limit() const noexcept { return tail_limit(rows_.size()); }

  /// The structure and, as far as levels from the root down, the tree.
  void draw(DebugDraw& draw, std::size_t max_depth) const;
  void draw_objects(DebugDraw& draw, const DebugDrawOptions& options) const;
  [[nodiscard]] std::uint64_t builds() const noexcept { return builds_; }
  void add_statistics(Statistics& statistics) const noexcept;
  void add_bytes(Footprint& footprint) const noexcept;
  /// Gives back scratch and, where there are no objects, everything.
  void release_memory() noexcept;

 private:
  /// A structure, or none.
  struct Held {
    StructureKind kind{};
    Structure* structure = nullptr;
  };
  [[nodiscard]] Structure* make(StructureKind kind) noexcept;
  void end(const Held& one) noexcept;
  void put_by(const Held& one) noexcept;
  [[nodiscard]] bool reserve_order(std::size_t rows, std::size_t behind, Pages pages) noexcept;
  [[nodiscard]] bool let_wait(const Held& one) noexcept;
  [[nodiscard]] bool have_wait(std::span<const StructureKind> kinds) noexcept;
  void end_waiting() noexcept;
  void install(Structure* structure, StructureKind kind) noexcept;
  [[nodiscard]] bool needs_build() const noexcept;
  [[nodiscard]] static std::size_t tail_limit(std::size_t objects) noexcept {
    return objects / 16 + 64;
  }
  /// Rows that a tail may get: no object is in it twice.
  [[nodiscard]] static std::size_t most_in_tail(std::size_t objects) noexcept {
    return std::min(tail_limit(objects), objects);
  }
  /// Room that a build leaves behind its rows for a tail.
  [[nodiscard]] static std::size_t spare_rows(const Structure& structure,
                                              std::size_t objects) noexcept {
    return (structure.prunes_rows() ? 2 : 1) * most_in_tail(objects);
  }
  [[nodiscard]] std::size_t spare_rows(const Structure& structure) const noexcept {
    return spare_rows(structure, rows_.size());
  }
  [[nodiscard]] std::size_t tail() const noexcept;
  [[nodiscard]] bool wants_grouping() const noexcept;
  Status build();
  /// `moved` says that objects may have since the plan was begun.
  Status take_order(bool moved);
  [[nodiscard]] bool start_plan(Structure& structure) noexcept;
  [[nodiscard]] KdParts wanted_parts(const Structure& structure) const noexcept;
  void take_next_structure() noexcept;
  Status build_flat();
  Status absorb_changes(bool all);
  [[nodiscard]] bool is_next_frame() const noexcept;
  [[nodiscard]] bool is_torn() const noexcept;
  [[nodiscard]] bool make_room_for_misfits() noexcept;
  [[nodiscard]] bool collect_misfits(bool any_row, std::size_t most) noexcept;
  [[nodiscard]] std::size_t ordered_blocks() const noexcept;
  [[nodiscard]] std::size_t wide_blocks() const noexcept;
  Status look_for_strays();
  [[nodiscard]] bool collect_strays(std::size_t limit) noexcept;
  Status take_out_strays();
  bool move_to_tail(std::span<const std::uint32_t> rows) noexcept;
  bool sort_tail() noexcept;
  bool sort_by_place(std::span<std::uint32_t> rows, std::uint32_t* room) noexcept;
  bool refit_trees() noexcept;
  bool refit(BlockTree& tree, std::size_t first, std::size_t blocks,
             BlockTree::Nodes nodes) noexcept;
  [[nodiscard]] BlockTree::Nodes node_content() const noexcept;
  void release_scratch() noexcept;

  // Planning ahead.
  [[nodiscard]] bool plans_ahead() const noexcept;
  [[nodiscard]] std::size_t planning_work(const Structure& structure) const noexcept;
  [[nodiscard]] std::size_t changed() const noexcept;
  void note_lull() noexcept;
  [[nodiscard]] bool plan_waits() const noexcept;
  void go_on_planning() noexcept;
  [[nodiscard]] bool build_is_near() const noexcept;
  [[nodiscard]] std::uint64_t most_wear() const noexcept;
  void give_up_plan() noexcept;

  std::pmr::memory_resource* memory_;
  Rows& rows_;
  StructureKind kind_;
  Structure* structure_ = nullptr;
  BlockTree tree_;

  // Unless the structure prunes rows or is flat it serves all queries but pairs, and is made when
  // the first one comes.
  mutable BlockTree regular_tree_;
  Column<Held> waiting_;            // to be taken, with what was reserved for them
  mutable float leaf_edge_ = 0.0F;  // of a typical block
  mutable std::atomic<bool> queries_stale_{true};
  mutable std::atomic<std::size_t> asked_{0};    // refreshes for such queries since the last build
  mutable std::atomic<bool> questioned_{false};  // in any way since the last refresh

  float built_edge_ = 0.0F;      // of a typical leaf of the tree, as the build left it
  std::size_t known_wide_ = 0;   // blocks that are wide, but not by objects that have jumped
  std::size_t built_holes_ = 0;  // padding that the build left between the regions
  bool tail_changed_ = false;    // rows of it stand elsewhere
  bool order_changed_ = false;   // so do others
  bool reserved_ = false;        // memory is there to stay, whatever the structure
  bool exchange_refused_ = false;

  Column<float> spare_;               // what columns are permuted through
  Column<std::uint32_t> tail_order_;  // while the tail is sorted

  // Planning ahead.
  const std::size_t build_budget_;
  OrderPlan plan_;
  Held next_;  // is taken with the plan, if the structure is to be exchanged
  Departures departures_;
  Growth tail_growth_;
  Growth wear_growth_;
  std::size_t refreshes_before_plan_ = 0;  // since the build before it
  std::size_t changed_at_plan_ = 0;  // objects, since the refresh before the one that began it
  std::size_t lull_ = 0;             // refreshes in a row that changed far fewer
  std::size_t unforeseen_ = 0;       // builds to wait for until one is foreseen again

  // Wear, in tests of 16 volumes: what a query costs on a fresh structure, and what those since
  // have cost beyond that.
  mutable std::atomic<std::uint64_t> full_base_{0};
  mutable std::atomic<std::uint64_t> moved_base_{0};
  mutable std::atomic<std::uint64_t> excess_{0};

  std::uint64_t builds_ = 0;
  std::uint64_t planned_builds_ = 0;
  std::uint64_t refits_ = 0;
};

}  // namespace winnow
