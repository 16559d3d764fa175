// Pair queries of a resting scene: starting and updating the Verlet list of RestDetector. While
// boxes are deferred, rows contain boxes that differ from the given boxes by up to a skin. A
// query then tests the watched pairs, and queries with the objects that left their skin. Called
// by run_self_pairs in self_pairs.cpp.

#include <winnow/core/rounding.h>
#include "partitions/pairs/event_writer.h"
#include "partitions/pairs/linked_pairs.h"
#include "partitions/pairs/pair_tracker.h"
#include "partitions/pairs/pair_writer.h"
#include "partitions/state/partition_state.h"

#include <algorithm>
#include <cfloat>

namespace winnow {
namespace {

constexpr std::size_t kNearQueriesPerTask = 64;
constexpr std::size_t kMinObjects = 256;

bool given_overlap(const VerletSkin::DeferredBox& a, const VerletSkin::DeferredBox& b) noexcept {
  // Branchless: the overlap of a watched pair is unpredictable.
  unsigned ok = 1;
  for (int axis = 0; axis < 3; ++axis) {
    ok &= static_cast<unsigned>(a.min[axis] <= b.max[axis]) &
          static_cast<unsigned>(b.min[axis] <= a.max[axis]);
  }
  return ok != 0;
}

/// Returns by how much the gap of two stored ends can shrink: two skins, each enlarged by the
/// rounding error of the comparison with the skin.
double reach_of(float skin) noexcept {
  return 2.0 * static_cast<double>(skin) * (1.0 + 0x1p-20);
}

double finite(float end) noexcept {
  return static_cast<double>(std::clamp(end, -FLT_MAX, FLT_MAX));
}

/// The boxes of rows, enlarged by `reach`, as a query batch that reports pairs (row, other).
struct NearBatch {
  alignas(64) float ends[6][kNearQueriesPerTask + kBlockRows];
  std::uint32_t ids[kNearQueriesPerTask + kBlockRows];
  std::uint32_t layers[kNearQueriesPerTask + kBlockRows];
  std::uint32_t masks[kNearQueriesPerTask + kBlockRows];
  std::uint32_t environments[kNearQueriesPerTask + kBlockRows];
  std::uint32_t size = 0;

  void add(const RowView& view, std::size_t row, double reach) noexcept {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto low = static_cast<double>(view.column[c][row]);
      const auto high = static_cast<double>(view.column[3 + c][row]);
      ends[c][size] = std::max(round_down(add_down(low, -reach)), -FLT_MAX);
      ends[3 + c][size] = std::min(round_up(add_up(high, reach)), FLT_MAX);
    }
    if (view.filter.layers != nullptr) {
      layers[size] = view.filter.layers[row];
      masks[size] = view.filter.mask[row];
      environments[size] = view.filter.environment[row];
    }
    ids[size++] = view.id[row];
  }
  [[nodiscard]] QueryBatch batch(const RowView& view) const noexcept {
    QueryBatch batch;
    for (std::size_t c = 0; c < 6; ++c) batch.column[c] = ends[c];
    batch.id = ids;
    batch.end = size;
    batch.mode = HitMode::query_first;
    if (view.filter.layers != nullptr) batch.filter = {layers, masks, environments};
    batch.environments = view.environments;
    batch.matches_all = view.all_match;
    return batch;
  }
};

}  // namespace

bool PartitionState::can_stay_deferred(const PairBuffer& out, const PairOptions& options,
                                       const EventWriter* events) const noexcept {
  // If more than 1/16 of the objects were inserted, removed, filtered or left their skin, a full
  // query is cheaper.
  const std::size_t disturbed = rows.moved().ids().size();
  return deferred_.active() && 16 * disturbed <= rows.size() &&
         options.predicate.accept == nullptr && can_update_in_place(out, options, events) &&
         LinkedPairs::is_linked(out) &&
         pairs_.resting.watched.size() <= RestDetector::max_watched(rows.size(), out.size());
}

