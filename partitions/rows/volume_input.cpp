// Insert and update of rows. Boxes go through VolumeInput and are converted into the stored volume;
// spheres and k-DOPs are stored directly. Partition and PartitionState call the public functions of
// Rows; the sources in volume_source.h validate and write.

#include "core/memory/columns.h"
#include "partitions/rows/fat_volumes.h"
#include "partitions/rows/rows.h"
#include "partitions/rows/volume_source.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <utility>

namespace winnow {

WINNOW_DEFINE_KERNELS(BoxInputKernels, box_input_kernels)

namespace {

/// Stores volumes as given.
struct AsGiven {
  template <typename Source, typename Use>
  static Status use(const Source& source, const FatMargin&, Use&& use) {
    return use(source);
  }
};

/// Stores volumes enlarged by the margin, if there is one.
struct WithMargin {
  template <typename Source, typename Use>
  static Status use(const Source& source, const FatMargin& margin, Use&& use) {
    if (margin.is_none()) return use(source);
    return use(FatSource<Source>{source, margin});
  }
};

SphereSource source_of(std::span<const Sphere> spheres) noexcept {
  return {spheres};
}
template <int K>
KdopSource<K> source_of(std::span<const Kdop<K>> kdops) noexcept {
  return {kdops};
}

/// True if the source may leave a stored volume unchanged (see FatSource).
template <typename Source>
constexpr bool kMayStay = requires(const Source& source) {
  source.write_if_departed(0, ColumnPointers{}, 0);
};

/// Returns the smallest and largest id of the entries.
std::ranges::minmax_result<ObjectId> ends_of_ids(const UpdateSubset& entries,
                                                 bool ascending) noexcept {
  if (ascending) return {entries.key(0).id, entries.key(entries.count - 1).id};
  std::ranges::minmax_result<ObjectId> ends{entries.key(0).id, entries.key(0).id};
  for (std::size_t j = 1; j < entries.count; ++j) {
    ends.min = std::min(ends.min, entries.key(j).id);
    ends.max = std::max(ends.max, entries.key(j).id);
  }
  return ends;
}

}  // namespace

Status Rows::insert(const BoxView& boxes, std::span<const ClientData> data, std::span<Key> keys) {
  return (this->*input_.insert)(boxes, data, keys);
}

Status Rows::update(const UpdateSubset& entries, const BoxView& boxes) {
  return (this->*input_.update)(entries, boxes);
}

Status Rows::update(Key key, const Aabb& box) {
  if (!keys_.is_valid(key)) return Status::invalid_key;
  return (this->*input_.update_one)(key, BoxView(std::span<const Aabb>(&box, 1)));
}

template <typename V>
Status Rows::insert(std::span<const V> volumes, std::span<const ClientData> data,
                    std::span<Key> keys) {
  const auto source = source_of(volumes);
  if (source.kVolume != pool_.volume()) return Status::unsupported_volume;
  return insert_from<WithMargin>(source, volumes.size(), data, keys);
}

template <typename V>
Status Rows::update(std::span<const Key> keys, std::span<const V> volumes) {
  const auto source = source_of(volumes);
  if (source.kVolume != pool_.volume()) return Status::unsupported_volume;
  return update_from<WithMargin>(source, volumes.size(), keys);
}

template <typename Stored, typename Source>
Status Rows::insert_from(const Source& source, std::size_t count, std::span<const ClientData> data,
                         std::span<Key> keys) {
  if (keys.size() != count || (!data.empty() && data.size() != count)) return Status::size_mismatch;
  if (count > kMaxObjects - keys_.size()) return Status::too_many_objects;
  if (!all_valid(source, UpdateSubset(count), execution_)) return Status::invalid_bounds;
  if (!make_room(keys_.size() + count)) return Status::out_of_memory;
  if (count == 0) return Status::ok;
  const std::size_t first = pool_.rows();
  ++arrangement_;
  filters_.note_new();
  pool_.append(count);
  keys_.acquire(static_cast<std::uint32_t>(first), data, keys, execution_);
  note_stale(std::span<const Key>(keys));
  return Stored::use(source, fat_margin_, [&](const auto& volumes) {
    for_ranges(execution_, count, [&](std::size_t begin, std::size_t end) {
      write_new(volumes, keys, first, begin, end);
    });
    return Status::ok;
  });
}

/// Writes entry i, its id and its filter to row first + i, for i in [begin, end).
template <typename Source>
void Rows::write_new(const Source& source, std::span<const Key> keys, std::size_t first,
                     std::size_t begin, std::size_t end) {
  const PoolColumns columns(pool_);
  for (std::size_t i = begin; i < end; ++i) pool_.ids()[first + i] = keys[i].id;
  for (std::size_t i = begin; i < end && pool_.has_filters(); ++i) {
    pool_.set_filter(first + i, filters_.of(keys[i].id));
  }
  if constexpr (requires { source.write_in_order(begin, end, columns.pointers, first); }) {
    if (source.packed()) return source.write_in_order(begin, end, columns.pointers, first + begin);
  }
  for (std::size_t i = begin; i < end; ++i) source.write(i, columns.pointers, first + i);
}

/// Checks the keys of entries [begin, end), whose indices are consecutive.
KeyTable::KeysCheck Rows::check_keys(const UpdateSubset& entries, std::size_t begin,
                                     std::size_t end) const noexcept {
  if (end - begin >= UpdateSubset::kLongRun) {
    return keys_.check_keys(entries.keys.subspan(entries[begin], end - begin));
  }
  KeyTable::KeysCheck run;
  for (std::size_t j = begin; j < end; ++j) {
    run.valid &= keys_.is_valid(entries.key(j));
    run.ascending &= j == begin || entries.key(j - 1).id < entries.key(j).id;
  }
  return run;
}

/// Returns the status of an invalid update; sets `ascending` if ids strictly ascend.
template <typename Source>
Status Rows::check_update(const Source& source, std::size_t volumes, const UpdateSubset& entries,
                          bool& ascending) const {
  if (entries.keys.size() != volumes) return Status::size_mismatch;
  std::atomic<bool> known{true};
  std::atomic<bool> rising{true};
  for_ranges(execution_, entries.count, [&](std::size_t begin, std::size_t end) {
    bool ok = true;
    bool up = true;
    for (std::size_t next = begin; begin < end; begin = next) {
      next = entries.run_end(begin, end);
      if (next + kFetchAhead < end) __builtin_prefetch(&entries.keys[entries[next + kFetchAhead]]);
      const KeyTable::KeysCheck run = check_keys(entries, begin, next);
      ok &= run.valid;
      up &= run.ascending && (begin == 0 || entries.key(begin - 1).id < entries.key(begin).id);
    }
    if (!ok) known.store(false, std::memory_order_relaxed);
    if (!up) rising.store(false, std::memory_order_relaxed);
  });
  ascending = rising.load();
  if (!known.load()) return Status::invalid_key;
  return all_valid(source, entries, execution_) ? Status::ok : Status::invalid_bounds;
}

template <typename Stored, typename Source>
Status Rows::update_from(const Source& source, std::size_t volumes, const UpdateSubset& entries) {
  bool ascending = false;
  const Status status = check_update(source, volumes, entries, ascending);
  if (status != Status::ok || entries.count == 0) return status;
  return Stored::use(source, fat_margin_,
                     [&](const auto& stored) { return write(stored, entries, ascending); });
}

template <typename Stored, typename Source>
Status Rows::update_one(const Source& source, Key key) {
  if (!source.valid(0)) return Status::invalid_bounds;
  return Stored::use(source, fat_margin_, [&](const auto& volumes) {
    const PoolColumns columns(pool_);
    const std::size_t row = keys_.row_of(key.id);
    if constexpr (requires { volumes.write_if_departed(0, columns.pointers, row); }) {
      if (!volumes.write_if_departed(0, columns.pointers, row)) return Status::ok;
    } else {
      volumes.write(0, columns.pointers, row);
    }
    stale_.add(key.id);
    changed_ = true;
    return Status::ok;
  });
}

/// True if an update writes rows in row order instead of entry order: if more than half of the rows
/// change, and there are at most half as many other ids between the smallest and the largest one.
/// It then reads entries in arbitrary order but writes each of the six columns in order, which
/// touches a sixth of the cache lines. A table maps ids to entries unless ids and entries
/// correspond one to one. False if a key occurs twice, because its entries must be written in
/// order.
bool Rows::writes_by_rows(const UpdateSubset& entries, bool ascending, BoxOfId& entry_of) {
  const std::size_t count = entries.count;
  if (2 * count <= pool_.rows()) return false;
  const auto [first, last] = ends_of_ids(entries, ascending);
  const std::size_t ids = last - first + std::size_t{1};
  if (ids > count + count / 2) return false;
  entry_of = {first, static_cast<std::uint32_t>(ids)};
  if (ascending && ids == count && entries.number == nullptr) return true;
  if (!selection_.list.resize(ids)) return false;
  std::uint32_t* const table = selection_.list.data();
  entry_of.table = table;
  std::fill(table, table + ids, kNoObject);
  if (ascending && entries.number == nullptr) {
    std::uint32_t entry = 0;
    for (const Key& key : entries.keys) table[key.id - first] = entry++;
    return true;
  }
  for (std::size_t j = 0; j < count; ++j) {
    std::uint32_t& entry = table[entries.key(j).id - first];
    if (entry != kNoObject) return false;
    entry = static_cast<std::uint32_t>(entries[j]);
  }
  return true;
}

template <typename Source>
Status Rows::write(const Source& source, const UpdateSubset& entries, bool ascending) {
  const PoolColumns columns(pool_);
  BoxOfId entry_of_id{};
  const bool by_rows = writes_by_rows(entries, ascending, entry_of_id);
  const EntryOfRow entry_of{entry_of_id, pool_.ids()};
  if constexpr (kMayStay<Source>) {
    const std::size_t slots = by_rows ? pool_.rows() : entries.count;
    if (!selection_.reserve_bits(slots)) return Status::out_of_memory;
    std::uint64_t* const departed = selection_.bits.data();
    if (by_rows) {
      for_ranges(execution_, slots, [&](std::size_t begin, std::size_t end) {
        write_departed_rows(source, entry_of, columns.pointers, begin, end, departed);
      });
    } else {
      for_entries(entries, ascending, [&](std::size_t i, std::size_t row, std::size_t j) {
        const bool wrote = source.write_if_departed(i, columns.pointers, row);
        departed[j >> 6U] |= std::uint64_t{wrote} << (j & 63U);
      });
    }
    note_departed(entries, by_rows, slots);
    return Status::ok;
  } else {
    note_stale(entries);
    const bool all = by_rows && entries.number == nullptr && entries.count == keys_.size();
    if (all && order_is_lost(source, entries.keys)) {
      write_all(source, entries.keys);
      return Status::ok;
    }
    const auto one = [&](std::size_t i, std::size_t row) {
      source.write(i, columns.pointers, row);
    };
    if (by_rows) {
      for_rows(source, entry_of, one);
    } else {
      for_entries(entries, ascending,
                  [&](std::size_t i, std::size_t row, std::size_t) { one(i, row); });
    }
    return Status::ok;
  }
}

/// True if most objects move far and in different directions, so that the order of the rows is
/// worthless. Decided from a sample.
template <typename Source>
bool Rows::order_is_lost(const Source& source, std::span<const Key> keys) const noexcept {
  constexpr std::size_t kSample = 64;
  // With few rows the order does not matter.
  constexpr std::size_t kFewRows = 256;
  if (!regions_.built || !(order_reach_ > 0.0F) || keys.size() < kFewRows) return false;
  float volume[kMaxColumns];
  float* columns[kMaxColumns];
  for (std::size_t c = 0; c < pool_.columns(); ++c) columns[c] = volume + c;
  std::array<float, 3> before{};
  std::array<float, 3> edge_before{};
  std::size_t apart = 0;
  for (std::size_t k = 0; k < kSample; ++k) {
    const std::size_t i = keys.size() * k / kSample;
    const std::size_t row = keys_.row_of(keys[i].id);
    source.write(i, columns, 0);
    bool far = false;
    for (std::size_t a = 0; a < 3; ++a) {
      const float step = volume[a] - pool_.column(a)[row];
      const float edge = volume[3 + a] - volume[a];
      // Steps are compared with the previous sample's, because a common motion keeps the order. The
      // difference must also exceed the edges of both objects, because order_reach_ may stem from
      // much smaller objects.
      far |= std::abs(step - before[a]) > std::max({order_reach_, edge, edge_before[a]});
      before[a] = step;
      edge_before[a] = edge;
    }
    apart += far ? 1 : 0;
  }
  return 2 * apart > kSample;
}

/// Writes all objects in the order of the keys, entry i to row i.
template <typename Source>
void Rows::write_all(const Source& source, std::span<const Key> keys) {
  pool_.clear();
  pool_.append(keys.size());
  for_ranges(execution_, keys.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      keys_.set_row(keys[i].id, static_cast<std::uint32_t>(i));
    }
    write_new(source, keys, 0, begin, end);
  });
  invalidate_order();
}

