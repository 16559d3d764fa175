#include <winnow/pipeline/scene/motion_bound.h>
#include <winnow/pipeline/scene/scene_state.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <new>

namespace winnow {
namespace {

[[nodiscard]] bool is_length(double value) noexcept {
  return std::isfinite(value) && value >= 0.0;
}

[[nodiscard]] bool are_good(const SceneOptions& options) noexcept {
  const auto known = [](std::string_view name) {
    const auto names = partition_names();
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  return is_length(options.margin) && is_length(options.carry_over) &&
         std::all_of(std::begin(options.partitions), std::end(options.partitions), known) &&
         options.tier <= NarrowTier::reference;
}

[[nodiscard]] std::uint64_t next_serial() noexcept {
  static std::atomic<std::uint64_t> serial{0};
  return ++serial;
}

constexpr Motion kEveryMotion[kMotions] = {Motion::fixed, Motion::dynamic, Motion::sleeping};

[[nodiscard]] bool is_motion(Motion motion) noexcept {
  return motion <= Motion::sleeping;
}

}  // namespace

Bytes SceneFootprint::total() const noexcept {
  Bytes sum;
  for (const Bytes* part : {&bodies, &partitions[0], &partitions[1], &partitions[2], &pairs,
                            &mid_phase, &narrow_phase}) {
    sum += *part;
  }
  return sum;
}

Scene::State::State(const ShapePool& pool, const SceneOptions& given)
    : shapes(pool),
      options(given),
      options_are_good(are_good(given)),
      growth(given.margin * 0.5 + given.carry_over),
      keys(given.memory),
      shape(given.memory),
      pose(given.memory),
      motion(given.memory),
      place(given.memory),
      moved_at(given.memory),
      shaped_at(given.memory),
      anchor(given.memory),
      stale(given.memory),
      is_stale(given.memory),
      boxes(given.memory),
      boxes_of(given.memory),
      boxes_body(given.memory),
      chosen(given.memory),
      left(given.memory),
      sets{SceneSet(given.memory), SceneSet(given.memory), SceneSet(given.memory)},
      serial(next_serial()),
      pairs(given.memory),
      narrow(given.memory),
      answers(given.memory),
      slot(given.memory),
      convex(given.memory),
      composite(given.memory),
      parts(given.memory),
      parts_narrow(given.memory),
      parts_answers(given.memory),
      parts_slot(given.memory) {
  if (given.composites != nullptr) composites_seen = given.composites->revision();
}

Scene::Scene(const ShapePool& shapes, const SceneOptions& options)
    : state_(new State(shapes, options)) {}

Scene::~Scene() {
  delete state_;
}

Status Scene::State::check(ShapeId id, const Pose& at) const noexcept {
  const bool known = id.is_composite()
                         ? options.composites != nullptr && options.composites->contains(id)
                         : shapes.contains(id);
  if (!known) return Status::invalid_key;
  return at.is_valid() ? Status::ok : Status::invalid_pose;
}

Status Scene::State::make_partition_of(Motion which) {
  SceneSet& target = set(which);
  if (target.partition != nullptr) return Status::ok;
  try {
    target.partition = make_partition(options.partitions[static_cast<std::size_t>(which)],
                                      {options.memory, options.execution});
  } catch (const std::bad_alloc&) {
  }
  return target.partition == nullptr ? Status::out_of_memory : Status::ok;
}

PlainBox Scene::State::grown_bounds(std::uint32_t body) const noexcept {
  const ShapeId id = shape[body];
  const Aabb box = id.is_composite() ? options.composites->bounds(id, pose[body])
                                     : shapes.bounds(id, pose[body]);
  PlainBox grown;
  for (int axis = 0; axis < 3; ++axis) {
    grown.min[axis] = round_down(add_down(static_cast<double>(box.min[axis]), -growth));
    grown.max[axis] = round_up(add_up(static_cast<double>(box.max[axis]), growth));
  }
  return grown;
}

// Of what lies in `boxes`.
BoxView Scene::State::box_view() const noexcept {
  const PlainBox* const first = boxes.data();
  return {{&first->min[0], &first->min[1], &first->min[2]},
          {&first->max[0], &first->max[1], &first->max[2]},
          boxes.size(),
          sizeof(PlainBox)};
}

Status Scene::State::place_bodies(Motion which, std::span<const std::uint32_t> bodies) {
  if (bodies.empty()) return Status::ok;
  SceneSet& target = set(which);
  if (const Status made = make_partition_of(which); made != Status::ok) return made;
  const std::size_t count = bodies.size();
  if (!boxes.resize(count) || !boxes_of.resize(count) || !boxes_body.resize(count)) {
    return Status::out_of_memory;
  }
  for (std::size_t i = 0; i < count; ++i) {
    boxes[i] = grown_bounds(bodies[i]);
    boxes_body[i] = bodies[i];
  }
  const std::span<Key> keys_given{boxes_of.data(), count};
  const Status status =
      target.partition->insert(box_view(), {boxes_body.data(), count}, keys_given);
  if (status != Status::ok) return status;
  std::size_t objects = target.body_of.size();
  for (const Key& key : keys_given) objects = std::max(objects, key.id + std::size_t{1});
  if (!target.body_of.resize(objects)) {
    (void)target.partition->remove(keys_given);
    return Status::out_of_memory;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t body = bodies[i];
    place[body] = boxes_of[i];
    target.body_of[boxes_of[i].id] = body;
    if (!anchor.empty()) anchor[body] = with_unit_turn(pose[body]);
  }
  ++target.changes;
  return Status::ok;
}

Status Scene::State::displace(Motion which, std::span<const Key> places) {
  if (places.empty()) return Status::ok;
  const Status status = set(which).partition->remove(places);
  if (status == Status::ok) ++set(which).changes;
  return status;
}

// Room in every column, so that what follows cannot fail.
bool Scene::State::reserve(std::size_t fresh) noexcept {
  if (!keys.reserve(keys.size() + fresh)) return false;
  const std::size_t slots = keys.slot_count() + fresh;
  const bool with_anchors = options.carry_over == 0.0 || anchor.grow(slots);
  return with_anchors && shape.grow(slots) && pose.grow(slots) && motion.grow(slots) &&
         place.grow(slots) && moved_at.grow(slots) && shaped_at.grow(slots) && stale.grow(slots) &&
         is_stale.grow(slots) && chosen.grow(slots) && left.grow(slots);
}

Key Scene::State::acquire(const BodyDefinition& body) noexcept {
  const Key key = keys.acquire(0, body.data);
  const std::size_t slots = keys.slot_count();
  if (key.id >= shape.size()) {
    shape.set_size(slots);
    pose.set_size(slots);
    motion.set_size(slots);
    place.set_size(slots);
    moved_at.set_size(slots);
    shaped_at.set_size(slots);
    is_stale.set_size(slots);
    is_stale[key.id] = 0;
    if (options.carry_over > 0.0) anchor.set_size(slots);
  }
  shape[key.id] = body.shape;
  pose[key.id] = body.pose;
  motion[key.id] = body.motion;
  place[key.id] = {};
  moved_at[key.id] = shaped_at[key.id] = clock;
  return key;
}

std::span<const std::uint32_t> Scene::State::choose(std::span<const Key> given,
                                                    Motion which) noexcept {
  chosen.clear();
  for (const Key& key : given) {
    if (motion[key.id] == which) (void)chosen.push_back(key.id);
  }
  return {chosen.data(), chosen.size()};
}

Status Scene::add(const BodyDefinition& body, Key& key) {
  return add({&body, 1}, {&key, 1});
}

Status Scene::add(std::span<const BodyDefinition> bodies, std::span<Key> keys) {
  State& s = *state_;
  if (!s.options_are_good) return Status::invalid_argument;
  if (bodies.size() != keys.size()) return Status::size_mismatch;
  if (bodies.size() + s.keys.size() > kMaxObjects) return Status::too_many_objects;
  for (const BodyDefinition& body : bodies) {
    if (!is_motion(body.motion)) return Status::invalid_argument;
    if (const Status good = s.check(body.shape, body.pose); good != Status::ok) return good;
  }
  if (!s.reserve(bodies.size())) return Status::out_of_memory;
  for (std::size_t i = 0; i < bodies.size(); ++i) keys[i] = s.acquire(bodies[i]);
  const Status status = s.settle(bodies, keys);
  if (status == Status::ok) return status;
  for (Key& key : keys) {
    if (s.place[key.id] != Key{}) {
      (void)s.displace(s.motion[key.id], {&s.place[key.id], 1});
    }
    s.keys.release(key.id);
    key = {};
  }
  return status;
}

// Places bodies that have just got their keys.
Status Scene::State::settle(std::span<const BodyDefinition> bodies, std::span<const Key> given) {
  for (const Motion which : kEveryMotion) {
    const Status status = place_bodies(which, choose(given, which));
    if (status != Status::ok) return status;
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].filter == ObjectFilter{}) continue;
    Partition& partition = *set(bodies[i].motion).partition;
    const Status status = partition.set_filter(place[given[i].id], bodies[i].filter);
    if (status != Status::ok) return status;
  }
  return Status::ok;
}

