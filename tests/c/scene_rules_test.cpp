// Layers, offsets, predicates, warm starts and motions of scenes in C, compared with the C++ object
// behind each handle.

#include "tests/c/handles_of_c.h"

#include <winnow/pipeline/rigid_motion.h>

#include <array>
#include <vector>

namespace winnow::test {
namespace {

/// A floor, and a row of balls that rest on it and touch each other.
class BallsOfC {
 public:
  static constexpr std::size_t kBalls = 6;

  explicit BallsOfC(winnow_scene_options options = WINNOW_SCENE_OPTIONS)
      : shapes(winnow_shape_pool_create, nullptr),
        scene(winnow_scene_create, shapes, &options),
        contacts(winnow_contacts_create, nullptr) {
    ball = got<winnow_shape_id>(winnow_shape_pool_add, shapes, &kBall);
    std::array<winnow_body_definition, kBalls + 1> bodies;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      bodies[i] = WINNOW_BODY_DEFINITION;
      bodies[i].shape = ball;
      bodies[i].pose.position[0] = 0.9 * static_cast<double>(i);
      bodies[i].pose.position[2] = 0.5;
    }
    bodies[kBalls] = WINNOW_BODY_DEFINITION;
    bodies[kBalls].shape = got<winnow_shape_id>(winnow_shape_pool_add, shapes, &kFloor);
    bodies[kBalls].state = WINNOW_BODY_STATE_FIXED;
    EXPECT_EQ(winnow_scene_add(scene, bodies.data(), bodies.size(), keys.data()), WINNOW_OK);
  }

  /// Returns the number of pairs at level manifold.
  [[nodiscard]] std::size_t pairs() {
    EXPECT_EQ(winnow_scene_collide(scene, WINNOW_LEVEL_MANIFOLD, contacts), WINNOW_OK);
    return columns().pairs;
  }
  [[nodiscard]] winnow_contact_columns columns() const {
    return got<winnow_contact_columns>(winnow_contacts_columns, contacts);
  }