void Rows::note_stale(const UpdateSubset& entries) noexcept {
  if (entries.count > stale_.limit()) {
    stale_.add_all();
  } else {
    for (std::size_t j = 0; j < entries.count; ++j) stale_.add(entries.key(j).id);
  }
  changed_ = true;
}

/// Adds the objects whose bits are set in the selection to `stale` and clears the bits, which are
/// indexed by row or by entry.
void Rows::note_departed(const UpdateSubset& entries, bool by_rows, std::size_t slots) noexcept {
  bool any = false;
  for (std::size_t w = 0; w < bitmap_words(slots); ++w) {
    for (std::uint64_t bits = std::exchange(selection_.bits[w], 0); bits != 0; bits &= bits - 1) {
      const std::size_t slot = 64 * w + static_cast<std::size_t>(std::countr_zero(bits));
      stale_.add(by_rows ? pool_.ids()[slot] : entries.key(slot).id);
      any = true;
    }
  }
  if (any) changed_ = true;
}

/// Calls visit(entry, row) for every row whose object has an entry.
template <typename Source, typename Visit>
void Rows::for_rows(const Source& source, const EntryOfRow& entry_of, const Visit& visit) {
  for_ranges(execution_, pool_.rows(), [&](std::size_t begin, std::size_t end) {
    if constexpr (requires { source.packed(); }) {
      // Packed boxes are written 16 rows at a time and not visited.
      const std::size_t whole = end - end % kBlockRows;
      if (source.packed()) {
        source.write_rows(entry_of.of_id, entry_of.id, PoolColumns(pool_).pointers, begin, whole);
        begin = whole;
      }
    }
    for (std::size_t row = begin; row < end; ++row) {
      if constexpr (requires { source.fetch(begin); }) {
        const std::size_t ahead = row + kFetchAhead < end ? entry_of[row + kFetchAhead] : kNoObject;
        if (ahead != kNoObject) source.fetch(ahead);
      }
      const std::size_t i = entry_of[row];
      if (i != kNoObject) visit(i, row);
    }
  });
}

