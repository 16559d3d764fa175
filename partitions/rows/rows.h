#pragma once

#include <winnow/core/box_view.h>
#include <winnow/core/execution.h>
#include <winnow/core/footprint.h>
#include <winnow/core/margin.h>
#include <winnow/core/status.h>
#include "core/memory/bounds_pool.h"
#include "core/memory/key_table.h"
#include "partitions/rows/change_list.h"
#include "partitions/rows/entry_list.h"
#include "partitions/rows/filter_table.h"
#include "partitions/rows/row_selection.h"
#include "partitions/rows/row_view.h"

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

struct BoxOfId;
struct EntryOfRow;
class Rows;

/// How rows take boxes in, which become the volume that is stored. Rows reach it through a pointer:
/// a program has the code of those volumes alone that it can ask for.
struct VolumeInput {
  Volume volume;
  Status (Rows::*insert)(const BoxView&, std::span<const ClientData>, std::span<Key>);
  Status (Rows::*update)(const EntryList&, const BoxView&);
  Status (Rows::*update_one)(Key, const BoxView&);
};

/// Objects as they were saved: slots of keys, and of the live ones, by id, what is stored.
struct SavedRows {
  KeyTable::Saved keys;
  std::size_t objects = 0;                  ///< odd stamps
  std::span<const float> columns;           ///< of the volume, one after the other
  std::span<const ObjectFilter> filters{};  ///< empty if all are the default
};

/// The box of one row, with what is stored for an infinite end given back as infinite. A hole gives
/// an empty box.
[[nodiscard]] Aabb stored_box(const float* const columns[6], std::size_t row) noexcept;

/// How the rows of a partition lie. The *regular* ones are ordered by the structure: cells, strips,
/// or plain rows. Behind them, from the next whole block on, every row is a leaf of a block tree:
/// first what a build put there, then the *tail* of objects that are new, or moved out of where the
/// build had put them.
struct RowRegions {
  bool built = false;       ///< false: the next refresh has to order the rows
  std::size_t regular = 0;  ///< rows [0, regular) are the structure's
  std::size_t ordered = 0;  ///< rows from here on are the tail
  std::size_t sorted = 0;   ///< tail rows below this are in spatial order
  /// An order is being planned for rows below this: none of them becomes another object's.
  std::size_t planned = 0;
};

/// The objects of a partition: keys, client data, filters, and bounding volumes in rows; and what
/// changed since when. It knows nothing of how rows are pruned but how they lie.
class Rows {
 public:
  /// The input of boxes that are stored as they are given: for rows without a margin.
  [[nodiscard]] static const VolumeInput& boxes_as_given() noexcept;
  /// That of any volume, with or without a margin; null if there is no such volume. Links all.
  [[nodiscard]] static const VolumeInput* input_of(Volume volume) noexcept;

  /// `input` must outlive the rows.
  Rows(std::pmr::memory_resource* memory, const Execution& execution, const VolumeInput& input,
       const Margin& margin) noexcept;

  Status insert(const BoxView& boxes, std::span<const ClientData> data, std::span<Key> keys);
  Status update(const EntryList& entries, const BoxView& boxes);
  Status update(Key key, const Aabb& box);
  /// The same by spheres or k-DOPs; `unsupported_volume` where others are stored.
  template <typename V>
  Status insert(std::span<const V> volumes, std::span<const ClientData> data, std::span<Key> keys);
  template <typename V>
  Status update(std::span<const Key> keys, std::span<const V> volumes);

  /// What an update with these boxes would answer.
  [[nodiscard]] Status check(const EntryList& entries, const BoxView& boxes) const;
  /// Gives every row of boxes the one that stands at its object's id, if there is one.
  void write_by_id(const BoxView& boxes) noexcept;

  Status remove(Key key);
  Status remove(std::span<const Key> keys);
  void clear() noexcept;
  /// Room for so many objects in all, in as many rows.
  Status reserve(std::size_t objects);
  /// Writes to the pages that hold nothing yet.
  void touch() noexcept;
  /// Gives back what nobody's objects need; everything if there are none.
  void release_memory() noexcept;

  /// Of rows that never held an object: they become the saved ones, in rows by id, with the keys
  /// that they had (see KeyTable::restore). `invalid_argument` for what no rows can have been;
  /// nothing changed then.
  Status restore(const SavedRows& saved, Rows& other);

  Status set_filter(std::span<const Key> keys, std::span<const ObjectFilter> filters);
  Status bounds(Key key, Aabb& box) const noexcept;
  /// The boxes of objects with valid keys, one for each.
  void read_bounds(std::span<const Key> keys, std::span<Aabb> boxes) const noexcept;

  [[nodiscard]] std::size_t size() const noexcept { return keys_.size(); }
  [[nodiscard]] const BoundsPool& pool() const noexcept { return pool_; }
  [[nodiscard]] const KeyTable& keys() const noexcept { return keys_; }
  [[nodiscard]] const FilterTable& filters() const noexcept { return filters_; }
  [[nodiscard]] const Execution& execution() const noexcept { return execution_; }
  [[nodiscard]] const Margin& margin() const noexcept { return margin_; }
  [[nodiscard]] const RowRegions& regions() const noexcept { return regions_; }
  /// What kernels see of the rows.
  [[nodiscard]] RowView view() const noexcept;
  /// How work on so many objects is best run.
  [[nodiscard]] Execution execution_for(std::size_t objects) const noexcept;
  void add_bytes(Footprint& footprint) const noexcept;

