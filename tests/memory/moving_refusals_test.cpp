// Refuses each memory request of continuous collision detection, sensors, queries of sets, layers
// and deformable meshes in turn (refusals.h has the loop over requests).

#include <winnow/winnow.h>

#include <algorithm>
#include <cmath>

#include "tests/memory/refusals.h"
#include "tests/pipeline/composite_world.h"
#include "tests/support/answers.h"

namespace winnow::test {
namespace {

/// A ball, a box, a capsule, a mesh and a compound, shared by all worlds.
struct FewShapes {
  FewShapes() {
    ids.push_back(pool.add(SphereShape{0.5}));
    ids.push_back(pool.add(BoxShape{{0.5, 0.4, 0.3}}));
    ids.push_back(pool.add(CapsuleShape{0.3, 0.4}));
    const Surface hills =
        grid(4, 1.0F, Cut::same, [](float x, float y) { return 0.3F * std::sin(x + 2.0F * y); });
    ShapeId id = expect_ok(composites.add_mesh(std::span<const Point>(hills.vertices),
                                               std::span<const std::uint32_t>(hills.corners)));
    ids.push_back(id);
    const std::vector<CompoundChild> children{{ids[0], Pose::at(0.4, 0, 0)}, {ids[1], Pose{}}};
    id = expect_ok(composites.add_compound(children));
    ids.push_back(id);
  }

  ShapePool pool;
  CompositePool composites{pool};
  std::vector<ShapeId> ids;
};

const FewShapes& few_shapes() {
  static const FewShapes shapes;
  return shapes;
}

Pose pose_in(Random& random, double reach) {
  Pose pose = Pose::at(random.uniform(-reach, reach), random.uniform(-reach, reach),
                       random.uniform(-reach, reach));
  for (double& q : pose.orientation) q = random.uniform(-1.0, 1.0);
  return pose;
}

struct MovingWorld {
  MovingWorld(std::pmr::memory_resource* memory, Execution execution)
      : scene(few_shapes().pool, {.memory = memory,
                                  .execution = execution,
                                  .contact_margin = 0.05,
                                  .suppress_ghost_contacts = true,
                                  .warm_start = true,
                                  .composites = &few_shapes().composites}),
        contacts(memory),
        groups(memory),
        ccd(scene, memory),
        sensors(scene, memory),
        queries(scene, memory) {
    Random random(8);
    for (std::size_t i = 0; i < 24; ++i) {
      BodyDefinition body;
      body.shape = few_shapes().ids[i % few_shapes().ids.size()];
      body.pose = pose_in(random, 1.5);
      body.state = i % 4 == 3 ? BodyState::fixed : BodyState::dynamic;
      body.data = i;
      bodies.push_back(body);
      ends.push_back(pose_in(random, 2.5));
    }
  }

  void describe(Digest& digest) const {
    digest.insert(digest.end(), {scene.size(), sensors.size()});
    for (const Key key : keys) {
      BodyDefinition body;
      if (scene.body(key).get(body) != Status::ok) continue;
      digest.insert(digest.end(), {body.shape.bits, body.data, body.layer});
      put(digest, body.offsets.contact);
      put(digest, body.offsets.rest);
      put(digest, body.pose.position[0]);
    }
    for (const Key key : eyes) {
      SensorDefinition sensor;
      if (sensors.sensor(key).get(sensor) != Status::ok) continue;
      digest.insert(digest.end(), {sensor.shape.bits, sensor.data});
      put(digest, sensor.pose.position[0]);
    }
    digest.insert(digest.end(), answers.begin(), answers.end());
  }

  Status collide() {
    const Status status = scene.collide(ContactLevel::manifold, contacts);
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      answers.insert(answers.end(), {contacts.data_a()[i], contacts.data_b()[i]});
    }
    return status;
  }
  Status look(const ContinuousOptions& options) {
    const Status status = ccd.find_impacts(keys, ends, options);
    for (const SceneImpact& impact : ccd.impacts()) {
      if (status != Status::ok) break;
      answers.insert(answers.end(), {impact.data_a, impact.data_b});
      put(answers, impact.time);
    }
    return status;
  }
  Status sense() {
    const Status status = sensors.sense();
    if (status != Status::ok) {
      EXPECT_TRUE(sensors.sensed().empty());
      return status;
    }
    // Leaves out the events of overlaps: after a refused call every overlap begins again.
    for (const SensedBody& in : sensors.sensed()) {
      answers.insert(answers.end(), {in.sensor_data, in.body_data});
    }
    return status;
  }
  Status add_sensor(std::size_t i) {
    Key key;
    const Status status = sensors
                              .add({.shape = few_shapes().ids[i],
                                    .pose = Pose::at(0.5 * static_cast<double>(i), 0, 0),
                                    .data = i})
                              .get(key);
    if (status == Status::ok) eyes.push_back(key);
    return status;
  }

