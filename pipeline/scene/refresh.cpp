// Boxes and partitions follow what moved, and partitions tell which bodies may meet.

#include "pipeline/scene/motion_bound.h"
#include "pipeline/scene/scene_state.h"

#include <algorithm>

namespace winnow {
namespace {

constexpr std::size_t kBodiesPerTask = 256;

}  // namespace

Status Scene::refresh() {
  return state_->refresh();
}

// False if the box that the partition has still holds the body, its growth included.
bool Scene::State::needs_box(std::uint32_t body) const noexcept {
  if (anchor.empty() || shaped_at[body] >= moved_at[body]) return true;
  const ShapeId id = shape[body];
  const double radius =
      id.is_composite() ? options.composites->radius(id) : shape_radius(shapes.tables(), id);
  // The comparison is false for NaN too.
  return !(motion_bound(anchor[body], with_unit_turn(pose[body]), radius) <= options.carry_over);
}

Status Scene::State::refresh() {
  if (options.composites != nullptr && options.composites->revision() != composites_seen) {
    composites_seen = options.composites->revision();
    for (std::uint32_t body = 0; body < shape.size(); ++body) {
      if (!keys.is_live(body) || !shape[body].is_composite()) continue;
      shaped_at[body] = clock;
      mark_stale(body);
    }
  }
  if (stale.empty()) return Status::ok;
  for (std::size_t which = 0; which < kMotions; ++which) {
    const Status status = refresh_set(static_cast<Motion>(which));
    if (status != Status::ok) return status;
  }
  for (const std::uint32_t body : stale) is_stale[body] = 0;
  stale.clear();
  return Status::ok;
}

Status Scene::State::refresh_set(Motion which) {
  SceneSet& target = set(which);
  if (!target.partition.has_value()) return Status::ok;
  chosen.clear();
  for (const std::uint32_t body : stale) {
    if (motion[body] != which || !needs_box(body)) continue;
    chosen[chosen.size()] = body;
    chosen.set_size(chosen.size() + 1);
  }
  const std::size_t count = chosen.size();
  if (count == 0) return Status::ok;
  if (!boxes.resize(count) || !boxes_of.resize(count)) return Status::out_of_memory;
  options.execution.for_each((count + kBodiesPerTask - 1) / kBodiesPerTask, [&](std::size_t task) {
    const std::size_t end = std::min(count, (task + 1) * kBodiesPerTask);
    for (std::size_t i = task * kBodiesPerTask; i < end; ++i) {
      boxes[i] = grown_bounds(chosen[i]);
      boxes_of[i] = place[chosen[i]];
    }
  });
  const Status status = target.partition->update({boxes_of.data(), count}, box_view());
  if (status != Status::ok) return status;
  if (!anchor.empty()) {
    for (const std::uint32_t body : chosen) anchor[body] = with_unit_turn(pose[body]);
  }
  boxes_updated += count;
  ++target.changes;
  return Status::ok;
}

// Dynamic bodies among themselves, then with each other set. Asked only if something changed.
Status Scene::State::find_pairs() {
  if (const Status status = refresh(); status != Status::ok) return status;
  bool changed = false;
  for (std::size_t i = 0; i < kMotions; ++i) {
    changed = changed || pairs.changes[i] != sets[i].changes;
  }
  if (!changed) return Status::ok;
  const SceneSet& dynamic = set(Motion::dynamic);
  BodyPairs::Source sources[kMotions];
  std::size_t count = 0;
  for (SceneSet& other : sets) {
    if (!dynamic.partition.has_value() || !other.partition.has_value()) continue;
    const Status status = &other == &dynamic
                              ? dynamic.partition->self_pairs(other.with_dynamic)
                              : dynamic.partition->pairs_with(*other.partition, other.with_dynamic);
    if (status != Status::ok) return status;
    sources[count++] = {other.with_dynamic.pairs(), dynamic.body_of.data(), other.body_of.data()};
  }
  const Status status =
      pairs.assign({sources, count}, shape.data(), keys.slot_count(), options.execution);
  if (status != Status::ok) return status;
  for (std::size_t i = 0; i < kMotions; ++i) pairs.changes[i] = sets[i].changes;
  return Status::ok;
}

}  // namespace winnow
