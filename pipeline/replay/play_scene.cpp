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
Status add_plain(ByteReader& in, ShapePool& pool, ShapeId& id, Digest& digest) {
  Shape shape{};
  if (!in.get_bytes(&shape, sizeof shape)) return Status::invalid_argument;
  const Status status = pool.add(shape, id);
  if (status != Status::ok) return status;
  digest.add(std::as_bytes(std::span(KindOf<Shape>::in(pool.tables()) + id.index(), 1)));
  return status;
}

/// Increments the revision of the pool without changing its shapes.
Status change_composites(CompositePool& pool) {
  constexpr float kHeights[4] = {};
  ShapeId passing;
  const Status added =
      pool.add_height_field({.heights = kHeights, .columns = 2, .rows = 2}, passing);
  return added == Status::ok ? pool.remove(passing) : added;
}

BodyState body_state_of(std::uint32_t number, ByteReader& in) noexcept {
  if (number >= kBodyStates) in.fail();
  return number < kBodyStates ? static_cast<BodyState>(number) : BodyState::fixed;
}

}  // namespace

Status ReplayState::make_scene(ReplayedWorld& of) {
  SceneOptions made;
  made.memory = options.memory;
  made.execution = options.execution;
  for (StructureKind& structure : made.structures) structure = read_structure(in);
  made.contact_margin = in.get<double>();
  made.tier = read_tier(in);
  made.cache_tolerance = in.get<double>();
  made.contact_reduction = in.get_bool();
  made.warm_start = in.get_bool();
  made.build_budget = static_cast<std::size_t>(in.get<std::uint64_t>());
  if (!in.ok()) return reading();
  of.shapes.emplace(options.memory);
  of.composites.emplace(*of.shapes, options.memory);
  made.composites = &*of.composites;
  of.scene.emplace(*of.shapes, made);
  return Status::ok;
}

bool ReplayState::read_keys(const Scene& of) {
  if (!in.get_array(ids)) return false;
  if (!keys.resize(ids.size())) return in.refuse_memory();
  for (std::size_t i = 0; i < ids.size(); ++i) keys[i] = of.key_of(ids[i]);
  return true;
}

Status ReplayState::change_scene(RecordedCall call, ReplayedWorld& of) {
  Scene& scene = *of.scene;
  const auto all_keys = [&] { return std::span<const Key>(keys.data(), keys.size()); };
  switch (call) {
    case RecordedCall::add_shape:
      return add_shape(of);
    case RecordedCall::add_bodies:
      return add_bodies(of);
    case RecordedCall::remove_bodies:
      return read_keys(scene) ? scene.remove(all_keys()) : reading();
    case RecordedCall::clear_bodies:
      scene.clear();
      return Status::ok;
    case RecordedCall::move:
      return move(of);
    case RecordedCall::set_body_state: {
      if (!read_keys(scene)) return reading();
      const auto state = in.get_enum(BodyState::sleeping);
      return in.ok() ? scene.set_body_state(all_keys(), state) : reading();
    }
    case RecordedCall::set_shape: {
      const Key key = scene.key_of(in.get<ObjectId>());
      const auto number = in.get<std::uint32_t>();
      if (!in.ok() || number >= of.shape_ids.size()) return Status::invalid_argument;
      return scene.set_shape(key, of.shape_ids[number]);
    }
    case RecordedCall::set_body_filter: {
      const Key key = scene.key_of(in.get<ObjectId>());
      ObjectFilter given;
      if (!in.get_bytes(&given, sizeof given)) return Status::invalid_argument;
      return scene.set_filter(key, given);
    }
    case RecordedCall::set_offsets: {
      const Key key = scene.key_of(in.get<ObjectId>());
      ContactOffsets given;
      given.contact = in.get<double>();
      given.rest = in.get<double>();
      return in.ok() ? scene.set_offsets(key, given) : reading();
    }
    case RecordedCall::set_layer: {
      const Key key = scene.key_of(in.get<ObjectId>());
      const auto layer = in.get<std::uint16_t>();
      return in.ok() ? scene.set_layer(key, layer) : reading();
    }
    case RecordedCall::set_layers_collide: {
      const auto a = in.get<std::uint16_t>();
      const auto b = in.get<std::uint16_t>();
      const bool collide = in.get_bool();
      return in.ok() ? scene.set_layers_collide(a, b, collide) : reading();
    }
    case RecordedCall::set_ignored: {
      const bool ignored = in.get_bool();
      Column<RecordedPair> pairs(options.memory);
      if (!in.get_array(pairs)) return reading();
      if (!key_pairs.resize(pairs.size())) return Status::out_of_memory;
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        key_pairs[i] = {scene.key_of(pairs[i].first), scene.key_of(pairs[i].second)};
      }
      return scene.set_ignored(std::span<const KeyPair>(key_pairs.data(), key_pairs.size()),
                               ignored);
    }
    case RecordedCall::refresh_scene:
      return scene.refresh();
    case RecordedCall::add_composite:
      return add_composite(of);
    case RecordedCall::change_composite:
      return change_composite(of);
    case RecordedCall::set_predicate: {
      const bool has_predicate = in.get_bool();
      if (!in.ok()) return reading();
      scene.set_predicate(has_predicate ? among<lower_first>(of.passed) : PairPredicate{});
      return Status::ok;
    }
    case RecordedCall::pairs_passed:
      return pairs_passed(of);
    case RecordedCall::composites_changed:
      return change_composites(*of.composites);
    case RecordedCall::load_scene:
      return load_scene(of);
    case RecordedCall::load_contacts: {
      const std::span<const std::byte> saved = in.get_nested();
      return in.ok() ? scene.load_contacts(saved, of.contacts) : reading();
    }
    default:
      return collide(of);
  }
}