  std::vector<BodyDefinition> bodies;
  std::vector<Pose> ends;
  Scene scene;
  Contacts contacts;
  ContactGroups groups;
  ContinuousCollision ccd;
  Sensors sensors;
  SceneQueries queries;
  std::vector<Key> keys;
  std::vector<Key> eyes;
  Digest answers;
};

using MovingCalls = std::vector<Call<MovingWorld>>;

void add_bodies_and_layers(MovingCalls& calls) {
  static constexpr SceneCapacity kRoom{.bodies = {10, 40, 0},
                                       .pairs = 200,
                                       .level = ContactLevel::manifold,
                                       .touching = 200,
                                       .manifolds = 400,
                                       .points = 800};
  calls.push_back({"reserve", [](auto& w) { return w.scene.reserve(kRoom); }});
  calls.push_back(
      {"reserve contacts", [](auto& w) { return w.scene.reserve_contacts(w.contacts, kRoom); }});
  calls.push_back({"add", [](auto& w) {
                     std::vector<Key> added(w.bodies.size());
                     const Status status = w.scene.add(w.bodies, added);
                     if (status == Status::ok) w.keys = added;
                     return status;
                   }});
  calls.push_back({"contacts", [](auto& w) { return w.collide(); }});
  calls.push_back({"offsets", [](auto& w) { return w.scene.set_offsets(w.keys[2], {0.2, 0.1}); }});
  calls.push_back({"layers", [](auto& w) { return w.scene.set_layers_collide(3, 70, false); }});
  calls.push_back({"layer", [](auto& w) { return w.scene.set_layer(w.keys[1], 3); }});
  calls.push_back({"another layer", [](auto& w) { return w.scene.set_layer(w.keys[0], 70); }});
  calls.push_back({"contacts with offsets", [](auto& w) { return w.collide(); }});
  calls.push_back({"islands", [](auto& w) { return w.scene.islands(w.contacts, w.groups); }});
  calls.push_back({"colours", [](auto& w) { return w.scene.colours(w.contacts, w.groups); }});
}

void add_ways_and_volumes(MovingCalls& calls) {
  calls.push_back({"impacts", [](auto& w) { return w.look({}); }});
  calls.push_back({"impacts, first only", [](auto& w) { return w.look({.first_only = true}); }});
  calls.push_back({"impacts with fixed bodies",
                   [](auto& w) { return w.look({.pairs = ContinuousPairs::fixed}); }});
  for (const std::size_t i : {0U, 1U, 3U, 4U}) {
    calls.push_back({"sensor", [i](auto& w) { return w.add_sensor(i); }});
  }
  calls.push_back({"sense", [](auto& w) { return w.sense(); }});
  calls.push_back(
      {"move a sensor", [](auto& w) { return w.sensors.move(w.eyes[1], Pose::at(-1, 0, 0)); }});
  calls.push_back({"remove a sensor", [](auto& w) { return w.sensors.remove(w.eyes[0]); }});
  calls.push_back({"sense again", [](auto& w) { return w.sense(); }});
  calls.push_back({"refresh", [](auto& w) { return w.scene.refresh(); }});
  calls.push_back({"least distance", [](auto& w) {
                     SetDistance found;
                     const Status status =
                         w.queries
                             .least_distance(std::span(w.keys).first(9), std::span(w.keys).last(9))
                             .get(found);
                     if (status == Status::ok) put(w.answers, found.to.distance);
                     return status;
                   }});
  calls.push_back(
      {"overlaps of sets", [](auto& w) {
         std::span<const KeyPair> pairs;
         const Status status =
             w.queries.overlaps(std::span(w.keys).first(9), std::span(w.keys).last(9)).get(pairs);
         if (status == Status::ok) w.answers.push_back(pairs.size());
         return status;
       }});
  calls.push_back({"any contact of sets", [](auto& w) {
                     KeyPair pair;
                     const Status status = w.queries
                                               .any_contact(std::span(w.keys).first(9),
                                                            std::span(w.keys).last(9), 0.5)
                                               .get(pair);
                     if (status == Status::ok) w.answers.push_back(pair.first.id);
                     return status;
                   }});
  calls.push_back({"any contact", [](auto& w) {
                     KeyPair pair;
                     const Status status = w.queries.any_contact(0.5).get(pair);
                     if (status == Status::ok) w.answers.push_back(pair.first.id);
                     return status;
                   }});
  calls.push_back({"contacts at the end", [](auto& w) { return w.collide(); }});
}

TEST(SceneRefusals, refused_impacts_sensors_sets_and_layers_change_nothing) {
  for (const int threads : {1, 2}) {
    MovingCalls calls;
    add_bodies_and_layers(calls);
    add_ways_and_volumes(calls);
    const Execution execution = threads == 1 ? Execution::serial() : Execution::parallel();
    EXPECT_GT((RefusedPlay<MovingWorld, Execution>(calls, threads, execution).check()),
              is_quick() ? 50U : 100U);
  }
}

/// Two cloths, one above the other. The first cloth folds.
struct ClothWorld {
  ClothWorld(std::pmr::memory_resource* memory, Execution execution)
      : cloth({.memory = memory, .execution = execution, .chunk = 64}),
        other({.memory = memory, .execution = execution, .chunk = 64}),
        rest(grid(7, 0.5F, Cut::alternating, [](float, float) { return 0.0F; })),
        folded(grid(7, 0.5F, Cut::alternating, [](float x, float) { return x * x - 1.0F; })) {}

