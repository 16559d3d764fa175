// Insert and update of volumes other than boxes that are stored as given: spheres, k-DOPs, boxes
// that are converted into these, and volumes with a fat margin. The steps are those of RowInput;
// the sources in volume_source.h and fat_volumes.h validate and write. Nothing in a program that
// uses only boxes refers to this code.

#include "partitions/rows/fat_volumes.h"
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
  return is_none(margin) ? use(source) : use(FatSource<Source>{source, margin});
}

}  // namespace

/// The functions of VolumeInput, by the source that reads the given volumes.
struct VolumeUpdate : RowInput {
  explicit VolumeUpdate(const RowInput& input) noexcept : RowInput(input) {}

  template <typename Source>
  Status insert(const Source& source, std::size_t count, std::span<const ClientData> data,
                std::span<Key> keys) {
    Status status = check_insert(count, data, keys);
    if (status != Status::ok) return status;
    if (!all_valid(source, UpdateSubset(count), rows_.execution_)) return Status::invalid_bounds;
    std::size_t first = 0;
    status = begin_insert(count, data, keys, first);
    if (status != Status::ok || count == 0) return status;
    with_margin(source, rows_.fat_margin_, [&](const auto& stored) {
      for_ranges(rows_.execution_, count, [&](std::size_t begin, std::size_t end) {
        write_new(stored, keys, first, begin, end);
      });
    });
    return Status::ok;
  }

  template <typename Source>
  Status update(const Source& source, std::size_t volumes, const UpdateSubset& entries) {
    bool ascending = false;
    const Status status = check_keys(volumes, entries, ascending);
    if (status != Status::ok) return status;
    if (!all_valid(source, entries, rows_.execution_)) return Status::invalid_bounds;
    if (entries.count == 0) return Status::ok;
    return with_margin(source, rows_.fat_margin_,
                       [&](const auto& stored) { return write_all(stored, entries, ascending); });
  }

  template <typename Source>
  Status update_one(const Source& source, Key key) {
    if (!source.valid(0)) return Status::invalid_bounds;
    const PoolColumns columns(rows_.pool_);
    const std::size_t row = rows_.keys_.row_of(key.id);
    const bool wrote = with_margin(source, rows_.fat_margin_, [&](const auto& stored) {
      return write_one(stored, columns.pointers, row);
    });
    if (!wrote) return Status::ok;
    rows_.changes_.add(key.id);
    return Status::ok;
  }

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

  template <typename Source>
  Status write_all(const Source& source, const UpdateSubset& entries, bool ascending) {
    write(source, entries, ascending);
    return Status::ok;
  }

  /// Writes the volumes that left their fat volumes, and notes only these as changed.
  template <typename Source>
  Status write_all(const FatSource<Source>& fat, const UpdateSubset& entries, bool ascending) {
    const PoolColumns columns(rows_.pool_);
    EntryOfId entry_of_id{};
    const bool by_rows = writes_by_rows(entries, ascending, entry_of_id);
    const EntryOfRow entry_of{entry_of_id, rows_.pool_.ids()};
    const std::size_t slots = by_rows ? rows_.pool_.rows() : entries.count;
    if (!rows_.selection_.reserve_bits(slots)) return Status::out_of_memory;
    std::uint64_t* const departed = rows_.selection_.bits.data();
    if (by_rows) {
      for_ranges(rows_.execution_, slots, [&](std::size_t begin, std::size_t end) {
        write_departed_rows(fat, entry_of, columns.pointers, begin, end, departed);
      });
    } else {
      for_entries(entries, ascending, [&](std::size_t i, std::size_t row, std::size_t j) {
        const bool wrote = fat.write_if_departed(i, columns.pointers, row);
        departed[j >> 6U] |= std::uint64_t{wrote} << (j & 63U);
      });
    }
    note_departed(entries, by_rows, slots);
    return Status::ok;
  }

  /// Adds the objects whose bits are set in the selection to `stale` and clears the bits, which are
  /// indexed by row or by entry.
  void note_departed(const UpdateSubset& entries, bool by_rows, std::size_t slots) noexcept {
    for (std::size_t w = 0; w < bitmap_words(slots); ++w) {
      std::uint64_t bits = std::exchange(rows_.selection_.bits[w], 0);
      for (; bits != 0; bits &= bits - 1) {
        const std::size_t slot = 64 * w + static_cast<std::size_t>(std::countr_zero(bits));
        rows_.changes_.add(by_rows ? rows_.pool_.ids()[slot] : entries.key(slot).id);
      }
    }
  }
};

namespace {

/// The table for boxes that `Source` converts.
template <typename Source>
constexpr VolumeInput kVolumeInput{
    Source::kVolume,
    [](RowInput& in, const BoxView& boxes, std::span<const ClientData> data, std::span<Key> keys) {
      return VolumeUpdate(in).insert(Source{boxes}, boxes.count, data, keys);
    },
    [](RowInput& in, const UpdateSubset& entries, const BoxView& boxes) {
      return VolumeUpdate(in).update(Source{boxes}, boxes.count, entries);
    },
    [](RowInput& in, Key key, const BoxView& box) {
      return VolumeUpdate(in).update_one(Source{box}, key);
    }};

}  // namespace

template <typename V>
Status RowInput::insert(std::span<const V> volumes, std::span<const ClientData> data,
                        std::span<Key> keys) {
  const auto source = source_of(volumes);
  if (source.kVolume != rows_.pool_.volume()) return Status::unsupported_volume;
  return VolumeUpdate(*this).insert(source, volumes.size(), data, keys);
}

template <typename V>
Status RowInput::update(std::span<const Key> keys, std::span<const V> volumes) {
  const auto source = source_of(volumes);
  if (source.kVolume != rows_.pool_.volume()) return Status::unsupported_volume;
  return VolumeUpdate(*this).update(source, volumes.size(), UpdateSubset(keys));
}

const VolumeInput* RowInput::of(Volume volume, const FatMargin& fat_margin) noexcept {
  switch (volume) {
    case Volume::aabb:
      return is_none(legal(fat_margin)) ? &boxes_as_given() : &kVolumeInput<BoxSource>;
    case Volume::sphere:
      return &kVolumeInput<SphereAroundBoxSource>;
    case Volume::kdop14:
      return &kVolumeInput<KdopAroundBoxSource<14>>;
    case Volume::kdop18:
      return &kVolumeInput<KdopAroundBoxSource<18>>;
    case Volume::kdop26:
      return &kVolumeInput<KdopAroundBoxSource<26>>;
  }
  return nullptr;
}

template Status RowInput::insert(std::span<const Sphere>, std::span<const ClientData>,
                                 std::span<Key>);
template Status RowInput::insert(std::span<const Kdop<14>>, std::span<const ClientData>,
                                 std::span<Key>);
template Status RowInput::insert(std::span<const Kdop<18>>, std::span<const ClientData>,
                                 std::span<Key>);
template Status RowInput::insert(std::span<const Kdop<26>>, std::span<const ClientData>,
                                 std::span<Key>);
template Status RowInput::update(std::span<const Key>, std::span<const Sphere>);
template Status RowInput::update(std::span<const Key>, std::span<const Kdop<14>>);
template Status RowInput::update(std::span<const Key>, std::span<const Kdop<18>>);
template Status RowInput::update(std::span<const Key>, std::span<const Kdop<26>>);

}  // namespace winnow
