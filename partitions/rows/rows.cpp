#include "partitions/rows/rows.h"

#include "partitions/rows/row_writer.h"
#include "partitions/rows/volume_source.h"

#include <algorithm>
#include <cfloat>
#include <limits>

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

Status Rows::insert(const BoxView& boxes, std::span<const ClientData> data, std::span<Key> keys) {
  return with_box_source(pool_.volume(), boxes, [&](const auto& source) {
    return insert_from(source, boxes.count, data, keys);
  });
}

Status Rows::update(std::span<const Key> keys, const BoxView& boxes) {
  return with_box_source(pool_.volume(), boxes, [&](const auto& source) {
    return update_from(source, boxes.count, keys);
  });
}

Status Rows::update(Key key, const Aabb& box) {
  if (!keys_.is_valid(key)) return Status::invalid_key;
  const BoxView boxes(std::span<const Aabb>(&box, 1));
  return with_box_source(pool_.volume(), boxes,
                         [&](const auto& source) { return update_one(source, key); });
}

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
  const PoolColumns columns(pool_);
  std::size_t to = 0;
  for (std::size_t from = 0; from < pool_.rows(); ++from) {
    const ObjectId id = pool_.ids()[from];
    if (id == kNoObject) continue;
    for (std::size_t c = 0; c < pool_.columns(); ++c) {
      columns.pointers[c][to] = columns.pointers[c][from];
    }
    pool_.ids()[to] = id;
    keys_.set_row(id, static_cast<std::uint32_t>(to++));
  }
  pool_.clear();
  pool_.append(to);
  regions_.built = false;
  regions_.regular = 0;
  changed_ = true;
}

void Rows::remove_row(ObjectId id) noexcept {
  const std::size_t row = keys_.row_of(id);
  pool_.blank(row);
  // The last row of the tail is simply dropped, so that churn at the end leaves no holes.
  if (row + 1 == pool_.rows() && row >= regions_.ordered && row >= regions_.sorted) {
    pool_.drop_last();
  }
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
  stale_.clear();
  moved_.clear();
  disorder();
}

Status Rows::reserve(std::size_t objects) {
  if (objects > kMaxObjects) return Status::too_many_objects;
  if (objects <= keys_.size()) return Status::ok;
  return make_room(objects) ? Status::ok : Status::out_of_memory;
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

Status Rows::set_filter(std::span<const Key> keys, std::span<const ObjectFilter> filters) {
  if (keys.size() != filters.size()) return Status::size_mismatch;
  if (!std::ranges::all_of(keys, [&](Key key) { return keys_.is_valid(key); })) {
    return Status::invalid_key;
  }
  const bool any = std::ranges::any_of(filters, [](const auto& f) { return f != ObjectFilter{}; });
  if (any && !filters_.begin_use()) return Status::out_of_memory;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const ObjectId id = keys[i].id;
    if (filters_.of(id) == filters[i]) continue;
    filters_.set(id, filters[i]);
    stale_.add(id);
    changed_ = true;
  }
  return Status::ok;
}

Status Rows::bounds(Key key, Aabb& box) const noexcept {
  if (!keys_.is_valid(key)) return Status::invalid_key;
  const std::size_t row = keys_.row_of(key.id);
  box = stored_box(view().column, row);
  return Status::ok;
}

Aabb stored_box(const float* const columns[6], std::size_t row) noexcept {
  constexpr float inf = std::numeric_limits<float>::infinity();
  Aabb box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
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
  view.filter = filters_.data();
  return view;
}

void Rows::add_bytes(Footprint& footprint) const noexcept {
  footprint.bounds += pool_.bytes();
  footprint.keys += keys_.key_bytes();
  footprint.client_data += keys_.client_data_bytes();
  footprint.structure += filters_.bytes();
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
  regions_ = {};
  changed_ = true;
}

void Rows::reorder(std::span<const std::uint32_t> order, Column<float>& spare) noexcept {
  const Execution execution = execution_for(order.size());
  pool_.reorder(order, spare, execution);
  for_ranges(execution, order.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      const ObjectId id = pool_.ids()[row];
      if (id != kNoObject) keys_.set_row(id, static_cast<std::uint32_t>(row));
    }
  });
}

void Rows::reorder_tail(std::size_t begin, std::span<const std::uint32_t> order,
                        Column<float>& spare) noexcept {
  pool_.reorder_tail(begin, order, spare);
  for (std::size_t row = begin; row < pool_.rows(); ++row) {
    keys_.set_row(pool_.ids()[row], static_cast<std::uint32_t>(row));
  }
}

void Rows::move_to_end(std::span<const std::uint32_t> rows) noexcept {
  const PoolColumns columns(pool_);
  for (const std::uint32_t row : rows) {
    const std::size_t to = pool_.rows();
    const ObjectId id = pool_.ids()[row];
    pool_.append(1);
    for (std::size_t c = 0; c < pool_.columns(); ++c) {
      columns.pointers[c][to] = columns.pointers[c][row];
    }
    pool_.ids()[to] = id;
    keys_.set_row(id, static_cast<std::uint32_t>(to));
    pool_.blank(row);
  }
  pool_.pad();
}

}  // namespace winnow