  void describe(Digest& digest) const {
    digest.insert(digest.end(), {cloth.triangles(), cloth.edges(), other.triangles()});
    digest.insert(digest.end(), answers.begin(), answers.end());
  }
  static PointView points(const Surface& surface) {
    return {std::span<const Point>(surface.vertices)};
  }
  Status build(DeformableMesh& mesh, const Surface& surface) {
    return mesh.build(points(surface), IndexView(std::span<const std::uint32_t>(rest.corners)));
  }
  /// Drops the chunks that were delivered before a refusal.
  template <typename Query>
  Status run_query(Query&& query) {
    Digest found;
    const Status status = query([&](auto chunk) {
      for (const auto& one : chunk) {
        if constexpr (requires { one.features; }) {
          found.insert(found.end(), {one.features.first, one.features.second});
        } else {
          found.insert(found.end(), {one.first, one.second});
        }
      }
    });
    if (status == Status::ok) answers.insert(answers.end(), found.begin(), found.end());
    return status;
  }

  DeformableMesh cloth;
  DeformableMesh other;
  Surface rest;
  Surface folded;
  Digest answers;
};

TEST(ClothRefusals, refused_memory_changes_nothing) {
  using enum FeaturePair;
  std::vector<Call<ClothWorld>> calls;
  calls.push_back({"build", [](auto& w) { return w.build(w.cloth, w.rest); }});
  calls.push_back(
      {"move", [](auto& w) { return w.cloth.move(w.points(w.rest), w.points(w.folded), 0.1); }});
  calls.push_back({"build the other", [](auto& w) { return w.build(w.other, w.folded); }});
  calls.push_back({"move the other", [](auto& w) {
                     return w.other.move(w.points(w.folded), w.points(w.rest), 0.1);
                   }});
  for (const FeaturePair kind : {vertex_face, edge_edge}) {
    calls.push_back({"candidates", [kind](auto& w) {
                       return w.run_query(
                           [&](auto take) { return w.cloth.self_candidates(kind, take); });
                     }});
    calls.push_back({"impacts", [kind](auto& w) {
                       return w.run_query(
                           [&](auto take) { return w.cloth.self_impacts(kind, {}, take); });
                     }});
    calls.push_back({"impacts with the other", [kind](auto& w) {
                       return w.run_query([&](auto take) {
                         return w.cloth.impacts_with(w.other, kind, {}, take);
                       });
                     }});
    calls.push_back({"proximity", [kind](auto& w) {
                       return w.run_query([&](auto take) {
                         return w.cloth.proximity_with(w.other, kind, 0.05, take);
                       });
                     }});
  }
  calls.push_back({"rebuild", [](auto& w) { return w.build(w.cloth, w.folded); }});
  for (const int threads : {1, 2}) {
    const Execution execution = threads == 1 ? Execution::serial() : Execution::parallel();
    EXPECT_GT((RefusedPlay<ClothWorld, Execution>(calls, threads, execution).check()), 20U);
  }
}

}  // namespace
}  // namespace winnow::test
