// Bodies and their partitions: adding, removing, moving between sets, boxes and the origin they are
// measured from, and the broad phase (find_pairs). scene.cpp calls this; the pairs go to Collision
// (collide.cpp).

#include "pipeline/scene/scene_state.h"

#include "core/hooks/stage_scope.h"
#include "core/numbers/rounding.h"
#include "core/sort/parallel_ranges.h"
#include "partitions/state/box_partition.h"
#include "pipeline/composites/parts.h"
#include "pipeline/scene/body_predicate.h"
#include "pipeline/scene/motion_bound.h"
#include "pipeline/scene/scene_origin.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

namespace winnow {
namespace {

[[nodiscard]] bool is_length(double value) noexcept {
  return std::isfinite(value) && value >= 0.0;
}

[[nodiscard]] bool are_good(const SceneOptions& options) noexcept {
  const auto known = [](StructureKind kind) { return kind != StructureKind{}; };
  return is_length(options.contact_margin) && is_length(options.cache_tolerance) &&
         std::all_of(std::begin(options.structures), std::end(options.structures), known) &&
         options.tier <= NarrowTier::reference;
}

[[nodiscard]] std::uint64_t next_serial() noexcept {
  static std::atomic<std::uint64_t> serial{0};
  return ++serial;
}

constexpr std::size_t kBodiesPerRange = 256;
constexpr std::size_t kFewBoxes = 128;
// Boxes computed before they are given to their partition: few enough to use little memory beside
// the bodies, enough to occupy many threads.
constexpr std::size_t kBoxesPerBatch = 16384;
constexpr std::size_t kKeysPerCall = 512;

// A buffer that grows while pairs are found grows by half. The number of pairs is about the same in
// most frames, so the capacity shrinks to that number and a sixteenth more. If the smaller
// allocation is refused, the larger one stays.
void shrink_to_steady(PairBuffer& pairs) noexcept {
  const std::size_t steady = pairs.size() + pairs.size() / 16;
  if (pairs.capacity() * sizeof(Pair) >= kSmallColumn) (void)pairs.shrink(steady);
}

}  // namespace

SceneState::SceneState(const ShapePool& pool, const SceneOptions& given) noexcept
    : BodyColumns(given.memory),
      shapes(pool),
      options(given),
      options_are_good(are_good(given)),
      growth(given.contact_margin * 0.5 + given.cache_tolerance),
      stale(given.memory),
      staged(given.memory),
      sets{SceneSet(given.memory), SceneSet(given.memory), SceneSet(given.memory)},
      serial(next_serial()),
      pairs(given.memory),
      batch(given.memory),
      rules(given.memory) {
  if (given.composites != nullptr) composites_seen = given.composites->revision();
}

// Marks bodies with the second bit of `flag` to find duplicates.
bool StaleBodies::are_distinct(const KeyTable& keys, std::span<const Key> given) noexcept {
  constexpr std::uint8_t kSeen = 2;
  std::size_t marked = 0;
  for (; marked < given.size(); ++marked) {
    const Key key = given[marked];
    if (!keys.is_valid(key) || (flag[key.id] & kSeen) != 0) break;
    flag[key.id] |= kSeen;
  }
  for (std::size_t i = 0; i < marked; ++i) {
    flag[given[i].id] = static_cast<std::uint8_t>(flag[given[i].id] & ~kSeen);
  }
  return marked == given.size();
}

void StaleBodies::forget_removed(const KeyTable& keys) noexcept {
  std::size_t kept = 0;
  for (const std::uint32_t body : bodies) {
    if (keys.is_live(body)) {
      bodies[kept++] = body;
    } else {
      flag[body] = 0;
    }
  }
  bodies.set_size(kept);
}

BoxView StagedBoxes::view() const noexcept {
  const PlainBox* const first = boxes.data();
  return {{&first->min[0], &first->min[1], &first->min[2]},
          {&first->max[0], &first->max[1], &first->max[2]},
          boxes.size(),
          sizeof(PlainBox)};
}

BoxRoom::BoxRoom(StagedBoxes& staged) noexcept : staged_(staged) {
  std::size_t i = 0;
  staged_.visit_columns([&](auto& column) { room_[i++] = column.capacity(); });
}

BoxRoom::~BoxRoom() {
  std::size_t i = 0;
  staged_.visit_columns([&](auto& column) {
    if (column.capacity() <= std::max(room_[i++], kBoxesPerBatch)) return;
    column.clear();
    // If the smaller allocation is refused, the larger one stays.
    (void)column.shrink(kBoxesPerBatch);
  });
}

Status SceneState::check(ShapeId id, const Pose& at) const noexcept {
  if (id.is_composite() && options.composites == nullptr) return Status::unsupported;
  const bool known =
      id.is_composite()
          ? mid::PoolAccess::mid_phase(*options.composites).contains(*options.composites, id)
          : shapes.contains(id);
  if (!known) return Status::invalid_key;
  return at.is_valid() ? Status::ok : Status::invalid_pose;
}

bool SceneState::has_composites() const noexcept {
  return options.composites != nullptr &&
         std::any_of(shape.begin(), shape.end(), [](ShapeId id) { return id.is_composite(); });
}

Status SceneState::make_partition_of(BodyState which) {
  SceneSet& target = set(which);
  if (target.partition.has_value()) return Status::ok;
  Partition made = make_box_partition(options.structures[static_cast<std::size_t>(which)],
                                      {.memory = options.memory,
                                       .execution = options.execution,
                                       .build_budget = options.build_budget});
  const Status status = made.status();
  if (status == Status::ok) target.partition.emplace(std::move(made));
  return status;
}

double SceneState::radius(std::uint32_t body) const noexcept {
  return SubShapeQuery(shapes, options.composites).radius(shape[body]);
}

PlainBox SceneState::bounds_from(const Eigen::Vector3d& from, ShapeId id, const Pose& at,
                                 double grown_by) const noexcept {
  Pose moved = at;
  double growth_to[3];
  for (int axis = 0; axis < 3; ++axis) {
    // Grows the box by the rounding error of the difference.
    const double low = add_down(at.position[axis], -from[axis]);
    const double high = add_up(at.position[axis], -from[axis]);
    moved.position[axis] = low;
    growth_to[axis] = grown_by + (high - low);
  }
  const Aabb box =
      id.is_composite()
          ? mid::PoolAccess::mid_phase(*options.composites).bounds(*options.composites, id, moved)
          : shapes.bounds(id, moved);
  PlainBox grown;
  for (int axis = 0; axis < 3; ++axis) {
    grown.min[axis] = round_down(add_down(static_cast<double>(box.min[axis]), -growth_to[axis]));
    grown.max[axis] = round_up(add_up(static_cast<double>(box.max[axis]), growth_to[axis]));
  }
  return grown;
}

bool SceneState::has_one_origin() const noexcept {
  return std::all_of(std::begin(sets), std::end(sets), [&](const SceneSet& set) {
    return !set.partition.has_value() || set.origin == origin || set.partition->size() == 0;
  });
}

// Samples at most BodySample::kMaxSamples bodies, at equal steps of ids.
void SceneState::choose_origin() noexcept {
  boxes_since_sampling = 0;
  if (keeps_origin) return;
  const std::size_t slots = keys.slot_count();
  const std::size_t step = slots / BodySample::kMaxSamples + 1;
  BodySample places;
  for (std::size_t body = 0; body < slots; body += step) {
    const auto id = static_cast<std::uint32_t>(body);
    if (keys.is_live(id)) places.add(pose[id].position.data(), radius(id));
  }
  origin = places.origin(origin);
}

// The radius includes the rounding errors of the difference and of the conversion to float.
BodyBall SceneState::ball_from(const Eigen::Vector3d& from, std::uint32_t body) const noexcept {
  constexpr double kCenterError = 0x1p-23;
  const Pose& at = anchor.empty() ? pose[body] : anchor[body];
  BodyBall made;
  double length = 0.0;
  bool is_float = true;
  for (int axis = 0; axis < 3; ++axis) {
    const double center = at.position[axis] - from[axis];
    made.center[axis] = static_cast<float>(center);
    length += std::abs(center);
    is_float = is_float && std::isfinite(made.center[axis]);
  }
  const double grown = radius(body) + growth + offsets.of(body).contact +
                       (length * kCenterError + std::numeric_limits<float>::min());
  made.radius = is_float ? round_up(grown) : std::numeric_limits<float>::infinity();
  return made;
}

void SceneState::set_balls(std::span<const std::uint32_t> bodies,
                           const Eigen::Vector3d& from) noexcept {
  for_each_range(options.execution, bodies.size(), kBodiesPerRange,
                 [&](std::size_t first, std::size_t end) {
                   for (const std::uint32_t body : bodies.subspan(first, end - first)) {
                     ball[body] = ball_from(from, body);
                   }
                 });
}

Status SceneState::place_bodies(BodyState which, std::span<const std::uint32_t> bodies) {
  if (bodies.empty()) return Status::ok;
  SceneSet& target = set(which);
  if (const Status made = make_partition_of(which); made != Status::ok) return made;
  if (target.partition->size() == 0) target.origin = origin;
  if (!staged.boxes.resize(bodies.size())) return Status::out_of_memory;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    staged.boxes[i] = bounds_from(target.origin, shape[bodies[i]], pose[bodies[i]],
                                  growth + offsets.of(bodies[i]).contact);
  }
  if (const Status placed = place_boxes(which, bodies); placed != Status::ok) return placed;
  for (const std::uint32_t body : bodies) {
    if (!anchor.empty()) anchor[body] = with_unit_turn(pose[body]);
  }
  set_balls(bodies, target.origin);
  boxes_since_sampling += bodies.size();
  return Status::ok;
}

