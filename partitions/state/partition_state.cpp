// Mutations, refresh and bookkeeping of a partition. Pair queries are in pairs/self_pairs.cpp and
// pairs/resting_pairs.cpp; other queries, in queries/, call `prepare`.

#include "partitions/state/partition_state.h"

#include "core/hooks/log.h"
#include "core/hooks/stage_scope.h"
#include "core/memory/new_in.h"

#include <algorithm>
#include <bit>

namespace winnow {
namespace {

std::uint64_t next_identity() noexcept {
  static std::atomic<std::uint64_t> counter{0};
  return 1 + counter.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace

PairTracking::PairTracking(std::pmr::memory_resource* memory) noexcept
    : identity(next_identity()), resting(memory) {}

PartitionState::PartitionState(std::pmr::memory_resource* resource, const PartitionOptions& options,
                               const VolumeInput& input) noexcept
    : memory(resource),
      rows(resource, options.execution, input, options.fat_margin),
      index(resource, rows, options.build_budget),
      pairs_(resource),
      deferred_(resource),
      near_(resource),
      listed_(resource) {}

PartitionState::~PartitionState() {
  if (chooser_ != nullptr) chooser_->destroy(memory);
}

PartitionState* PartitionState::make(StructureKind kind, const PartitionOptions& options,
                                     const VolumeInput& input) noexcept {
  auto* const state = new_in<PartitionState>(options.memory, options.memory, options, input);
  if (state == nullptr || state->set_structure(kind)) return state;
  delete_in(options.memory, state);
  return nullptr;
}

bool PartitionState::set_structure(StructureKind given) noexcept {
  end_deferring();
  Chooser* chooser = nullptr;
  StructureKind held = given;
  if (given.info()->make_chooser != nullptr) {
    chooser = given.info()->make_chooser(memory);
    if (chooser == nullptr) return false;
    held = chooser->first();
  }
  const bool is_first = structure.info() == nullptr;
  const bool tested = !is_first && index.structure().tests_volumes();
  if (!index.set_structure(held)) {
    if (chooser != nullptr) chooser->destroy(memory);
    return false;
  }
  if (!is_first && index.structure().tests_volumes() != tested) {
    // The structures differ in the pairs that they report, so the tracked buffer is out of date.
    pairs_.resting.end();
    pairs_.tracked_serial = 0;
  }
  if (chooser_ != nullptr) chooser_->destroy(memory);
  chooser_ = chooser;
  structure = given;
  stale_.store(true, std::memory_order_relaxed);
  return true;
}

Status PartitionState::insert(const BoxView& boxes, std::span<const ClientData> data,
                              std::span<Key> keys) {
  const Status status = rows.insert(boxes, data, keys);
  if (status == Status::ok && deferred_.active() && !deferred_.insert(keys, boxes)) {
    end_deferring();
  }
  pairs_.resting.disturb(keys.size(), rows.size());
  note_changes(keys.size());
  if (chooser_ != nullptr) chooser_->note_inserted(keys.size());
  return status;
}

Status PartitionState::remove(std::span<const Key> keys) {
  const Status status = rows.remove(keys);
  pairs_.resting.disturb(keys.size(), rows.size());
  note_changes(keys.size());
  return status;
}

Status PartitionState::restore(const SavedRows& saved, PartitionState& other) {
  const Status status = rows.restore(saved, other.rows);
  if (status != Status::ok) return status;
  note_changes(saved.objects);
  if (chooser_ != nullptr) chooser_->note_inserted(saved.objects);
  return status;
}

Status PartitionState::reserve(std::size_t objects, Pages pages) {
  const Status status = rows.reserve(objects);
  const std::size_t most = std::max(objects, rows.size());
  const std::span<const StructureKind> later =
      chooser_ == nullptr ? std::span<const StructureKind>() : chooser_->choices();
  const bool reserved =
      status == Status::ok && index.reserve(most, pages, later) && pairs_.resting.reserve(pages);
  if (reserved && pages == Pages::prefaulted) rows.touch();
  note_changes(0);
  return status == Status::ok && !reserved ? Status::out_of_memory : status;
}

Status PartitionState::set_filter(std::span<const Key> keys,
                                  std::span<const ObjectFilter> filters) {
  const Status status = rows.set_filter(keys, filters);
  pairs_.resting.disturb(keys.size(), rows.size());
  note_changes(0);
  return status;
}

Status PartitionState::update(const UpdateSubset& entries, const BoxView& boxes) {
  if (!deferred_.active()) {
    const Status status = rows.update(entries, boxes);
    note_changes(entries.count);
    return status;
  }
  const Status status = deferred_.update(rows, entries, boxes);
  if (deferred_.active()) {
    note_changes(0);
  } else {
    pairs_.resting.end();
    note_changes(entries.count);
  }
  return status;
}

Status PartitionState::update(std::span<const Key> keys, const BoxView& boxes,
                              const IndexSubset& entries) {
  if (!entries.is_mask()) {
    const auto is_one = [&](std::uint32_t number) { return number < keys.size(); };
    if (!std::ranges::all_of(entries.indices(), is_one)) return Status::invalid_argument;
    return update({keys, entries.indices()}, boxes);
  }
  if (entries.words().size() != (keys.size() + 63) / 64) return Status::size_mismatch;
  listed_.clear();
  if (!listed_.reserve(keys.size())) return Status::out_of_memory;
  for (std::size_t w = 0; w < entries.words().size(); ++w) {
    for (std::uint64_t bits = entries.words()[w]; bits != 0; bits &= bits - 1) {
      const std::size_t i = 64 * w + static_cast<std::size_t>(std::countr_zero(bits));
      if (i < keys.size()) (void)listed_.push_back(static_cast<std::uint32_t>(i));
    }
  }
  return update({keys, {listed_.data(), listed_.size()}}, boxes);
}

Status PartitionState::update(Key key, const Aabb& box) {
  const bool deferring = deferred_.active();
  const Status status = deferring ? deferred_.update(rows, key, box) : rows.update(key, box);
  note_changes(deferring ? 0 : 1);
  return status;
}

Status PartitionState::bounds(std::span<const Key> keys, std::span<Aabb> boxes) const noexcept {
  if (!rows.keys().check_keys(keys).valid) return Status::invalid_key;
  Lock lock = Lock::deferred(refresh_mutex_);
  if (stale_.load(std::memory_order_acquire) || deferred_.active()) lock.lock();
  if (!deferred_.active()) {
    rows.read_bounds(keys, boxes);
    return Status::ok;
  }
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const VerletSkin::DeferredBox& given = deferred_.given()[keys[i].id];
    boxes[i] = {Vec3f(given.min), Vec3f(given.max)};
  }
  return Status::ok;
}

// Writes the rows although it is const. No other thread reads them at the same time: a mutation has
// exclusive access, and a query that reads rows holds tracker_mutex_ or has called
// `write_deferred`, which locks this mutex.
void PartitionState::end_deferring() const noexcept {
  if (!deferred_.active()) return;
  const Lock lock(refresh_mutex_);
  auto& self = const_cast<PartitionState&>(*this);
  if (deferred_.write(self.rows)) self.note_changes(rows.size());
  pairs_.resting.end();
  deferred_.drop();
}

void PartitionState::note_changes(std::size_t count) noexcept {
  if (chooser_ != nullptr) chooser_->note_changes(count);
  const bool counts = chooser_ != nullptr && count != 0;
  if (counts || rows.changed()) stale_.store(true, std::memory_order_relaxed);
}

void PartitionState::write_deferred() const {
  if (!deferred_.active()) return;
  const Lock lock(tracker_mutex_);
  end_deferring();
}

Status PartitionState::settle() const {
  write_deferred();
  return refresh();
}

Status PartitionState::refresh() const {
  if (!stale_.load(std::memory_order_acquire)) return Status::ok;
  const Lock lock(refresh_mutex_);
  if (!stale_.load(std::memory_order_relaxed)) return Status::ok;
  const StageScope stage(WorkStage::refresh);
  // The structure is a cache of the rows, so a const query may bring it up to date.
  const Status status = const_cast<PartitionState*>(this)->refresh_now();
  if (status == Status::ok) stale_.store(false, std::memory_order_release);
  return status;
}

// The kind of the first query is unknown, so the first build is made as for casts and regions.
Status PartitionState::refresh_for_queries() const {
  if (stale_.load(std::memory_order_acquire)) {
    const Lock lock(refresh_mutex_);
    if (index.builds() == 0) index.note_query();
  }
  return refresh();
}

Status PartitionState::refresh_now() {
  const StructureKind now = index.kind();
  // While an exchange of the structure is planned, the choice is not revised.
  const bool choosing = chooser_ != nullptr && !index.swap_is_planned();
  const StructureKind chosen =
      choosing
          ? chooser_->choose(rows, now, {index.builds(), index.excess_tests(), index.tail_limit()})
          : now;
  bool refused = false;
  Status status = Status::ok;
  if (chosen != now) {
    status = index.refresh_as(chosen, refused);
  } else if (rows.changed()) {
    status = index.refresh();
  }
  if (refused || (chooser_ != nullptr && index.swap_refused())) chooser_->refused();
  if (status != Status::ok) return status;
  rows.clear_stale(pairs_.tracked_serial != 0);
  if (chooser_ == nullptr) return Status::ok;
  chooser_->refreshed(rows, index.kind(), index.builds());
  if (index.kind() != now) {
    StructureChoice choice;
    chooser_->report(choice);
    log_choice(now.name(), index.kind().name(), choice.reason, rows.size());
  }
  return Status::ok;
}

void PartitionState::count_queries(QueryKind kind, std::size_t count) const noexcept {
  if (chooser_ != nullptr) chooser_->count_queries(kind, count);
}

Status PartitionState::prepare(QueryKind kind, std::size_t count, QueryView& view) const {
  if (stale_.load(std::memory_order_acquire)) index.note_query();
  if (const Status status = settle(); status != Status::ok) return status;
  count_queries(kind, count);
  if (index.queries_stale()) {
    const Lock lock(refresh_mutex_);
    if (index.queries_stale()) {
      if (const Status status = index.refresh_queries(); status != Status::ok) return status;
    }
  }
  index.view(view);
  return Status::ok;
}

void PartitionState::clear() noexcept {
  deferred_.drop();
  pairs_.resting.end();
  rows.clear();
  pairs_.tracked_serial = 0;
  if (chooser_ != nullptr) chooser_->clear();
  note_changes(0);
}

void PartitionState::release_memory() noexcept {
  end_deferring();
  deferred_.release();
  pairs_.resting.release();
  near_.release();
  listed_.release();
  index.release_memory();
  rows.release_memory();
  if (rows.size() == 0) {
    pairs_.tracked_serial = 0;
    // An empty partition has no features, so the choice restarts from its first structure.
    if (chooser_ != nullptr) (void)index.set_structure(chooser_->first());
  }
  note_changes(0);
}

Footprint PartitionState::footprint() const noexcept {
  // Concurrent queries may change the memory that is counted.
  const Lock tracker(tracker_mutex_);
  const Lock refresher(refresh_mutex_);
  Footprint result;
  const std::size_t own = sizeof *this + (chooser_ != nullptr ? chooser_->bytes() : 0);
  result.structure = {own, own};
  rows.add_bytes(result);
  index.add_bytes(result);
  result.bounds += deferred_.bytes();
  result.scratch += listed_.bytes();
  result.scratch += near_.footprint().total();
  result.structure += pairs_.resting.bytes();
  return result;
}

bool PartitionState::is_exact() const noexcept {
  return rows.pool().volume() == Volume::aabb && rows.fat_margin().is_none() &&
         with_stable_index([&] { return index.structure().tests_volumes(); });
}

Statistics PartitionState::statistics() const noexcept {
  Statistics s;
  with_stable_index([&] { index.add_statistics(s); });
  s.full_queries = pairs_.full_queries.load(std::memory_order_relaxed);
  s.incremental_queries = pairs_.incremental_queries.load(std::memory_order_relaxed);
  s.last_tests = pairs_.last_tests.load(std::memory_order_relaxed);
  s.last_pairs = pairs_.last_pairs.load(std::memory_order_relaxed);
  return s;
}

StructureChoice PartitionState::choice() const noexcept {
  return with_stable_index([&] {
    StructureChoice choice;
    choice.structure = index.kind();
    choice.reason = "requested by the caller";
    if (chooser_ != nullptr) chooser_->report(choice);
    return choice;
  });
}

}  // namespace winnow
