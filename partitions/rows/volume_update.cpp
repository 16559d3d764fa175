// Insert and update of volumes other than boxes that are stored as given: spheres, k-DOPs, boxes
// that are converted into these, and volumes with a fat margin. The steps are those of
// box_update.cpp, whose functions check keys and find rows; the sources in volume_source.h and
// fat_volumes.h validate and write. Nothing in a program that uses only boxes refers to this code.

#include "core/memory/columns.h"
#include "partitions/rows/fat_volumes.h"
#include "partitions/rows/rows.h"
#include "partitions/rows/volume_source.h"

#include <bit>
#include <utility>

namespace winnow {
namespace {

SphereSource source_of(std::span<const Sphere> spheres) noexcept {
  return {spheres};
}
template <int K>
KdopSource<K> source_of(std::span<const Kdop<K>> kdops) noexcept {
  return {kdops};
}

/// Calls use(source), with the source enlarged by the margin if there is one.
template <typename Source, typename Use>
auto with_margin(const Source& source, const FatMargin& margin, Use&& use) {
  return margin.is_none() ? use(source) : use(FatSource<Source>{source, margin});
}

}  // namespace

/// The functions of VolumeInput, by the source that reads the given volumes.
struct VolumeUpdate {
  template <typename Source>
  static Status insert(Rows& rows, const Source& source, std::size_t count,
                       std::span<const ClientData> data, std::span<Key> keys) {
    Status status = rows.check_insert(count, data, keys);
    if (status != Status::ok) return status;
    if (!all_valid(source, UpdateSubset(count), rows.execution_)) return Status::invalid_bounds;
    std::size_t first = 0;
    status = rows.begin_insert(count, data, keys, first);
    if (status != Status::ok || count == 0) return status;
    with_margin(source, rows.fat_margin_,
                [&](const auto& stored) { write_new(rows, stored, keys, first, false); });
    return Status::ok;
  }

  template <typename Source>
  static Status update(Rows& rows, const Source& source, std::size_t volumes,
                       const UpdateSubset& entries) {
    bool ascending = false;
    const Status status = rows.check_keys(volumes, entries, ascending);
    if (status != Status::ok) return status;
    if (!all_valid(source, entries, rows.execution_)) return Status::invalid_bounds;
    if (entries.count == 0) return Status::ok;
    return with_margin(source, rows.fat_margin_,
                       [&](const auto& stored) { return write(rows, stored, entries, ascending); });
  }

  template <typename Source>
  static Status update_one(Rows& rows, const Source& source, Key key) {
    if (!source.valid(0)) return Status::invalid_bounds;
    const PoolColumns columns(rows.pool_);
    const std::size_t row = rows.keys_.row_of(key.id);
    const bool wrote = with_margin(source, rows.fat_margin_, [&](const auto& stored) {
      return write_one(stored, columns.pointers, row);
    });
    if (!wrote) return Status::ok;
    rows.stale_.add(key.id);
    rows.changed_ = true;
    return Status::ok;
  }

  /// The table for boxes that `Source` converts.
  template <typename Source>
  static constexpr VolumeInput kInput{
      Source::kVolume,
      [](Rows& rows, const BoxView& boxes, std::span<const ClientData> data, std::span<Key> keys) {
        return insert(rows, Source{boxes}, boxes.count, data, keys);
      },
      [](Rows& rows, const UpdateSubset& entries, const BoxView& boxes) {
        return update(rows, Source{boxes}, boxes.count, entries);
      },
      [](Rows& rows, Key key, const BoxView& box) { return update_one(rows, Source{box}, key); }};

 private:
  template <typename Source>
  static bool write_one(const Source& source, ColumnPointers columns, std::size_t row) {
    source.write(0, columns, row);
    return true;
  }
  template <typename Source>
  static bool write_one(const FatSource<Source>& fat, ColumnPointers columns, std::size_t row) {
    return fat.write_if_departed(0, columns, row);
  }

  /// Writes volume i to row first + i. `anew`: also gives object i this row; `first` is 0 then.
  template <typename Source>
  static void write_new(Rows& rows, const Source& source, std::span<const Key> keys,
                        std::size_t first, bool anew) {
    const PoolColumns columns(rows.pool_);
    for_ranges(rows.execution_, keys.size(), [&](std::size_t begin, std::size_t end) {
      if (anew) rows.number_rows(keys, begin, end);
      rows.place_new(keys, first, begin, end);
      for (std::size_t i = begin; i < end; ++i) source.write(i, columns.pointers, first + i);
    });
  }

  /// Writes volumes as given.
  template <typename Source>
  static Status write(Rows& rows, const Source& source, const UpdateSubset& entries,
                      bool ascending) {
    rows.note_stale(entries);
    EntryOfId entry_of_id{};
    if (!rows.writes_by_rows(entries, ascending, entry_of_id)) {
      const PoolColumns columns(rows.pool_);
      rows.for_entries(entries, ascending, [&](std::size_t i, std::size_t row, std::size_t) {
        source.write(i, columns.pointers, row);
      });
    } else if (rows.loses_order(source, entries)) {
      rows.pool_.clear();
      rows.pool_.append(entries.count);
      write_new(rows, source, entries.keys, 0, true);
      rows.invalidate_order();
    } else {
      write_by_rows(rows, source, {entry_of_id, rows.pool_.ids()});
    }
    return Status::ok;
  }