Status SceneState::place_boxes(BodyState which, std::span<const std::uint32_t> bodies) {
  SceneSet& target = set(which);
  if (const Status made = make_partition_of(which); made != Status::ok) return made;
  const std::size_t count = bodies.size();
  // New ids of the partition are below its largest former id count plus `count`.
  if (!staged.keys.resize(count) || !staged.data.resize(count) ||
      !target.body_of.grow(target.body_of.size() + count)) {
    return Status::out_of_memory;
  }
  for (std::size_t i = 0; i < count; ++i) staged.data[i] = bodies[i];
  const std::span<Key> keys_given{staged.keys.data(), count};
  const Status status =
      target.partition->insert(staged.view(), {staged.data.data(), count}, keys_given);
  if (status != Status::ok) return status;
  std::size_t objects = target.body_of.size();
  for (const Key& key : keys_given) objects = std::max(objects, key.id + std::size_t{1});
  target.body_of.set_size(objects);
  for (std::size_t i = 0; i < count; ++i) {
    place[bodies[i]] = staged.keys[i];
    target.body_of[staged.keys[i].id] = bodies[i];
  }
  ++target.changes;
  return Status::ok;
}

void SceneState::displace(BodyState which, std::span<const Key> places) {
  if (places.empty()) return;
  // Cannot fail: removal allocates nothing, and the keys are valid.
  (void)set(which).partition->remove(places);
  ++set(which).changes;
}

