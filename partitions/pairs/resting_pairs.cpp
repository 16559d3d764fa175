// Verlet list of a resting scene: deferred boxes of updates, then pair queries. While boxes are
// deferred, rows contain boxes that differ from the given boxes by up to a skin. A query tests the
// watched pairs, and queries with the objects that left their skin.

#include "partitions/pairs/resting_pairs.h"

#include <winnow/core/volumes.h>
#include "core/memory/columns.h"
#include "core/numbers/rounding.h"
#include "partitions/index/spatial_index.h"
#include "partitions/pairs/linked_pairs.h"
#include "partitions/pairs/pair_tracker.h"
#include "partitions/pairs/pair_writer.h"
#include "partitions/rows/box_compare.kernel.h"
#include "partitions/rows/row_input.h"

#include <algorithm>
#include <cfloat>
#include <utility>

namespace winnow {
namespace {

constexpr std::size_t kNearQueriesPerTask = 64;
constexpr std::size_t kMinObjects = 256;

/// Returns by how much the gap of two stored ends can shrink: two skins, each enlarged by the
/// rounding error of the comparison with the skin.
double reach_of(float skin) noexcept {
  return 2.0 * static_cast<double>(skin) * (1.0 + 0x1p-20);
}

double finite(float end) noexcept {
  return static_cast<double>(std::clamp(end, -FLT_MAX, FLT_MAX));
}

}  // namespace

// Deferred boxes.

RestingPairs::DeferredBox RestingPairs::as_given(const Aabb& box) noexcept {
  return {{box.min[0], box.min[1], box.min[2]}, {box.max[0], box.max[1], box.max[2]}};
}

BoxView RestingPairs::view_of(const DeferredBox* boxes, std::size_t count) noexcept {
  static_assert(sizeof(DeferredBox) == 6 * sizeof(float));
  if (count == 0) return {};
  const float* const low = boxes->min;
  const float* const high = boxes->max;
  return {{low, low + 1, low + 2}, {high, high + 1, high + 2}, count, sizeof(DeferredBox)};
}

// False if memory is refused.
bool RestingPairs::start(float skin) noexcept {
  const std::size_t slots = rows_.keys().slot_count();
  max_departed_ = static_cast<std::uint32_t>(rows_.size() / 32 + 16);
  if (!given_.resize(slots) || !stored_.resize(slots) ||
      !departed_.resize(max_departed_ + 2 * kBlockRows)) {
    return false;
  }
  const RowView view = rows_.view();
  for (std::size_t row = 0; row < rows_.pool().rows(); ++row) {
    const ObjectId id = view.id[row];
    if (id != kNoObject) stored_[id] = given_[id] = as_given(stored_box(view.column, row));
  }
  skin_ = skin;
  active_.store(true, std::memory_order_release);
  return true;
}

Status RestingPairs::update(const UpdateSubset& entries, const BoxView& boxes) {
  bool ascending = false;
  const Status status = RowInput(rows_).check(entries, boxes, ascending);
  if (status != Status::ok) return status;
  pending_ = true;
  if (!copy(entries, boxes)) {
    (void)write();
    end();
    return RowInput(rows_).update(entries, boxes);
  }
  for (const ObjectId id : departed_) {
    const Key key = rows_.keys().key_of(id);
    // If a key is repeated, the row gets the last box, which may be within the skin again.
    (void)RowInput(rows_).update(UpdateSubset(std::span(&key, 1)), view_of(given_.data() + id, 1));
    stored_[id] = given_[id];
  }
  return Status::ok;
}

Status RestingPairs::update(Key key, const Aabb& box) {
  if (!rows_.keys().is_valid(key)) return Status::invalid_key;
  const BoxView view(std::span<const Aabb>(&box, 1));
  if (!BoxSource{view}.valid(0)) return Status::invalid_bounds;
  const DeferredBox given = as_given(box);
  const bool departed =
      box_compare_kernels().copy_near(given.min, stored_[key.id].min, given_[key.id].min, 1, skin_,
                                      departed_.data(), 0) != 0;
  pending_ = true;
  if (!departed) return Status::ok;
  stored_[key.id] = given;
  return RowInput(rows_).update(key, box);
}

// Collects in departed_ the ids whose boxes left the skin. False if there are more than
// max_departed_.
bool RestingPairs::copy(const UpdateSubset& entries, const BoxView& boxes) noexcept {
  const bool packed = BoxSource{boxes}.packed();
  departed_.clear();
  for (std::size_t begin = 0; begin < entries.count;) {
    // Consecutive ids have consecutive boxes in both arrays, so one kernel call handles the whole
    // run.
    const std::size_t i = entries[begin];
    const ObjectId first = entries.keys[i].id;
    std::size_t end = begin + 1;
    while (packed && end < entries.count && entries[end] - i == end - begin &&
           entries.key(end).id - first == end - begin) {
      ++end;
    }
    const DeferredBox one = packed ? DeferredBox{} : as_given(boxes[i]);
    const float* const from = packed ? boxes.min[0] + 6 * i : one.min;
    std::uint32_t* const departed = departed_.end();
    const std::uint32_t found = box_compare_kernels().copy_near(
        from, stored_[first].min, given_[first].min, end - begin, skin_, departed,
        max_departed_ - static_cast<std::uint32_t>(departed_.size()));
    for (std::uint32_t k = 0; k < found; ++k) departed[k] += first;
    departed_.set_size(departed_.size() + found);
    if (departed_.size() > max_departed_) return false;
    begin = end;
  }
  return true;
}

bool RestingPairs::insert(std::span<const Key> keys, const BoxView& boxes) noexcept {
  std::size_t slots = stored_.size();
  for (const Key key : keys) slots = std::max<std::size_t>(slots, key.id + std::size_t{1});
  if (!given_.resize(slots) || !stored_.resize(slots)) return false;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    stored_[keys[i].id] = given_[keys[i].id] = as_given(boxes[i]);
  }
  return true;
}