  // For who brings the rows in order.

  /// True from a change on until `settle`.
  [[nodiscard]] bool changed() const noexcept { return changed_; }
  /// Objects that changed since the last `settle`.
  [[nodiscard]] const ChangeList& stale() const noexcept { return stale_; }
  /// Ends a refresh: nothing is stale any more. Objects that were have moved, if anybody tracks
  /// moves.
  void settle(bool track_moves) noexcept;
  /// Objects that changed since `forget_moves`, as far as they were tracked.
  [[nodiscard]] const ChangeList& moved() const noexcept { return moved_; }
  void forget_moves() const noexcept { moved_.clear(); }

  [[nodiscard]] RowRegions& regions() noexcept { return regions_; }
  /// The next refresh has to order the rows.
  void disorder() noexcept;
  void pad() noexcept { pool_.pad(); }
  [[nodiscard]] bool reserve_rows(std::size_t rows) noexcept { return pool_.reserve_exact(rows); }
  /// Closes all holes; the rows are in no order then.
  void compact() noexcept;
  /// Row i becomes what row order[i] is. `spare` must have room for the pool's capacity and two
  /// blocks more.
  void reorder(std::span<const std::uint32_t> order, Column<float>& spare) noexcept;
  /// The same for the rows from `begin` on alone, on the calling thread.
  void reorder_tail(std::size_t begin, std::span<const std::uint32_t> order,
                    Column<float>& spare) noexcept;
  /// Puts rows behind the last one, and leaves holes. Room was made.
  void move_to_end(std::span<const std::uint32_t> rows) noexcept;
  /// The rows stand in an order that is good for as long as most objects are within `far` of where
  /// they were; 0: for ever.
  void note_build(float far) noexcept {
    filters_.note_build({pool_.ids(), pool_.rows()});
    far_ = far;
  }

  /// Scratch for who selects some of the rows; what it holds lasts until the next one does.
  [[nodiscard]] RowSelection& selection() const noexcept { return selection_; }

 private:
  [[nodiscard]] bool make_room(std::size_t objects) noexcept;
  [[nodiscard]] bool begin_filters() noexcept;
  void remove_row(ObjectId id) noexcept;
  void fetch_row(std::size_t row) const noexcept;

  // Of volumes that are stored in some way: as a source offers them, or with the margin.
  template <typename Source, typename Stored>
  [[nodiscard]] static const VolumeInput& input() noexcept;
  template <typename Source, typename Stored>
  Status insert_boxes(const BoxView& boxes, std::span<const ClientData> data, std::span<Key> keys);
  template <typename Source, typename Stored>
  Status update_boxes(const EntryList& entries, const BoxView& boxes);
  template <typename Source, typename Stored>
  Status update_box(Key key, const BoxView& box);
  template <typename Stored, typename Source>
  Status insert_from(const Source& source, std::size_t count, std::span<const ClientData> data,
                     std::span<Key> keys);
  [[nodiscard]] KeyTable::RunOfKeys look_at(const EntryList& entries, std::size_t begin,
                                            std::size_t end) const noexcept;
  template <typename Source>
  Status check_update(const Source& source, std::size_t volumes, const EntryList& entries,
                      bool& ascending) const;
  template <typename Stored, typename Source>
  Status update_from(const Source& source, std::size_t volumes, const EntryList& entries);
  template <typename Stored, typename Source>
  Status update_one(const Source& source, Key key);
  template <typename Source>
  Status write(const Source& source, const EntryList& entries, bool ascending);
  bool goes_by_rows(const EntryList& entries, bool ascending, BoxOfId& entry_of);
  template <typename Source>
  [[nodiscard]] bool scatters(const Source& source, std::span<const Key> keys) const noexcept;
  template <typename Source>
  void write_all(const Source& source, std::span<const Key> keys);
  template <typename Source, typename Visit>
  void for_rows(const Source& source, const EntryOfRow& entry_of, const Visit& visit);
  template <typename Visit>
  void for_entries(const EntryList& entries, bool ascending, const Visit& visit);
  template <typename Source>
  void write_new(const Source& source, std::span<const Key> keys, std::size_t first,
                 std::size_t begin, std::size_t end);
  void note_stale(const EntryList& entries) noexcept;
  void note_left(const EntryList& entries, bool by_rows, std::size_t slots) noexcept;

  Execution execution_;
  Margin margin_;
  const VolumeInput& input_;
  BoundsPool pool_;
  KeyTable keys_;
  FilterTable filters_;
  RowRegions regions_;
  float far_ = 0.0F;
  bool changed_ = false;
  std::uint64_t arrangement_ = 1;  // see RowView
  ChangeList stale_;
  mutable ChangeList moved_;
  mutable RowSelection selection_;
};

}  // namespace winnow
