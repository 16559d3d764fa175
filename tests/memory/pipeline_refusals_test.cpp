// Refuses each memory request of each call of scenes, scene queries, shape pools and the narrow
// phase in turn (refusals.h has the loop over requests).

#include <winnow/winnow.h>

#include <algorithm>

#include "tests/memory/refusals.h"
#include "tests/pipeline/composite_world.h"
#include "tests/pipeline/scene_world.h"

namespace winnow::test {
namespace {

// Convex and composite shapes.

void put_box(Digest& digest, const Aabb& box) {
  for (int k = 0; k < 3; ++k) {
    put(digest, static_cast<double>(box.min[k]));
    put(digest, static_cast<double>(box.max[k]));
  }
}

struct ShapeWorld {
  explicit ShapeWorld(std::pmr::memory_resource* memory)
      : shapes(memory), composites(shapes, memory), mesh(memory), field(memory) {}

  void describe(Digest& digest) const {
    for (const ShapeKind kind : kConvexKinds) digest.push_back(shapes.size(kind));
    for (const ShapeId id : ids) {
      digest.push_back(id.bits);
      if (shapes.contains(id)) put_box(digest, shapes.bounds(id, Pose{}));
      if (composites.contains(id)) put_box(digest, composites.bounds(id, Pose{}));
    }
    for (const CompositeKind kind :
         {CompositeKind::mesh, CompositeKind::compound, CompositeKind::height_field}) {
      digest.push_back(composites.size(kind));
    }
    digest.insert(digest.end(), {mesh.triangles(), mesh.vertices(), field.columns()});
    put_box(digest, mesh.bounds());
    put_box(digest, field.bounds());
  }

  /// Runs a call that returns a new id, and stores the id.
  template <typename Add>
  Status keep(Add&& add) {
    ShapeId id;
    const Status status = add(id);
    if (status == Status::ok) {
      ids.push_back(id);
    } else {
      EXPECT_EQ(id, ShapeId{});
    }
    return status;
  }
  template <typename Shape>
  Status add(const Shape& shape) {
    return keep([&](ShapeId& id) { return shapes.add(shape).get(id); });
  }
  Status remove(std::size_t i) {
    const ShapeId id = ids[i];
    const Status status = id.is_composite() ? composites.remove(id) : shapes.remove(id);
    if (status == Status::ok) ids.erase(ids.begin() + static_cast<std::ptrdiff_t>(i));
    return status;
  }