/// If the shape in the pool differs from the recorded one, this counts as a difference.
Status ReplayState::add_shape(ReplayedWorld& of) {
  ShapeId id;
  Digest digest;
  const auto kind = in.get_enum(kLastConvexKind);
  if (!in.ok()) return reading();
  if (ShapeId::of(kind, 0).is_composite()) return Status::invalid_argument;
  const Status taken = with_kind(kind, [&](auto its) {
    using Shape = typename decltype(its)::Shape;
    if constexpr (std::is_same_v<Shape, HullShape>) {
      return add_hull(of, id, digest);
    } else if constexpr (std::is_same_v<Shape, SupportShape>) {
      return Status::invalid_argument;
    } else {
      return add_plain<Shape>(in, *of.shapes, id, digest);
    }
  });
  if (taken != Status::ok) return taken;
  if (!of.shape_ids.push_back(id)) return Status::out_of_memory;
  return compare(digest);
}

Status ReplayState::add_hull(ReplayedWorld& of, ShapeId& id, Digest& digest) {
  ReadHull hull(options.memory);
  hull.read(in);
  if (!in.ok()) return reading();
  const Status taken = of.shapes->add_built_hull(hull.points(), hull.faces(), hull.rounding, id);
  if (taken == Status::ok) add_to(digest, of.shapes->tables().hulls[id.index()]);
  return taken;
}

Status ReplayState::add_composite(ReplayedWorld& of) {
  const auto kind = in.get<std::uint8_t>();
  const std::span<const std::byte> saved = in.get_nested();
  std::array<double, 3> scale{};
  (void)in.get_bytes(scale.data(), sizeof scale);
  const auto count = in.get<std::uint64_t>();
  if (!in.ok() || count > in.rest().size() / sizeof(Pose)) return Status::invalid_argument;
  Column<CompoundChild> children(options.memory);
  if (!children.resize(static_cast<std::size_t>(count))) return Status::out_of_memory;
  for (CompoundChild& child : children) {
    child = {};
    const auto number = in.get<std::uint32_t>();
    if (number >= of.shape_ids.size()) return Status::invalid_argument;
    child.shape = of.shape_ids[number];
    (void)in.get_bytes(&child.pose, sizeof child.pose);
  }
  if (!in.ok()) return reading();
  ShapeId id;
  Status taken = Status::invalid_argument;
  if (kind == static_cast<std::uint8_t>(CompositeKind::mesh)) {
    taken = of.composites->add_saved_mesh(saved, scale, id, options.execution);
  } else if (kind == static_cast<std::uint8_t>(CompositeKind::height_field)) {
    taken = of.composites->add_saved_height_field(saved, id);
  } else if (kind == static_cast<std::uint8_t>(CompositeKind::compound)) {
    taken = of.composites->add_compound({children.data(), children.size()}, id);
  }
  if (taken != Status::ok) return taken;
  if (!of.shape_ids.push_back(id)) return Status::out_of_memory;
  return compare(digests_of(*of.composites, id).all);
}

