// The public interface of Scene: checks arguments, calls SceneState (scene_state.cpp), and passes
// successful calls to the observer. Other
// members of Scene are in collide.cpp, pair_rules.cpp, contact_offsets.cpp, contact_groups.cpp,
// reserve.cpp, scene_snapshot.cpp and contacts_snapshot.cpp.

#include <winnow/pipeline/scene.h>

#include <winnow/pipeline/recording.h>
#include "core/hooks/log.h"
#include "core/memory/new_in.h"
#include "core/threads/float_environment.h"
#include "pipeline/scene/scene_observer.h"
#include "pipeline/scene/scene_state.h"

#include <algorithm>

namespace winnow {
namespace {

[[nodiscard]] bool is_body_state(BodyState state) noexcept {
  return state <= BodyState::sleeping;
}

/// Converts what a partition draws to world coordinates, by adding the origin of its boxes.
class InTheWorld final : public DebugDraw {
 public:
  InTheWorld(DebugDraw& draw, const Vec3d& origin) noexcept
      : draw_(draw), origin_(origin.cast<float>()) {}

  void box(const Aabb& box, Colour colour) override {
    draw_.box({box.min + origin_, box.max + origin_}, colour);
  }
  void line(const Vec3f& from, const Vec3f& to, Colour colour) override {
    draw_.line(from + origin_, to + origin_, colour);
  }
  void sphere(const Sphere& sphere, Colour colour) override {
    draw_.sphere({sphere.center + origin_, sphere.radius}, colour);
  }
  void text(const Vec3f& at, std::string_view text, Colour colour) override {
    draw_.text(at + origin_, text, colour);
  }

 private:
  DebugDraw& draw_;
  Vec3f origin_;
};

}  // namespace

Bytes SceneFootprint::total() const noexcept {
  Bytes sum;
  for (const Bytes* part : {&bodies, &partitions[0], &partitions[1], &partitions[2], &pairs,
                            &mid_phase, &narrow_phase}) {
    sum += *part;
  }
  return sum;
}

Bytes PartAnswers::bytes() const noexcept {
  Bytes sum{sizeof *this, sizeof *this};
  for (const Bytes& part :
       {pairs.footprint().total(), gaps.bytes(), narrow.footprint().total(),
        answers.footprint().total(), slot.bytes(), regions.footprint().total()}) {
    sum += part;
  }
  return sum;
}

Scene::Scene(const ShapePool& shapes, const SceneOptions& options) noexcept
    : state_(new_in<SceneState>(options.memory, shapes, options)) {
  if (state_ != nullptr && options.recorder != nullptr)
    state_->observer = options.recorder->observe_scene(*state_);
}

Scene::~Scene() {
  if (state_ == nullptr) return;
  if (state_->observer != nullptr) state_->observer->end();
  delete_in(state_->options.memory, state_);
}

Answer<Key> Scene::add(const BodyDefinition& body) {
  Key key;
  const Status status = add({&body, 1}, {&key, 1});
  if (status != Status::ok) return status;
  return key;
}

Status Scene::add(std::span<const BodyDefinition> bodies, std::span<Key> keys) {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return logged(Status::out_of_memory, "Scene::add");
  SceneState& s = *state_;
  if (!s.options_are_good) return logged(Status::invalid_argument, "Scene::add");
  if (bodies.size() != keys.size()) return logged(Status::size_mismatch, "Scene::add");
  if (bodies.size() + s.keys.slot_count() >= kMaxBodies)
    return logged(Status::too_many_objects, "Scene::add");
  bool with_offsets = false;
  bool with_layers = false;
  for (const BodyDefinition& body : bodies) {
    if (!is_body_state(body.state) || !are_good(body.offsets) || body.layer >= kSceneLayers)
      return logged(Status::invalid_argument, "Scene::add");
    with_offsets = with_offsets || body.offsets != ContactOffsets{};
    with_layers = with_layers || body.layer != 0;
    if (const Status good = s.check(body.shape, body.pose); good != Status::ok)
      return logged(good, "Scene::add");
  }
  if (!s.reserve(bodies.size()) ||
      (with_offsets && !s.offsets.begin(s.shape.size(), s.shape.capacity())) ||
      (with_layers && !s.rules.begin_layers(s.shape.size(), s.shape.capacity())))
    return logged(Status::out_of_memory, "Scene::add");
  const bool is_first = s.keys.size() == 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) keys[i] = s.acquire(bodies[i]);
  if (is_first) s.choose_origin();
  const Status status = s.settle(bodies, keys);
  if (status == Status::ok) {
    if (s.observer != nullptr) s.observer->add(bodies, keys);
    return status;
  }
  // In reverse, so that the next bodies get the same ids.
  for (std::size_t i = keys.size(); i-- > 0;) {
    s.keys.release(keys[i].id);
    keys[i] = {};
  }
  return logged(status, "Scene::add");
}