  ShapePool shapes;
  CompositePool composites;
  TriangleMesh mesh;
  HeightField field;
  std::vector<ShapeId> ids;
};

const Surface& hills(float height) {
  const auto wave = [](float scale) {
    return grid(6, 0.5F, Cut::random, [scale](float x, float y) {
      return scale * std::sin(3.0F * x) * std::cos(2.0F * y);
    });
  };
  static const Surface low = wave(0.3F);
  static const Surface high = wave(1.5F);
  return height < 1.0F ? low : high;
}
PointView points_of(const Surface& surface) {
  return {std::span<const Point>(surface.vertices)};
}
IndexView corners_of(const Surface& surface) {
  return {std::span<const std::uint32_t>(surface.corners)};
}

const std::vector<float>& some_heights() {
  static const std::vector<float> heights{0.0F, 1.0F, 0.5F, 2.0F, 0.25F, 0.5F, 0.0F, 1.0F, 0.125F};
  return heights;
}

std::vector<Eigen::Vector3d> ball_of_points() {
  Random random(3);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 30; ++i) {
    const Eigen::Vector3d p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    points.push_back(p.normalized());
  }
  return points;
}

using ShapeCalls = std::vector<Call<ShapeWorld>>;

void add_shapes(ShapeCalls& calls) {
  calls.push_back({"sphere", [](auto& w) { return w.add(SphereShape{0.5}); }});
  calls.push_back({"capsule", [](auto& w) { return w.add(CapsuleShape{0.5, 1}); }});
  calls.push_back({"box", [](auto& w) { return w.add(BoxShape{{1, 2, 3}}); }});
  calls.push_back({"cylinder", [](auto& w) { return w.add(CylinderShape{1, 2}); }});
  calls.push_back({"cone", [](auto& w) { return w.add(ConeShape{1, 2}); }});
  calls.push_back({"triangle", [](auto& w) {
                     return w.add(TriangleShape{{{0, 0, 0}, {1, 0, 0}}});
                   }});
  calls.push_back({"half-space", [](auto& w) { return w.add(HalfSpaceShape{}); }});
  calls.push_back(
      {"hull of faces", [](auto& w) {
         const std::vector<Eigen::Vector3d> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
         const std::vector<std::uint32_t> loops{0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
         const std::vector<std::uint32_t> sizes(4, 3);
         return w.keep([&](ShapeId& id) {
           return w.shapes.add_hull(corners, {loops, sizes}, 0.0).get(id);
         });
       }});
  calls.push_back({"hull of points", [](auto& w) {
                     return w.keep([&](ShapeId& id) {
                       return w.shapes.add_hull(ball_of_points(), 0.1).get(id);
                     });
                   }});
}

void add_composites(ShapeCalls& calls) {
  calls.push_back(
      {"mesh", [](auto& w) {
         return w.keep([&](ShapeId& id) {
           return w.composites.add_mesh(points_of(hills(0)), corners_of(hills(0))).get(id);
         });
       }});
  calls.push_back({"scaled mesh", [](auto& w) {
                     return w.keep([&](ShapeId& id) {
                       return w.composites.add_scaled(w.ids.back(), {1, -2, 3}).get(id);
                     });
                   }});
  calls.push_back({"refit of a mesh", [](auto& w) {
                     return w.composites.refit_mesh(w.ids.back(), points_of(hills(2)));
                   }});
  calls.push_back({"compound", [](auto& w) {
                     std::vector<CompoundChild> children;
                     for (int i = 0; i < 20; ++i) children.push_back({w.ids[2], Pose::at(i, 0, 0)});
                     return w.keep(
                         [&](ShapeId& id) { return w.composites.add_compound(children).get(id); });
                   }});
  calls.push_back({"height field", [](auto& w) {
                     return w.keep([&](ShapeId& id) {
                       return w.composites.add_height_field({some_heights(), 3, 3}).get(id);
                     });
                   }});
  calls.push_back(
      {"update of a height field", [](auto& w) {
         return w.composites.update_height_field(w.ids.back(), 1, 1, {some_heights(), 2, 2});
       }});
  calls.push_back({"removal of a compound", [](auto& w) { return w.remove(w.ids.size() - 2); }});
  calls.push_back({"removal of a sphere", [](auto& w) { return w.remove(0); }});
  calls.push_back({"another sphere", [](auto& w) { return w.add(SphereShape{2}); }});
}

void add_surfaces(ShapeCalls& calls) {
  calls.push_back(
      {"build", [](auto& w) { return w.mesh.build(points_of(hills(0)), corners_of(hills(0))); }});
  calls.push_back({"refit", [](auto& w) { return w.mesh.refit(points_of(hills(2))); }});
  calls.push_back({"parallel rebuild", [](auto& w) {
                     return w.mesh.build(points_of(hills(2)), corners_of(hills(2)), {},
                                         Execution::parallel());
                   }});
  calls.push_back({"field", [](auto& w) { return w.field.build({some_heights(), 3, 3}); }});
  calls.push_back({"update of the field", [](auto& w) {
                     return w.field.update(0, 0, {some_heights(), 2, 2});
                   }});
  calls.push_back({"smaller field", [](auto& w) { return w.field.build({some_heights(), 2, 3}); }});
}

TEST(ShapeRefusals, refused_memory_changes_nothing) {
  for (const int threads : {1, 2}) {
    ShapeCalls calls;
    add_shapes(calls);
    add_composites(calls);
    add_surfaces(calls);
    EXPECT_GT(RefusedPlay<ShapeWorld>(calls, threads).check(), 40U);
  }
}

// The mid phase and the narrow phase.

struct NarrowWorld {
  NarrowWorld(std::pmr::memory_resource* memory, Execution how)
      : execution(how), narrow(memory), result(memory), primitives(memory) {
    Random random(9);
    scene.add_shapes(random);
    scene.add_pairs(random, 20, 1.5, {0.0, 0.0, 0.0});
    for (const BodyPair& pair : scene.pairs) {
      if (!scene.body[pair.a].is_composite() && !scene.body[pair.b].is_composite()) continue;
      mixed.push_back(pair);
    }
    for (std::uint32_t i = 0; i < 40; ++i) {
      convex.push_back({static_cast<std::uint32_t>(scene.body.size()),
                        static_cast<std::uint32_t>(scene.body.size() + 1)});
      for (int k = 0; k < 2; ++k) {
        scene.body.push_back(scene.ids[random.below(7)]);
        scene.pose.push_back(random_pose(random, 1.0));
      }
    }
  }

  void describe(Digest& digest) const {
    digest.insert(digest.end(), answers.begin(), answers.end());
  }

  Status collide(ContactLevel level, NarrowTier tier) {
    const Status status = narrow.collide(
        scene.shapes, scene.bodies(), convex,
        {.level = level, .tier = tier, .contact_margin = 0.1, .execution = execution}, result);
    if (status == Status::ok) {
      answer();
    } else {
      EXPECT_EQ(result.size(), 0U);
    }
    return status;
  }
  Status find_primitive_pairs() {
    const Status status = mid::find_primitive_pairs(scene.composites, scene.shapes, scene.bodies(),
                                                    mixed, 0.1, execution, primitives);
    if (status == Status::ok) answers.push_back(primitives.pairs.size());
    return status;
  }
  Status collide_primitives() {
    const Status status = narrow.collide(
        primitives.tables(scene.shapes),
        {{primitives.shapes.data(), primitives.shapes.size()},
         {primitives.poses.data(), primitives.poses.size()}},
        {primitives.pairs.data(), primitives.pairs.size()},
        {.level = ContactLevel::manifold, .contact_margin = 0.1, .execution = execution}, result);
    if (status == Status::ok) answer();
    return status;
  }

  void answer() {
    for (std::size_t i = 0; i < result.size(); ++i) {
      answers.push_back(result.pair_of(i) * 2U + (result.overlaps(i) ? 1U : 0U));
      if (result.level() == ContactLevel::boolean) continue;
      put(answers, result.distance()[i]);
      for (int k = 0; k < 3; ++k) put(answers, result.normal(k)[i]);
    }
    for (std::size_t i = 0; i < result.contacts(); ++i) {
      answers.push_back(result.contact(i).feature);
      put(answers, static_cast<double>(result.contact(i).depth));
    }
  }

  CompositeWorld scene;
  std::vector<BodyPair> mixed;
  std::vector<BodyPair> convex;
  Execution execution;
  NarrowPhase narrow;
  NarrowResult result;
  PrimitivePairs primitives;
  Digest answers;
};

TEST(NarrowRefusals, refused_memory_changes_nothing) {
  using enum ContactLevel;
  for (const int threads : {1, 2}) {
    std::vector<Call<NarrowWorld>> calls;
    calls.push_back({"overlaps", [](auto& w) { return w.collide(boolean, NarrowTier::robust); }});
    calls.push_back({"distances", [](auto& w) { return w.collide(distance, NarrowTier::robust); }});
    calls.push_back({"manifolds", [](auto& w) { return w.collide(manifold, NarrowTier::robust); }});
    calls.push_back({"solved", [](auto& w) { return w.collide(manifold, NarrowTier::reference); }});
    calls.push_back({"primitives", [](auto& w) { return w.find_primitive_pairs(); }});
    calls.push_back({"manifolds of primitives", [](auto& w) { return w.collide_primitives(); }});
    const Execution execution = threads == 1 ? Execution::serial() : Execution::parallel();
    EXPECT_GT((RefusedPlay<NarrowWorld, Execution>(calls, threads, execution).check()), 20U);
  }
}

// Scenes and scene queries.

/// Shapes shared by all scenes.
const CompositeWorld& shapes_of_scenes() {
  static const auto world = [] {
    auto made = std::make_unique<CompositeWorld>();
    Random random(5);
    made->add_shapes(random);
    // Leave out the largest compounds and the triangle soup: they are slow and add no coverage.
    for (const std::ptrdiff_t i : {14, 12, 11}) made->ids.erase(made->ids.begin() + i);
    return made;
  }();
  return *world;
}

struct WholeWorld {
  WholeWorld(std::pmr::memory_resource* memory, Execution execution, double cache_tolerance)
      : scene(world.shapes, {.memory = memory,
                             .execution = execution,
                             .contact_margin = 0.05,
                             .cache_tolerance = cache_tolerance,
                             .warm_start = true,
                             .composites = &world.composites}),
        contacts(memory),
        queries(scene, memory),
        compares_contacts(cache_tolerance == 0.0) {
    Random random(6);
    for (std::size_t i = 0; i < 30; ++i) {
      BodyDefinition body;
      body.shape = world.ids[i % world.ids.size()];
      body.pose = random_pose(random, 2.5);
      body.state = i % 5 == 0   ? BodyState::fixed
                   : i % 7 == 0 ? BodyState::sleeping
                                : BodyState::dynamic;
      body.data = i;
      bodies.push_back(body);
    }
  }

  void describe(Digest& digest) const {
    digest.push_back(scene.size());
    for (ObjectId id = 0; id < 60; ++id) {
      const Key key = scene.key_of(id);
      BodyDefinition body;
      digest.push_back(key.id);
      if (scene.body(key).get(body) != Status::ok) continue;
      digest.insert(digest.end(), {body.shape.bits, static_cast<std::uint64_t>(body.state),
                                   body.filter.layers, body.data});
      for (const double x : body.pose.position) put(digest, x);
    }
    digest.insert(digest.end(), answers.begin(), answers.end());
  }

  Status add(std::size_t first, std::size_t count) {
    std::vector<Key> added(count);
    const Status status = scene.add(std::span(bodies).subspan(first, count), added);
    if (status == Status::ok) keys.insert(keys.end(), added.begin(), added.end());
    return status;
  }
  Status collide(ContactLevel level) {
    const Status status = scene.collide(level, contacts);
    if (status == Status::ok) {
      answer();
    } else {
      EXPECT_EQ(contacts.size(), 0U);
    }
    return status;
  }
  /// Leaves out events: they depend on the last frame, which a refusal clears. With caching, also
  /// leaves out distances and points: they depend on the frame in which they were computed.
  void answer() {
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      answers.insert(answers.end(), {contacts.data_a()[i], contacts.data_b()[i]});
    }
    if (!compares_contacts || contacts.level() < ContactLevel::distance) return;
    for (const double distance : contacts.distance()) put(answers, distance);
    for (std::size_t p = 0; p < contacts.points(); ++p) {
      answers.push_back(contacts.contact(p).feature);
      put(answers, static_cast<double>(contacts.contact(p).depth));
    }
  }
  void answer(const SceneHit& hit) {
    answers.insert(answers.end(), {hit.key.id, hit.part});
    put(answers, hit.t);
  }

  const CompositeWorld& world = shapes_of_scenes();
  std::vector<BodyDefinition> bodies;
  Scene scene;
  Contacts contacts;
  SceneQueries queries;
  bool compares_contacts;
  std::vector<Key> keys;
  Digest answers;
};

using SceneCalls = std::vector<Call<WholeWorld>>;

void add_scene_changes(SceneCalls& calls) {
  using enum ContactLevel;
  calls.push_back({"add", [](auto& w) { return w.add(0, 22); }});
  calls.push_back({"contacts", [](auto& w) { return w.collide(manifold); }});
  calls.push_back({"move", [](auto& w) {
                     std::vector<Pose> poses;
                     for (std::size_t i = 0; i < 12; ++i) poses.push_back(w.bodies[i + 5].pose);
                     return w.scene.move(std::span(w.keys).first(12), poses);
                   }});
  calls.push_back({"contacts after moves", [](auto& w) { return w.collide(manifold); }});
  calls.push_back({"wake and sleep", [](auto& w) {
                     return w.scene.set_body_state(std::span(w.keys).first(8), BodyState::sleeping);
                   }});
  calls.push_back({"contacts of awake bodies", [](auto& w) { return w.collide(manifold); }});
  calls.push_back({"shape", [](auto& w) { return w.scene.set_shape(w.keys[3], w.world.ids[9]); }});
  calls.push_back({"ignored", [](auto& w) { return w.scene.set_ignored(w.keys[5], w.keys[2]); }});
  calls.push_back({"filter", [](auto& w) { return w.scene.set_filter(w.keys[4], {2, 2, 0}); }});
  calls.push_back({"remove", [](auto& w) {
                     const std::vector<Key> gone(w.keys.begin() + 9, w.keys.begin() + 14);
                     const Status status = w.scene.remove(gone);
                     if (status == Status::ok)
                       w.keys.erase(w.keys.begin() + 9, w.keys.begin() + 14);
                     return status;
                   }});
  calls.push_back({"distances", [](auto& w) { return w.collide(distance); }});
  calls.push_back({"add again", [](auto& w) { return w.add(22, 8); }});
  calls.push_back({"overlaps", [](auto& w) { return w.collide(boolean); }});
  calls.push_back({"wake", [](auto& w) {
                     return w.scene.set_body_state(std::span(w.keys).first(8), BodyState::dynamic);
                   }});
  calls.push_back({"contacts of all", [](auto& w) { return w.collide(manifold); }});
  calls.push_back({"pairs", [](auto& w) { return w.collide(pairs); }});
  calls.push_back({"refresh", [](auto& w) { return w.scene.refresh(); }});
}

void add_scene_queries(SceneCalls& calls) {
  static constexpr ShapeRay kRay{{-6, 0.1, 0.2}, {1, 0.02, 0.01}, 100.0};
  calls.push_back({"closest hit", [](auto& w) {
                     SceneHit hit;
                     const Status status = w.queries.closest(kRay).get(hit);
                     if (status == Status::ok) w.answer(hit);
                     return status;
                   }});
  calls.push_back({"all hits", [](auto& w) {
                     std::span<const SceneHit> hits;
                     const Status status = w.queries.all(kRay).get(hits);
                     for (const SceneHit& hit : hits) w.answer(hit);
                     return status;
                   }});
  calls.push_back({"hits of many rays", [](auto& w) {
                     const std::vector<ShapeRay> rays(20, kRay);
                     SceneHitLists lists;
                     const Status status = w.queries.all(ShapeRayBatch(rays)).get(lists);
                     for (const SceneHit& hit : lists.hits) w.answer(hit);
                     return status;
                   }});
  calls.push_back({"moving shape", [](auto& w) {
                     std::span<const SceneHit> hits;
                     const ShapeCast cast{w.world.ids[2], Pose::at(-6, 0, 0), {12, 0, 0}, 1.0};
                     const Status status = w.queries.all(cast).get(hits);
                     for (const SceneHit& hit : hits) w.answer(hit);
                     return status;
                   }});
  calls.push_back(
      {"turning shape", [](auto& w) {
         std::span<const SceneHit> hits;
         const MotionCast cast{w.world.ids[2], {Pose::at(-6, 0, 0), {12, 1, 1}, {0, 3, 0}}};
         const Status status = w.queries.all(cast).get(hits);
         for (const SceneHit& hit : hits) w.answer(hit);
         return status;
       }});
  calls.push_back({"overlap", [](auto& w) {
                     std::span<const SceneOverlap> found;
                     const Status status = w.queries.overlap(w.world.ids[9], Pose{}).get(found);
                     for (const SceneOverlap& one : found) w.answers.push_back(one.key.id);
                     return status;
                   }});
  calls.push_back({"distance", [](auto& w) {
                     SceneDistance gap;
                     const Status status = w.queries.distance(w.keys[1], w.keys[12]).get(gap);
                     if (status == Status::ok) put(w.answers, gap.distance);
                     return status;
                   }});
  calls.push_back({"nearest", [](auto& w) {
                     const double from[3] = {0, 0, 0};
                     std::span<const SceneDistance> found;
                     const Status status = w.queries.nearest(from, 10, 5.0).get(found);
                     for (const SceneDistance& one : found) w.answers.push_back(one.key.id);
                     return status;
                   }});
  calls.push_back({"clear", [](auto& w) {
                     w.scene.clear();
                     w.keys.clear();
                     return Status::ok;
                   }});
  calls.push_back({"add at the end", [](auto& w) { return w.add(0, 30); }});
  calls.push_back(
      {"contacts at the end", [](auto& w) { return w.collide(ContactLevel::manifold); }});
}

TEST(SceneRefusals, refused_memory_changes_nothing) {
  for (const int threads : {1, 2}) {
    for (const double cache_tolerance : {0.0, 0.01}) {
      if (threads != 1 && cache_tolerance != 0.0) continue;
      SCOPED_TRACE(testing::Message()
                   << threads << " threads, cache tolerance " << cache_tolerance);
      SceneCalls calls;
      add_scene_changes(calls);
      add_scene_queries(calls);
      const Execution execution = threads == 1 ? Execution::serial() : Execution::parallel();
      const auto refused =
          RefusedPlay<WholeWorld, Execution, double>(calls, threads, execution, cache_tolerance)
              .check();
      EXPECT_GT(refused, is_quick() ? 100U : 200U);
    }
  }
}

}  // namespace
}  // namespace winnow::test