// Works in chunks on the stack, so it allocates nothing.
void SceneState::take_out(std::span<const Key> given, BodyState which) {
  Key places[kKeysPerCall];
  std::size_t count = 0;
  for (const Key& key : given) {
    if (body_state[key.id] != which) continue;
    places[count++] = place[key.id];
    keys.release(key.id);
    if (count == kKeysPerCall) displace(which, {places, std::exchange(count, 0)});
  }
  displace(which, {places, count});
}

// Removes the bodies in reverse order, so that the partition assigns the same ids again.
void SceneState::take_back(std::span<const std::uint32_t> bodies, BodyState which) {
  for (std::size_t i = bodies.size(); i-- > 0;) displace(which, {&place[bodies[i]], 1});
}

// Reserves every column, so that adding the bodies cannot fail.
bool SceneState::reserve(std::size_t fresh) noexcept {
  if (!keys.reserve(keys.size() + fresh)) return false;
  const std::size_t slots = keys.slots_with(fresh);
  const bool with_anchors = options.cache_tolerance == 0.0 || anchor.grow(slots);
  const bool has_room = (!offsets.any || offsets.column.grow(slots)) &&
                        (!rules.with_layers || rules.layer.grow(slots));
  return with_anchors && has_room && shape.grow(slots) && pose.grow(slots) &&
         body_state.grow(slots) && ball.grow(slots) && place.grow(slots) && moved_at.grow(slots) &&
         shaped_at.grow(slots) && stale.bodies.grow(slots) && stale.flag.grow(slots);
}

Key SceneState::acquire(const BodyDefinition& body) noexcept {
  const Key key = keys.acquire(0, body.data);
  const std::size_t slots = keys.slot_count();
  if (key.id >= shape.size()) {
    shape.set_size(slots);
    pose.set_size(slots);
    body_state.set_size(slots);
    place.set_size(slots);
    ball.set_size(slots);
    moved_at.set_size(slots);
    shaped_at.set_size(slots);
    stale.flag.set_size(slots);
    stale.flag[key.id] = 0;
    if (options.cache_tolerance > 0.0) anchor.set_size(slots);
    if (offsets.any) offsets.column.set_size(slots);
    if (rules.with_layers) rules.layer.set_size(slots);
  }
  shape[key.id] = body.shape;
  pose[key.id] = body.pose;
  body_state[key.id] = body.state;
  place[key.id] = {};
  moved_at[key.id] = shaped_at[key.id] = clock;
  if (offsets.any) offsets.column[key.id] = body.offsets;
  if (rules.with_layers) rules.layer[key.id] = body.layer;
  return key;
}

