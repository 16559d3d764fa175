#pragma once

#include <winnow/core/kdop.h>
#include <winnow/core/sphere.h>
#include <winnow/partitions/partition.h>
#include "core/memory/bounds_pool.h"
#include "core/memory/key_table.h"
#include "partitions/pairs/pair_sink.h"
#include "partitions/queries/query_view.h"
#include "partitions/rows/change_list.h"
#include "partitions/rows/filter_table.h"
#include "partitions/tree/block_tree.h"
#include "partitions/tree/kd_order.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>

namespace winnow {

class EventWriter;
struct Sweep;

/// What all partitions share: keys, rows, what changed since when, pair queries and their order.
///
/// Rows fall into two regions. The *regular* region is the derived partition's own: cells, strips,
/// or plain rows. Behind it every row is a leaf of a block tree: objects that do not suit the
/// regular region (oversize, unbounded, in overfull cells), objects inserted since the last build,
/// and objects that moved out of where the build put them. So no input can make a regular structure
/// degenerate: what does not fit it is pruned by the tree. LinearBvh has no regular region.
///
/// Queries other than pairs walk blocks of rows, whatever region these lie in: cells and strips are
/// runs of rows, so a second block tree over the regular rows leads to them. It is made when such a
/// query first comes, and refitted after changes; a scene that never asks does not pay for it.
///
/// Filters are looked up where a test hits. Nodes know what the filters below them have between
/// them, so that subtrees which a filter cannot meet are not walked; the blocks of flat partitions
/// have such nodes, without boxes, for that alone. Where more than one environment is in use a
/// build puts each one's rows together: worlds at the same place cost no more than their sum.
///
/// A build permutes the rows themselves, so the pool is the sorted copy. It happens when the share
/// of new rows, moved rows or holes passes a limit, or when the extra tests that a worn structure
/// has cost since the last build exceed the price of a build: at most twice the cost of the best
/// schedule known in hindsight (the ski-rental bound; Karlin et al., Algorithmica 3, 1988). The
/// decision counts tests, never time, so every machine takes it at the same frame.
class RowPartition : public Partition {
 public:
  ~RowPartition() override;

  Status insert(const BoxView& boxes, std::span<const ClientData> data,
                std::span<Key> keys) override;
  Status insert(const Aabb& box, ClientData data, Key& key) override;
  Status update(std::span<const Key> keys, const BoxView& boxes) override;
  Status update(Key key, const Aabb& box) override;

  /// Spheres, where `volume()` is Volume::sphere; else `unsupported_volume`. Given boxes, a
  /// partition of spheres or k-DOPs stores the tightest volume around each (a sphere wants finite
  /// boxes). Spheres that miss each other by less than 1e-6 of their distance may be reported.
  Status insert(std::span<const Sphere> spheres, std::span<const ClientData> data,
                std::span<Key> keys);
  Status update(std::span<const Key> keys, std::span<const Sphere> spheres);
  /// k-DOPs, where `volume()` is that of the same K (14, 18 or 26); else `unsupported_volume`.
  template <int K>
  Status insert(std::span<const Kdop<K>> kdops, std::span<const ClientData> data,
                std::span<Key> keys);
  template <int K>
  Status update(std::span<const Key> keys, std::span<const Kdop<K>> kdops);

  Status remove(std::span<const Key> keys) override;
  Status remove(Key key) override;
  void clear() noexcept override;
  void release_memory() noexcept override;
  Status reserve(std::size_t objects) override;

  [[nodiscard]] bool is_exact() const noexcept override {
    return pool_.volume() == Volume::aabb && margin_.is_none();
  }
  [[nodiscard]] Volume volume() const noexcept { return pool_.volume(); }
  [[nodiscard]] const Margin& margin() const noexcept { return margin_; }

  [[nodiscard]] std::size_t size() const noexcept override { return keys_.size(); }
  [[nodiscard]] bool contains(Key key) const noexcept override { return keys_.is_valid(key); }
  Status bounds(Key key, Aabb& box) const noexcept override;
  Status client_data(Key key, ClientData& data) const noexcept override;
  [[nodiscard]] Key key_of(ObjectId id) const noexcept override { return keys_.key_of(id); }
  [[nodiscard]] ClientData client_data_of(ObjectId id) const noexcept override {
    return keys_.is_live(id) ? keys_.client_data(id) : 0;
  }