/// Calls visit(entry, its row, j) for the j-th entry. Threads never share an aligned group of 64
/// entries, so that `visit` may set bit j of a bitmap.
template <typename Visit>
void Rows::for_entries(const UpdateSubset& entries, bool ascending, const Visit& visit) {
  const std::size_t count = entries.count;
  const auto go = [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) {
      if (j + kFetchAhead < end) fetch_row(keys_.row_of(entries.key(j + kFetchAhead).id));
      visit(entries[j], keys_.row_of(entries.key(j).id), j);
    }
  };
  // Only ascending ids are certain to be distinct; entries of a repeated key must be written in
  // order.
  if (ascending) {
    for_ranges(execution_, count, go);
  } else {
    go(0, count);
  }
}

Status Rows::check(const UpdateSubset& entries, const BoxView& boxes) const {
  bool ascending = false;
  return check_update(BoxSource{boxes}, boxes.count, entries, ascending);
}

void Rows::write_by_id(const BoxView& boxes) noexcept {
  const BoxSource source{boxes};
  const PoolColumns columns(pool_);
  const BoxOfId all{.first = 0, .ids = static_cast<std::uint32_t>(boxes.count)};
  for_rows(source, {all, pool_.ids()},
           [&](std::size_t id, std::size_t row) { source.write(id, columns.pointers, row); });
  stale_.add_all();
  changed_ = true;
}