Status Scene::remove(Key key) {
  return remove({&key, 1});
}

Status Scene::remove(std::span<const Key> keys) {
  State& s = *state_;
  if (!s.are_distinct(keys)) return Status::invalid_key;
  if (!s.left.resize(keys.size())) return Status::out_of_memory;
  for (const Motion which : kEveryMotion) {
    std::size_t count = 0;
    for (const std::uint32_t body : s.choose(keys, which)) s.left[count++] = s.place[body];
    const Status status = s.displace(which, {s.left.data(), count});
    if (status != Status::ok) return status;
    for (const std::uint32_t body : s.chosen) s.keys.release(body);
  }
  ++s.regroupings;
  s.forget_stale();
  return Status::ok;
}

// Marks by the second bit of the flags; keys.size() <= slots is implied by being distinct.
bool Scene::State::are_distinct(std::span<const Key> given) noexcept {
  constexpr std::uint8_t kSeen = 2;
  std::size_t marked = 0;
  for (; marked < given.size(); ++marked) {
    const Key key = given[marked];
    if (!keys.is_valid(key) || (is_stale[key.id] & kSeen) != 0) break;
    is_stale[key.id] |= kSeen;
  }
  for (std::size_t i = 0; i < marked; ++i) {
    is_stale[given[i].id] = static_cast<std::uint8_t>(is_stale[given[i].id] & ~kSeen);
  }
  return marked == given.size();
}

