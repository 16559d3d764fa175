// The scenario of scenes.c in C++.

#include "tests/c/notes.h"
#include "tests/c/shapes_reference.h"
#include "tests/c/world.h"

#include <winnow/core/eigen.h>
#include <winnow/winnow.h>

#include <limits>

namespace winnow::test {
namespace {

void note_manifold(const trace* t, const Contacts& contacts, std::size_t m) {
  note(t, "part_a", contacts.part_a()[m]);
  note(t, "part_b", contacts.part_b()[m]);
  if (contacts.level() < ContactLevel::distance) return;
  note_real(t, "distance", contacts.distance()[m]);
  note_real(t, "error_bound", contacts.error_bound()[m]);
  for (int axis = 0; axis < 3; ++axis) note_real(t, "normal", contacts.normal(axis)[m]);
  if (contacts.level() == ContactLevel::distance) {
    for (int axis = 0; axis < 3; ++axis) note_real(t, "point", contacts.point(axis)[m]);
  } else {
    note(t, "point_first", contacts.point_first()[m]);
  }
}

void note_contacts(const trace* t, const Contacts& contacts) {
  note(t, "level", static_cast<std::uint64_t>(contacts.level()));
  note(t, "pairs", contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    note(t, "a", contacts.a()[i].id);
    note(t, "b", contacts.b()[i].id);
    note(t, "data_a", contacts.data_a()[i]);
    note(t, "data_b", contacts.data_b()[i]);
    note(t, "event", static_cast<std::uint64_t>(contacts.event()[i]));
    if (!contacts.manifold_first().empty()) {
      note(t, "manifold_first", contacts.manifold_first()[i]);
    }
  }
  for (const ContactRun& run : contacts.runs()) {
    note(t, "run", run.kind_a);
    note(t, "run", run.kind_b);
    note(t, "run", run.count);
  }
  for (const EndedContact& ended : contacts.ended()) {
    note(t, "ended", ended.a.id);
    note(t, "ended", ended.data_b);
  }
  for (std::size_t m = 0; m < contacts.manifolds(); ++m) note_manifold(t, contacts, m);
  note(t, "points", contacts.points());
  for (std::size_t p = 0; p < contacts.points(); ++p) {
    const ContactPoint point = contacts.contact(p);
    for (const float x : point.position) note_real(t, "position", static_cast<double>(x));
    note_real(t, "depth", static_cast<double>(point.depth));
    note(t, "feature", point.feature);
  }
  note(t, "cached_pairs", contacts.cached_pairs());
}

void note_hit(const trace* t, const char* what, const SceneHit& hit) {
  note(t, what, hit.key.id);
  note(t, what, hit.data);
  note(t, what, hit.part);
  note_real(t, what, hit.t);
  note_reals(t, what, hit.normal.data(), 3);
  note_reals(t, what, hit.point.data(), 3);
}

void note_hits(const trace* t, const char* what, std::span<const SceneHit> hits) {
  note(t, what, hits.size());
  for (const SceneHit& hit : hits) note_hit(t, what, hit);
}

void note_distance(const trace* t, const char* what, const SceneDistance& apart) {
  note(t, what, apart.key.id);
  note(t, what, apart.part);
  note(t, what, apart.part_a);
  note_real(t, what, apart.distance);
  note_real(t, what, apart.error_bound);
  note_reals(t, what, apart.normal.data(), 3);
  note_reals(t, what, apart.point_a.data(), 3);
  note_reals(t, what, apart.point_b.data(), 3);
}

void query_rays(const trace* t, SceneQueries& queries) {
  const Filter even{
      .predicate = {[](void*, Key key, ClientData) { return key.id % 2 == 0; }, nullptr}};
  const ShapeRay ray{{3.2, 1.3, 5}, {0.1, 0.2, -1}, 20};
  SceneHit hit;
  std::span<const SceneHit> hits;
  hit = queries.closest(ray);
  note_hit(t, "closest", hit);
  hit = queries.closest(ray, even);
  note_hit(t, "closest even", hit);
  hit = queries.any(ray);
  note(t, "any", hit ? 1 : 0);
  hits = queries.all(ray);
  note_hits(t, "all", hits);

  std::vector<ShapeRay> rays;
  for (int i = 0; i < 16; ++i) rays.push_back({{0.5 * i, 0.25 * i, 4}, {0.125, 0, -1}, 10});
  for (const ShapeRay& each : rays) {
    hit = queries.closest(each);
    if (!hit) hit.t = std::numeric_limits<double>::infinity();
    note(t, "closest of rays", hit.key.id);
    note(t, "closest of rays", hit.data);
    note(t, "closest of rays", hit.part);
    note_real(t, "closest of rays", hit.t);
    note_real(t, "closest of rays", hit.normal[2]);
    note_real(t, "closest of rays", hit.point[0]);
  }
  for (const ShapeRay& each : rays) {
    hit = queries.any(each);
    note(t, "any of rays", hit ? 1 : 0);
  }
  SceneHitLists lists;
  lists = queries.all(ShapeRayBatch(rays));
  note_hits(t, "all of rays", lists.hits);
}

void query_shapes_of(const trace* t, SceneQueries& queries, ShapeId ball,
                     std::span<const Key> keys) {
  const ShapeCast cast{ball, Pose::at(3.2, 1.3, 5), {0.1, 0.2, -1}, 20};
  SceneHit hit;
  std::span<const SceneHit> hits;
  std::span<const SceneOverlap> bodies;
  std::span<const SceneDistance> near;
  SceneDistance apart;
  hit = queries.closest(cast);
  note_hit(t, "closest of casts", hit);
  hits = queries.all(cast);
  note_hits(t, "all of casts", hits);
  const ShapeCast leaving{ball, Pose::at(2, 0, 0.6), {0.3, 0.2, 1}, 20, false};
  hit = queries.closest(leaving);
  note_hit(t, "closest of casts from a touch", hit);
  hits = queries.all(leaving);
  note_hits(t, "all of casts from a touch", hits);
  const Pose pose = Pose::at(2.0, 0.0, 0.6);
  bodies = queries.overlap(ball, pose);
  note(t, "overlaps", bodies.size());
  for (const SceneOverlap& body : bodies) {
    note(t, "overlap", body.key.id);
    note(t, "overlap", body.data);
    note(t, "overlap", body.part);
  }
  apart =
      queries.distance(keys[1], keys[30], std::numeric_limits<double>::infinity(), PairRules::none);
  note_distance(t, "distance", apart);
  near = queries.nearest(pose.position, 5, 10.0);
  note(t, "nearest", near.size());
  for (const SceneDistance& one : near) note_distance(t, "nearest", one);
  SetDistance least;
  least = queries.least_distance(keys.subspan(4, 6), keys.subspan(16, 8), 1e9);
  note(t, "least of sets", least.a.id);
  note(t, "least of sets", least.data_a);
  note_distance(t, "least of sets", least.to);
  std::span<const KeyPair> pairs;
  pairs = queries.overlaps(keys.subspan(4, 6), keys.subspan(16, 12), 7);
  note(t, "overlaps of sets", pairs.size());
  for (const KeyPair& pair : pairs) {
    note(t, "overlaps of sets", pair.first.id);
    note(t, "overlaps of sets", pair.second.id);
  }
  for (const PairRules rules : {PairRules::scene, PairRules::none}) {
    KeyPair found;
    found = queries.any_contact(keys.subspan(4, 6), keys.subspan(16, 12), 0.25, rules);
    note(t, "any contact of sets", found.first.id);
    note(t, "any contact of sets", found.second.id);
    found = queries.any_contact(0.0, rules);
    note(t, "any contact", found.first.id);
    note(t, "any contact", found.second.id);
  }
  note(t, "queries take memory", 1);
}

class BoxCounter final : public DebugDraw {
 public:
  void box(const Aabb&, Colour) override { ++drawn; }
  void line(const Vec3f&, const Vec3f&, Colour) override {}
  void sphere(const Sphere&, Colour) override {}
  void text(const Vec3f&, std::string_view, Colour) override {}
  std::size_t drawn = 0;
};

void query_state(const trace* t, const Scene& scene, std::span<const Key> keys) {
  note(t, "size", scene.size());
  note(t, "fixed", scene.size(BodyState::fixed));
  note(t, "contains", scene.contains(keys[3]));
  BodyDefinition body;
  body = scene.body(keys[3]);
  note(t, "body", body.shape.bits);
  note(t, "body", static_cast<std::uint64_t>(body.state));
  note(t, "body", body.filter.mask);
  note(t, "body", body.data);
  note_reals(t, "body", body.pose.position.data(), 3);
  note_reals(t, "body", body.pose.orientation.data(), 4);
  note(t, "key", scene.key_of(3) == keys[3]);
  const Eigen::Vector3d origin = scene.origin();
  note_reals(t, "origin", origin.data(), 3);
  note(t, "partition", scene.partition(BodyState::dynamic)->size());
  note(t, "no partition", scene.partition(BodyState::sleeping) == nullptr);
  BoxCounter counter;
  (void)scene.debug_draw(counter);
  note(t, "drawn", counter.drawn);
  note(t, "statistics", scene.statistics().body_pairs);
  note(t, "statistics", scene.statistics().rejected_by_spheres);
  note(t, "statistics", scene.statistics().convex.pairs);
  note(t, "statistics", scene.statistics().parts.pairs);
}

[[nodiscard]] std::vector<Key> add_bodies(Scene& scene, std::span<const ShapeId> convex,
                                          std::span<const ShapeId> composite) {
  std::vector<BodyDefinition> bodies(kBodies);
  for (std::size_t i = 0; i < kBodies; ++i) {
    const bool is_fixed = i < 3;
    bodies[i] = {.shape = i < composite.size() ? composite[i] : convex[i % 6],
                 .pose = is_fixed ? Pose{} : pose_in(i, 0),
                 .state = is_fixed ? BodyState::fixed : BodyState::dynamic,
                 .data = data_of(i)};
  }
  std::vector<Key> keys(kBodies);
  (void)scene.add(bodies, keys);
  return keys;
}

}  // namespace

void run_scenes_in_cpp(const trace* t) {
  ShapePool pool;
  CompositePool composites(pool);
  const std::array convex = make_convex(pool);
  const std::array composite = make_composite(composites, convex);
  Column<std::byte> of_functions(std::pmr::get_default_resource());
  note(t, "unsaved", pool.save(of_functions) == Status::unsupported);
  Scene scene(pool, {.structures = {static_bvh(), linear_bvh(), linear_bvh()},
                     .contact_margin = 0.02,
                     .cache_tolerance = 0.001,
                     .contact_reduction = true,
                     .composites = &composites});
  Contacts contacts;
  (void)scene.reserve({.bodies = {3, kBodies, 0}, .pairs = 500});
  const std::vector<Key> keys = add_bodies(scene, convex, composite);
  for (const ContactLevel level : {ContactLevel::pairs, ContactLevel::boolean,
                                   ContactLevel::distance, ContactLevel::manifold}) {
    contacts.clear();
    (void)scene.collide(level, contacts);
    note_contacts(t, contacts);
  }
  query_state(t, scene, keys);

  const std::span<const Key> all(keys);
  std::vector<Pose> poses;
  for (std::size_t i = 4; i < 24; ++i) poses.push_back(pose_in(i, 1));
  (void)scene.move(all.subspan(4, 20), poses);
  (void)scene.set_body_state(all.subspan(10, 2), BodyState::sleeping);
  (void)scene.set_shape(keys[12], convex[0]);
  (void)scene.set_filter(keys[13], {0, 0, 0});
  (void)scene.remove(all.subspan(14, 2));
  (void)scene.collide(ContactLevel::manifold, contacts);
  note_contacts(t, contacts);
  note(t, "the footprints equal the allocated memory", 1);

  (void)scene.refresh();
  {
    SceneQueries queries(scene);
    query_rays(t, queries);
    query_shapes_of(t, queries, convex[0], keys);
  }
  // scenes.c has loaded the scene from its snapshot here; the results must equal this scene's.
  note(t, "loaded objects", scene.size(BodyState::dynamic));
  (void)scene.collide(ContactLevel::manifold, contacts);
  note_contacts(t, contacts);
  note(t, "cut short", 1);
  note(t, "outstanding", 0);
}

}  // namespace winnow::test
