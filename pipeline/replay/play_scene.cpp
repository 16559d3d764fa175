// Plays calls of scenes: shapes, bodies, contacts and snapshots.

#include "pipeline/kinds/with_shape.h"
#include "pipeline/narrow/tier_number.h"
#include "pipeline/recording/composite_bytes.h"
#include "pipeline/recording/contact_digest.h"
#include "pipeline/replay/replay_state.h"
#include "pipeline/scene/scene_state.h"
#include "pipeline/shapes/hull_bytes.h"

#include <algorithm>
#include <type_traits>

namespace winnow {
namespace {

/// Reads a shape struct and adds it to the pool. The digest is of the shape in the pool.
template <typename Shape>
Answer<ShapeId> add_plain(ByteReader& in, ShapePool& pool, Digest& digest) {
  Shape shape{};
  if (!in.get_bytes(&shape, sizeof shape)) return Status::invalid_argument;
  const Answer<ShapeId> id = pool.add(shape);
  if (id.status == Status::ok) {
    digest.add(std::as_bytes(std::span(KindOf<Shape>::in(pool.tables()) + id.index(), 1)));
  }
  return id;
}

/// Increments the revision of the pool without changing its shapes.
Status change_composites(CompositePool& pool) {
  constexpr float kHeights[4] = {};
  const Answer<ShapeId> passing =
      pool.add_height_field({.heights = kHeights, .columns = 2, .rows = 2});
  return passing.status == Status::ok ? pool.remove(passing) : passing.status;
}

BodyState body_state_of(std::uint32_t number, ByteReader& in) noexcept {
  if (number >= kBodyStates) in.fail();
  return number < kBodyStates ? static_cast<BodyState>(number) : BodyState::fixed;
}

Answer<ShapeId> add_hull(ReplayState& replay, ReplayedWorld& of, Digest& digest) {
  ReadHull hull(replay.options.memory);
  hull.read(replay.in);
  if (!replay.in.ok()) return status_of(replay.in);
  const Answer<ShapeId> id = of.shapes->add_built_hull(hull.points(), hull.faces(), hull.rounding);
  if (id.status == Status::ok) add_to(digest, of.shapes->tables().hulls[id.index()]);
  return id;
}

/// If the shape in the pool differs from the recorded one, this counts as a difference.
Status add_shape(ReplayState& replay, ReplayedWorld& of) {
  Digest digest;
  const auto kind = replay.in.get_enum(kLastConvexKind);
  if (!replay.in.ok()) return status_of(replay.in);
  if (ShapeId::of(kind, 0).is_composite()) return Status::invalid_argument;
  const Answer<ShapeId> id = with_kind(kind, [&](auto its) -> Answer<ShapeId> {
    using Shape = typename decltype(its)::Shape;
    if constexpr (std::is_same_v<Shape, HullShape>) {
      return add_hull(replay, of, digest);
    } else if constexpr (std::is_same_v<Shape, SupportShape>) {
      return Status::invalid_argument;
    } else {
      return add_plain<Shape>(replay.in, *of.shapes, digest);
    }
  });
  if (id.status != Status::ok) return id.status;
  if (!of.shape_ids.push_back(id)) return Status::out_of_memory;
  return replay.compare(digest);
}

Status add_composite(ReplayState& replay, ReplayedWorld& of) {
  const auto kind = replay.in.get<std::uint8_t>();
  const std::span<const std::byte> saved = replay.in.get_nested();
  Vec3d scale{};
  (void)replay.in.get_bytes(scale.data(), sizeof scale);
  const auto count = replay.in.get<std::uint64_t>();
  if (!replay.in.ok() || count > replay.in.rest().size() / sizeof(Pose))
    return Status::invalid_argument;
  Column<CompoundChild> children(replay.options.memory);
  if (!children.resize(static_cast<std::size_t>(count))) return Status::out_of_memory;
  for (CompoundChild& child : children) {
    child = {};
    const auto number = replay.in.get<std::uint32_t>();
    if (number >= of.shape_ids.size()) return Status::invalid_argument;
    child.shape = of.shape_ids[number];
    (void)replay.in.get_bytes(&child.pose, sizeof child.pose);
  }
  if (!replay.in.ok()) return status_of(replay.in);
  Answer<ShapeId> id = Status::invalid_argument;
  if (kind == static_cast<std::uint8_t>(CompositeKind::mesh)) {
    id = of.composites->add_saved_mesh(saved, scale, replay.options.execution);
  } else if (kind == static_cast<std::uint8_t>(CompositeKind::height_field)) {
    id = of.composites->add_saved_height_field(saved);
  } else if (kind == static_cast<std::uint8_t>(CompositeKind::compound)) {
    id = of.composites->add_compound({children.data(), children.size()});
  }
  if (id.status != Status::ok) return id.status;
  if (!of.shape_ids.push_back(id)) return Status::out_of_memory;
  return replay.compare(digests_of(*of.composites, id).all);
}

Status change_composite(ReplayState& replay, ReplayedWorld& of) {
  const auto number = replay.in.get<std::uint32_t>();
  if (!replay.in.get_array(replay.floats)) return status_of(replay.in);
  if (number >= of.shape_ids.size()) return Status::invalid_argument;
  const ShapeId id = of.shape_ids[number];
  const float* const at = replay.floats.data();
  Status taken = Status::invalid_argument;
  if (const HeightField* const field = of.composites->height_field(id)) {
    taken = of.composites->update_height_field(id, 0, 0,
                                               {.heights = {at, replay.floats.size()},
                                                .columns = field->columns(),
                                                .rows = field->rows()});
  } else if (of.composites->mesh(id) != nullptr && replay.floats.size() % 3 == 0 && at != nullptr) {
    taken = of.composites->refit_mesh(
        id, PointView({at, at + 1, at + 2}, replay.floats.size() / 3, 3 * sizeof(float)),
        replay.options.execution);
  }
  return taken == Status::ok ? replay.compare(digests_of(*of.composites, id).all) : taken;
}

Status add_bodies(ReplayState& replay, ReplayedWorld& of) {
  if (!replay.in.get_array(replay.recorded_bodies)) return status_of(replay.in);
  if (!replay.bodies.resize(replay.recorded_bodies.size()) ||
      !replay.keys.resize(replay.recorded_bodies.size())) {
    return Status::out_of_memory;
  }
  for (std::size_t i = 0; i < replay.bodies.size(); ++i) {
    const RecordedBody& one = replay.recorded_bodies[i];
    if (one.shape >= of.shape_ids.size()) return Status::invalid_argument;
    BodyDefinition body;
    body.shape = of.shape_ids[one.shape];
    body.state = body_state_of(one.state, replay.in);
    body.pose = {Vec3d(one.pose), {one.pose[3], one.pose[4], one.pose[5], one.pose[6]}};
    body.filter = {one.filter[0], one.filter[1], one.filter[2]};
    body.data = one.data;
    replay.bodies[i] = body;
  }
  if (!replay.in.ok()) return status_of(replay.in);
  return of.scene->add({replay.bodies.data(), replay.bodies.size()},
                       std::span<Key>(replay.keys.data(), replay.keys.size()));
}

Status move(ReplayState& replay, ReplayedWorld& of) {
  PoseView given;
  if (!replay.read_keys(*of.scene) || !replay.read_poses(replay.keys.size(), given))
    return status_of(replay.in);
  return of.scene->move(std::span<const Key>(replay.keys.data(), replay.keys.size()), given);
}

/// Loads a snapshot of the recorded scene, with shape ids translated to this process.
Status load_scene(ReplayState& replay, ReplayedWorld& of) {
  const std::span<const std::byte> saved = replay.in.get_nested();
  Column<RecordedName> recorded(replay.options.memory);
  Column<SavedNames::Name> names(replay.options.memory);
  if (!replay.in.get_array(recorded) || !replay.in.get_array(replay.ids))
    return status_of(replay.in);
  if (!names.resize(recorded.size())) return Status::out_of_memory;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (recorded[i].number >= of.shape_ids.size()) return Status::invalid_argument;
    names[i] = {ShapeId{recorded[i].bits}, of.shape_ids[recorded[i].number]};
  }
  std::sort(names.begin(), names.end(), [](const SavedNames::Name& a, const SavedNames::Name& b) {
    return a.saved.bits < b.saved.bits;
  });
  SceneState* const scene = ReplayState::state_of(*of.scene);
  if (scene == nullptr) return Status::out_of_memory;
  const SavedNames all{{names.data(), names.size()}, {replay.ids.data(), replay.ids.size()}};
  return winnow::load_scene(*scene, saved, &all);
}

Status pairs_passed(ReplayState& replay, ReplayedWorld& of) {
  if (!replay.in.get_array(of.passed)) return status_of(replay.in);
  std::sort(of.passed.begin(), of.passed.end());
  return Status::ok;
}

Status collide(ReplayState& replay, ReplayedWorld& of) {
  const auto level = replay.in.get_enum(ContactLevel::manifold);
  const bool continues = replay.in.get_bool();
  if (!replay.in.ok()) return status_of(replay.in);
  if (!continues) of.contacts.clear();
  return replay.compare_if(of.scene->collide(level, of.contacts), of.contacts);
}

}  // namespace

