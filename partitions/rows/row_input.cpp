// Insert and update of boxes: checks all entries, notes which objects change, then writes the boxes
// into the rows. PartitionState calls the public functions. If boxes are not stored as given, the
// functions of VolumeInput (volume_update.cpp) do the same for spheres, k-DOPs and fat volumes.

#include "partitions/rows/row_input.h"
#include "partitions/rows/box_compare.kernel.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

namespace winnow {

WINNOW_DEFINE_KERNELS(BoxInputKernels, box_input_kernels)
WINNOW_DEFINE_KERNELS(BoxCompareKernels, box_compare_kernels)

const VolumeInput& RowInput::boxes_as_given() noexcept {
  static constexpr VolumeInput kInput{Volume::aabb, nullptr, nullptr, nullptr};
  return kInput;
}

// Update.

Status RowInput::update(const UpdateSubset& entries, const BoxView& boxes) {
  if (rows_.input_.update != nullptr) return rows_.input_.update(*this, entries, boxes);
  bool ascending = false;
  const Status status = check(entries, boxes, ascending);
  if (status != Status::ok || entries.count == 0) return status;
  write(BoxSource{boxes}, entries, ascending);
  return Status::ok;
}

Status RowInput::update(Key key, const Aabb& box) {
  if (!rows_.keys_.is_valid(key)) return Status::invalid_key;
  const BoxView one(std::span<const Aabb>(&box, 1));
  if (rows_.input_.update_one != nullptr) return rows_.input_.update_one(*this, key, one);
  const BoxSource source{one};
  if (!source.valid(0)) return Status::invalid_bounds;
  source.write(0, PoolColumns(rows_.pool_).pointers, rows_.keys_.row_of(key.id));
  rows_.changes_.add(key.id);
  return Status::ok;
}

Status RowInput::check(const UpdateSubset& entries, const BoxView& boxes, bool& ascending) const {
  const Status status = check_keys(boxes.count, entries, ascending);
  if (status != Status::ok) return status;
  return all_valid(BoxSource{boxes}, entries, rows_.execution_) ? Status::ok
                                                                : Status::invalid_bounds;
}

// Checks the keys of an update with that many volumes. Sets `ascending` if the ids strictly ascend.
Status RowInput::check_keys(std::size_t volumes, const UpdateSubset& entries,
                            bool& ascending) const {
  if (entries.keys.size() != volumes) return Status::size_mismatch;
  std::atomic<bool> all_known{true};
  std::atomic<bool> all_ascending{true};
  // Checks entries [begin, end), whose indices are consecutive.
  const auto check_run = [&](std::size_t begin, std::size_t end) {
    if (end - begin >= UpdateSubset::kLongRun) {
      return rows_.keys_.check_keys(entries.keys.subspan(entries[begin], end - begin));
    }
    KeyTable::KeysCheck run;
    for (std::size_t j = begin; j < end; ++j) {
      run.valid &= rows_.keys_.is_valid(entries.key(j));
      run.ascending &= j == begin || entries.key(j - 1).id < entries.key(j).id;
    }
    return run;
  };
  for_ranges(rows_.execution_, entries.count, [&](std::size_t begin, std::size_t end) {
    bool ok = true;
    bool ascend = true;
    for (std::size_t next = begin; begin < end; begin = next) {
      next = entries.run_end(begin, end);
      if (next + kFetchAhead < end) __builtin_prefetch(&entries.keys[entries[next + kFetchAhead]]);
      const KeyTable::KeysCheck run = check_run(begin, next);
      ok &= run.valid;
      ascend &= run.ascending && (begin == 0 || entries.key(begin - 1).id < entries.key(begin).id);
    }
    if (!ok) all_known.store(false, std::memory_order_relaxed);
    if (!ascend) all_ascending.store(false, std::memory_order_relaxed);
  });
  ascending = all_ascending.load();
  return all_known.load() ? Status::ok : Status::invalid_key;
}

void RowInput::note_stale(const UpdateSubset& entries) noexcept {
  RowChanges& changes = rows_.changes_;
  if (entries.count > changes.stale.limit()) return changes.add_all();
  for (std::size_t j = 0; j < entries.count; ++j) changes.stale.add(entries.key(j).id);
  changes.any = true;
}

namespace {

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

// True if an update writes rows in row order instead of entry order: if more than half of the rows
// change, and there are at most half as many other ids between the smallest and the largest one. In
// the order of entries, each box touches a cache line in each of the six columns; in the order of
// rows, it touches only the one or two that it is read from, and the columns are written in order.
// A table maps ids to entries unless ids and entries correspond one to one. False if a key occurs
// twice, because its entries must be written in order.
bool RowInput::writes_by_rows(const UpdateSubset& entries, bool ascending, EntryOfId& entry_of_id) {
  const std::size_t count = entries.count;
  if (2 * count <= rows_.pool_.rows()) return false;
  const auto [first, last] = ends_of_ids(entries, ascending);
  const std::size_t ids = last - first + std::size_t{1};
  if (ids > count + count / 2) return false;
  entry_of_id = {first, static_cast<std::uint32_t>(ids)};
  if (ascending && ids == count && entries.entry == nullptr) return true;
  if (!rows_.selection_.list.resize(ids)) return false;
  std::uint32_t* const table = rows_.selection_.list.data();
  entry_of_id.table = table;
  std::fill(table, table + ids, kNoObject);
  if (ascending && entries.entry == nullptr) {
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

void RowInput::write_by_id(const BoxView& boxes) noexcept {
  const EntryOfId all{.first = 0, .ids = static_cast<std::uint32_t>(boxes.count)};
  write_by_rows(BoxSource{boxes}, {all, rows_.pool_.ids()});
  rows_.changes_.add_all();
}

// True if most objects move far and in different directions. RebuildPlanner lists the other signs
// of a lost order.
bool RowInput::order_is_lost(const SampledBoxes& sample, std::span<const Key> keys) const noexcept {
  std::array<float, 3> before{};
  std::array<float, 3> edge_before{};
  std::size_t apart = 0;
  for (std::size_t k = 0; k < SampledBoxes::kSize; ++k) {
    const float* const box = sample.box[k];
    const std::size_t row = rows_.keys_.row_of(keys[SampledBoxes::entry(k, keys.size())].id);
    bool far = false;
    for (std::size_t a = 0; a < 3; ++a) {
      const float step = box[a] - rows_.pool_.column(a)[row];
      const float edge = box[3 + a] - box[a];
      // Steps are compared with the previous sample's, because a common motion keeps the order. The
      // difference must also exceed the edges of both objects, because order_reach_ may stem from
      // much smaller objects.
      far |= std::abs(step - before[a]) > std::max({rows_.order_reach_, edge, edge_before[a]});
      before[a] = step;
      edge_before[a] = edge;
    }
    apart += far ? 1 : 0;
  }
  return 2 * apart > SampledBoxes::kSize;
}

// Insert.

Status RowInput::insert(const BoxView& boxes, std::span<const ClientData> data,
                        std::span<Key> keys) {
  if (rows_.input_.insert != nullptr) return rows_.input_.insert(*this, boxes, data, keys);
  const std::size_t count = boxes.count;
  if (const Status status = check_insert(count, data, keys); status != Status::ok) return status;
  const BoxSource source{boxes};
  if (!all_valid(source, UpdateSubset(count), rows_.execution_)) return Status::invalid_bounds;
  std::size_t first = 0;
  const Status status = begin_insert(count, data, keys, first);
  if (status != Status::ok || count == 0) return status;
  for_ranges(rows_.execution_, count, [&](std::size_t begin, std::size_t end) {
    write_new(source, keys, first, begin, end);
  });
  return Status::ok;
}

Status RowInput::check_insert(std::size_t count, std::span<const ClientData> data,
                              std::span<Key> keys) const noexcept {
  if (keys.size() != count || (!data.empty() && data.size() != count)) return Status::size_mismatch;
  return count > kMaxObjects - rows_.keys_.size() ? Status::too_many_objects : Status::ok;
}

// Makes `count` rows from row `first` on, and their keys.
Status RowInput::begin_insert(std::size_t count, std::span<const ClientData> data,
                              std::span<Key> keys, std::size_t& first) {
  if (!rows_.make_room(rows_.keys_.size() + count)) return Status::out_of_memory;
  if (count == 0) return Status::ok;
  first = rows_.pool_.rows();
  ++rows_.arrangement_;
  rows_.filters_.note_new();
  rows_.pool_.append(count);
  rows_.keys_.acquire(static_cast<std::uint32_t>(first), data, keys, rows_.execution_);
  note_stale(UpdateSubset(std::span<const Key>(keys)));
  return Status::ok;
}

}  // namespace winnow