// Called after a full query. If memory is refused, deferring does not start.
void PartitionState::try_start_resting(PairBuffer& out, const PairOptions& options) const noexcept {
  RestDetector& resting = pairs_.resting;
  const bool can = options.order == Order::fast && options.predicate.accept == nullptr &&
                   rows.size() >= kMinObjects && is_exact();
  if (!can || !resting.seems_at_rest(rows)) return;
  LinkedPairs linked(out);
  const float skin = resting.skin();
  if (linked.can_link() && linked.link(rows.keys().slot_count()) && deferred_.begin(rows, skin) &&
      watch_all(RestDetector::max_watched(rows.size(), out.size()))) {
    return linked.link_rest();
  }
  resting.end();
  deferred_.drop();
}

// Collects the watched pairs of all rows. False if memory is refused or there are more than `most`.
bool PartitionState::watch_all(std::size_t most) const noexcept {
  // Rows are queried in batches, to limit the memory of the results.
  constexpr std::size_t kAtOnce = 1024;
  constexpr std::size_t kSample = 64;
  Column<RestDetector::WatchedPair>& watched = pairs_.resting.watched;
  const std::size_t count = rows.pool().rows();
  // Sample some rows first: a crowd of n objects has up to n^2 pairs, and the sample stops the
  // search before it finds them all.
  const std::size_t stride = std::max<std::size_t>(1, count / kSample);
  if (!watch_rows(0, count, stride) || watched.size() * stride > 2 * most) return false;
  watched.clear();
  for (std::size_t begin = 0; begin < count; begin += kAtOnce) {
    if (!watch_rows(begin, std::min(count, begin + kAtOnce), 1) || watched.size() > most) {
      return false;
    }
  }
  return true;
}

bool PartitionState::watch_rows(std::size_t begin, std::size_t end,
                                std::size_t stride) const noexcept {
  RowSelection& query_rows = rows.selection();
  near_.clear();
  if (!query_rows.start((end - begin + stride - 1) / stride)) return false;
  for (std::size_t row = begin; row < end; row += stride) {
    if (rows.pool().ids()[row] != kNoObject) query_rows.add(row);
  }
  std::uint64_t tests = 0;
  if (query_near(query_rows.entries(), near_, tests) != Status::ok) return false;
  for (const Pair& pair : near_) {
    // Each pair is found from both sides; keep it from the smaller id.
    if (pair.first >= pair.second || !is_watched(pair)) continue;
    const bool overlapped =
        given_overlap(deferred_.given()[pair.first], deferred_.given()[pair.second]);
    if (!pairs_.resting.watched.push_back({pair.first, pair.second, overlapped})) return false;
  }
  return true;
}

// False if the boxes overlap for every position within their skins.
bool PartitionState::is_watched(const Pair& pair) const noexcept {
  const VerletSkin::DeferredBox& a = deferred_.stored()[pair.first];
  const VerletSkin::DeferredBox& b = deferred_.stored()[pair.second];
  const double reach = reach_of(deferred_.skin());
  for (int axis = 0; axis < 3; ++axis) {
    if (!(add_up(finite(a.min[axis]), reach) <= finite(b.max[axis])) ||
        !(add_up(finite(b.min[axis]), reach) <= finite(a.max[axis]))) {
      return true;
    }
  }
  return false;
}

// Appends (row's object, other) for all stored boxes within reach of the stored boxes of the rows.
Status PartitionState::query_near(std::span<const std::uint32_t> query_rows, PairBuffer& out,
                                  std::uint64_t& tests) const {
  const std::size_t count = query_rows.size();
  const double reach = reach_of(deferred_.skin());
  const Execution execution = rows.execution_for(count);
  PairWriter writer(out, execution);
  const std::size_t tasks = (count + kNearQueriesPerTask - 1) / kNearQueriesPerTask;
  const Status status = writer.append(tasks, [&](std::size_t task, PairSink& sink) {
    const RowView view = rows.view();
    NearBatch near;
    const std::size_t end = std::min(count, (task + 1) * kNearQueriesPerTask);
    for (std::size_t i = task * kNearQueriesPerTask; i < end; ++i) {
      near.add(view, query_rows[i], reach);
    }
    return index.query(near.batch(view), sink);
  });
  tests += writer.tests();
  return status;
}