Status make_scene(ReplayState& replay, ReplayedWorld& of) {
  SceneOptions made;
  made.memory = replay.options.memory;
  made.execution = replay.options.execution;
  for (StructureKind& structure : made.structures) structure = read_structure(replay.in);
  made.contact_margin = replay.in.get<double>();
  made.tier = read_tier(replay.in);
  made.cache_tolerance = replay.in.get<double>();
  made.part_manifolds = !replay.in.get_bool();
  made.warm_start = replay.in.get_bool();
  made.build_budget = static_cast<std::size_t>(replay.in.get<std::uint64_t>());
  if (!replay.in.ok()) return status_of(replay.in);
  of.shapes.emplace(replay.options.memory);
  of.composites.emplace(*of.shapes, replay.options.memory);
  made.composites = &*of.composites;
  of.scene.emplace(*of.shapes, made);
  return Status::ok;
}

Status change_scene(ReplayState& replay, RecordedCall call, ReplayedWorld& of) {
  Scene& scene = *of.scene;
  const auto all_keys = [&] {
    return std::span<const Key>(replay.keys.data(), replay.keys.size());
  };
  switch (call) {
    case RecordedCall::add_shape:
      return add_shape(replay, of);
    case RecordedCall::add_bodies:
      return add_bodies(replay, of);
    case RecordedCall::remove_bodies:
      return replay.read_keys(scene) ? scene.remove(all_keys()) : status_of(replay.in);
    case RecordedCall::clear_bodies:
      scene.clear();
      return Status::ok;
    case RecordedCall::move:
      return move(replay, of);
    case RecordedCall::set_body_state: {
      if (!replay.read_keys(scene)) return status_of(replay.in);
      const auto state = replay.in.get_enum(BodyState::sleeping);
      return replay.in.ok() ? scene.set_body_state(all_keys(), state) : status_of(replay.in);
    }
    case RecordedCall::set_shape: {
      const Key key = scene.key_of(replay.in.get<ObjectId>());
      const auto number = replay.in.get<std::uint32_t>();
      if (!replay.in.ok() || number >= of.shape_ids.size()) return Status::invalid_argument;
      return scene.set_shape(key, of.shape_ids[number]);
    }
    case RecordedCall::set_body_filter: {
      const Key key = scene.key_of(replay.in.get<ObjectId>());
      ObjectFilter given;
      if (!replay.in.get_bytes(&given, sizeof given)) return Status::invalid_argument;
      return scene.set_filter(key, given);
    }
    case RecordedCall::set_offsets: {
      const Key key = scene.key_of(replay.in.get<ObjectId>());
      ContactOffsets given;
      given.contact = replay.in.get<double>();
      given.rest = replay.in.get<double>();
      return replay.in.ok() ? scene.set_offsets(key, given) : status_of(replay.in);
    }
    case RecordedCall::set_layer: {
      const Key key = scene.key_of(replay.in.get<ObjectId>());
      const auto layer = replay.in.get<std::uint16_t>();
      return replay.in.ok() ? scene.set_layer(key, layer) : status_of(replay.in);
    }
    case RecordedCall::set_layers_collide: {
      const auto a = replay.in.get<std::uint16_t>();
      const auto b = replay.in.get<std::uint16_t>();
      const bool collide = replay.in.get_bool();
      return replay.in.ok() ? scene.set_layers_collide(a, b, collide) : status_of(replay.in);
    }
    case RecordedCall::set_ignored: {
      const bool ignored = replay.in.get_bool();
      Column<RecordedPair> pairs(replay.options.memory);
      if (!replay.in.get_array(pairs)) return status_of(replay.in);
      if (!replay.key_pairs.resize(pairs.size())) return Status::out_of_memory;
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        replay.key_pairs[i] = {scene.key_of(pairs[i].first), scene.key_of(pairs[i].second)};
      }
      return scene.set_ignored(
          std::span<const KeyPair>(replay.key_pairs.data(), replay.key_pairs.size()), ignored);
    }
    case RecordedCall::refresh_scene:
      return scene.refresh();
    case RecordedCall::add_composite:
      return add_composite(replay, of);
    case RecordedCall::change_composite:
      return change_composite(replay, of);
    case RecordedCall::set_predicate: {
      const bool has_predicate = replay.in.get_bool();
      if (!replay.in.ok()) return status_of(replay.in);
      scene.set_predicate(has_predicate ? among<lower_first>(of.passed) : PairPredicate{});
      return Status::ok;
    }
    case RecordedCall::pairs_passed:
      return pairs_passed(replay, of);
    case RecordedCall::composites_changed:
      return change_composites(*of.composites);
    case RecordedCall::load_scene:
      return load_scene(replay, of);
    case RecordedCall::load_contacts: {
      const std::span<const std::byte> saved = replay.in.get_nested();
      return replay.in.ok() ? scene.load_contacts(saved, of.contacts) : status_of(replay.in);
    }
    default:
      return collide(replay, of);
  }
}

}  // namespace winnow