  Status set_filter(std::span<const Key> keys, std::span<const ObjectFilter> filters) override;
  Status set_filter(Key key, const ObjectFilter& filter) override;
  Status filter(Key key, ObjectFilter& filter) const noexcept override;

  Status refresh() const override;
  Status self_pairs(PairBuffer& out, const PairOptions& options = {}) const override;
  Status self_pairs(PairBuffer& out, PairEvents& events,
                    const PairOptions& options = {}) const override;
  Status pairs_with(const Partition& other, PairBuffer& out,
                    const PairOptions& options = {}) const override;

  Status closest(const Cast& cast, Hit& hit, const Filter& filter = {}) const override;
  Status any(const Cast& cast, Hit& hit, const Filter& filter = {}) const override;
  Status all(const Cast& cast, HitBuffer& hits, const Filter& filter = {}) const override;
  Status closest(const RayBatch& rays, const HitColumns& hits,
                 const Filter& filter = {}) const override;
  Status any(const RayBatch& rays, const HitColumns& hits,
             const Filter& filter = {}) const override;
  Status all(const RayBatch& rays, HitBuffer& hits, const Filter& filter = {}) const override;
  Status overlap(const Region& region, OverlapBuffer& objects, const Filter& filter = {},
                 Order order = Order::fast) const override;
  Status overlap(const BoxView& boxes, PairBuffer& out, const Filter& filter = {},
                 Order order = Order::fast) const override;
  Status nearest(const Aabb& from, std::size_t count, float radius, HitBuffer& hits,
                 const Filter& filter = {}) const override;
  Status debug_draw(DebugDraw& draw, const DebugDrawOptions& options = {}) const override;

  [[nodiscard]] Footprint footprint() const noexcept override;
  [[nodiscard]] Statistics statistics() const noexcept override;

  [[nodiscard]] const RowPartition* row_partition() const noexcept override { return this; }

  /// Exchanges the objects of two partitions made with the same options but for `execution`: keys,
  /// client data, filters, what pair buffers know of them, and the counters of Statistics. The next
  /// refresh of either builds; what a tracked pair buffer holds is still updated. O(1).
  void swap_objects(RowPartition& other) noexcept;

 protected:
  RowPartition(const PartitionOptions& options, Volume volume);

  /// Chooses, at a build, the rows of the regular region and their order: appends row numbers to
  /// `regular` (which has room for every row and may be left with kNoObject entries as padding) and
  /// all other live rows to `rest`. False if memory is refused: another build follows then. The
  /// default makes every live row part of the rest.
  virtual bool plan(Column<std::uint32_t>& regular, Column<std::uint32_t>& rest);
  /// Appends the rest to `order` in the order in which the tree's blocks of 16 hold it; entries of
  /// kNoObject leave places empty. It may reorder `rest`. False if memory is refused. The default
  /// cuts at medians (see kd_order.h), each environment by itself.
  virtual bool order_rest(std::span<std::uint32_t> rest, Column<std::uint32_t>& order);
  /// What a build costs in tests of 16 volumes per object.
  [[nodiscard]] virtual std::uint64_t build_price() const noexcept;
  /// Called when the rows stand in the planned order.
  virtual void finish_build() {}
  /// True if the object in this regular row still fits where the build put it.
  [[nodiscard]] virtual bool fits(std::size_t) const noexcept { return true; }
  /// Appends the regular rows that no longer fit, until the list holds `limit`; any may have
  /// changed.
  virtual void find_misfits(Column<std::uint32_t>&, std::size_t) noexcept {}