Status Scene::remove(Key key) {
  return remove({&key, 1});
}

Status Scene::remove(std::span<const Key> keys) {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return logged(Status::out_of_memory, "Scene::remove");
  SceneState& s = *state_;
  if (!s.stale.are_distinct(s.keys, keys)) return logged(Status::invalid_key, "Scene::remove");
  for (const BodyState which : kAllBodyStates) s.take_out(keys, which);
  ++s.regroupings;
  s.stale.forget_removed(s.keys);
  s.rules.forget_ignored(keys, s.keys);
  if (s.observer != nullptr) s.observer->remove(keys);
  return Status::ok;
}

void Scene::clear() noexcept {
  if (state_ == nullptr) return;
  SceneState& s = *state_;
  for (SceneSet& set : s.sets) {
    if (!set.partition.has_value()) continue;
    set.partition->clear();
    ++set.changes;
  }
  s.keys.clear();
  s.offsets.column.clear();
  s.offsets.any = false;
  s.stale.forget_removed(s.keys);
  s.rules.forget_bodies();
  ++s.regroupings;
  if (s.observer != nullptr) s.observer->clear();
}

Status Scene::move(Key key, const Pose& pose) {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return logged(Status::out_of_memory, "Scene::move");
  if (!state_->keys.is_valid(key)) return logged(Status::invalid_key, "Scene::move");
  if (!pose.is_valid()) return logged(Status::invalid_pose, "Scene::move");
  state_->set_pose(key.id, pose);
  if (state_->observer != nullptr)
    state_->observer->move({&key, 1}, PoseView(std::span<const Pose>(&pose, 1)));
  return Status::ok;
}

Status Scene::move(std::span<const Key> keys, const PoseView& poses) {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return logged(Status::out_of_memory, "Scene::move");
  SceneState& s = *state_;
  if (keys.size() != poses.count) return logged(Status::size_mismatch, "Scene::move");
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (!s.keys.is_valid(keys[i])) return logged(Status::invalid_key, "Scene::move");
    if (!poses[i].is_valid()) return logged(Status::invalid_pose, "Scene::move");
  }
  for (std::size_t i = 0; i < keys.size(); ++i) {
    Pose to = poses[i];
    if (!poses.has_orientations()) {
      to.orientation = s.pose[keys[i].id].orientation;
    }
    s.set_pose(keys[i].id, to);
  }
  if (s.observer != nullptr) s.observer->move(keys, poses);
  return Status::ok;
}

Status Scene::set_body_state(Key key, BodyState state) {
  return set_body_state({&key, 1}, state);
}

Status Scene::set_body_state(std::span<const Key> keys, BodyState state) {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return logged(Status::out_of_memory, "Scene::set_body_state");
  SceneState& s = *state_;
  if (!is_body_state(state)) return logged(Status::invalid_argument, "Scene::set_body_state");
  if (!s.stale.are_distinct(s.keys, keys))
    return logged(Status::invalid_key, "Scene::set_body_state");
  const Status status = s.move_to_set(keys, state);
  if (is_observed(status, state_)) s.observer->set_body_state(keys, state);
  return logged(status, "Scene::set_body_state");
}

Status Scene::set_shape(Key key, ShapeId shape) {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return logged(Status::out_of_memory, "Scene::set_shape");
  SceneState& s = *state_;
  if (!s.keys.is_valid(key)) return logged(Status::invalid_key, "Scene::set_shape");
  if (const Status good = s.check(shape, s.pose[key.id]); good != Status::ok)
    return logged(good, "Scene::set_shape");
  s.shape[key.id] = shape;
  s.shaped_at[key.id] = s.clock;
  s.stale.mark(key.id);
  if (s.observer != nullptr) s.observer->set_shape(key, shape);
  return Status::ok;
}

Status Scene::set_filter(Key key, const ObjectFilter& filter) {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return logged(Status::out_of_memory, "Scene::set_filter");
  SceneState& s = *state_;
  if (!s.keys.is_valid(key)) return logged(Status::invalid_key, "Scene::set_filter");
  SceneSet& set = s.set(s.body_state[key.id]);
  const Status status = set.partition->set_filter(s.place[key.id], filter);
  if (status == Status::ok) ++set.changes;
  if (is_observed(status, state_)) s.observer->set_filter(key, filter);
  return logged(status, "Scene::set_filter");
}

