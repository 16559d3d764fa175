#pragma once

// The objects of a partition as rows of columns. PartitionState owns the rows, SpatialIndex orders
// them, and kernels read them through RowView.

#include <winnow/core/box_view.h>
#include <winnow/core/execution.h>
#include <winnow/core/fat_margin.h>
#include <winnow/core/footprint.h>
#include <winnow/core/status.h>
#include "core/memory/bounds_pool.h"
#include "core/memory/key_table.h"
#include "partitions/rows/change_list.h"
#include "partitions/rows/filter_table.h"
#include "partitions/rows/row_selection.h"
#include "partitions/rows/row_view.h"

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

struct EntryOfId;
struct BoxSource;
struct EntryOfRow;
struct SampledBoxes;
class Rows;

/// The entries of keys and volumes that an update processes: all of them, or a list of indices.
struct UpdateSubset {
  std::span<const Key> keys;
  std::size_t count = 0;
  const std::uint32_t* number = nullptr;  ///< null: all

  /// Entries without keys.
  explicit UpdateSubset(std::size_t all) noexcept : count(all) {}
  explicit UpdateSubset(std::span<const Key> all) noexcept : keys(all), count(all.size()) {}
  UpdateSubset(std::span<const Key> all, std::span<const std::uint32_t> numbers) noexcept
      : keys(all), count(numbers.size()), number(numbers.data()) {}

  [[nodiscard]] std::size_t operator[](std::size_t j) const noexcept {
    return number == nullptr ? j : number[j];
  }
  [[nodiscard]] Key key(std::size_t j) const noexcept { return keys[(*this)[j]]; }

  /// Shorter runs are handled entry by entry, because a call per run costs more.
  static constexpr std::size_t kLongRun = 16;

  /// Returns the end, at most `end`, of the longest run of consecutive indices that starts at the
  /// j-th entry.
  [[nodiscard]] std::size_t run_end(std::size_t j, std::size_t end) const noexcept {
    if (number == nullptr) return end;
    std::size_t next = j + 1;
    while (next < end && number[next] - number[j] == next - j) ++next;
    return next;
  }
};

/// How boxes are converted into the stored volume. All functions are null if boxes are stored as
/// given. A program links only the code of the tables that it names.
struct VolumeInput {
  Volume volume;
  Status (*insert)(Rows&, const BoxView&, std::span<const ClientData>, std::span<Key>);
  Status (*update)(Rows&, const UpdateSubset&, const BoxView&);
  Status (*update_one)(Rows&, Key, const BoxView&);
};

/// A saved set of objects: slots of keys, and per live object, by id, its volume and filter.
struct SavedRows {
  KeyTable::SavedSlots keys;
  std::size_t objects = 0;                  ///< live slots, i.e. odd stamps
  std::span<const float> columns;           ///< of the volume, one after the other
  std::span<const ObjectFilter> filters{};  ///< empty if all are the default
};

/// Returns the box of a row with infinite ends as infinite. The box of a hole is empty.
[[nodiscard]] Aabb stored_box(const float* const columns[6], std::size_t row) noexcept;

/// Layout of the rows. The structure orders the *regular* rows: cells, strips, or no order. From
/// the next whole block on, the blocks of rows are the leaves of a block tree: first the rows
/// ordered by the last build, then the *tail* of objects that were inserted or moved out of their
/// place since.
struct RowRegions {
  bool built = false;       ///< false: the next refresh must order the rows
  std::size_t regular = 0;  ///< rows [0, regular) belong to the structure
  std::size_t ordered = 0;  ///< the tail starts here
  std::size_t sorted = 0;   ///< tail rows below this are in spatial order
  /// An order is being planned for rows below this; a removed object leaves a hole there until
  /// the plan is applied or dropped.
  std::size_t planned = 0;
};