void RestingPairs::read_bounds(std::span<const Key> keys, std::span<Aabb> boxes) const noexcept {
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const DeferredBox& given = given_[keys[i].id];
    boxes[i] = {Vec3f(given.min), Vec3f(given.max)};
  }
}

bool RestingPairs::write() noexcept {
  if (pending_) RowInput(rows_).write_by_id(view_of(given_.data(), given_.size()));
  return std::exchange(pending_, false);
}

void RestingPairs::drop() noexcept {
  watched_.clear();
  given_.clear();
  stored_.clear();
  departed_.clear();
  pending_ = false;
  active_.store(false, std::memory_order_release);
}

void RestingPairs::end() noexcept {
  detector_.end();
  drop();
}

void RestingPairs::release() noexcept {
  release_columns(watched_, given_, stored_, departed_);
  detector_.release();
  near_.release();
}

void RestingPairs::add_bytes(Footprint& footprint) const noexcept {
  footprint.bounds += bytes_of(given_, stored_, departed_);
  footprint.scratch += near_.footprint().total();
  footprint.structure += watched_.bytes();
  footprint.structure += detector_.bytes();
}

// Starting.

// The largest number of watched pairs that still costs less than querying the objects again.
std::size_t RestingPairs::max_watched(std::size_t pairs) const noexcept {
  return 8 * rows_.size() + pairs;
}

void RestingPairs::try_start(PairBuffer& out) noexcept {
  if (rows_.size() < kMinObjects || !detector_.seems_at_rest(rows_)) return;
  LinkedPairs linked(out);
  if (linked.can_link() && linked.link(rows_.keys().slot_count()) && start(detector_.skin()) &&
      watch_all(max_watched(out.size()))) {
    return linked.link_rest();
  }
  end();
}

// Collects the watched pairs of all rows. False if memory is refused or there are more than `most`.
bool RestingPairs::watch_all(std::size_t most) noexcept {
  // Rows are queried in batches, to limit the memory of the results.
  constexpr std::size_t kAtOnce = 1024;
  constexpr std::size_t kSample = 64;
  const std::size_t count = rows_.pool().rows();
  // Sample some rows first: a crowd of n objects has up to n^2 pairs, and the sample stops the
  // search before it finds them all.
  const std::size_t stride = std::max<std::size_t>(1, count / kSample);
  if (!watch_rows(0, count, stride) || watched_.size() * stride > 2 * most) return false;
  watched_.clear();
  for (std::size_t begin = 0; begin < count; begin += kAtOnce) {
    if (!watch_rows(begin, std::min(count, begin + kAtOnce), 1) || watched_.size() > most) {
      return false;
    }
  }
  return true;
}

bool RestingPairs::watch_rows(std::size_t begin, std::size_t end, std::size_t stride) noexcept {
  RowSelection& query_rows = rows_.selection();
  near_.clear();
  if (!query_rows.start((end - begin + stride - 1) / stride)) return false;
  for (std::size_t row = begin; row < end; row += stride) {
    if (rows_.pool().ids()[row] != kNoObject) query_rows.add(row);
  }
  std::uint64_t tests = 0;
  if (query_near(query_rows.entries(), near_, tests) != Status::ok) return false;
  for (const Pair& pair : near_) {
    // Each pair is found from both sides; keep it from the smaller id.
    if (pair.first >= pair.second || !is_watched(pair)) continue;
    if (!watched_.push_back({pair.first, pair.second, overlap(pair.first, pair.second)})) {
      return false;
    }
  }
  return true;
}

