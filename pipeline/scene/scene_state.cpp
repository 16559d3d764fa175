#include "pipeline/scene/scene_state.h"
#include "pipeline/scene/motion_bound.h"

#include <algorithm>
#include <utility>

namespace winnow {

Status Scene::State::check(ShapeId id, const Pose& at) const noexcept {
  const bool known = id.is_composite()
                         ? options.composites != nullptr && options.composites->contains(id)
                         : shapes.contains(id);
  if (!known) return Status::invalid_key;
  return at.is_valid() ? Status::ok : Status::invalid_pose;
}

Status Scene::State::make_partition_of(Motion which) {
  SceneSet& target = set(which);
  if (target.partition.has_value()) return Status::ok;
  Partition made(options.structures[static_cast<std::size_t>(which)],
                 {.memory = options.memory, .execution = options.execution});
  const Status status = made.status();
  if (status == Status::ok) target.partition.emplace(std::move(made));
  return status;
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

}  // namespace winnow