/// The objects of a partition: keys, client data, filters and bounding volumes, and which of them
/// changed. Rows are independent of the structure that prunes them.
class Rows {
 public:
  /// Input of boxes that are stored as given, without a margin.
  [[nodiscard]] static const VolumeInput& boxes_as_given() noexcept;
  /// Input of a volume, with or without a margin; null for an invalid volume. Links all volumes.
  [[nodiscard]] static const VolumeInput* input_of(Volume volume,
                                                   const FatMargin& fat_margin) noexcept;

  /// `input` must outlive the rows.
  Rows(std::pmr::memory_resource* memory, const Execution& execution, const VolumeInput& input,
       const FatMargin& fat_margin) noexcept;

  Status insert(const BoxView& boxes, std::span<const ClientData> data, std::span<Key> keys);
  Status update(const UpdateSubset& entries, const BoxView& boxes);
  Status update(Key key, const Aabb& box);
  /// As above with spheres or k-DOPs; `unsupported_volume` if another volume is stored.
  template <typename V>
  Status insert(std::span<const V> volumes, std::span<const ClientData> data, std::span<Key> keys);
  template <typename V>
  Status update(std::span<const Key> keys, std::span<const V> volumes);

  /// Returns the status that an update with these boxes would have.
  [[nodiscard]] Status check(const UpdateSubset& entries, const BoxView& boxes) const;
  /// Gives every row the box at the index of its object's id, if there is one.
  void write_by_id(const BoxView& boxes) noexcept;

  Status remove(Key key);
  Status remove(std::span<const Key> keys);
  void clear() noexcept;
  /// Makes room for `objects` objects in rows without holes.
  Status reserve(std::size_t objects);
  /// Prefaults reserved pages.
  void touch() noexcept;
  /// Frees scratch, and all memory if there are no objects.
  void release_memory() noexcept;

  /// Makes the saved objects the rows' objects, in rows by id, with their keys (see
  /// KeyTable::restore). The rows must never have contained an object. `invalid_argument` if the
  /// data are inconsistent; nothing is changed then.
  Status restore(const SavedRows& saved, Rows& other);

  Status set_filter(std::span<const Key> keys, std::span<const ObjectFilter> filters);
  Status bounds(Key key, Aabb& box) const noexcept;
  /// Writes one box per key; the keys must be valid.
  void read_bounds(std::span<const Key> keys, std::span<Aabb> boxes) const noexcept;

  [[nodiscard]] std::size_t size() const noexcept { return keys_.size(); }
  [[nodiscard]] const BoundsPool& pool() const noexcept { return pool_; }
  [[nodiscard]] const KeyTable& keys() const noexcept { return keys_; }
  [[nodiscard]] const FilterTable& filters() const noexcept { return filters_; }
  [[nodiscard]] const Execution& execution() const noexcept { return execution_; }
  [[nodiscard]] const FatMargin& fat_margin() const noexcept { return fat_margin_; }
  [[nodiscard]] const RowRegions& regions() const noexcept { return regions_; }
  /// Returns the pointers that kernels use.
  [[nodiscard]] RowView view() const noexcept;
  /// Returns serial execution if there are too few objects to share the work.
  [[nodiscard]] Execution execution_for(std::size_t objects) const noexcept;
  void add_bytes(Footprint& footprint) const noexcept;

  // For SpatialIndex, which orders the rows.

  /// True from a change until `clear_stale`.
  [[nodiscard]] bool changed() const noexcept { return changed_; }
  /// Objects that changed since the last `clear_stale`.
  [[nodiscard]] const ChangeList& stale() const noexcept { return stale_; }
  /// Ends a refresh: clears `stale`. If `track_moves` is true, adds the objects in `stale` to
  /// `moved` first.
  void clear_stale(bool track_moves) noexcept;
  /// Objects that changed since `forget_moves`, if moves were tracked.
  [[nodiscard]] const ChangeList& moved() const noexcept { return moved_; }
  void forget_moves() const noexcept { moved_.clear(); }

