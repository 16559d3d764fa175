#include "pipeline/cluster/rank_members.h"

#include "pipeline/scene/scene_state.h"

namespace winnow {

RankMembers::RankMembers(const ShapePool& shapes, const SceneOptions& options)
    : scene_(shapes, options), table_(options.memory) {}

bool RankMembers::is_good() const noexcept {
  return state().options_are_good;
}

Status RankMembers::find_keys(std::span<const BodyName> names, std::uint8_t flag,
                              std::vector<Key>& keys) const {
  keys.clear();
  for (const BodyName name : names) {
    const std::uint32_t id = table_.find(name);
    if (id == NameTable::kNone || (flags_[id] & flag) == 0) return Status::invalid_key;
    keys.push_back(state().keys.key_of(id));
  }
  return has_twice(std::vector<BodyName>(names.begin(), names.end())) ? Status::invalid_key
                                                                      : Status::ok;
}

Status RankMembers::key_of(BodyName name, Key& key) const noexcept {
  const std::uint32_t id = table_.find(name);
  if (id == NameTable::kNone || (flags_[id] & kOwned) == 0) return Status::invalid_key;
  key = state().keys.key_of(id);
  return Status::ok;
}

Status RankMembers::bodies(std::span<ClusterBody> bodies) const {
  if (bodies.size() != size()) return Status::size_mismatch;
  std::size_t count = 0;
  for (ObjectId id = 0; id < flags_.size(); ++id) {
    const Key key = state().keys.key_of(id);
    if (is_owned(key)) bodies[count++] = {names_[id], key};
  }
  return Status::ok;
}

void RankMembers::records(std::vector<BodyName>& names, std::vector<BodyRecord>& bodies) const {
  for (ObjectId id = 0; id < flags_.size(); ++id) {
    if (!is_owned(state().keys.key_of(id))) continue;
    names.push_back(names_[id]);
    bodies.push_back(record_of(id));
  }
}

Aabb RankMembers::box_of(ObjectId id) const noexcept {
  return state().set(state().body_state[id]).partition->bounds(state().place[id]);
}

BodyRecord RankMembers::record_of(ObjectId id) const noexcept {
  BodyRecord record{state().pose[id], state().shape[id], {}, state().body_state[id]};
  record.filter = state().set(record.state).partition->filter(state().place[id]);
  record.is_new = (flags_[id] & kNew) != 0 ? 1 : 0;
  return record;
}

Status RankMembers::check_shape(ShapeId shape, const Pose& pose) const noexcept {
  return state().check(shape, pose);
}

Aabb RankMembers::box_around(ShapeId shape, const Pose& pose) const noexcept {
  const PlainBox box = state().bounds_from(state().origin, shape, pose, 0.0);
  return {{box.min[0], box.min[1], box.min[2]}, {box.max[0], box.max[1], box.max[2]}};
}

}  // namespace winnow