// False if the boxes overlap for every position within their skins.
bool RestingPairs::is_watched(const Pair& pair) const noexcept {
  const DeferredBox& a = stored_[pair.first];
  const DeferredBox& b = stored_[pair.second];
  const double reach = reach_of(skin_);
  for (int axis = 0; axis < 3; ++axis) {
    if (!(add_up(finite(a.min[axis]), reach) <= finite(b.max[axis])) ||
        !(add_up(finite(b.min[axis]), reach) <= finite(a.max[axis]))) {
      return true;
    }
  }
  return false;
}

// True if the given boxes overlap.
bool RestingPairs::overlap(ObjectId first, ObjectId second) const noexcept {
  const DeferredBox& a = given_[first];
  const DeferredBox& b = given_[second];
  // Branchless: the overlap of a watched pair is unpredictable.
  unsigned ok = 1;
  for (int axis = 0; axis < 3; ++axis) {
    ok &= static_cast<unsigned>(a.min[axis] <= b.max[axis]) &
          static_cast<unsigned>(b.min[axis] <= a.max[axis]);
  }
  return ok != 0;
}

// Pair queries.

/// The boxes of rows, enlarged by `reach`, as a query batch that reports pairs (row, other).
struct RestingPairs::NearBatch {
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

bool RestingPairs::is_cheaper(const PairBuffer& out) const noexcept {
  // If more than 1/16 of the objects were inserted, removed, filtered or left their skin, a full
  // query is cheaper.
  const std::size_t disturbed = rows_.changes().moved.ids().size();
  return 16 * disturbed <= rows_.size() && LinkedPairs::is_linked(out) &&
         watched_.size() <= max_watched(out.size());
}

// Appends (row's object, other) for all stored boxes within reach of the stored boxes of the rows.
Status RestingPairs::query_near(std::span<const std::uint32_t> query_rows, PairBuffer& out,
                                std::uint64_t& tests) const {
  const std::size_t count = query_rows.size();
  const double reach = reach_of(skin_);
  const Execution execution = rows_.execution_for(count);
  PairWriter writer(out, execution);
  const std::size_t tasks = (count + kNearQueriesPerTask - 1) / kNearQueriesPerTask;
  const Status status = writer.append(tasks, [&](std::size_t task, PairSink& sink) {
    const RowView view = rows_.view();
    NearBatch near;
    const std::size_t end = std::min(count, (task + 1) * kNearQueriesPerTask);
    for (std::size_t i = task * kNearQueriesPerTask; i < end; ++i) {
      near.add(view, query_rows[i], reach);
    }
    return index_.query(near.batch(view), sink);
  });
  tests += writer.tests();
  return status;
}

Status RestingPairs::query_moved(PairBuffer& out, std::uint64_t& tests) {
  const std::size_t kept = out.size();
  const Status status = query_near(rows_.selection().entries(), out, tests);
  if (status != Status::ok) return status;
  return keep_near(out, kept) ? Status::ok : Status::out_of_memory;
}

// Filters the pairs that moved objects found: keeps overlapping ones as (smaller id, larger id),
// and watches the ones whose overlap may change.
bool RestingPairs::keep_near(PairBuffer& out, std::size_t kept) noexcept {
  const std::uint64_t* const bits = rows_.changes().moved.bits();
  const auto has_moved = [&](ObjectId id) { return (bits[id >> 6U] >> (id & 63U) & 1U) != 0; };
  WatchedPair* const left = std::remove_if(
      watched_.begin(), watched_.end(),
      [&](const WatchedPair& pair) { return has_moved(pair.first) || has_moved(pair.second); });
  watched_.set_size(static_cast<std::size_t>(left - watched_.begin()));
  std::size_t size = kept;
  Pair* const pairs = PairTracker::data(out);
  for (std::size_t i = kept; i < out.size(); ++i) {
    const auto [query, other] = pairs[i];
    if (query == other || (other < query && has_moved(other))) continue;
    const Pair pair{std::min(query, other), std::max(query, other)};
    const bool overlapped = overlap(pair.first, pair.second);
    if (is_watched(pair) && !watched_.push_back({pair.first, pair.second, overlapped})) {
      return false;
    }
    if (overlapped) pairs[size++] = pair;
  }
  PairTracker::set_size(out, size);
  return true;
}

bool RestingPairs::note_watched(LinkedPairs& linked) noexcept {
  for (WatchedPair& pair : watched_) {
    const bool overlap_now = overlap(pair.first, pair.second);
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
