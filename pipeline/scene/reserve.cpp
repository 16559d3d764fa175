// Scene::reserve and reserve_contacts. Columns and partitions reserve for given counts; the narrow
// phase, whose scratch is private, is called with the same number of pairs as a rehearsal.

#include "core/memory/columns.h"
#include "core/threads/float_environment.h"
#include "pipeline/kernels/kernels.h"
#include "pipeline/narrow/narrow_columns.h"
#include "pipeline/scene/collision.h"
#include "pipeline/scene/contact_frame.h"
#include "pipeline/scene/scene_state.h"

#include <algorithm>
#include <numeric>

namespace winnow {
namespace {

// A partition with holes in its rows (from added and removed objects) compacts its rows once the
// holes are a fifth of all rows and more than this number.
constexpr std::size_t kFewRows = 64;

[[nodiscard]] std::size_t rows_for(std::size_t bodies) noexcept {
  return bodies + std::max(kFewRows, bodies / 4);
}

[[nodiscard]] std::size_t bodies_of(const SceneCapacity& room) noexcept {
  return std::accumulate(std::begin(room.bodies), std::end(room.bodies), std::size_t{0});
}

// Number of pairs in Contacts.
[[nodiscard]] std::size_t shown_pairs(const SceneCapacity& room) noexcept {
  return room.level == ContactLevel::pairs ? room.pairs : room.touching;
}

[[nodiscard]] Status check(const SceneCapacity& room) noexcept {
  if (room.level > ContactLevel::manifold) return Status::invalid_argument;
  const bool too_many =
      std::ranges::any_of(room.bodies, [](auto n) { return n >= kMaxBodies; }) ||
      bodies_of(room) >= kMaxBodies ||
      std::max({room.pairs, room.touching, room.manifolds, room.points}) >= kNoEntry;
  return too_many ? Status::too_many_objects : Status::ok;
}

template <typename... T>
[[nodiscard]] bool reserve_all(std::size_t count, Pages pages, Column<T>&... columns) noexcept {
  return (columns.reserve(count, pages) && ...);
}

}  // namespace

Status Scene::reserve(const SceneCapacity& room, Pages pages) {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return Status::out_of_memory;
  if (!state_->options_are_good) return Status::invalid_argument;
  const Status good = check(room);
  return good == Status::ok ? state_->reserve(room, pages) : good;
}

Status Scene::reserve_contacts(Contacts& out, const SceneCapacity& room, Pages pages) const {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr || out.state_ == nullptr) return Status::out_of_memory;
  if (const Status good = check(room); good != Status::ok) return good;
  return out.state_->reserve(room, state_->options, pages) ? Status::ok : Status::out_of_memory;
}

// Partitions come last, because a new partition is visible to callers.
Status SceneState::reserve(const SceneCapacity& room, Pages pages) {
  if (!reserve_bodies(room, pages) || !pairs.reserve(room.pairs, pages)) {
    return Status::out_of_memory;
  }
  const Status status = batch.reserve(shapes, options, room, offsets.any, pages);
  return status == Status::ok ? reserve_sets(room, pages) : status;
}

bool SceneState::reserve_bodies(const SceneCapacity& room, Pages pages) noexcept {
  const std::size_t bodies = bodies_of(room);
  if (!reserve(bodies > keys.size() ? bodies - keys.size() : 0)) return false;
  // One call may move all bodies, and passes boxes to one set at a time.
  const std::size_t largest = *std::ranges::max_element(room.bodies);
  if (!reserve_all(largest, pages, staged.boxes, staged.keys, staged.data) ||
      !reserve_all(bodies, pages, staged.chosen) || !reserve_all(bodies, pages, staged.old_keys)) {
    return false;
  }
  if (pages == Pages::prefaulted) {
    keys.touch();
    touch_columns(shape, pose, body_state, place, ball, moved_at, shaped_at, stale.bodies,
                  stale.flag);
    anchor.touch();
  }
  return true;
}

Status SceneState::reserve_sets(const SceneCapacity& room, Pages pages) {
  bool is_new[kBodyStates] = {};
  Status status = Status::ok;
  for (std::size_t i = 0; i < kBodyStates && status == Status::ok; ++i) {
    const std::size_t bodies = room.bodies[i];
    if (bodies == 0) continue;
    SceneSet& target = sets[i];
    is_new[i] = !target.partition.has_value();
    status = make_partition_of(static_cast<BodyState>(i));
    if (status == Status::ok) status = target.partition->reserve(rows_for(bodies), pages);
    if (status == Status::ok) {
      status = target.partition->reserve_pairs(target.with_dynamic, room.pairs, pages);
    }
    // Twice, because place_boxes allocates an entry for each body that it adds, in addition to the
    // entries in use. Either number may be `bodies`.
    if (status == Status::ok && !target.body_of.reserve(2 * bodies, pages)) {
      status = Status::out_of_memory;
    }
  }
  for (std::size_t i = 0; i < kBodyStates && status != Status::ok; ++i) {
    if (is_new[i]) sets[i].partition.reset();
  }
  return status;
}

