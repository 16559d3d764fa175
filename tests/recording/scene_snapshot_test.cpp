// Loaded scenes, shapes and contacts continue exactly as the saved ones would have, and invalid
// snapshots are rejected and change nothing.

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "pipeline/recording/contact_digest.h"
#include "tests/pipeline/scene_world.h"
#include "tests/recording/mutations.h"
#include "tests/support/answers.h"
#include "tests/support/config.h"
#include "tests/support/meshes.h"

namespace winnow::test {
namespace {

using SavedBytes = std::vector<std::byte>;

/// Returns the bytes that save(column) appends.
template <typename Save>
SavedBytes saved_by(const Save& save) {
  Column<std::byte> bytes(std::pmr::get_default_resource());
  EXPECT_EQ(save(bytes), Status::ok);
  return {bytes.begin(), bytes.end()};
}

/// All snapshots of a stage.
struct SavedStage {
  SavedBytes shapes;
  SavedBytes composites;
  SavedBytes scene;
  SavedBytes contacts;

  friend bool operator==(const SavedStage&, const SavedStage&) = default;
};

/// A scene with its pools and contacts.
struct Stage {
  explicit Stage(const SceneOptions& options)
      : composites(shapes), scene(shapes, with(options, composites)) {}

  static SceneOptions with(SceneOptions options, const CompositePool& composites) {
    options.composites = &composites;
    return options;
  }

  [[nodiscard]] SavedStage save() const {
    return {saved_by([&](auto& out) { return shapes.save(out); }),
            saved_by([&](auto& out) { return composites.save(out); }),
            saved_by([&](auto& out) { return scene.save(out); }),
            saved_by([&](auto& out) { return scene.save_contacts(contacts, out); })};
  }
  void load(const SavedStage& saved) {
    EXPECT_EQ(shapes.load(saved.shapes), Status::ok);
    EXPECT_EQ(composites.load(saved.composites), Status::ok);
    EXPECT_EQ(scene.load(saved.scene), Status::ok);
    EXPECT_EQ(scene.load_contacts(saved.contacts, contacts), Status::ok);
  }