  static constexpr winnow_shape kBall = {WINNOW_SHAPE_SPHERE, {.sphere = {0.5}}};
  static constexpr winnow_shape kFloor = {WINNOW_SHAPE_HALF_SPACE, {.half_space = {{0, 0, 1}, 0}}};
  OwnedShapes shapes;
  OwnedScene scene;
  OwnedContacts contacts;
  winnow_shape_id ball = WINNOW_NO_SHAPE;
  std::array<winnow_key, kBalls + 1> keys{};
};

constexpr std::size_t kTouching = 2 * BallsOfC::kBalls - 1;

[[nodiscard]] bool collide(const BallsOfC& world, std::uint16_t a, std::uint16_t b) {
  return got<bool>(winnow_scene_layers_collide, world.scene, a, b);
}

TEST(CInterface, layers_that_do_not_collide_make_no_pairs) {
  BallsOfC world;
  EXPECT_EQ(world.pairs(), kTouching);
  for (std::size_t i = 0; i < BallsOfC::kBalls; ++i) {
    EXPECT_EQ(winnow_scene_set_layer(world.scene, world.keys[i], 7), WINNOW_OK);
    EXPECT_EQ(got<std::uint16_t>(winnow_scene_layer, world.scene, world.keys[i]), 7);
  }
  EXPECT_EQ(winnow_scene_set_layers_collide(world.scene, 7, 7, false), WINNOW_OK);
  EXPECT_FALSE(collide(world, 7, 7));
  EXPECT_TRUE(collide(world, 0, 7));
  EXPECT_EQ(world.pairs(), BallsOfC::kBalls);
  EXPECT_EQ(winnow_scene_set_layers_collide(world.scene, 7, 7, true), WINNOW_OK);
  EXPECT_EQ(world.pairs(), kTouching);
  EXPECT_EQ(winnow_scene_set_layer(world.scene, world.keys[0], WINNOW_SCENE_LAYERS),
            WINNOW_INVALID_ARGUMENT);
  std::uint16_t layer = 0;
  EXPECT_EQ(winnow_scene_layer(world.scene, WINNOW_NULL_KEY, &layer), WINNOW_INVALID_KEY);
}

TEST(CInterface, predicate_of_a_scene_rejects_pairs) {
  BallsOfC world;
  std::uint32_t none = world.keys[2].id;
  const winnow_pair_predicate predicate = {
      [](void* context, std::uint32_t first, std::uint32_t second) {
        const std::uint32_t id = *static_cast<std::uint32_t*>(context);
        return first != id && second != id;
      },
      &none};
  EXPECT_EQ(winnow_scene_set_predicate(world.scene, &predicate), WINNOW_OK);
  EXPECT_EQ(world.pairs(), kTouching - 3);
  EXPECT_EQ(winnow_scene_set_predicate(world.scene, nullptr), WINNOW_OK);
  EXPECT_EQ(world.pairs(), kTouching);
}

TEST(CInterface, offsets_make_contacts_begin_earlier) {
  BallsOfC world;
  const winnow_contact_offsets offsets = {0.9, 0.25};
  EXPECT_EQ(winnow_scene_set_offsets(world.scene, world.keys[0], &offsets), WINNOW_OK);
  EXPECT_EQ(world.scene->body(c::to_cpp(world.keys[0])).offsets, (ContactOffsets{0.9, 0.25}));
  EXPECT_EQ(world.pairs(), kTouching + 1);
  const winnow_contact_offsets negative = {-1.0, 0.0};
  EXPECT_EQ(winnow_scene_set_offsets(world.scene, world.keys[0], &negative),
            WINNOW_INVALID_ARGUMENT);
}

TEST(CInterface, warm_start_maps_pairs_to_previous_frame) {
  BallsOfC plain;
  EXPECT_GT(plain.pairs(), 0U);
  EXPECT_EQ(plain.columns().previous_pair, nullptr);
  winnow_scene_options options = WINNOW_SCENE_OPTIONS;
  options.warm_start = 1;
  options.suppress_ghost_contacts = 1;
  BallsOfC world(options);
  const std::size_t pairs = world.pairs();
  for (std::size_t i = 0; i < pairs; ++i) {
    EXPECT_EQ(world.columns().previous_pair[i], WINNOW_NO_CONTACT);
  }
  EXPECT_EQ(winnow_scene_remove(world.scene, world.keys.data(), 1), WINNOW_OK);
  EXPECT_EQ(world.pairs(), pairs - 2);
  const winnow_contact_columns now = world.columns();
  EXPECT_EQ(now.previous_pair, world.contacts->previous_pair().data());
  EXPECT_EQ(now.previous_point, world.contacts->previous_point().data());
  EXPECT_LT(now.previous_pair[0], pairs);
}

TEST(CInterface, options_of_an_older_program_are_accepted) {
  winnow_scene_options old = WINNOW_SCENE_OPTIONS;
  old.size = offsetof(winnow_scene_options, suppress_ghost_contacts);
  old.warm_start = 7;
  BallsOfC world(old);
  EXPECT_EQ(world.pairs(), kTouching);
  EXPECT_EQ(world.columns().previous_pair, nullptr);
  winnow_contact_columns shown{};
  shown.size = offsetof(winnow_contact_columns, previous_pair);
  const std::uint32_t untouched = 5;
  shown.previous_pair = &untouched;
  EXPECT_EQ(winnow_contacts_columns(world.contacts, &shown), WINNOW_OK);
  EXPECT_EQ(shown.pairs, kTouching);
  EXPECT_EQ(shown.previous_pair, &untouched);
}

TEST(CInterface, motion_casts_give_the_hits_of_cpp) {
  BallsOfC world;
  ASSERT_EQ(winnow_scene_refresh(world.scene), WINNOW_OK);
  OwnedQueries queries(winnow_scene_queries_create, static_cast<const winnow_scene*>(world.scene),
                       nullptr);
  winnow_motion_cast cast = WINNOW_MOTION_CAST;
  cast.shape = world.ball;
  cast.motion.start.position[0] = -3.0;
  cast.motion.start.position[2] = 0.75;
  cast.motion.travel[0] = 9.0;
  cast.motion.turn[2] = 1.0;
  const winnow_scene_filter* const all = nullptr;
  for (cast.from_touch = 0; cast.from_touch <= 1; ++cast.from_touch) {
    const auto hit =
        got<winnow_scene_hit>(winnow_scene_queries_closest_motion, queries, &cast, all, 1e-6);
    const MotionCast expected{{cast.shape}, *c::as_cpp(&cast.motion), cast.from_touch == 0};
    SceneQueries others(*world.scene);
    EXPECT_TRUE(same(hit, others.closest(expected)));
    EXPECT_EQ(hit.key.id, world.keys[0].id);
    const auto hits =
        got_all<winnow_scene_hit>(winnow_scene_queries_all_motion, queries, &cast, all, 1e-6);
    EXPECT_EQ(hits.size(), BallsOfC::kBalls);
    EXPECT_EQ(hits.size(), others.all(expected).size());
  }
}

TEST(CInterface, impacts_of_motions_equal_impacts_of_ends) {
  BallsOfC world;
  std::array<winnow_rigid_motion, 2> motions{};
  std::array<winnow_pose, 2> ends{};
  for (std::size_t i = 0; i < motions.size(); ++i) {
    motions[i].start =
        got<winnow_body_definition>(winnow_scene_body, world.scene, world.keys[4 * i]).pose;
    motions[i].travel[0] = i == 0 ? 2.0 : -2.0;
    ends[i] = motions[i].start;
    ends[i].position[0] += motions[i].travel[0];
  }
  const std::array<winnow_key, 2> keys{world.keys[0], world.keys[4]};
  const winnow_pose_view view = winnow_poses(ends.data(), ends.size());
  OwnedImpacts by_ends(winnow_continuous_collision_create, world.scene, nullptr);
  OwnedImpacts by_motions(winnow_continuous_collision_create, world.scene, nullptr);
  EXPECT_EQ(winnow_continuous_collision_find_impacts(by_ends, keys.data(), 2, &view, nullptr),
            WINNOW_OK);
  EXPECT_EQ(winnow_continuous_collision_find_impacts_of_motions(by_motions, keys.data(),
                                                                motions.data(), 2, nullptr),
            WINNOW_OK);
  const auto impacts =
      got_all<winnow_scene_impact>(winnow_continuous_collision_impacts, by_motions);
  ASSERT_GT(impacts.size(), 0U);
  EXPECT_EQ(impacts.size(), by_ends->impacts().size());
  EXPECT_TRUE(have_same_bits(impacts[0], by_ends->impacts()[0]));
  const auto counters =
      got<winnow_continuous_statistics>(winnow_continuous_collision_statistics, by_motions);
  EXPECT_GT(counters.boxes, 0U);
  EXPECT_EQ(counters.body_pairs, by_motions->statistics().body_pairs);
}

TEST(CInterface, margins_of_pairs_replace_one_margin) {
  BallsOfC world;
  const std::array<winnow_shape_id, 2> shapes{world.ball, world.ball};
  std::array<winnow_pose, 2> poses = {winnow_pose(WINNOW_POSE), winnow_pose(WINNOW_POSE)};
  poses[1].position[0] = 1.5;
  winnow_narrow_options options = WINNOW_NARROW_OPTIONS;
  const double margin = 0.75;
  winnow_pair_answer answer;
  for (const double* margins : {static_cast<const double*>(nullptr), &margin}) {
    options.contact_margins = margins;
    EXPECT_EQ(
        winnow_collide(world.shapes, shapes[0], &poses[0], shapes[1], &poses[1], &options, &answer),
        WINNOW_OK);
    EXPECT_EQ(answer.contact_count, margins == nullptr ? 0U : 1U);
  }
}

}  // namespace
}  // namespace winnow::test