// Takes removed bodies off the list.
void Scene::State::forget_stale() noexcept {
  std::size_t kept = 0;
  for (const std::uint32_t body : stale) {
    if (keys.is_live(body)) {
      stale[kept++] = body;
    } else {
      is_stale[body] = 0;
    }
  }
  stale.set_size(kept);
}

void Scene::clear() noexcept {
  State& s = *state_;
  for (SceneSet& set : s.sets) {
    if (set.partition == nullptr) continue;
    set.partition->clear();
    ++set.changes;
  }
  s.keys.clear();
  s.forget_stale();
  ++s.regroupings;
}

void Scene::State::mark_stale(std::uint32_t body) noexcept {
  if (is_stale[body] != 0) return;
  is_stale[body] = 1;
  stale[stale.size()] = body;
  stale.set_size(stale.size() + 1);
}

void Scene::State::set_pose(std::uint32_t body, const Pose& to) noexcept {
  pose[body] = to;
  moved_at[body] = clock;
  mark_stale(body);
}

Status Scene::move(Key key, const Pose& pose) {
  if (!state_->keys.is_valid(key)) return Status::invalid_key;
  if (!pose.is_valid()) return Status::invalid_pose;
  state_->set_pose(key.id, pose);
  return Status::ok;
}

Status Scene::move(std::span<const Key> keys, const PoseView& poses) {
  State& s = *state_;
  if (keys.size() != poses.count) return Status::size_mismatch;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (!s.keys.is_valid(keys[i])) return Status::invalid_key;
    if (!poses[i].is_valid()) return Status::invalid_pose;
  }
  for (std::size_t i = 0; i < keys.size(); ++i) s.set_pose(keys[i].id, poses[i]);
  return Status::ok;
}

Status Scene::set_motion(Key key, Motion motion) {
  return set_motion({&key, 1}, motion);
}

Status Scene::set_motion(std::span<const Key> keys, Motion motion) {
  State& s = *state_;
  if (!is_motion(motion)) return Status::invalid_argument;
  if (!s.are_distinct(keys)) return Status::invalid_key;
  for (const Motion from : kEveryMotion) {
    if (from == motion) continue;
    const Status status = s.move_to_set(from, motion, s.choose(keys, from));
    if (status != Status::ok) return status;
  }
  return Status::ok;
}

