// Storage of objects in rows: capacity, removal, filters, snapshots and reordering. RowInput
// (row_input.cpp) inserts and updates.

#include "partitions/rows/rows.h"

#include "core/memory/volume_columns.h"
#include "core/sort/scatter_by_owner.h"
#include "partitions/rows/fat_volumes.h"
#include "partitions/rows/row_input.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <limits>

namespace winnow {

Rows::Rows(std::pmr::memory_resource* memory, const Execution& execution, const VolumeInput& input,
           const FatMargin& fat_margin) noexcept
    : execution_(execution),
      fat_margin_(legal(fat_margin)),
      input_(input),
      pool_(memory, input.volume),
      keys_(memory),
      filters_(memory),
      changes_(memory),
      selection_(memory) {}

Execution Rows::execution_for(std::size_t objects) const noexcept {
  // For fewer objects, handing over a task costs more than running it.
  constexpr std::size_t kWorthSharing = 1536;
  return objects < kWorthSharing ? Execution::serial() : execution_;
}

void Rows::fetch_row(std::size_t row) const noexcept {
  for (std::size_t c = 0; c < pool_.columns(); ++c) __builtin_prefetch(pool_.column(c) + row, 1);
}

bool Rows::make_room(std::size_t objects) noexcept {
  const std::size_t added = objects - keys_.size();
  const std::size_t rows = pool_.rows();
  const std::size_t holes = rows - keys_.size();
  // Once holes are a fifth of all rows they are closed instead of allocating more memory.
  // Alternating inserts and removals then move four rows per object.
  const bool worn = rows >= 64 && 5 * holes >= rows;
  if ((rows + added > pool_.capacity() && worn) || rows + added > kNoObject) compact();
  const std::size_t needed = pool_.rows() + added;
  // A partition that also loses objects is unlikely to grow by half, so it reserves only an eighth
  // more.
  const std::size_t room = needed + (needed > pool_.capacity() ? needed / 8 : 0);
  const bool grown =
      holes == 0 ? pool_.reserve(needed) : pool_.reserve_exact(room) || pool_.reserve(needed);
  if (!grown || !keys_.reserve(objects)) return false;
  const std::size_t slots = keys_.slots_with(added);
  return filters_.reserve(slots) && changes_.reserve(slots);
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
  changes_.any = true;
}

void Rows::remove_row(ObjectId id) noexcept {
  const std::size_t row = keys_.row_of(id);
  pool_.blank(row);
  // If this is the last row of the tail, drop it, so that alternating inserts and removals leave no
  // holes there.
  const std::size_t fixed = std::max({regions_.ordered, regions_.sorted, regions_.planned});
  if (row + 1 == pool_.rows() && row >= fixed) pool_.drop_last();
  changes_.add(id);
  filters_.reset(id);
  keys_.release(id);
}

bool Rows::has_margin() const noexcept {
  return !is_none(fat_margin_);
}

Status Rows::remove(Key key) {
  if (!keys_.is_valid(key)) return Status::invalid_key;
  remove_row(key.id);
  return Status::ok;
}

Status Rows::remove(std::span<const Key> keys) {
  // The first pass blanks the row's id of each object. A repeated key finds its row blanked; the
  // ids are then restored.
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
  changes_.clear();
  invalidate_order();
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
  changes_.touch();
}

void Rows::release_memory() noexcept {
  selection_.release();
  if (keys_.size() != 0) return;
  pool_.release();
  filters_.release();
  changes_.release();
  keys_.release_if_unused();
  clear();
}

/// Starts storing filters. False, and unchanged, if memory is refused.
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
    changes_.add(id);
  }
  return Status::ok;
}

namespace {

/// True if a row of saved columns is valid: all finite, no slab inverted.
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
  if (!KeyTable::are_consistent(saved.keys, seen)) return Status::invalid_argument;
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
  changes_.add_all();
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
  view.all_match = surely_match(view.span, view.span);
  view.arrangement = arrangement_;
  return view;
}

void Rows::add_bytes(Footprint& footprint) const noexcept {
  footprint.bounds += pool_.bytes();
  footprint.keys += keys_.key_bytes();
  footprint.client_data += keys_.client_data_bytes();
  footprint.structure += filters_.bytes();
  footprint.structure += pool_.filter_bytes();
  footprint.structure += changes_.bytes();
  footprint.scratch += selection_.bytes();
}

void Rows::invalidate_order() noexcept {
  ++arrangement_;
  regions_ = {};
  changes_.any = true;
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