  /// Pair finding within the regular region, in independent tasks.
  [[nodiscard]] virtual std::size_t regular_tasks() const noexcept { return 0; }
  virtual bool run_regular_task(std::size_t, PairSink&) const noexcept { return true; }
  /// Hits of boxes in the regular region.
  virtual bool query_regular(const QueryBatch&, PairSink&) const noexcept { return true; }
  /// Draws cells, strips or whatever the regular region has.
  virtual void draw_regular(DebugDraw&, const DebugDrawOptions&) const {}
  /// True for partitions that find regular rows by the boxes of their blocks: the block tree over
  /// these is then made by each build and kept up to date by each refresh.
  [[nodiscard]] virtual bool prunes_rows() const noexcept { return false; }
  /// True for partitions whose rows all stay in one unordered regular region.
  [[nodiscard]] virtual bool is_flat() const noexcept { return false; }

  virtual void release_structure() noexcept {}
  virtual void add_structure_bytes(Footprint&) const noexcept {}
  [[nodiscard]] virtual std::size_t cell_count() const noexcept { return tree_.blocks(); }

  /// Bulk insert and update from any source of volumes (see volume_source.h).
  template <typename Source>
  Status insert_from(const Source& source, std::size_t count, std::span<const ClientData> data,
                     std::span<Key> keys);
  template <typename Source>
  Status update_from(const Source& source, std::size_t count, std::span<const Key> keys);

  [[nodiscard]] RowView row_view() const noexcept;
  /// Of a flat partition: the rows and what their blocks hold of filters.
  [[nodiscard]] TreeView block_filters() const noexcept { return block_filters_.view(row_view()); }
  /// The block tree over the regular rows, where `prunes_rows`.
  [[nodiscard]] TreeView row_tree() const noexcept { return row_tree_.view(row_view()); }
  [[nodiscard]] const BoundsPool& pool() const noexcept { return pool_; }
  [[nodiscard]] const FilterTable& filters() const noexcept { return filters_; }
  [[nodiscard]] const Execution& execution() const noexcept { return execution_; }
  [[nodiscard]] std::size_t regular_rows() const noexcept { return regular_rows_; }
  /// Scratch that a plan may use; the build uses it afterwards.
  [[nodiscard]] Column<std::uint64_t>& sort_scratch() noexcept { return sort_scratch_; }

 private:
  friend class AutoPartition;  // which looks at a sample of the rows

  template <typename Source, typename Use>
  Status with_margin(const Source& source, Use&& use);
  template <typename Source>
  Status update_one(const Source& source, Key key);
  template <typename Source>
  Status write(const Source& source, std::span<const Key> keys, bool ascending);
  template <typename Source, typename Visit>
  void for_entries(const Source& source, std::span<const Key> keys, bool by_rows, bool ascending,
                   const Visit& visit);
  template <typename Source>
  void write_left_boxes(const Source& source, std::span<const Key> keys);
  template <typename Source>
  void write_left(const Source& source, std::span<const Key> keys, std::size_t begin,
                  std::size_t end);
  void note_left(std::span<const Key> keys, bool by_rows, std::size_t slots) noexcept;
  void fetch_row(std::size_t row) const noexcept;
  [[nodiscard]] bool make_room(std::size_t objects) noexcept;
  void compact_rows() noexcept;
  void remove_row(ObjectId id) noexcept;

  Status refresh_now();
  [[nodiscard]] bool needs_build() const noexcept;
  /// Rows that may stand behind the built ones before a build is due.
  [[nodiscard]] std::size_t tail_limit() const noexcept { return keys_.size() / 16 + 64; }
  [[nodiscard]] bool wants_grouping() const noexcept;
  Status build();
  Status build_flat();
  bool sort_by_place(std::span<std::uint32_t> rows, const Execution& execution);
  Status absorb_changes();
  [[nodiscard]] bool is_torn() const noexcept;
  void collect_misfits(std::size_t limit) noexcept;
  bool move_to_tail(std::span<const std::uint32_t> rows) noexcept;
  bool sort_tail() noexcept;
  bool refit_tree() noexcept;
  bool refit(BlockTree& tree, std::size_t first, std::size_t blocks,
             BlockTree::Nodes nodes) noexcept;
  [[nodiscard]] BlockTree::Nodes node_content() const noexcept;
  void forward_changes() noexcept;

