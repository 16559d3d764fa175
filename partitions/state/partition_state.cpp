// Mutations, refresh and pair queries of a partition. Rows stores boxes, SpatialIndex orders and
// refits, PairFinder finds pairs. Other queries, in queries/, call `prepare`.

#include "partitions/state/partition_state.h"

#include "core/hooks/log.h"
#include "core/hooks/stage_scope.h"
#include "core/memory/new_in.h"
#include "partitions/pairs/pair_tracker.h"
#include "partitions/rows/row_input.h"

#include <algorithm>
#include <bit>

namespace winnow {
PartitionState::PartitionState(std::pmr::memory_resource* resource, const PartitionOptions& options,
                               const VolumeInput& input) noexcept
    : memory(resource),
      rows(resource, options.execution, input, options.fat_margin),
      index(resource, rows, options.build_budget),
      pairs_(resource, rows, index),
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
    pairs_.resting().end();
    pairs_.forget_buffer();
  }
  if (chooser_ != nullptr) chooser_->destroy(memory);
  chooser_ = chooser;
  structure = given;
  stale_.store(true, std::memory_order_relaxed);
  return true;
}

Status PartitionState::insert(const BoxView& boxes, std::span<const ClientData> data,
                              std::span<Key> keys) {
  const Status status = RowInput(rows).insert(boxes, data, keys);
  RestingPairs& resting = pairs_.resting();
  if (status == Status::ok && resting.active() && !resting.insert(keys, boxes)) end_deferring();
  resting.disturb(keys.size());
  note_changes(status, keys.size());
  if (chooser_ != nullptr && status == Status::ok) chooser_->note_inserted(keys.size());
  return status;
}

Status PartitionState::remove(std::span<const Key> keys) {
  const Status status = rows.remove(keys);
  pairs_.resting().disturb(keys.size());
  note_changes(status, keys.size());
  return status;
}

Status PartitionState::remove(Key key) {
  const Status status = rows.remove(key);
  pairs_.resting().disturb(1);
  note_changes(status, 1);
  return status;
}

Status PartitionState::restore(const SavedRows& saved, PartitionState& other) {
  const Status status = rows.restore(saved, other.rows);
  if (status != Status::ok) return status;
  note_changes(status, saved.objects);
  if (chooser_ != nullptr) chooser_->note_inserted(saved.objects);
  return status;
}

Status PartitionState::reserve(std::size_t objects, Pages pages) {
  const Status status = rows.reserve(objects);
  const std::size_t most = std::max(objects, rows.size());
  const std::span<const StructureKind> later =
      chooser_ == nullptr ? std::span<const StructureKind>() : chooser_->choices();
  const bool reserved =
      status == Status::ok && index.reserve(most, pages, later) && pairs_.resting().reserve(pages);
  if (reserved && pages == Pages::prefaulted) rows.touch();
  note_changes(status, 0);
  return status == Status::ok && !reserved ? Status::out_of_memory : status;
}

Status PartitionState::set_filter(std::span<const Key> keys,
                                  std::span<const ObjectFilter> filters) {
  const Status status = rows.set_filter(keys, filters);
  pairs_.resting().disturb(keys.size());
  note_changes(status, 0);
  return status;
}

Status PartitionState::update(const UpdateSubset& entries, const BoxView& boxes) {
  RestingPairs& resting = pairs_.resting();
  const Status status =
      resting.active() ? resting.update(entries, boxes) : RowInput(rows).update(entries, boxes);
  // Deferred boxes change no rows.
  note_changes(status, resting.active() ? 0 : entries.count);
  return status;
}