std::span<const std::uint32_t> SceneState::choose(std::span<const Key> given,
                                                  BodyState which) noexcept {
  staged.chosen.clear();
  for (const Key& key : given) {
    if (body_state[key.id] == which) (void)staged.chosen.push_back(key.id);
  }
  return {staged.chosen.data(), staged.chosen.size()};
}

// Inserts bodies that have just got their keys into their partitions: all of them or none.
Status SceneState::settle(std::span<const BodyDefinition> bodies, std::span<const Key> given) {
  const BoxRoom room(staged);
  if (!staged.chosen.grow(bodies.size())) return Status::out_of_memory;
  std::size_t settled = 0;
  Status status = Status::ok;
  for (; settled < kBodyStates && status == Status::ok; ++settled) {
    const BodyState which = kAllBodyStates[settled];
    status = place_bodies(which, choose(given, which));
  }
  if (status != Status::ok) --settled;
  for (std::size_t i = 0; i < bodies.size() && status == Status::ok; ++i) {
    if (bodies[i].filter == ObjectFilter{}) continue;
    Partition& partition = *set(bodies[i].state).partition;
    status = partition.set_filter(place[given[i].id], bodies[i].filter);
  }
  if (status == Status::ok) return status;
  while (settled-- > 0) take_back(choose(given, kAllBodyStates[settled]), kAllBodyStates[settled]);
  return status;
}

void SceneState::set_pose(std::uint32_t body, const Pose& to) noexcept {
  pose[body] = to;
  moved_at[body] = clock;
  stale.mark(body);
}

// Every body is inserted in its new partition, with its filter, before the first one is removed
// from its old partition. Until then everything can be undone.
Status SceneState::move_to_set(std::span<const Key> given, BodyState to) {
  const BoxRoom room(staged);
  staged.chosen.clear();
  if (!staged.chosen.grow(given.size())) return Status::out_of_memory;
  for (const Key& key : given) {
    if (body_state[key.id] != to) (void)staged.chosen.push_back(key.id);
  }
  const std::span<const std::uint32_t> bodies{staged.chosen.data(), staged.chosen.size()};
  if (bodies.empty()) return Status::ok;
  if (!staged.old_keys.resize(bodies.size())) return Status::out_of_memory;
  for (std::size_t i = 0; i < bodies.size(); ++i) staged.old_keys[i] = place[bodies[i]];
  Status status = place_bodies(to, bodies);
  if (status != Status::ok) return status;
  for (std::size_t i = 0; i < bodies.size() && status == Status::ok; ++i) {
    const Answer<ObjectFilter> filter =
        set(body_state[bodies[i]]).partition->filter(staged.old_keys[i]);
    status = filter.status;
    if (status == Status::ok && filter != ObjectFilter{}) {
      status = set(to).partition->set_filter(place[bodies[i]], filter);
    }
  }
  if (status != Status::ok) {
    take_back(bodies, to);
    for (std::size_t i = 0; i < bodies.size(); ++i) place[bodies[i]] = staged.old_keys[i];
    return status;
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    displace(body_state[bodies[i]], {&staged.old_keys[i], 1});
    body_state[bodies[i]] = to;
  }
  ++regroupings;
  return Status::ok;
}

// False if the box in the partition still contains the body and its margin: boxes are enlarged by
// SceneOptions::cache_tolerance, and the body moved by no more than that.
bool SceneState::needs_box(std::uint32_t body) const noexcept {
  if (anchor.empty() || shaped_at[body] >= moved_at[body]) return true;
  // NaN compares false, and the result is then true.
  return !(motion_bound(anchor[body], with_unit_turn(pose[body]), radius(body)) <=
           options.cache_tolerance);
}

Status SceneState::refresh() {
  if (options.composites != nullptr && options.composites->revision() != composites_seen) {
    composites_seen = options.composites->revision();
    for (std::uint32_t body = 0; body < shape.size(); ++body) {
      if (!keys.is_live(body) || !shape[body].is_composite()) continue;
      shaped_at[body] = clock;
      stale.mark(body);
    }
  }
  // Bodies are sampled only after many boxes were updated, so a sample costs little beside the
  // updates.
  if (boxes_since_sampling >= std::max(kFewBoxes, keys.size() / 2)) choose_origin();
  if (is_up_to_date()) return Status::ok;
  const StageScope stage(WorkStage::refresh);
  for (std::size_t which = 0; which < kBodyStates; ++which) {
    const Status status = refresh_set(static_cast<BodyState>(which));
    if (status != Status::ok) return status;
  }
  stale.clear();
  return Status::ok;
}