template <typename Source, typename Stored>
Status Rows::insert_boxes(const BoxView& boxes, std::span<const ClientData> data,
                          std::span<Key> keys) {
  return insert_from<Stored>(Source{boxes}, boxes.count, data, keys);
}

template <typename Source, typename Stored>
Status Rows::update_boxes(const UpdateSubset& entries, const BoxView& boxes) {
  return update_from<Stored>(Source{boxes}, boxes.count, entries);
}

template <typename Source, typename Stored>
Status Rows::update_box(Key key, const BoxView& box) {
  return update_one<Stored>(Source{box}, key);
}

template <typename Source, typename Stored>
const VolumeInput& Rows::input() noexcept {
  static constexpr VolumeInput kInput{Source::kVolume, &Rows::insert_boxes<Source, Stored>,
                                      &Rows::update_boxes<Source, Stored>,
                                      &Rows::update_box<Source, Stored>};
  return kInput;
}

const VolumeInput& Rows::boxes_as_given() noexcept {
  return input<BoxSource, AsGiven>();
}

const VolumeInput* Rows::input_of(Volume volume) noexcept {
  switch (volume) {
    case Volume::aabb:
      return &input<BoxSource, WithMargin>();
    case Volume::sphere:
      return &input<SphereAroundBoxSource, WithMargin>();
    case Volume::kdop14:
      return &input<KdopAroundBoxSource<14>, WithMargin>();
    case Volume::kdop18:
      return &input<KdopAroundBoxSource<18>, WithMargin>();
    case Volume::kdop26:
      return &input<KdopAroundBoxSource<26>, WithMargin>();
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