  struct SelfTasks;
  Status find_self_pairs(PairBuffer& out, const PairOptions& options, EventWriter* events) const;
  Status full_self_pairs(PairBuffer& out, const PairPredicate& predicate,
                         EventWriter* events) const;
  Status incremental_self_pairs(PairBuffer& out, const PairPredicate& predicate,
                                EventWriter* events) const;
  bool finish_pairs(PairBuffer& out, Order order, bool all, EventWriter* events) const noexcept;
  [[nodiscard]] bool can_update(const PairBuffer& out) const noexcept;
  bool run_self_task(const SelfTasks& tasks, std::size_t task, PairSink& sink) const noexcept;
  bool query_all(const QueryBatch& batch, PairSink& sink) const noexcept;
  Status ask(const RowPartition& other, HitMode mode, const PairPredicate& predicate,
             PairBuffer& out) const;
  /// Brings everything up to date that queries walk.
  Status prepare(QueryView& view) const;
  Status refresh_for_queries() const;
  /// A kernel that finds one hit of each of some sweeps.
  using FindHits = void (*)(const QueryView&, const Sweep*, std::uint32_t count, const QueryFilter&,
                            std::uint64_t* found);
  Status find_hit(FindHits find, const Cast& cast, Hit& hit, const Filter& filter) const;
  QueryBatch box_batch(std::size_t begin, std::size_t end) const noexcept;
  void note_work(std::uint64_t tests, std::uint64_t queries,
                 std::atomic<std::uint64_t>& base) const noexcept;
  [[nodiscard]] Execution execution_for(std::size_t objects) const noexcept;

  Execution execution_;
  Margin margin_;
  BoundsPool pool_;
  KeyTable keys_;
  FilterTable filters_;
  BlockTree tree_;
  BlockTree block_filters_;  // of flat partitions, whose rows are in no spatial order

  // Over the regular rows. Unless `prunes_rows` it serves all queries but pairs, and is made when
  // the first one comes.
  mutable BlockTree row_tree_;
  mutable float leaf_edge_ = 0.0F;  // of a typical block
  mutable std::atomic<bool> queries_stale_{true};

  std::size_t regular_rows_ = 0;  // rows [0, regular_rows_) are the derived partition's
  std::size_t built_rows_ = 0;    // rows from here on are the tail: new or moved since the build
  std::size_t sorted_rows_ = 0;   // tail rows below this are in spatial order
  float built_edge_ = 0.0F;       // of a typical leaf of the tree, as the build left it
  std::size_t built_holes_ = 0;   // padding that the build left between the regions
  bool built_ = false;
  bool tail_changed_ = false;

  ChangeList stale_;                     // since the last refresh
  mutable ChangeList moved_;             // since the last tracked pair query
  Column<float> spare_;                  // what columns are permuted through
  Column<std::uint32_t> order_;          // old row of each new row
  mutable Column<std::uint32_t> list_;   // rows or nodes to visit
  mutable Column<std::uint64_t> words_;  // bitmap for sorting them
  Column<std::uint64_t> sort_scratch_;
  Column<KdPoint> kd_scratch_;

  std::uint64_t identity_;
  mutable std::uint64_t tracked_serial_ = 0;  // 0: no buffer is tracked
  mutable std::atomic<std::uint64_t> last_serial_{
      0};  // never goes back, so an old buffer cannot match
  mutable std::mutex refresh_mutex_;
  mutable std::mutex tracker_mutex_;
  mutable std::atomic<bool> dirty_{false};

  // Work accounting, in tests of 16 volumes.
  mutable std::atomic<std::uint64_t> full_base_{0};
  mutable std::atomic<std::uint64_t> moved_base_{0};
  mutable std::atomic<std::uint64_t> excess_{0};

  mutable std::atomic<std::uint64_t> full_queries_{0};
  mutable std::atomic<std::uint64_t> incremental_queries_{0};
  mutable std::atomic<std::uint64_t> last_tests_{0};
  mutable std::atomic<std::uint64_t> last_pairs_{0};
  std::uint64_t builds_ = 0;
  std::uint64_t refits_ = 0;
};

}  // namespace winnow