  template <typename Source>
  static void write_by_rows(Rows& rows, const Source& source, const EntryOfRow& entry_of) {
    const PoolColumns columns(rows.pool_);
    for_ranges(rows.execution_, rows.pool_.rows(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row) {
        if constexpr (requires { source.fetch(begin); }) {
          const std::size_t ahead =
              row + kFetchAhead < end ? entry_of[row + kFetchAhead] : kNoObject;
          if (ahead != kNoObject) source.fetch(ahead);
        }
        const std::size_t i = entry_of[row];
        if (i != kNoObject) source.write(i, columns.pointers, row);
      }
    });
  }

  /// Writes the volumes that left their fat volumes, and notes only these as changed.
  template <typename Source>
  static Status write(Rows& rows, const FatSource<Source>& fat, const UpdateSubset& entries,
                      bool ascending) {
    const PoolColumns columns(rows.pool_);
    EntryOfId entry_of_id{};
    const bool by_rows = rows.writes_by_rows(entries, ascending, entry_of_id);
    const EntryOfRow entry_of{entry_of_id, rows.pool_.ids()};
    const std::size_t slots = by_rows ? rows.pool_.rows() : entries.count;
    if (!rows.selection_.reserve_bits(slots)) return Status::out_of_memory;
    std::uint64_t* const departed = rows.selection_.bits.data();
    if (by_rows) {
      for_ranges(rows.execution_, slots, [&](std::size_t begin, std::size_t end) {
        write_departed_rows(fat, entry_of, columns.pointers, begin, end, departed);
      });
    } else {
      rows.for_entries(entries, ascending, [&](std::size_t i, std::size_t row, std::size_t j) {
        const bool wrote = fat.write_if_departed(i, columns.pointers, row);
        departed[j >> 6U] |= std::uint64_t{wrote} << (j & 63U);
      });
    }
    note_departed(rows, entries, by_rows, slots);
    return Status::ok;
  }

  /// Adds the objects whose bits are set in the selection to `stale` and clears the bits, which are
  /// indexed by row or by entry.
  static void note_departed(Rows& rows, const UpdateSubset& entries, bool by_rows,
                            std::size_t slots) noexcept {
    bool any = false;
    for (std::size_t w = 0; w < bitmap_words(slots); ++w) {
      std::uint64_t bits = std::exchange(rows.selection_.bits[w], 0);
      for (; bits != 0; bits &= bits - 1) {
        const std::size_t slot = 64 * w + static_cast<std::size_t>(std::countr_zero(bits));
        rows.stale_.add(by_rows ? rows.pool_.ids()[slot] : entries.key(slot).id);
        any = true;
      }
    }
    if (any) rows.changed_ = true;
  }
};

template <typename V>
Status Rows::insert(std::span<const V> volumes, std::span<const ClientData> data,
                    std::span<Key> keys) {
  const auto source = source_of(volumes);
  if (source.kVolume != pool_.volume()) return Status::unsupported_volume;
  return VolumeUpdate::insert(*this, source, volumes.size(), data, keys);
}

template <typename V>
Status Rows::update(std::span<const Key> keys, std::span<const V> volumes) {
  const auto source = source_of(volumes);
  if (source.kVolume != pool_.volume()) return Status::unsupported_volume;
  return VolumeUpdate::update(*this, source, volumes.size(), UpdateSubset(keys));
}

const VolumeInput* Rows::input_of(Volume volume, const FatMargin& fat_margin) noexcept {
  switch (volume) {
    case Volume::aabb:
      return fat_margin.legal().is_none() ? &boxes_as_given() : &VolumeUpdate::kInput<BoxSource>;
    case Volume::sphere:
      return &VolumeUpdate::kInput<SphereAroundBoxSource>;
    case Volume::kdop14:
      return &VolumeUpdate::kInput<KdopAroundBoxSource<14>>;
    case Volume::kdop18:
      return &VolumeUpdate::kInput<KdopAroundBoxSource<18>>;
    case Volume::kdop26:
      return &VolumeUpdate::kInput<KdopAroundBoxSource<26>>;
  }
  return nullptr;
}

template Status Rows::insert(std::span<const Sphere>, std::span<const ClientData>, std::span<Key>);
template Status Rows::insert(std::span<const Kdop<14>>, std::span<const ClientData>,
                             std::span<Key>);
template Status Rows::insert(std::span<const Kdop<18>>, std::span<const ClientData>,
                             std::span<Key>);
template Status Rows::insert(std::span<const Kdop<26>>, std::span<const ClientData>,
                             std::span<Key>);
template Status Rows::update(std::span<const Key>, std::span<const Sphere>);
template Status Rows::update(std::span<const Key>, std::span<const Kdop<14>>);
template Status Rows::update(std::span<const Key>, std::span<const Kdop<18>>);
template Status Rows::update(std::span<const Key>, std::span<const Kdop<26>>);

}  // namespace winnow