Status PartitionState::resting_self_pairs(PairBuffer& out, EventWriter* events) const {
  pairs_.incremental_queries.fetch_add(1, std::memory_order_relaxed);
  pairs_.resting.note_frame();
  std::uint64_t tests = 0;
  const std::span<const ObjectId> moved = rows.moved().ids();
  LinkedPairs linked(out);
  const std::size_t kept = out.size();
  if (events != nullptr) events->hold_none(out);
  if (!moved.empty()) {
    if (!linked.link(rows.keys().slot_count()) || !select_moved_rows())
      return Status::out_of_memory;
    const std::span<const std::uint32_t> query_rows = rows.selection().entries();
    if (const Status status = query_near(query_rows, out, tests); status != Status::ok)
      return status;
    if (!keep_near(out, kept)) return Status::out_of_memory;
  }
  pairs_.last_tests.store(tests, std::memory_order_relaxed);
  if (events != nullptr) events->find_reused(moved);
  const auto reused = [&](ObjectId id) { return events != nullptr && events->is_reused(id); };
  if (!linked.compare(kept, moved, rows.moved().bits(), reused) || !note_watched(linked) ||
      !linked.sort() ||
      (events != nullptr && !events->store_changes(out, linked.begun(), linked.ended(), moved))) {
    return Status::out_of_memory;
  }
  linked.apply();
  return Status::ok;
}

// Filters the pairs that moved objects found: keeps overlapping ones as (smaller id, larger id),
// and watches the ones whose overlap may change.
bool PartitionState::keep_near(PairBuffer& out, std::size_t kept) const noexcept {
  Column<RestDetector::WatchedPair>& watched = pairs_.resting.watched;
  const std::uint64_t* const bits = rows.moved().bits();
  const auto has_moved = [&](ObjectId id) { return (bits[id >> 6U] >> (id & 63U) & 1U) != 0; };
  RestDetector::WatchedPair* const left =
      std::remove_if(watched.begin(), watched.end(), [&](const RestDetector::WatchedPair& pair) {
        return has_moved(pair.first) || has_moved(pair.second);
      });
  watched.set_size(static_cast<std::size_t>(left - watched.begin()));
  std::size_t size = kept;
  Pair* const pairs = PairTracker::data(out);
  for (std::size_t i = kept; i < out.size(); ++i) {
    const auto [query, other] = pairs[i];
    if (query == other || (other < query && has_moved(other))) continue;
    const Pair pair{std::min(query, other), std::max(query, other)};
    const bool overlapped =
        given_overlap(deferred_.given()[pair.first], deferred_.given()[pair.second]);
    if (is_watched(pair) && !watched.push_back({pair.first, pair.second, overlapped})) return false;
    if (overlapped) pairs[size++] = pair;
  }
  PairTracker::set_size(out, size);
  return true;
}

// Adds the watched pairs that began or ended to `linked`.
bool PartitionState::note_watched(LinkedPairs& linked) const noexcept {
  const VerletSkin::DeferredBox* const given = deferred_.given();
  for (RestDetector::WatchedPair& pair : pairs_.resting.watched) {
    const bool overlap_now = given_overlap(given[pair.first], given[pair.second]);
    if (overlap_now == pair.overlapped) continue;
    pair.overlapped = overlap_now;
    if (!(overlap_now ? linked.begin({pair.first, pair.second})
                      : linked.end({pair.first, pair.second}))) {
      return false;
    }
  }
  return true;
}

}  // namespace winnow
