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
#include "partitions/rows/update_subset.h"

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

struct BoxOfId;
struct EntryOfRow;
class Rows;

/// How boxes are converted into the stored volume. Rows call these functions through pointers to
/// members, so that a program links only the code of the volumes that it can use.
struct VolumeInput {
  Volume volume;
  Status (Rows::*insert)(const BoxView&, std::span<const ClientData>, std::span<Key>);
  Status (Rows::*update)(const UpdateSubset&, const BoxView&);
  Status (Rows::*update_one)(Key, const BoxView&);
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
  /// An order is being planned for rows below this; none of them is given to another object.
  std::size_t planned = 0;
};

/// The objects of a partition: keys, client data, filters and bounding volumes, and which of them
/// changed. Rows are independent of the structure that prunes them.
class Rows {
 public:
  /// Input of boxes that are stored as given, without a margin.
  [[nodiscard]] static const VolumeInput& boxes_as_given() noexcept;
  /// Input of a volume, with or without a margin; null for an invalid volume. Links all volumes.
  [[nodiscard]] static const VolumeInput* input_of(Volume volume) noexcept;

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

  // Source reads the given volumes; Stored is AsGiven or WithMargin.
  template <typename Source, typename Stored>
  [[nodiscard]] static const VolumeInput& input() noexcept;
  template <typename Source, typename Stored>
  Status insert_boxes(const BoxView& boxes, std::span<const ClientData> data, std::span<Key> keys);
  template <typename Source, typename Stored>
  Status update_boxes(const UpdateSubset& entries, const BoxView& boxes);
  template <typename Source, typename Stored>
  Status update_box(Key key, const BoxView& box);
  template <typename Stored, typename Source>
  Status insert_from(const Source& source, std::size_t count, std::span<const ClientData> data,
                     std::span<Key> keys);
  [[nodiscard]] KeyTable::KeysCheck check_keys(const UpdateSubset& entries, std::size_t begin,
                                               std::size_t end) const noexcept;
  template <typename Source>
  Status check_update(const Source& source, std::size_t volumes, const UpdateSubset& entries,
                      bool& ascending) const;
  template <typename Stored, typename Source>
  Status update_from(const Source& source, std::size_t volumes, const UpdateSubset& entries);
  template <typename Stored, typename Source>
  Status update_one(const Source& source, Key key);
  template <typename Source>
  Status write(const Source& source, const UpdateSubset& entries, bool ascending);
  bool writes_by_rows(const UpdateSubset& entries, bool ascending, BoxOfId& entry_of);
  template <typename Source>
  [[nodiscard]] bool order_is_lost(const Source& source, std::span<const Key> keys) const noexcept;
  template <typename Source>
  void write_all(const Source& source, std::span<const Key> keys);
  template <typename Source, typename Visit>
  void for_rows(const Source& source, const EntryOfRow& entry_of, const Visit& visit);
  template <typename Visit>
  void for_entries(const UpdateSubset& entries, bool ascending, const Visit& visit);
  template <typename Source>
  void write_new(const Source& source, std::span<const Key> keys, std::size_t first,
                 std::size_t begin, std::size_t end);
  void note_stale(const UpdateSubset& entries) noexcept;
  void note_departed(const UpdateSubset& entries, bool by_rows, std::size_t slots) noexcept;

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