std::size_t Scene::size() const noexcept {
  return state_ != nullptr ? state_->keys.size() : 0;
}

std::size_t Scene::size(BodyState state) const noexcept {
  const Partition* const held = partition(state);
  return held == nullptr ? 0 : held->size();
}

bool Scene::contains(Key key) const noexcept {
  return state_ != nullptr && state_->keys.is_valid(key);
}

Answer<BodyDefinition> Scene::body(Key key) const noexcept {
  if (state_ == nullptr) return Status::out_of_memory;
  const SceneState& s = *state_;
  if (!s.keys.is_valid(key)) return Status::invalid_key;
  BodyDefinition body;
  body.shape = s.shape[key.id];
  body.pose = s.pose[key.id];
  body.state = s.body_state[key.id];
  body.data = s.keys.client_data(key.id);
  body.offsets = s.offsets.of(key.id);
  body.layer = s.rules.layer_of(key.id);
  body.filter = s.set(body.state).partition->filter(s.place[key.id]);
  return body;
}

Key Scene::key_of(ObjectId id) const noexcept {
  return state_ != nullptr ? state_->keys.key_of(id) : Key{};
}

Status Scene::refresh() {
  const DefaultFloatEnvironment environment;
  const Status status = state_ != nullptr ? state_->refresh() : Status::out_of_memory;
  if (is_observed(status, state_)) state_->observer->refresh();
  return logged(status, "Scene::refresh");
}

const Partition* Scene::partition(BodyState state) const noexcept {
  if (state_ == nullptr || !is_body_state(state)) return nullptr;
  const SceneSet& set = state_->set(state);
  return set.partition.has_value() ? &*set.partition : nullptr;
}

Vec3d Scene::origin() const noexcept {
  if (state_ == nullptr) return {};
  return state_->origin;
}

Status Scene::debug_draw(DebugDraw& draw, const DebugDrawOptions& options) const noexcept {
  const DefaultFloatEnvironment environment;
  if (state_ == nullptr) return Status::out_of_memory;
  for (const SceneSet& set : state_->sets) {
    if (!set.partition.has_value()) continue;
    InTheWorld drawn(draw, set.origin);
    const Status status = set.partition->debug_draw(drawn, options);
    if (status != Status::ok) return status;
  }
  return Status::ok;
}

const SceneStatistics& Scene::statistics() const noexcept {
  static const SceneStatistics kNothing;
  return state_ != nullptr ? state_->statistics : kNothing;
}

SceneFootprint Scene::footprint() const noexcept {
  SceneFootprint footprint;
  if (state_ == nullptr) return footprint;
  const SceneState& s = *state_;
  footprint.bodies = {sizeof(SceneState), sizeof(SceneState)};
  footprint.bodies += s.keys.key_bytes();
  footprint.bodies += s.keys.client_data_bytes();
  for (const Bytes& bytes :
       {s.shape.bytes(), s.pose.bytes(), s.body_state.bytes(), s.place.bytes(), s.moved_at.bytes(),
        s.shaped_at.bytes(), s.anchor.bytes(), s.ball.bytes(), s.offsets.column.bytes(),
        s.stale.bodies.bytes(), s.stale.flag.bytes(), s.rules.bytes()}) {
    footprint.bodies += bytes;
  }
  footprint.bodies += s.staged.bytes();
  for (std::size_t i = 0; i < kBodyStates; ++i) {
    const SceneSet& set = s.sets[i];
    if (set.partition.has_value()) footprint.partitions[i] += set.partition->footprint().total();
    footprint.partitions[i] += set.body_of.bytes();
    footprint.pairs += set.with_dynamic.footprint().total();
  }
  footprint.pairs += s.pairs.bytes();
  footprint.mid_phase += s.batch.composite.bytes();
  footprint.mid_phase += s.batch.gaps.bytes();
  if (s.batch.parts != nullptr) footprint.mid_phase += s.batch.parts->bytes();
  footprint.narrow_phase += s.batch.convex.bytes();
  footprint.narrow_phase += s.batch.floor_contacts.bytes();
  footprint.narrow_phase += s.batch.floor_order.bytes();
  footprint.narrow_phase += s.batch.narrow.footprint().total();
  footprint.narrow_phase += s.batch.answers.footprint().total();
  return footprint;
}

}  // namespace winnow