Status SceneState::refresh_set(BodyState which) {
  SceneSet& target = set(which);
  if (!target.partition.has_value()) return Status::ok;
  if (target.origin != origin) return move_origin(which);
  for (std::size_t next = 0; next < stale.bodies.size();) {
    staged.chosen.clear();
    if (!staged.chosen.reserve(std::min(stale.bodies.size() - next, kBoxesPerBatch)))
      return Status::out_of_memory;
    for (; next < stale.bodies.size() && staged.chosen.size() < kBoxesPerBatch; ++next) {
      const std::uint32_t body = stale.bodies[next];
      if (body_state[body] == which && needs_box(body)) (void)staged.chosen.push_back(body);
    }
    if (const Status status = renew_boxes(target); status != Status::ok) return status;
  }
  return Status::ok;
}

// Updates all boxes of a set in one call. If the update is refused, all boxes keep the old origin.
Status SceneState::move_origin(BodyState which) {
  SceneSet& target = set(which);
  const BoxRoom room(staged);
  staged.chosen.clear();
  if (!staged.chosen.reserve(target.partition->size())) return Status::out_of_memory;
  for (std::uint32_t body = 0; body < keys.slot_count(); ++body) {
    if (keys.is_live(body) && body_state[body] == which) (void)staged.chosen.push_back(body);
  }
  if (const Status status = renew_boxes(target); status != Status::ok) return status;
  target.origin = origin;
  return Status::ok;
}

// Gives the partition new boxes of the bodies in `staged.chosen`.
Status SceneState::renew_boxes(SceneSet& target) {
  const std::size_t count = staged.chosen.size();
  if (count == 0) return Status::ok;
  if (!staged.boxes.resize(count) || !staged.keys.resize(count)) return Status::out_of_memory;
  for_each_range(
      options.execution, count, kBodiesPerRange, [&](std::size_t first, std::size_t end) {
        for (std::size_t i = first; i < end; ++i) {
          const std::uint32_t body = staged.chosen[i];
          staged.boxes[i] =
              bounds_from(origin, shape[body], pose[body], growth + offsets.of(body).contact);
          staged.keys[i] = place[staged.chosen[i]];
        }
      });
  const Status status = target.partition->update({staged.keys.data(), count}, staged.view());
  if (status != Status::ok) return status;
  if (!anchor.empty()) {
    for (const std::uint32_t body : staged.chosen) anchor[body] = with_unit_turn(pose[body]);
  }
  set_balls({staged.chosen.data(), count}, origin);
  boxes_since_sampling += count;
  boxes_updated += count;
  ++target.changes;
  return Status::ok;
}

// Finds the pairs of dynamic bodies with the bodies of each set, unless nothing has changed since
// the last call.
Status SceneState::find_pairs(bool all) {
  if (const Status status = refresh(); status != Status::ok) return status;
  bool changed = pairs.are_all() != all;
  for (std::size_t i = 0; i < kBodyStates; ++i) {
    changed = changed || pairs.changes[i] != sets[i].changes;
  }
  if (!changed) return Status::ok;
  const SceneSet& dynamic = set(BodyState::dynamic);
  static_assert(kBodyStates <= BodyPairs::kMaxSources);
  BodyPairs::PairSource sources[kBodyStates];
  std::size_t count = 0;
  for (SceneSet& other : sets) {
    if (!dynamic.partition.has_value() || !other.partition.has_value()) continue;
    const BodyPredicate judge{*this, dynamic.body_of.data(), other.body_of.data()};
    const PairOptions pair_options = judge.options();
    const std::size_t room = other.with_dynamic.capacity();
    const Status status =
        &other == &dynamic
            ? dynamic.partition->self_pairs(other.with_dynamic, pair_options)
            : dynamic.partition->pairs_with(*other.partition, other.with_dynamic, pair_options);
    if (status != Status::ok) return status;
    if (other.with_dynamic.capacity() > room) shrink_to_steady(other.with_dynamic);
    sources[count++] = {other.with_dynamic.pairs(), dynamic.body_of.data(), other.body_of.data()};
  }
  const Status status = pairs.assign(
      {sources, count}, {shape.data(), all ? nullptr : ball.data(), keys.slot_count(), selection},
      options.execution);
  if (status != Status::ok) return status;
  for (std::size_t i = 0; i < kBodyStates; ++i) pairs.changes[i] = sets[i].changes;
  return Status::ok;
}

}  // namespace winnow