  ShapePool shapes;
  CompositePool composites;
  Scene scene;
  Contacts contacts;
};

/// Adds a mesh with shared vertices, a height field, and two compounds of the existing shapes.
void add_composites(Stage& stage, std::vector<ShapeId>& ids) {
  const MeshData land = terrain(6);
  const std::span<const std::uint32_t> corners(land.corners);
  const std::size_t convex = ids.size();
  ids.emplace_back() = expect_ok(stage.composites.add_mesh(land.points(), corners));
  ids.emplace_back() = expect_ok(stage.composites.add_scaled(ids[convex], {0.5, -1.0, 2.0}));
  EXPECT_EQ(stage.composites.remove(ids[convex]), Status::ok);
  ids.erase(ids.begin() + static_cast<std::ptrdiff_t>(convex));
  const std::vector<float> heights{0, 1, 0.5F, 0.2F, 0.1F, 0.3F, 1, 0, 0};
  ids.emplace_back() =
      expect_ok(stage.composites.add_height_field({.heights = heights, .columns = 3, .rows = 3}));
  EXPECT_EQ(stage.composites.set_one_sided(ids.back()), Status::ok);
  std::vector<CompoundChild> children;
  for (int i = 0; i < 18; ++i) {
    children.push_back({ids[static_cast<std::size_t>(i) % 5], Pose::at(0.3 * i, 0.1, 0)});
    if (i != 1 && i != 17) continue;
    ids.emplace_back() = expect_ok(stage.composites.add_compound(children));
  }
  const CompoundChild surfaces[] = {
      {ids[convex], Pose::at(1, 0, 0)}, {ids[0], {}}, {ids[convex + 1], Pose::at(0, 2, 0)}};
  ids.emplace_back() = expect_ok(stage.composites.add_compound(surfaces));
}

/// Adds shapes of every kind. Some have free slots before them.
std::vector<ShapeId> add_shapes(Stage& stage) {
  SceneWorld world(1);
  std::vector<ShapeId> ids;
  const auto add = [&](const auto& shape) {
    ids.emplace_back() = expect_ok(stage.shapes.add(shape));
  };
  const ShapeTables& from = world.pool.tables();
  for (const double radius : {0.2, 0.5, 0.4}) add(SphereShape{radius});
  add(from.capsules[0]);
  add(from.boxes[0]);
  add(from.cylinders[0]);
  add(from.cones[0]);
  add(from.triangles[0]);
  add(HalfSpaceShape{{0.1, -0.2, 0.7}, -1.0});
  add(EllipsoidShape{{0.3, 0.4, 0.2}});
  add(TaperedCapsuleShape{.radius = {0.2, 0.3}, .half_length = 0.4});
  const HullShape& hull = from.hulls[0];
  std::vector<std::uint32_t> sizes;
  for (std::uint32_t f = 0; f < hull.face_count; ++f) sizes.push_back(hull.faces[f].count);
  for (int i = 0; i < 2; ++i) {
    ids.emplace_back() = expect_ok(stage.shapes.add_hull(
        PointView({hull.vertex[0], hull.vertex[1], hull.vertex[2]}, hull.vertex_count),
        {{hull.loop, 2 * std::size_t{hull.edge_count}}, sizes}, 0.01));
  }
  for (const std::size_t gone : {std::size_t{0}, ids.size() - 2}) {
    EXPECT_EQ(stage.shapes.remove(ids[gone]), Status::ok);
  }
  ids.erase(ids.end() - 2);
  ids.erase(ids.begin());
  add_composites(stage, ids);
  return ids;
}

constexpr double kSide = 5.0;

Pose pose_in(Random& random) {
  Pose pose;
  for (double& p : pose.position) p = random.uniform(0.0, kSide);
  for (double& q : pose.orientation) q = random.uniform(-1.0, 1.0);
  return pose;
}

/// Returns the keys of all bodies, ascending by id.
std::vector<Key> keys_of(const Scene& scene) {
  std::vector<Key> keys;
  for (ObjectId id = 0; keys.size() < scene.size(); ++id) {
    if (scene.contains(scene.key_of(id))) keys.push_back(scene.key_of(id));
  }
  return keys;
}

/// change_scene changes this many bodies in different ways.
constexpr std::size_t kChangedBodies = 15;

/// Makes small changes of many kinds, which depend on `number` and on random numbers. The scene has
/// at least kChangedBodies.
void change_scene(Scene& scene, Random& random, int number) {
  const std::vector<Key> keys = keys_of(scene);
  ASSERT_GE(keys.size(), kChangedBodies);
  const auto key = [&](std::size_t i) { return keys[i % keys.size()]; };
  BodyDefinition body;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (random.below(3) != 0) continue;
    body = expect_ok(scene.body(keys[i]));
    const double step = random.below(2) == 0 ? 0.004 : 0.2;
    for (double& p : body.pose.position) p += random.uniform(-step, step);
    EXPECT_EQ(scene.move(keys[i], body.pose), Status::ok);
  }
  const auto n = static_cast<std::size_t>(number);
  EXPECT_EQ(scene.remove(key(n)), Status::ok);
  body = expect_ok(scene.body(key(n + 1)));
  body.pose = pose_in(random);
  expect_ok(scene.add(body));
  const BodyState states[] = {BodyState::sleeping, BodyState::dynamic, BodyState::fixed};
  for (std::size_t i = 2; i < 8; ++i) {
    EXPECT_EQ(scene.set_body_state(key(n + i), states[(n + i) % 3]), Status::ok);
  }
  EXPECT_EQ(scene.set_ignored(key(n + 9), key(n + 10)), Status::ok);
  EXPECT_EQ(scene.set_filter(key(n + 11), {.layers = 2, .mask = ~2U}), Status::ok);
  EXPECT_EQ(scene.set_offsets(key(n + 14), {.contact = 0.03, .rest = 0.01}), Status::ok);
  EXPECT_EQ(scene.set_layer(key(n + 8), 70), Status::ok);
  EXPECT_EQ(scene.set_layers_collide(70, 0, number % 2 == 0), Status::ok);
  body = expect_ok(scene.body(key(n + 12)));
  EXPECT_EQ(scene.set_shape(key(n + 13), body.shape), Status::ok);
}

/// Returns a digest of all contacts and of some queries.
std::uint64_t frame_digest(Stage& stage, ContactLevel level, SceneQueries& queries) {
  Digest digest;
  EXPECT_EQ(stage.scene.collide(level, stage.contacts), Status::ok);
  add_to(digest, stage.contacts);
  std::span<const SceneHit> hits = expect_ok(queries.all(ShapeRay{{-1, 2, 2}, {1, 0.05, 0.02}}));
  for (const SceneHit& hit : hits) {
    digest.add(std::uint64_t{hit.key.id});
    digest.add(hit.t);
  }
  std::span<const SceneDistance> near;
  const double middle[3] = {2, 2, 2};
  near = expect_ok(queries.nearest(middle, 5, 3.0));
  for (const SceneDistance& one : near) digest.add(one.distance);
  return digest.value();
}

/// Continues for some frames; the changes depend only on numbers.
std::vector<std::uint64_t> continue_frames(Stage& stage, SceneQueries& queries) {
  Random random(9);
  std::vector<std::uint64_t> all;
  for (int frame = 0; frame < 6; ++frame) {
    if (frame % 3 != 0) change_scene(stage.scene, random, frame);
    const auto level = frame == 4 ? ContactLevel::distance : ContactLevel::manifold;
    all.push_back(frame_digest(stage, level, queries));
  }
  return all;
}

/// Runs a scene for some frames and stops in the middle of a frame.
void run_frames(Stage& stage, std::size_t count) {
  Random random(4);
  const std::vector<ShapeId> shapes = add_shapes(stage);
  std::vector<BodyDefinition> bodies(count);
  std::vector<Key> keys(count);
  for (std::size_t i = 0; i < count; ++i) {
    bodies[i].shape = shapes[i % shapes.size()];
    bodies[i].pose = pose_in(random);
    bodies[i].data = i;
    const bool is_land = bodies[i].shape.kind_index() == 7 ||
                         (bodies[i].shape.is_composite() &&
                          bodies[i].shape.composite_kind() != CompositeKind::compound);
    bodies[i].state = is_land ? BodyState::fixed : BodyState::dynamic;
  }
  EXPECT_EQ(stage.scene.add(bodies, keys), Status::ok);
  SceneQueries queries(stage.scene);
  for (int frame = 0; frame < 4; ++frame) {
    change_scene(stage.scene, random, frame);
    (void)frame_digest(stage, ContactLevel::manifold, queries);
  }
  EXPECT_EQ(stage.scene.move(keys_of(stage.scene)[2], pose_in(random)), Status::ok);
}

std::vector<SceneOptions> kinds_of_scenes() {
  return {{},
          {.contact_margin = 0.05, .cache_tolerance = 0.01, .warm_start = true},
          {.suppress_ghost_contacts = true}};
}

TEST(SceneSnapshots, loaded_scene_continues_bit_identical) {
  for (const SceneOptions& options : kinds_of_scenes()) {
    Stage first(options);
    run_frames(first, std::max(scaled(150), kChangedBodies));
    const std::vector<Key> keys = keys_of(first.scene);
    const SavedStage saved = first.save();
    SceneQueries queries(first.scene);
    const std::vector<std::uint64_t> future = continue_frames(first, queries);
    // Goes back to the saved state in place; the queries still use the scene.
    first.load(saved);
    EXPECT_EQ(keys_of(first.scene), keys);
    // The next stamps are not restored.
    const SavedStage again = first.save();
    first.load(again);
    EXPECT_TRUE(first.save() == again);
    EXPECT_TRUE(continue_frames(first, queries) == future);
    for (const Isa isa : available_isas()) {
      const IsaScope scope(isa);
      for (const int threads : {1, 2}) {
        Stage other({.execution = Workers{threads}.execution()});
        other.load(saved);
        // Only the scene differs: the first scene has the keys.
        SavedStage of_other = other.save();
        of_other.scene = saved.scene;
        EXPECT_TRUE(of_other == saved);
        SceneQueries other_queries(other.scene);
        EXPECT_TRUE(continue_frames(other, other_queries) == future)
            << to_string(isa) << " " << threads;
      }
    }
  }
}

TEST(SceneSnapshots, loads_never_give_a_key_twice) {
  Stage stage(kinds_of_scenes()[0]);
  run_frames(stage, 40);
  const std::vector<Key> keys = keys_of(stage.scene);
  const SavedStage saved = stage.save();
  std::vector<Key> given;
  BodyDefinition body = expect_ok(stage.scene.body(keys[0]));
  for (int round = 0; round < 3; ++round) {
    for (const Key key : {keys[0], keys[7]}) ASSERT_EQ(stage.scene.remove(key), Status::ok);
    for (int i = 0; i < 20; ++i) {
      Key key = expect_ok(stage.scene.add(body));
      EXPECT_EQ(std::ranges::find(given, key), given.end());
      given.push_back(key);
    }
    stage.load(saved);
    EXPECT_EQ(keys_of(stage.scene), keys);
    for (const Key& key : given) EXPECT_FALSE(stage.scene.contains(key));
  }
}

TEST(SceneSnapshots, contacts_are_saved_only_for_their_scene) {
  Stage stage(kinds_of_scenes()[1]);
  run_frames(stage, 60);
  const SavedStage saved = stage.save();
  Contacts foreign;
  Column<std::byte> bytes(std::pmr::get_default_resource());
  EXPECT_EQ(stage.scene.save_contacts(foreign, bytes), Status::invalid_key);
  EXPECT_TRUE(bytes.empty());
  EXPECT_EQ(stage.scene.load_contacts(saved.contacts, foreign), Status::ok);
  EXPECT_EQ(foreign.size(), stage.contacts.size());
  EXPECT_EQ(stage.scene.remove(keys_of(stage.scene)[0]), Status::ok);
  EXPECT_EQ(stage.scene.load_contacts(saved.contacts, foreign), Status::invalid_argument);
  EXPECT_EQ(foreign.size(), stage.contacts.size());
  // A snapshot of bodies whose shapes are not in the pools is rejected.
  Stage empty({});
  EXPECT_EQ(empty.scene.load(saved.scene), Status::invalid_argument);
  EXPECT_EQ(empty.composites.load(saved.composites), Status::invalid_argument);
  EXPECT_EQ(empty.scene.size(), 0U);
}

/// Makes calls on whatever was loaded.
void use(Stage& stage) {
  SceneQueries queries(stage.scene);
  Random random(2);
  for (const auto level : {ContactLevel::manifold, ContactLevel::distance}) {
    const Status status = stage.scene.collide(level, stage.contacts);
    EXPECT_TRUE(status == Status::ok || status == Status::out_of_memory);
    if (stage.scene.size() >= kChangedBodies) change_scene(stage.scene, random, 1);
  }
  std::span<const SceneHit> hits;
  hits = queries.all(ShapeRay{{-1, 2, 2}, {1, 0.05, 0.02}});
}

TEST(SceneSnapshots, removed_tier_loads_as_robust) {
  constexpr std::size_t kTier = 32 + sizeof(std::uint32_t) + sizeof(double);
  const Stage stage({.tier = NarrowTier::robust});
  const SavedBytes saved = saved_by([&](auto& out) { return stage.scene.save(out); });
  for (const int number : {0, 1, 2, 3}) {
    SavedBytes other = saved;
    other[kTier] = static_cast<std::byte>(number);
    seal_snapshot(other);
    Stage loaded({});
    EXPECT_EQ(loaded.scene.load(other), number < 3 ? Status::ok : Status::invalid_argument);
    const SavedBytes again = saved_by([&](auto& out) { return loaded.scene.save(out); });
    EXPECT_EQ(again[kTier], std::byte{number == 2 ? std::uint8_t{2} : std::uint8_t{1}});
  }
}

TEST(SceneSnapshots, untrusted_snapshots_are_read_or_refused) {
  Stage first(kinds_of_scenes()[1]);
  run_frames(first, 40);
  const SavedStage good = first.save();
  Random random(3);
  std::size_t refused = 0;
  const std::size_t count = scaled(2500);
  SavedBytes SavedStage::*const parts[] = {&SavedStage::shapes, &SavedStage::composites,
                                           &SavedStage::scene, &SavedStage::contacts};
  // The stage into which parts are loaded; created again after a successful load.
  std::optional<Stage> stage;
  for (std::size_t i = 0; i < count; ++i) {
    SavedStage saved = good;
    SavedBytes& bytes = saved.*parts[i % 4];
    mutate(bytes, random);
    if (i % 9 != 0) seal_snapshot(bytes);
    if (!stage.has_value()) {
      stage.emplace(SceneOptions{.execution = Execution::serial()});
      stage->load(good);
    }
    const Status status = i % 4 == 0   ? stage->shapes.load(bytes)
                          : i % 4 == 1 ? stage->composites.load(bytes)
                          : i % 4 == 2 ? stage->scene.load(bytes)
                                       : stage->scene.load_contacts(bytes, stage->contacts);
    EXPECT_TRUE(status == Status::ok || status == Status::invalid_argument) << to_string(status);
    if (status != Status::ok) {
      ++refused;
      continue;
    }
    // After a pool was loaded, the scene, and the composite pool if the shape pool was loaded, must
    // be loaded too.
    const bool holds =
        i % 4 > 1 || ((i % 4 == 1 || stage->composites.load(good.composites) == Status::ok) &&
                      stage->scene.load(good.scene) == Status::ok);
    if (holds) use(*stage);
    stage.reset();
  }
  EXPECT_GT(refused, count / 16);
}

}  // namespace
}  // namespace winnow::test