Status PairBatch::reserve(const ShapePool& shapes, const SceneOptions& options,
                          const SceneCapacity& room, bool with_offsets, Pages pages) {
  if (room.level == ContactLevel::pairs) return Status::ok;
  const std::size_t batch = CollideCall::batch_size(options, room.pairs);
  if (options.composites != nullptr && !composite.reserve(batch, pages)) {
    return Status::out_of_memory;
  }
  ShapeId ids[2 * kShapeKinds];
  Pose poses[2 * kShapeKinds];
  std::size_t bodies = 0;
  for (std::uint32_t kind = 0; kind < kShapeKinds; ++kind) {
    if (shapes.tables().count[kind] == 0) continue;
    for (int copy = 0; copy < 2; ++copy) {
      ids[bodies] = ShapeId::of(static_cast<ShapeKind>(kind), 0);
      poses[bodies] = Pose::at(1e6 * static_cast<double>(bodies), 0.0, 0.0);
      ++bodies;
    }
  }
  if (!convex.reserve(CollideCall::batch_room(options, room.pairs), pages) ||
      (with_offsets && !gaps.reserve(batch, pages)) || !list_rehearsal(bodies / 2, batch)) {
    return Status::out_of_memory;
  }
  const Status status = narrow.collide(
      shapes, {{ids, bodies}, {poses, bodies}}, {convex.data(), convex.size()},
      {room.level, NarrowTier::robust, options.contact_margin, options.execution}, answers);
  convex.clear();
  if (status != Status::ok || room.level != ContactLevel::manifold) return status;
  // On one thread, a job requires room for the largest number of points it may find.
  ContactColumns& points = NarrowColumns::of(answers).contacts;
  const std::size_t found = std::min(room.points, batch * kManifoldPoints);
  const std::size_t most = found + std::size_t{kJobPairs} * kManifoldPoints + kContactSlack;
  return points.grow(most, pages) ? Status::ok : Status::out_of_memory;
}

// Lists `count` pairs; bodies 2 k and 2 k + 1 have kind k. The list begins with one pair for each
// two kinds, because the narrow phase ends each run of pairs of equal kinds with a partial job.
// These pairs are in swapped order, so that their results must be mirrored. All other pairs are of
// kind 0.
bool PairBatch::list_rehearsal(std::size_t kinds, std::size_t count) noexcept {
  if (!convex.reserve(count)) return false;
  convex.clear();
  for (std::uint32_t a = 0; a < kinds; ++a) {
    for (std::uint32_t b = a; b < kinds; ++b) {
      if (convex.size() < count) (void)convex.push_back({2 * b + 1, 2 * a});
    }
  }
  const std::size_t listed = convex.size();
  convex.set_size(kinds == 0 ? 0 : count);
  std::fill(convex.begin() + listed, convex.end(), BodyPair{0, 1});
  return true;
}

bool ContactsState::reserve(const SceneCapacity& room, const SceneOptions& options,
                            Pages pages) noexcept {
  const bool uses_cache = options.cache_tolerance > 0.0 && room.level >= ContactLevel::distance;
  const bool stores_positions = options.warm_start;
  const std::size_t shown = shown_pairs(room);
  const bool may_sleep = room.bodies[static_cast<std::size_t>(BodyState::fixed)] != 0 ||
                         room.bodies[static_cast<std::size_t>(BodyState::sleeping)] != 0;
  const bool parts = options.composites != nullptr;
  if (!frame.reserve(room.level, parts, shown, room.manifolds, room.points, pages)) return false;
  // Only caching and warm starts read the last frame and the manifolds of sleeping pairs.
  // Without them, the last frame is not kept, and sleeping pairs are kept without manifolds.
  const bool has_more = uses_cache || stores_positions;
  const std::size_t manifolds = has_more ? room.manifolds : 0;
  const std::size_t points_kept = has_more ? room.points : 0;
  if ((has_more && !before.reserve(room.level, parts, shown, manifolds, points_kept, pages)) ||
      (may_sleep && !dormant.reserve(room.level, parts, shown, manifolds, points_kept, pages)) ||
      !known.reserve(bodies_of(room), pages)) {
    return false;
  }
  const std::size_t points = room.level == ContactLevel::manifold ? room.points : 0;
  if (stores_positions && !history.reserve(shown, points, bodies_of(room), pages)) return false;
  // Pairs that wake are added to all records.
  const std::size_t remembered = uses_cache ? room.pairs + shown : shown;
  const std::size_t cached_room = uses_cache ? remembered : 0;
  // Caching is decided for all pairs before the narrow phase begins.
  const std::size_t batch = CollideCall::batch_size(options, room.pairs);
  const std::size_t batch_room = CollideCall::batch_room(options, room.pairs);
  const std::size_t record_room = uses_cache ? std::max(room.pairs, batch_room) : batch_room;
  const std::size_t input_room = room.level == ContactLevel::pairs ? 0 : batch_room;
  const std::size_t source_room = room.level == ContactLevel::pairs ? 0 : record_room;
  // Without caching and sleeping pairs, `records` and `records_before` share one column, of
  // which only `bits` is used. If the scene and the contacts have the same memory resource, the
  // column is borrowed from the scene (see BorrowedStorage in collide.cpp).
  const bool two_orders = uses_cache || may_sleep;
  const bool one_order = two_orders || frame.event.memory() != options.memory;
  return reserve_all(shown, pages, ended, is_in_new_frame) &&
         records.bits.reserve(one_order ? remembered : 0, pages) &&
         records_before.bits.reserve(two_orders ? remembered : 0, pages) &&
         reserve_all(two_orders ? remembered : 0, pages, records.frame_index,
                     records_before.frame_index) &&
         (!may_sleep || dormant_records.reserve(shown, pages)) &&
         reserve_all(cached_room, pages, cached, cached_before) &&
         dormant_cached.reserve(uses_cache ? shown : 0, pages) &&
         input.reserve(input_room, pages) && source.reserve(source_room, pages) &&
         old_record.reserve(record_room, pages) &&
         sums.reserve(batch / CollideCall::kPairsPerTask + 1, pages);
}

}  // namespace winnow
