#include "partitions/state/partition_state.h"

#include "core/memory/new_in.h"

namespace winnow {
namespace {

std::uint64_t next_identity() noexcept {
  static std::atomic<std::uint64_t> counter{0};
  return 1 + counter.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace

PairTracking::PairTracking() noexcept : identity(next_identity()) {}

PartitionState::PartitionState(std::pmr::memory_resource* resource,
                               const PartitionOptions& options) noexcept
    : memory(resource),
      rows(resource, options.execution, options.volume, options.margin),
      index(resource, rows) {}

PartitionState::~PartitionState() {
  if (chooser_ != nullptr) chooser_->end(memory);
}

PartitionState* PartitionState::make(StructureKind kind, const PartitionOptions& options) noexcept {
  auto* const state = new_in<PartitionState>(options.memory, options.memory, options);
  if (state == nullptr || state->set_structure(kind)) return state;
  delete_in(options.memory, state);
  return nullptr;
}

bool PartitionState::set_structure(StructureKind given) noexcept {
  Chooser* chooser = nullptr;
  StructureKind held = given;
  if (given.info()->make_chooser != nullptr) {
    chooser = given.info()->make_chooser(memory);
    if (chooser == nullptr) return false;
    held = chooser->first();
  }
  if (!index.set_structure(held)) {
    if (chooser != nullptr) chooser->end(memory);
    return false;
  }
  if (chooser_ != nullptr) chooser_->end(memory);
  chooser_ = chooser;
  structure = given;
  stale_.store(true, std::memory_order_relaxed);
  return true;
}

void PartitionState::note_changes(std::size_t count) noexcept {
  if (chooser_ != nullptr) chooser_->note_changes(count);
  if (chooser_ != nullptr || rows.changed()) stale_.store(true, std::memory_order_relaxed);
}

Status PartitionState::refresh() const {
  if (!stale_.load(std::memory_order_acquire)) return Status::ok;
  const std::lock_guard lock(refresh_mutex_);
  if (!stale_.load(std::memory_order_relaxed)) return Status::ok;
  // The structure is a cache of the rows: bringing it up to date is no change that a caller of a
  // const query can see.
  const Status status = const_cast<PartitionState*>(this)->refresh_now();
  if (status == Status::ok) stale_.store(false, std::memory_order_release);
  return status;
}

Status PartitionState::refresh_now() {
  const StructureKind now = index.kind();
  const StructureKind wanted =
      chooser_ == nullptr ? now : chooser_->choose(rows, now, index.builds());
  bool taken = true;
  Status status = Status::ok;
  if (wanted != now) {
    status = index.refresh_as(wanted, taken);
  } else if (rows.changed()) {
    status = index.refresh();
  }
  if (!taken) chooser_->refused();
  if (status != Status::ok) return status;
  rows.settle(pairs_.tracked_serial != 0);
  if (chooser_ != nullptr) chooser_->refreshed(rows, index.kind(), index.builds());
  return Status::ok;
}

void PartitionState::note(QueryKind kind, std::size_t count) const noexcept {
  if (chooser_ != nullptr) chooser_->note(kind, count);
}

Status PartitionState::prepare(QueryKind kind, std::size_t count, QueryView& view) const {
  if (const Status status = refresh(); status != Status::ok) return status;
  note(kind, count);
  if (index.queries_stale()) {
    const std::lock_guard lock(refresh_mutex_);
    if (index.queries_stale()) {
      if (const Status status = index.refresh_queries(); status != Status::ok) return status;
    }
  }
  index.view(view);
  return Status::ok;
}

void PartitionState::clear() noexcept {
  rows.clear();
  pairs_.tracked_serial = 0;
  if (chooser_ != nullptr) chooser_->clear();
  note_changes(0);
}

void PartitionState::release_memory() noexcept {
  index.release_memory();
  rows.release_memory();
  if (rows.size() == 0) pairs_.tracked_serial = 0;
  note_changes(0);
}

Footprint PartitionState::footprint() const noexcept {
  // Queries that run at the same time may be bringing up to date what is counted here.
  const std::scoped_lock lock(refresh_mutex_, tracker_mutex_);
  Footprint result;
  const std::size_t own = sizeof *this + (chooser_ != nullptr ? chooser_->bytes() : 0);
  result.structure = {own, own};
  rows.add_bytes(result);
  index.add_bytes(result);
  return result;
}

Statistics PartitionState::statistics() const noexcept {
  Statistics s;
  steadily([&] { index.add_statistics(s); });
  s.full_queries = pairs_.full_queries.load(std::memory_order_relaxed);
  s.incremental_queries = pairs_.incremental_queries.load(std::memory_order_relaxed);
  s.last_tests = pairs_.last_tests.load(std::memory_order_relaxed);
  s.last_pairs = pairs_.last_pairs.load(std::memory_order_relaxed);
  return s;
}

StructureChoice PartitionState::choice() const noexcept {
  return steadily([&] {
    StructureChoice choice;
    choice.structure = index.kind();
    choice.reason = "as it was asked for";
    if (chooser_ != nullptr) chooser_->report(choice);
    return choice;
  });
}

}  // namespace winnow
