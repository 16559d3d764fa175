#pragma once

// The objects of a partition as rows of columns. PartitionState owns the rows, SpatialIndex orders
// them, and kernels read them through RowView.

#include <winnow/core/execution.h>
#include <winnow/core/memory.h>
#include <winnow/core/status.h>
#include <winnow/core/volumes.h>
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

struct VolumeInput;

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
/// changed. RowInput inserts and updates them. Rows are independent of the structure that prunes
/// them.
class Rows {
 public:
  /// `input` must outlive the rows.
  Rows(std::pmr::memory_resource* memory, const Execution& execution, const VolumeInput& input,
       const FatMargin& fat_margin) noexcept;

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
  /// True if volumes are stored enlarged.
  [[nodiscard]] bool has_margin() const noexcept;
  [[nodiscard]] const RowRegions& regions() const noexcept { return regions_; }
  [[nodiscard]] const RowChanges& changes() const noexcept { return changes_; }
  [[nodiscard]] RowChanges& changes() noexcept { return changes_; }
  /// Returns the pointers that kernels use.
  [[nodiscard]] RowView view() const noexcept;
  /// Returns serial execution if there are too few objects to share the work.
  [[nodiscard]] Execution execution_for(std::size_t objects) const noexcept;
  void add_bytes(Footprint& footprint) const noexcept;

  // For SpatialIndex, which orders the rows.
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
  /// `far`, the order is lost (see RowInput::order_is_lost); if `far` is 0, it never is.
  void note_build(float far) noexcept {
    filters_.note_build({pool_.ids(), pool_.rows()});
    order_reach_ = far;
  }

  /// Shared scratch for selecting rows; overwritten by the next selection.
  [[nodiscard]] RowSelection& selection() const noexcept { return selection_; }

 private:
  friend class RowInput;
  friend struct VolumeUpdate;

  [[nodiscard]] bool make_room(std::size_t objects) noexcept;
  [[nodiscard]] bool begin_filters() noexcept;
  void remove_row(ObjectId id) noexcept;
  void fetch_row(std::size_t row) const noexcept;

  Execution execution_;
  FatMargin fat_margin_;
  const VolumeInput& input_;
  BoundsPool pool_;
  KeyTable keys_;
  FilterTable filters_;
  RowRegions regions_;
  float order_reach_ = 0.0F;
  std::uint64_t arrangement_ = 1;  // see RowView
  RowChanges changes_;
  mutable RowSelection selection_;
};

}  // namespace winnow