  [[nodiscard]] RowRegions& regions() noexcept { return regions_; }
  /// Requires the next refresh to order the rows.
  void invalidate_order() noexcept;
  void pad() noexcept { pool_.pad(); }
  [[nodiscard]] bool reserve_rows(std::size_t rows) noexcept { return pool_.reserve_exact(rows); }
  /// Closes all holes; afterwards the rows are unordered.
  void compact() noexcept;
  /// Moves row order[i] to row i. `spare` must have room for the pool's capacity plus two blocks.
  void reorder(std::span<const std::uint32_t> order, Column<float>& spare) noexcept;
  /// As above for the rows from `begin` on, on the calling thread.
  void reorder_tail(std::size_t begin, std::span<const std::uint32_t> order,
                    Column<float>& spare) noexcept;
  /// Moves rows behind the last one and leaves holes. Requires room.
  void move_to_end(std::span<const std::uint32_t> rows) noexcept;
  /// Called when the rows have been ordered. If one update then moves most objects by more than
  /// `far`, the order is lost (see `order_is_lost`); if `far` is 0, it never is.
  void note_build(float far) noexcept {
    filters_.note_build({pool_.ids(), pool_.rows()});
    order_reach_ = far;
  }

  /// Shared scratch for selecting rows; overwritten by the next selection.
  [[nodiscard]] RowSelection& selection() const noexcept { return selection_; }

 private:
  [[nodiscard]] bool make_room(std::size_t objects) noexcept;
  [[nodiscard]] bool begin_filters() noexcept;
  void remove_row(ObjectId id) noexcept;
  void fetch_row(std::size_t row) const noexcept;

  // Insert and update, in box_update.cpp; volumes other than boxes as given use them, too.
  friend struct VolumeUpdate;
  [[nodiscard]] Status begin_insert(std::size_t count, std::span<const ClientData> data,
                                    std::span<Key> keys, std::size_t& first);
  void number_rows(std::span<const Key> keys, std::size_t begin, std::size_t end) noexcept;
  void place_new(std::span<const Key> keys, std::size_t first, std::size_t begin,
                 std::size_t end) noexcept;
  [[nodiscard]] Status check_insert(std::size_t count, std::span<const ClientData> data,
                                    std::span<Key> keys) const noexcept;
  [[nodiscard]] Status check_keys(std::size_t volumes, const UpdateSubset& entries,
                                  bool& ascending) const;
  [[nodiscard]] Status check(const UpdateSubset& entries, const BoxView& boxes,
                             bool& ascending) const;
  [[nodiscard]] bool writes_by_rows(const UpdateSubset& entries, bool ascending,
                                    EntryOfId& entry_of_id);
  void write_by_rows(const BoxSource& source, const EntryOfRow& entry_of);
  template <typename Visit>
  void for_entries(const UpdateSubset& entries, bool ascending, const Visit& visit);
  void write_new(const BoxSource& source, std::span<const Key> keys, std::size_t first,
                 std::size_t begin, std::size_t end) noexcept;
  [[nodiscard]] bool may_lose_order(const UpdateSubset& entries) const noexcept;
  [[nodiscard]] bool order_is_lost(const SampledBoxes& sample,
                                   std::span<const Key> keys) const noexcept;
  template <typename Source>
  [[nodiscard]] bool loses_order(const Source& source, const UpdateSubset& entries) const noexcept;
  void note_stale(const UpdateSubset& entries) noexcept;

  Execution execution_;
  FatMargin fat_margin_;
  const VolumeInput& input_;
  BoundsPool pool_;
  KeyTable keys_;
  FilterTable filters_;
  RowRegions regions_;
  float order_reach_ = 0.0F;
  bool changed_ = false;
  std::uint64_t arrangement_ = 1;  // see RowView
  ChangeList stale_;
  mutable ChangeList moved_;
  mutable RowSelection selection_;
};

}  // namespace winnow
