#include "partitions/rows/rows.h"

#include "core/memory/columns.h"
#include "core/sort/own_rows.h"
#include "partitions/rows/fat_volumes.h"
#include "partitions/rows/volume_source.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cfloat>
#include <cmath>
#include <limits>
#include <utility>

namespace winnow {

WINNOW_DEFINE_KERNELS(BoxInputKernels, box_input_kernels)

namespace {

/// Calls use(source) with the source that turns boxes into the pool's volume.
template <typename Use>
Status with_box_source(Volume volume, const BoxView& boxes, Use&& use) {
  switch (volume) {
    case Volume::aabb:
      return use(BoxSource{boxes});
    case Volume::sphere:
      return use(SphereAroundBoxSource{boxes});
    case Volume::kdop14:
      return use(KdopAroundBoxSource<14>{boxes});
    case Volume::kdop18:
      return use(KdopAroundBoxSource<18>{boxes});
    case Volume::kdop26:
      return use(KdopAroundBoxSource<26>{boxes});
  }
  return Status::unsupported_volume;
}

/// The source of volumes that are stored as they are given.
SphereSource source_of(std::span<const Sphere> spheres) noexcept {
  return {spheres};
}
template <int K>
KdopSource<K> source_of(std::span<const Kdop<K>> kdops) noexcept {
  return {kdops};
}

/// True if a row's volume may stay as it is though the source offers another.
template <typename Source>
constexpr bool kMayStay = requires(const Source& source) {
  source.write_if_left(0, ColumnPointers{}, 0);
};

/// The least and the largest id of entries; where ids ascend, those at their ends.
std::ranges::minmax_result<ObjectId> ends_of_ids(const EntryList& entries,
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

Rows::Rows(std::pmr::memory_resource* memory, const Execution& execution, Volume volume,
           const Margin& margin) noexcept
    : execution_(execution),
      margin_(margin.legal()),
      pool_(memory, volume),
      keys_(memory),
      filters_(memory),
      stale_(memory),
      moved_(memory),
      selection_(memory) {}

Execution Rows::execution_for(std::size_t objects) const noexcept {
  // Below this a task costs more to hand over than to do.
  constexpr std::size_t kWorthSharing = 1536;
  return objects < kWorthSharing ? Execution::serial() : execution_;
}

// Taking volumes in.

Status Rows::insert(const BoxView& boxes, std::span<const ClientData> data, std::span<Key> keys) {
  return with_box_source(pool_.volume(), boxes, [&](const auto& source) {
    return insert_from(source, boxes.count, data, keys);
  });
}

Status Rows::update(const EntryList& entries, const BoxView& boxes) {
  return with_box_source(pool_.volume(), boxes, [&](const auto& source) {
    return update_from(source, boxes.count, entries);
  });
}

Status Rows::update(Key key, const Aabb& box) {
  if (!keys_.is_valid(key)) return Status::invalid_key;
  const BoxView boxes(std::span<const Aabb>(&box, 1));
  return with_box_source(pool_.volume(), boxes,
                         [&](const auto& source) { return update_one(source, key); });
}

template <typename V>
Status Rows::insert(std::span<const V> volumes, std::span<const ClientData> data,
                    std::span<Key> keys) {
  const auto source = source_of(volumes);
  if (source.kVolume != pool_.volume()) return Status::unsupported_volume;
  return insert_from(source, volumes.size(), data, keys);
}

template <typename V>
Status Rows::update(std::span<const Key> keys, std::span<const V> volumes) {
  const auto source = source_of(volumes);
  if (source.kVolume != pool_.volume()) return Status::unsupported_volume;
  return update_from(source, volumes.size(), keys);
}

/// Calls use(source) with the source itself or, if volumes are stored larger, with one that makes
/// them so.
template <typename Source, typename Use>
Status Rows::with_margin(const Source& source, Use&& use) {
  if (margin_.is_none()) return use(source);
  return use(FatSource<Source>{source, margin_});
}

template <typename Source>
Status Rows::insert_from(const Source& source, std::size_t count, std::span<const ClientData> data,
                         std::span<Key> keys) {
  if (keys.size() != count || (!data.empty() && data.size() != count)) return Status::size_mismatch;
  if (count > kMaxObjects - keys_.size()) return Status::too_many_objects;
  if (!all_valid(source, EntryList(count), execution_)) return Status::invalid_bounds;
  if (!make_room(keys_.size() + count)) return Status::out_of_memory;
  if (count == 0) return Status::ok;
  const std::size_t first = pool_.rows();
  ++arrangement_;
  filters_.note_new();
  pool_.append(count);
  keys_.acquire(static_cast<std::uint32_t>(first), data, keys, execution_);
  note_stale(std::span<const Key>(keys));
  return with_margin(source, [&](const auto& volumes) {
    for_ranges(execution_, count, [&](std::size_t begin, std::size_t end) {
      write_new(volumes, keys, first, begin, end);
    });
    return Status::ok;
  });
}

/// Writes entries [begin, end) to the rows from `first` on that they have been given.
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

/// What is known of the keys of entries [begin, end), which follow each other.
KeyTable::RunOfKeys Rows::look_at(const EntryList& entries, std::size_t begin,
                                  std::size_t end) const noexcept {
  if (end - begin >= EntryList::kLongRun) {
    return keys_.look_at(entries.keys.subspan(entries[begin], end - begin));
  }
  KeyTable::RunOfKeys run;
  for (std::size_t j = begin; j < end; ++j) {
    run.valid &= keys_.is_valid(entries.key(j));
    run.ascending &= j == begin || entries.key(j - 1).id < entries.key(j).id;
  }
  return run;
}

/// Refuses an update that must be, and tells whether ids ascend, each once.
template <typename Source>
Status Rows::check_update(const Source& source, std::size_t volumes, const EntryList& entries,
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
      const KeyTable::RunOfKeys run = look_at(entries, begin, next);
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

template <typename Source>
Status Rows::update_from(const Source& source, std::size_t volumes, const EntryList& entries) {
  bool ascending = false;
  const Status status = check_update(source, volumes, entries, ascending);
  if (status != Status::ok || entries.count == 0) return status;
  return with_margin(source, [&](const auto& fat) { return write(fat, entries, ascending); });
}

template <typename Source>
Status Rows::update_one(const Source& source, Key key) {
  if (!source.valid(0)) return Status::invalid_bounds;
  return with_margin(source, [&](const auto& volumes) {
    const PoolColumns columns(pool_);
    const std::size_t row = keys_.row_of(key.id);
    if constexpr (requires { volumes.write_if_left(0, columns.pointers, row); }) {
      if (!volumes.write_if_left(0, columns.pointers, row)) return Status::ok;
    } else {
      volumes.write(0, columns.pointers, row);
    }
    stale_.add(key.id);
    changed_ = true;
    return Status::ok;
  });
}

void Rows::fetch_row(std::size_t row) const noexcept {
  for (std::size_t c = 0; c < pool_.columns(); ++c) __builtin_prefetch(pool_.column(c) + row, 1);
}

/// Nearly every row changes: rows are written one after another then, which reads entries out of
/// order but writes each column in order, and that is a sixth of the cache lines. Where ids leave
/// gaps or come in another order than their entries, a table leads from one to the other. False
/// where a key is there twice: such entries are written in their order.
bool Rows::goes_by_rows(const EntryList& entries, bool ascending, BoxOfId& entry_of) {
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
Status Rows::write(const Source& source, const EntryList& entries, bool ascending) {
  const PoolColumns columns(pool_);
  BoxOfId entry_of_id{};
  const bool by_rows = goes_by_rows(entries, ascending, entry_of_id);
  const EntryOfRow entry_of{entry_of_id, pool_.ids()};
  if constexpr (kMayStay<Source>) {
    const std::size_t slots = by_rows ? pool_.rows() : entries.count;
    if (!selection_.reserve_bits(slots)) return Status::out_of_memory;
    std::uint64_t* const left = selection_.bits.data();
    if (by_rows) {
      for_ranges(execution_, slots, [&](std::size_t begin, std::size_t end) {
        write_left_rows(source, entry_of, columns.pointers, begin, end, left);
      });
    } else {
      for_entries(entries, ascending, [&](std::size_t i, std::size_t row, std::size_t j) {
        const bool wrote = source.write_if_left(i, columns.pointers, row);
        left[j >> 6U] |= std::uint64_t{wrote} << (j & 63U);
      });
    }
    note_left(entries, by_rows, slots);
    return Status::ok;
  } else {
    note_stale(entries);
    const bool all = by_rows && entries.number == nullptr && entries.count == keys_.size();
    if (all && scatters(source, entries.keys)) {
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

/// True if most of the objects go so far, each its own way, that the order of the rows is worth
/// nothing: judged by a sample.
template <typename Source>
bool Rows::scatters(const Source& source, std::span<const Key> keys) const noexcept {
  constexpr std::size_t kSample = 64;
  // In few rows all orders are as good.
  constexpr std::size_t kFewRows = 256;
  if (!regions_.built || !(far_ > 0.0F) || keys.size() < kFewRows) return false;
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
      // What all do alike keeps their order; and beside large objects others that are far smaller
      // tell nothing about what is far.
      far |= std::abs(step - before[a]) > std::max({far_, edge, edge_before[a]});
      before[a] = step;
      edge_before[a] = edge;
    }
    apart += far ? 1 : 0;
  }
  return 2 * apart > kSample;
}

/// Writes every object anew, in the order of the keys: rows become those of entries.
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
  disorder();
}

void Rows::note_stale(const EntryList& entries) noexcept {
  if (entries.count > stale_.limit()) {
    stale_.add_all();
  } else {
    for (std::size_t j = 0; j < entries.count; ++j) stale_.add(entries.key(j).id);
  }
  changed_ = true;
}

/// Notes the objects whose bits are set in the selection as changed, and clears these: bits of
/// rows, or of entries.
void Rows::note_left(const EntryList& entries, bool by_rows, std::size_t slots) noexcept {
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
      // Not visited but written in registers.
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

/// Calls visit(entry, its row, j) for every j-th entry. No two threads meet in 64 of them that
/// follow each other.
template <typename Visit>
void Rows::for_entries(const EntryList& entries, bool ascending, const Visit& visit) {
  const std::size_t count = entries.count;
  const auto go = [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) {
      if (j + kFetchAhead < end) fetch_row(keys_.row_of(entries.key(j + kFetchAhead).id));
      visit(entries[j], keys_.row_of(entries.key(j).id), j);
    }
  };
  // Only ascending ids are known to be distinct; a repeated key must be written in order.
  if (ascending) {
    for_ranges(execution_, count, go);
  } else {
    go(0, count);
  }
}

Status Rows::check(const EntryList& entries, const BoxView& boxes) const {
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

// Room, objects that leave, and what else is known of them.

bool Rows::make_room(std::size_t objects) noexcept {
  const std::size_t added = objects - keys_.size();
  const std::size_t rows = pool_.rows();
  const std::size_t holes = rows - keys_.size();
  // Holes are closed rather than paid for in memory once they are a fifth of all rows: coming and
  // going in turn then costs the moving of four rows per object.
  const bool worn = rows >= 64 && 5 * holes >= rows;
  if ((rows + added > pool_.capacity() && worn) || rows + added > kNoObject) compact();
  const std::size_t needed = pool_.rows() + added;
  // A partition that loses objects as well as gains them is not about to grow by half.
  const std::size_t room = needed + (needed > pool_.capacity() ? needed / 8 : 0);
  const bool grown =
      holes == 0 ? pool_.reserve(needed) : pool_.reserve_exact(room) || pool_.reserve(needed);
  if (!grown || !keys_.reserve(objects)) return false;
  const std::size_t slots = std::max(keys_.slot_count() + added, objects);
  return filters_.reserve(slots) && stale_.reserve(slots) && moved_.reserve(slots);
}

void Rows::compact() noexcept {
  ++arrangement_;
  std::size_t to = 0;
  for (std::size_t from = 0; from < pool_.rows(); ++from) {
    const ObjectId id = pool_.ids()[from];
    if (id == kNoObject) continue;
    pool_.copy_row(from, to);
    keys_.set_row(id, static_cast<std::uint32_t>(to++));
  }
  pool_.clear();
  pool_.append(to);
  regions_.built = false;
  regions_.regular = 0;
  regions_.planned = 0;
  changed_ = true;
}

void Rows::remove_row(ObjectId id) noexcept {
  const std::size_t row = keys_.row_of(id);
  pool_.blank(row);
  // The last row of the tail is simply dropped, so that churn at the end leaves no holes.
  const std::size_t fixed = std::max({regions_.ordered, regions_.sorted, regions_.planned});
  if (row + 1 == pool_.rows() && row >= fixed) pool_.drop_last();
  stale_.add(id);
  filters_.reset(id);
  keys_.release(id);
  changed_ = true;
}

Status Rows::remove(Key key) {
  if (!keys_.is_valid(key)) return Status::invalid_key;
  remove_row(key.id);
  return Status::ok;
}

Status Rows::remove(std::span<const Key> keys) {
  // A first pass marks each object by blanking its row's id: a repeated key finds the mark, and the
  // marks are taken back.
  std::size_t marked = 0;
  for (; marked < keys.size(); ++marked) {
    if (!keys_.is_valid(keys[marked])) break;
    if (marked + kFetchAhead < keys.size() && keys_.is_valid(keys[marked + kFetchAhead])) {
      __builtin_prefetch(pool_.ids() + keys_.row_of(keys[marked + kFetchAhead].id), 1);
    }
    ObjectId& id = pool_.ids()[keys_.row_of(keys[marked].id)];
    if (id == kNoObject) break;
    id = kNoObject;
  }
  if (marked != keys.size()) {
    for (std::size_t i = 0; i < marked; ++i) {
      pool_.ids()[keys_.row_of(keys[i].id)] = keys[i].id;
    }
    return Status::invalid_key;
  }
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (i + kFetchAhead < keys.size()) fetch_row(keys_.row_of(keys[i + kFetchAhead].id));
    remove_row(keys[i].id);
  }
  return Status::ok;
}

void Rows::clear() noexcept {
  keys_.clear();
  filters_.clear();
  pool_.clear();
  pool_.end_filters();
  stale_.clear();
  moved_.clear();
  disorder();
}

Status Rows::reserve(std::size_t objects) {
  if (objects > kMaxObjects) return Status::too_many_objects;
  if (objects <= keys_.size()) return Status::ok;
  return make_room(objects) ? Status::ok : Status::out_of_memory;
}

void Rows::touch() noexcept {
  pool_.touch();
  keys_.touch();
  filters_.touch();
  stale_.touch();
  moved_.touch();
}

void Rows::release_memory() noexcept {
  selection_.release();
  if (keys_.size() != 0) return;
  pool_.release();
  filters_.release();
  stale_.release();
  moved_.release();
  keys_.release_if_unused();
  clear();
}

/// From here on objects may have filters. False, and unchanged, if memory is refused.
bool Rows::begin_filters() noexcept {
  if (!pool_.reserve_filters() || !filters_.begin_use()) return false;
  pool_.begin_filters();
  return true;
}

Status Rows::set_filter(std::span<const Key> keys, std::span<const ObjectFilter> filters) {
  if (keys.size() != filters.size()) return Status::size_mismatch;
  if (!std::ranges::all_of(keys, [&](Key key) { return keys_.is_valid(key); })) {
    return Status::invalid_key;
  }
  const bool any = std::ranges::any_of(filters, [](const auto& f) { return f != ObjectFilter{}; });
  if (any && !begin_filters()) return Status::out_of_memory;
  ++arrangement_;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const ObjectId id = keys[i].id;
    if (filters_.of(id) == filters[i]) continue;
    filters_.set(id, filters[i]);
    pool_.set_filter(keys_.row_of(id), filters[i]);
    stale_.add(id);
    changed_ = true;
  }
  return Status::ok;
}

namespace {

/// True if a row of saved columns may be stored: finite, and no slab inverted.
bool is_stored_volume(Volume volume, const SavedRows& saved, std::size_t i) noexcept {
  const auto at = [&](std::size_t column) { return saved.columns[column * saved.objects + i]; };
  for (std::size_t c = 0; c < column_count(volume); ++c) {
    if (!std::isfinite(at(c))) return false;
  }
  const std::size_t slabs = slab_count(volume);
  for (std::size_t s = 0; s < slabs; ++s) {
    if (!(at(low_column(slabs, s)) <= at(high_column(slabs, s)))) return false;
  }
  return volume != Volume::sphere || at(kRadiusColumn) >= 0.0F;
}

}  // namespace

Status Rows::restore(const SavedRows& saved, Rows& other) {
  const std::size_t slots = saved.keys.stamps.size();
  const auto is_live = [](std::uint32_t stamp) { return (stamp & 1U) != 0; };
  const auto live = static_cast<std::size_t>(std::ranges::count_if(saved.keys.stamps, is_live));
  const bool fits = slots <= kMaxObjects && live == saved.objects &&
                    saved.columns.size() == pool_.columns() * live &&
                    (saved.filters.empty() || saved.filters.size() == live);
  if (!fits) return Status::invalid_argument;
  for (std::size_t i = 0; i < live; ++i) {
    if (!is_stored_volume(pool_.volume(), saved, i)) return Status::invalid_argument;
  }
  Column<std::uint8_t> seen(keys_.key_memory());
  if (!seen.resize(slots) || !make_room(slots)) return Status::out_of_memory;
  if (!KeyTable::are_slots(saved.keys, seen)) return Status::invalid_argument;
  if (!saved.filters.empty() && !begin_filters()) return Status::out_of_memory;
  keys_.restore(saved.keys, other.keys_);
  pool_.append(live);
  for (std::size_t c = 0; c < pool_.columns(); ++c) {
    std::copy_n(saved.columns.data() + c * live, live, pool_.column(c));
  }
  for (std::size_t slot = 0; slot < slots; ++slot) {
    const auto id = static_cast<ObjectId>(slot);
    if (!keys_.is_live(id)) continue;
    const std::size_t row = keys_.row_of(id);
    pool_.ids()[row] = id;
    if (saved.filters.empty()) continue;
    filters_.set(id, saved.filters[row]);
    pool_.set_filter(row, saved.filters[row]);
  }
  stale_.add_all();
  changed_ = true;
  return Status::ok;
}

Status Rows::bounds(Key key, Aabb& box) const noexcept {
  if (!keys_.is_valid(key)) return Status::invalid_key;
  read_bounds({&key, 1}, {&box, 1});
  return Status::ok;
}

void Rows::read_bounds(std::span<const Key> keys, std::span<Aabb> boxes) const noexcept {
  const RowView rows = view();
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (i + kFetchAhead < keys.size()) fetch_row(keys_.row_of(keys[i + kFetchAhead].id));
    boxes[i] = stored_box(rows.column, keys_.row_of(keys[i].id));
  }
}

Aabb stored_box(const float* const columns[6], std::size_t row) noexcept {
  constexpr float inf = std::numeric_limits<float>::infinity();
  Aabb box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = axis;
    const float low = columns[axis][row];
    const float high = columns[3 + axis][row];
    box.min[a] = low == -FLT_MAX ? -inf : low;
    box.max[a] = high == FLT_MAX ? inf : high;
  }
  return box;
}

RowView Rows::view() const noexcept {
  RowView view;
  for (std::size_t c = 0; c < pool_.columns(); ++c) view.column[c] = pool_.column(c);
  view.further_slabs = static_cast<std::uint32_t>(slab_count(pool_.volume())) - 3;
  view.spheres = pool_.volume() == Volume::sphere;
  view.id = pool_.ids();
  view.filter = pool_.filters();
  view.environments = filters_.has_environments();
  view.span = filters_.span();
  view.all_meet = surely_meet(view.span, view.span);
  view.arrangement = arrangement_;
  return view;
}

void Rows::add_bytes(Footprint& footprint) const noexcept {
  footprint.bounds += pool_.bytes();
  footprint.keys += keys_.key_bytes();
  footprint.client_data += keys_.client_data_bytes();
  footprint.structure += filters_.bytes();
  footprint.structure += pool_.filter_bytes();
  footprint.structure += stale_.bytes();
  footprint.structure += moved_.bytes();
  footprint.scratch += selection_.bytes();
}

void Rows::settle(bool track_moves) noexcept {
  if (track_moves) {
    if (stale_.all()) {
      moved_.add_all();
    } else {
      for (const ObjectId id : stale_.ids()) moved_.add(id);
    }
  }
  stale_.clear();
  changed_ = false;
}

void Rows::disorder() noexcept {
  ++arrangement_;
  regions_ = {};
  changed_ = true;
}

void Rows::reorder(std::span<const std::uint32_t> order, Column<float>& spare) noexcept {
  ++arrangement_;
  const Execution execution = execution_for(order.size());
  pool_.reorder(order, spare, execution);
  for_rows_by_target({pool_.ids(), order.size()}, keys_.slot_count(), execution,
                     [&](std::uint32_t row, ObjectId id) { keys_.set_row(id, row); });
}

void Rows::reorder_tail(std::size_t begin, std::span<const std::uint32_t> order,
                        Column<float>& spare) noexcept {
  ++arrangement_;
  pool_.reorder_tail(begin, order, spare);
  for (std::size_t row = begin; row < pool_.rows(); ++row) {
    keys_.set_row(pool_.ids()[row], static_cast<std::uint32_t>(row));
  }
}

void Rows::move_to_end(std::span<const std::uint32_t> rows) noexcept {
  ++arrangement_;
  for (const std::uint32_t row : rows) {
    const std::size_t to = pool_.rows();
    pool_.append(1);
    pool_.copy_row(row, to);
    keys_.set_row(pool_.ids()[to], static_cast<std::uint32_t>(to));
    pool_.blank(row);
  }
  pool_.pad();
}

}  // namespace winnow