Status ReplayState::change_composite(ReplayedWorld& of) {
  const auto number = in.get<std::uint32_t>();
  if (!in.get_array(floats)) return reading();
  if (number >= of.shape_ids.size()) return Status::invalid_argument;
  const ShapeId id = of.shape_ids[number];
  const float* const at = floats.data();
  Status taken = Status::invalid_argument;
  if (const HeightField* const field = of.composites->height_field(id)) {
    taken = of.composites->update_height_field(
        id, 0, 0,
        {.heights = {at, floats.size()}, .columns = field->columns(), .rows = field->rows()});
  } else if (of.composites->mesh(id) != nullptr && floats.size() % 3 == 0 && at != nullptr) {
    taken = of.composites->refit_mesh(
        id, PointView({at, at + 1, at + 2}, floats.size() / 3, 3 * sizeof(float)),
        options.execution);
  }
  return taken == Status::ok ? compare(digests_of(*of.composites, id).all) : taken;
}

Status ReplayState::add_bodies(ReplayedWorld& of) {
  if (!in.get_array(recorded_bodies)) return reading();
  if (!bodies.resize(recorded_bodies.size()) || !keys.resize(recorded_bodies.size())) {
    return Status::out_of_memory;
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const RecordedBody& one = recorded_bodies[i];
    if (one.shape >= of.shape_ids.size()) return Status::invalid_argument;
    BodyDefinition body;
    body.shape = of.shape_ids[one.shape];
    body.state = body_state_of(one.state, in);
    std::copy_n(one.pose, 3, body.pose.position);
    std::copy_n(one.pose + 3, 4, body.pose.orientation);
    body.filter = {one.filter[0], one.filter[1], one.filter[2]};
    body.data = one.data;
    bodies[i] = body;
  }
  if (!in.ok()) return reading();
  return of.scene->add({bodies.data(), bodies.size()}, std::span<Key>(keys.data(), keys.size()));
}

bool ReplayState::read_poses(std::size_t count, PoseView& poses) {
  const bool turns = in.get_bool();
  if (!in.get_array(doubles)) return false;
  const std::size_t width = turns ? 7 : 3;
  if (doubles.size() != count * width) return in.fail();
  const double* const at = doubles.data();
  poses = {};
  poses.count = count;
  poses.position_stride = poses.orientation_stride = width * sizeof(double);
  if (at == nullptr) return true;
  poses.position = {at, at + 1, at + 2};
  if (turns) poses.orientation = {at + 3, at + 4, at + 5, at + 6};
  return true;
}

Status ReplayState::move(ReplayedWorld& of) {
  PoseView given;
  if (!read_keys(*of.scene) || !read_poses(keys.size(), given)) return reading();
  return of.scene->move(std::span<const Key>(keys.data(), keys.size()), given);
}

/// Loads a snapshot of the recorded scene, with shape ids translated to this process.
Status ReplayState::load_scene(ReplayedWorld& of) {
  const std::span<const std::byte> saved = in.get_nested();
  Column<RecordedName> recorded(options.memory);
  Column<SavedNames::Name> names(options.memory);
  if (!in.get_array(recorded) || !in.get_array(ids)) return reading();
  if (!names.resize(recorded.size())) return Status::out_of_memory;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (recorded[i].number >= of.shape_ids.size()) return Status::invalid_argument;
    names[i] = {ShapeId{recorded[i].bits}, of.shape_ids[recorded[i].number]};
  }
  std::sort(names.begin(), names.end(), [](const SavedNames::Name& a, const SavedNames::Name& b) {
    return a.saved.bits < b.saved.bits;
  });
  if (of.scene->state_ == nullptr) return Status::out_of_memory;
  const SavedNames all{{names.data(), names.size()}, {ids.data(), ids.size()}};
  return winnow::load_scene(*of.scene->state_, saved, &all);
}

Status ReplayState::pairs_passed(ReplayedWorld& of) {
  if (!in.get_array(of.passed)) return reading();
  std::sort(of.passed.begin(), of.passed.end());
  return Status::ok;
}

Status ReplayState::collide(ReplayedWorld& of) {
  const auto level = in.get_enum(ContactLevel::manifold);
  const bool continues = in.get_bool();
  if (!in.ok()) return reading();
  if (!continues) of.contacts.clear();
  const Status answered = of.scene->collide(level, of.contacts);
  return answered == Status::ok ? compare(of.contacts) : answered;
}

}  // namespace winnow
