#include "partitions/rows/row_partition.h"

#include "partitions/rows/row_mutation.h"
#include "partitions/rows/volume_source.h"

#include <atomic>
#include <cfloat>

namespace winnow {

WINNOW_DEFINE_KERNELS(BoxInputKernels, box_input_kernels)

namespace {

std::uint64_t next_identity() noexcept {
  static std::atomic<std::uint64_t> counter{0};
  return 1 + counter.fetch_add(1, std::memory_order_relaxed);
}

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

RowPartition::RowPartition(const PartitionOptions& options, Volume volume)
    : execution_(options.execution),
      margin_(options.margin.legal()),
      pool_(options.memory, volume),
      keys_(options.memory),
      filters_(options.memory),
      tree_(options.memory),
      block_filters_(options.memory),
      row_tree_(options.memory),
      stale_(options.memory),
      moved_(options.memory),
      spare_(options.memory),
      order_(options.memory),
      list_(options.memory),
      words_(options.memory),
      sort_scratch_(options.memory),
      kd_scratch_(options.memory),
      identity_(next_identity()) {}

RowPartition::~RowPartition() = default;

bool RowPartition::make_room(std::size_t objects) noexcept {
  const std::size_t added = objects - keys_.size();
  const std::size_t rows = pool_.rows();
  const std::size_t holes = rows - keys_.size();
  // Holes are closed rather than paid for in memory once they are a fifth of all rows: coming and
  // going in turn then costs the moving of four rows an object.
  const bool worn = rows >= 64 && 5 * holes >= rows;
  if ((rows + added > pool_.capacity() && worn) || rows + added > kNoObject) compact_rows();
  const std::size_t needed = pool_.rows() + added;
  // A partition that loses objects as well as gains them is not about to grow by half.
  const std::size_t room = needed + (needed > pool_.capacity() ? needed / 8 : 0);
  const bool grown =
      holes == 0 ? pool_.reserve(needed) : pool_.reserve_exact(room) || pool_.reserve(needed);
  if (!grown || !keys_.reserve(objects)) return false;
  const std::size_t slots = std::max(keys_.slot_count() + added, objects);
  return filters_.reserve(slots) && stale_.reserve(slots) && moved_.reserve(slots);
}

void RowPartition::compact_rows() noexcept {
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
  built_ = false;
  regular_rows_ = 0;
  dirty_.store(true, std::memory_order_relaxed);
}

Status RowPartition::insert(const BoxView& boxes, std::span<const ClientData> data,
                            std::span<Key> keys) {
  return with_box_source(pool_.volume(), boxes, [&](const auto& source) {
    return insert_from(source, boxes.count, data, keys);
  });
}

Status RowPartition::insert(const Aabb& box, ClientData data, Key& key) {
  return insert(BoxView(std::span<const Aabb>(&box, 1)), std::span<const ClientData>(&data, 1),
                std::span<Key>(&key, 1));
}

Status RowPartition::update(std::span<const Key> keys, const BoxView& boxes) {
  return with_box_source(pool_.volume(), boxes, [&](const auto& source) {
    return update_from(source, boxes.count, keys);
  });
}

Status RowPartition::update(Key key, const Aabb& box) {
  if (!keys_.is_valid(key)) return Status::invalid_key;
  const BoxView boxes(std::span<const Aabb>(&box, 1));
  return with_box_source(pool_.volume(), boxes,
                         [&](const auto& source) { return update_one(source, key); });
}

void RowPartition::remove_row(ObjectId id) noexcept {
  const std::size_t row = keys_.row_of(id);
  pool_.blank(row);
  // The last row of the tail is simply dropped, so that churn at the end leaves no holes.
  if (row + 1 == pool_.rows() && row >= built_rows_ && row >= sorted_rows_) {
    pool_.drop_last();
  }
  stale_.add(id);
  filters_.reset(id);
  keys_.release(id);
}

Status RowPartition::remove(Key key) {
  if (!keys_.is_valid(key)) return Status::invalid_key;
  remove_row(key.id);
  dirty_.store(true, std::memory_order_relaxed);
  return Status::ok;
}

Status RowPartition::remove(std::span<const Key> keys) {
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
  if (!keys.empty()) dirty_.store(true, std::memory_order_relaxed);
  return Status::ok;
}

void RowPartition::clear() noexcept {
  keys_.clear();
  filters_.clear();
  pool_.clear();
  stale_.clear();
  moved_.clear();
  tracked_serial_ = 0;
  built_ = false;
  regular_rows_ = built_rows_ = sorted_rows_ = 0;
  dirty_.store(true, std::memory_order_relaxed);
}

void RowPartition::release_memory() noexcept {
  spare_.release();
  order_.release();
  list_.release();
  words_.release();
  sort_scratch_.release();
  kd_scratch_.release();
  if (keys_.size() != 0) return;
  pool_.release();
  filters_.release();
  tree_.release();
  row_tree_.release();
  block_filters_.release();
  stale_.release();
  moved_.release();
  keys_.release_if_unused();
  release_structure();
  clear();
}

namespace {

template <typename T>
void exchange(std::atomic<T>& a, std::atomic<T>& b) noexcept {
  b.store(a.exchange(b.load(std::memory_order_relaxed), std::memory_order_relaxed),
          std::memory_order_relaxed);
}

}  // namespace

void RowPartition::swap_objects(RowPartition& other) noexcept {
  pool_.swap(other.pool_);
  keys_.swap(other.keys_);
  filters_.swap(other.filters_);
  stale_.swap(other.stale_);
  moved_.swap(other.moved_);
  std::swap(identity_, other.identity_);
  std::swap(tracked_serial_, other.tracked_serial_);
  exchange(last_serial_, other.last_serial_);
  std::swap(builds_, other.builds_);
  std::swap(refits_, other.refits_);
  exchange(full_queries_, other.full_queries_);
  exchange(incremental_queries_, other.incremental_queries_);
  exchange(last_tests_, other.last_tests_);
  exchange(last_pairs_, other.last_pairs_);
  for (RowPartition* p : {this, &other}) {
    p->built_ = false;
    p->regular_rows_ = p->built_rows_ = p->sorted_rows_ = 0;
    p->dirty_.store(true, std::memory_order_relaxed);
  }
}

Status RowPartition::reserve(std::size_t objects) {
  if (objects > kMaxObjects) return Status::too_many_objects;
  if (objects <= keys_.size()) return Status::ok;
  return make_room(objects) ? Status::ok : Status::out_of_memory;
}

Status RowPartition::bounds(Key key, Aabb& box) const noexcept {
  if (!keys_.is_valid(key)) return Status::invalid_key;
  const std::size_t row = keys_.row_of(key.id);
  constexpr float inf = std::numeric_limits<float>::infinity();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float low = pool_.column(axis)[row];
    const float high = pool_.column(3 + axis)[row];
    box.min[static_cast<Eigen::Index>(axis)] = low == -FLT_MAX ? -inf : low;
    box.max[static_cast<Eigen::Index>(axis)] = high == FLT_MAX ? inf : high;
  }
  return Status::ok;
}

Status RowPartition::client_data(Key key, ClientData& data) const noexcept {
  if (!keys_.is_valid(key)) return Status::invalid_key;
  data = keys_.client_data(key.id);
  return Status::ok;
}

RowView RowPartition::row_view() const noexcept {
  RowView view;
  for (std::size_t c = 0; c < pool_.columns(); ++c) view.column[c] = pool_.column(c);
  view.further_slabs = static_cast<std::uint32_t>(slab_count(pool_.volume())) - 3;
  view.spheres = pool_.volume() == Volume::sphere;
  view.id = pool_.ids();
  view.filter = filters_.data();
  return view;
}

Footprint RowPartition::footprint() const noexcept {
  // Queries that run at the same time may be bringing up to date what is counted here.
  const std::scoped_lock lock(refresh_mutex_, tracker_mutex_);
  Footprint result;
  result.bounds = pool_.bytes();
  result.keys = keys_.key_bytes();
  result.client_data = keys_.client_data_bytes();
  result.structure = tree_.bytes();
  result.structure += block_filters_.bytes();
  result.structure += filters_.bytes();
  result.structure += row_tree_.bytes();
  result.structure += stale_.bytes();
  result.structure += moved_.bytes();
  result.scratch = spare_.bytes();
  result.scratch += order_.bytes();
  result.scratch += list_.bytes();
  result.scratch += words_.bytes();
  result.scratch += sort_scratch_.bytes();
  result.scratch += kd_scratch_.bytes();
  add_structure_bytes(result);
  return result;
}

Statistics RowPartition::statistics() const noexcept {
  Statistics s;
  s.objects = keys_.size();
  const std::size_t regular_end =
      regular_rows_ == 0 ? built_rows_ : tree_.first_block() * BoundsPool::kBlock;
  const std::size_t behind = pool_.rows() > regular_end ? pool_.rows() - regular_end : 0;
  s.irregular = is_flat() ? 0 : std::min(keys_.size(), behind);
  s.regular = keys_.size() - s.irregular;
  s.cells = cell_count();
  s.depth = tree_.levels();
  s.builds = builds_;
  s.refits = refits_;
  s.full_queries = full_queries_.load(std::memory_order_relaxed);
  s.incremental_queries = incremental_queries_.load(std::memory_order_relaxed);
  s.last_tests = last_tests_.load(std::memory_order_relaxed);
  s.last_pairs = last_pairs_.load(std::memory_order_relaxed);
  return s;
}

}  // namespace winnow