Status Scene::State::move_to_set(Motion from, Motion to, std::span<const std::uint32_t> bodies) {
  if (bodies.empty()) return Status::ok;
  if (!left.resize(bodies.size())) return Status::out_of_memory;
  for (std::size_t i = 0; i < bodies.size(); ++i) left[i] = place[bodies[i]];
  Status status = place_bodies(to, bodies);
  if (status != Status::ok) return status;
  for (std::size_t i = 0; i < bodies.size() && status == Status::ok; ++i) {
    ObjectFilter filter;
    status = set(from).partition->filter(left[i], filter);
    if (status == Status::ok && filter != ObjectFilter{}) {
      status = set(to).partition->set_filter(place[bodies[i]], filter);
    }
  }
  if (status == Status::ok) status = displace(from, {left.data(), bodies.size()});
  if (status != Status::ok) {
    (void)displace(to, {boxes_of.data(), bodies.size()});
    for (std::size_t i = 0; i < bodies.size(); ++i) place[bodies[i]] = left[i];
    return status;
  }
  for (const std::uint32_t body : bodies) motion[body] = to;
  ++regroupings;
  return Status::ok;
}

Status Scene::set_shape(Key key, ShapeId shape) {
  State& s = *state_;
  if (!s.keys.is_valid(key)) return Status::invalid_key;
  if (const Status good = s.check(shape, s.pose[key.id]); good != Status::ok) return good;
  s.shape[key.id] = shape;
  s.shaped_at[key.id] = s.clock;
  s.mark_stale(key.id);
  return Status::ok;
}

Status Scene::set_filter(Key key, const ObjectFilter& filter) {
  State& s = *state_;
  if (!s.keys.is_valid(key)) return Status::invalid_key;
  SceneSet& set = s.set(s.motion[key.id]);
  const Status status = set.partition->set_filter(s.place[key.id], filter);
  if (status == Status::ok) ++set.changes;
  return status;
}

std::size_t Scene::size() const noexcept {
  return state_->keys.size();
}

std::size_t Scene::size(Motion motion) const noexcept {
  if (!is_motion(motion)) return 0;
  const Partition* const partition = state_->set(motion).partition.get();
  return partition == nullptr ? 0 : partition->size();
}

bool Scene::contains(Key key) const noexcept {
  return state_->keys.is_valid(key);
}

Status Scene::body(Key key, BodyDefinition& body) const noexcept {
  const State& s = *state_;
  if (!s.keys.is_valid(key)) return Status::invalid_key;
  body.shape = s.shape[key.id];
  body.pose = s.pose[key.id];
  body.motion = s.motion[key.id];
  body.data = s.keys.client_data(key.id);
  return s.set(body.motion).partition->filter(s.place[key.id], body.filter);
}

Key Scene::key_of(ObjectId id) const noexcept {
  return state_->keys.key_of(id);
}

const Partition* Scene::partition(Motion motion) const noexcept {
  return is_motion(motion) ? state_->set(motion).partition.get() : nullptr;
}

Status Scene::debug_draw(DebugDraw& draw, const DebugDrawOptions& options) const {
  for (const SceneSet& set : state_->sets) {
    if (set.partition == nullptr) continue;
    const Status status = set.partition->debug_draw(draw, options);
    if (status != Status::ok) return status;
  }
  return Status::ok;
}

const SceneStatistics& Scene::statistics() const noexcept {
  return state_->statistics;
}

SceneFootprint Scene::footprint() const noexcept {
  const State& s = *state_;
  SceneFootprint footprint;
  footprint.bodies += s.keys.key_bytes();
  footprint.bodies += s.keys.client_data_bytes();
  for (const Bytes& bytes :
       {s.shape.bytes(), s.pose.bytes(), s.motion.bytes(), s.place.bytes(), s.moved_at.bytes(),
        s.shaped_at.bytes(), s.anchor.bytes(), s.stale.bytes(), s.is_stale.bytes(), s.boxes.bytes(),
        s.boxes_of.bytes(), s.boxes_body.bytes(), s.chosen.bytes(), s.left.bytes()}) {
    footprint.bodies += bytes;
  }
  for (std::size_t i = 0; i < kMotions; ++i) {
    const SceneSet& set = s.sets[i];
    if (set.partition != nullptr) footprint.partitions[i] += set.partition->footprint().total();
    footprint.partitions[i] += set.body_of.bytes();
    footprint.pairs += set.with_dynamic.footprint().total();
  }
  footprint.pairs += s.pairs.bytes();
  footprint.mid_phase += s.composite.bytes();
  footprint.mid_phase += s.parts.footprint().total();
  footprint.mid_phase += s.parts_narrow.footprint().total();
  footprint.mid_phase += s.parts_answers.footprint().total();
  footprint.mid_phase += s.parts_slot.bytes();
  footprint.narrow_phase += s.convex.bytes();
  footprint.narrow_phase += s.slot.bytes();
  footprint.narrow_phase += s.narrow.footprint().total();
  footprint.narrow_phase += s.answers.footprint().total();
  return footprint;
}

}  // namespace winnow