Status PartitionState::update(std::span<const Key> keys, const BoxView& boxes,
                              const IndexSubset& entries) {
  if (!entries.is_mask) {
    const auto is_one = [&](std::uint32_t number) { return number < keys.size(); };
    if (!std::ranges::all_of(entries.indices, is_one)) return Status::invalid_argument;
    return update(UpdateSubset(keys, entries.indices), boxes);
  }
  if (entries.words.size() != (keys.size() + 63) / 64) return Status::size_mismatch;
  listed_.clear();
  if (!listed_.reserve(keys.size())) return Status::out_of_memory;
  for (std::size_t w = 0; w < entries.words.size(); ++w) {
    for (std::uint64_t bits = entries.words[w]; bits != 0; bits &= bits - 1) {
      const std::size_t i = 64 * w + static_cast<std::size_t>(std::countr_zero(bits));
      if (i < keys.size()) (void)listed_.push_back(static_cast<std::uint32_t>(i));
    }
  }
  return update({keys, {listed_.data(), listed_.size()}}, boxes);
}

Status PartitionState::update(Key key, const Aabb& box) {
  RestingPairs& resting = pairs_.resting();
  const Status status =
      resting.active() ? resting.update(key, box) : RowInput(rows).update(key, box);
  note_changes(status, resting.active() ? 0 : 1);
  return status;
}

Status PartitionState::bounds(std::span<const Key> keys, std::span<Aabb> boxes) const noexcept {
  if (!rows.keys().check_keys(keys).valid) return Status::invalid_key;
  const RestingPairs& resting = pairs_.resting();
  Lock lock = Lock::deferred(refresh_mutex_);
  if (stale_.load(std::memory_order_acquire) || resting.active()) lock.lock();
  if (resting.active()) {
    resting.read_bounds(keys, boxes);
  } else {
    rows.read_bounds(keys, boxes);
  }
  return Status::ok;
}

void PartitionState::note_changes(Status status, std::size_t count) const noexcept {
  const bool counts = chooser_ != nullptr && count != 0 && status == Status::ok;
  if (counts) chooser_->note_changes(count);
  if (counts || rows.changes().any) stale_.store(true, std::memory_order_relaxed);
}

// Writes the rows although it is const. No other thread reads them at the same time: a mutation has
// exclusive access, and a query that reads rows holds tracker_mutex_ or has called
// `write_deferred`, which locks this mutex.
void PartitionState::end_deferring() const noexcept {
  if (!pairs_.resting().active()) return;
  const Lock lock(refresh_mutex_);
  if (pairs_.resting().write()) note_changes(Status::ok, rows.size());
  pairs_.resting().end();
}

void PartitionState::write_deferred() const {
  if (!pairs_.resting().active()) return;
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

// The first build is made as for casts and regions.
Status PartitionState::refresh_early() const {
  if (stale_.load(std::memory_order_acquire)) {
    const Lock lock(refresh_mutex_);
    if (index.planner().builds() == 0) index.planner().note_query();
  }
  return refresh();
}

Status PartitionState::refresh_now() {
  const StructureKind now = index.kind();
  // While an exchange of the structure is planned, the choice is not revised.
  const bool choosing = chooser_ != nullptr && !index.swap_is_planned();
  const StructureKind chosen =
      choosing ? chooser_->choose(rows, now,
                                  {index.planner().builds(), index.planner().excess_tests(),
                                   RebuildPlanner::tail_limit(rows.size())})
               : now;
  bool refused = false;
  Status status = Status::ok;
  if (chosen != now) {
    status = index.refresh_as(chosen, refused);
  } else if (rows.changes().any) {
    status = index.refresh();
  }
  if (refused || (chooser_ != nullptr && index.swap_refused())) chooser_->refused();
  if (status != Status::ok) return status;
  rows.changes().end_refresh(pairs_.tracks());
  if (chooser_ == nullptr) return Status::ok;
  chooser_->refreshed(rows, index.kind(), index.planner().builds());
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
  // A build in this refresh may be made with more care (RebuildPlanner::precision).
  if (stale_.load(std::memory_order_acquire)) index.planner().note_query();
  if (const Status status = settle(); status != Status::ok) return status;
  count_queries(kind, count);
  if (index.query_trees_stale()) {
    const Lock lock(refresh_mutex_);
    if (index.query_trees_stale()) {
      if (const Status status = index.refresh_query_trees(); status != Status::ok) return status;
    }
  }
  index.view(view);
  return Status::ok;
}

Status PartitionState::self_pairs(PairBuffer& out, const PairOptions& options,
                                  PairEvents* events) const {
  const StageScope stage(WorkStage::pairs);
  SelfPairsQuery query{out, options};
  if (events != nullptr) query.events.emplace(pairs_.events_of(*events, out));
  // Only one buffer is tracked at a time. A query concurrent with a tracked one is not tracked.
  Lock lock = Lock::try_acquire(tracker_mutex_);
  query.tracked = lock.owns_lock() && options.incremental;
  const bool all = !options.incremental || out.empty();
  Status status = refresh();
  query.resting = status == Status::ok && pairs_.can_stay_resting(query);
  if (status == Status::ok && pairs_.resting().active() && !query.resting) {
    if (!lock.owns_lock()) lock.lock();
    end_deferring();
    status = refresh();
  }
  if (status == Status::ok) {
    count_queries(QueryKind::pairs, 1);
    status = pairs_.find(query);
  }
  if (status != Status::ok) {
    pairs_.undo(query);
  } else if (chooser_ != nullptr) {
    if (all) count_queries(QueryKind::all_pairs, 1);
    // The number of pairs that pass a predicate is not a property of the scene.
    if (options.predicate.accept == nullptr) chooser_->note_pairs(out.size());
  }
  return status;
}

Status PartitionState::pairs_with(const PartitionState& other, const PairOptions& options,
                                  PairBuffer& out) const {
  const StageScope stage(WorkStage::pairs);
  if (const Status status = settle(); status != Status::ok) return status;
  if (const Status status = other.settle(); status != Status::ok) return status;
  // Query with the smaller side: each query costs about the logarithm of the other side.
  const Status status =
      rows.size() <= other.rows.size()
          ? pairs_.find_with(other.pairs_, HitMode::query_first, options.predicate, out)
          : other.pairs_.find_with(pairs_, HitMode::query_second, options.predicate, out);
  const std::size_t slots = std::max(rows.keys().slot_count(), other.rows.keys().slot_count());
  if (status == Status::ok && (options.order == Order::fast || PairTracker::sort(out, slots))) {
    return Status::ok;
  }
  out.clear();
  return Status::out_of_memory;
}

Status PartitionState::reserve_pairs(PairBuffer& out, std::size_t pairs,
                                     Pages pages) const noexcept {
  const std::size_t most = with_stable_index([this] { return rows.pool().capacity(); });
  return pairs_.reserve(out, pairs, most, pages) ? Status::ok : Status::out_of_memory;
}

bool PartitionState::reserve_events(PairEvents& out, std::size_t pairs,
                                    Pages pages) const noexcept {
  const std::size_t objects = with_stable_index([this] { return rows.keys().capacity(); });
  return EventWriter::reserve(out, pairs, objects, pages);
}

void PartitionState::clear() noexcept {
  pairs_.resting().end();
  pairs_.forget_buffer();
  rows.clear();
  if (chooser_ != nullptr) chooser_->clear();
  note_changes(Status::ok, 0);
}

void PartitionState::release_memory() noexcept {
  end_deferring();
  pairs_.resting().release();
  listed_.release();
  index.release_memory();
  rows.release_memory();
  if (rows.size() == 0) {
    pairs_.forget_buffer();
    // An empty partition has no features, so the choice restarts from its first structure.
    if (chooser_ != nullptr) (void)index.set_structure(chooser_->first());
  }
  note_changes(Status::ok, 0);
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
  pairs_.resting().add_bytes(result);
  result.scratch += listed_.bytes();
  return result;
}

bool PartitionState::is_exact() const noexcept {
  return with_stable_index([this] { return pairs_.is_exact(); });
}

Statistics PartitionState::statistics() const noexcept {
  Statistics s;
  with_stable_index([&] { index.add_statistics(s); });
  pairs_.add_statistics(s);
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
