// The works of each phase, and the list of all works.

#include <algorithm>

#include "tests/digests/digest.h"

namespace winnow::test {
namespace {

/// Returns cubes of `sizes` different sizes.
std::vector<Aabb> boxes(std::size_t count, std::uint64_t seed, std::size_t sizes = 4) {
  Numbers numbers(seed);
  std::vector<Aabb> boxes(count);
  for (Aabb& box : boxes) {
    const auto size = static_cast<float>(1U << numbers.below(sizes)) * 0.5F;
    for (int k = 0; k < 3; ++k) {
      box.min[k] = static_cast<float>(numbers.coordinate(16));
      box.max[k] = box.min[k] + size;
    }
  }
  return boxes;
}

void add(Digest& digest, const PairBuffer& pairs) {
  for (const Pair& pair : pairs) digest.add(std::uint64_t{pair.first} << 32U | pair.second);
}
void add(Digest& digest, std::span<const Hit> hits) {
  for (const Hit& hit : hits) {
    digest.add(std::uint64_t{hit.key.id});
    digest.add(static_cast<double>(hit.t));
  }
}

/// Digests the pairs in the order in which they are found: first of all objects, then after some or
/// all objects have moved.
void pairs_of(std::vector<Aabb> given, StructureKind structure, const Execution& execution,
              Digest& digest) {
  Partition partition(structure, {.execution = execution});
  std::vector<Key> keys(given.size());
  bool good = partition.insert(given, {}, keys) == Status::ok;
  PairBuffer found;
  Numbers numbers(2);
  for (int frame = 0; frame < 4; ++frame) {
    good = good && partition.self_pairs(found) == Status::ok;
    add(digest, found);
    for (std::size_t i = numbers.below(7); i < given.size(); i += frame == 2 ? 1 : 19) {
      for (int k = 0; k < 3; ++k) {
        const auto step = static_cast<float>(numbers.coordinate(1));
        given[i].min[k] += step;
        given[i].max[k] += step;
      }
      good = good && partition.update(keys[i], given[i]) == Status::ok;
    }
  }
  digest.add(good ? 1.0 : 0.0);
}

/// Digests pairs of cubes of four sizes, some of which grids store in a tree, and pairs of cubes of
/// one size.
void pairs(StructureKind structure, const Execution& execution, Digest& digest) {
  const std::size_t count = structure == n_squared() ? 60 : 1500;
  pairs_of(boxes(count, 1), structure, execution, digest);
  pairs_of(boxes(count, 1, 1), structure, execution, digest);
}

void queries(StructureKind structure, const Execution& execution, Digest& digest) {
  Partition partition(structure, {.execution = execution});
  const std::vector<Aabb> given = boxes(1000, 3);
  std::vector<Key> keys(given.size());
  bool good = partition.insert(given, {}, keys) == Status::ok;
  Numbers numbers(4);
  std::vector<Ray> rays(60);
  for (Ray& ray : rays) {
    for (int k = 0; k < 3; ++k) {
      ray.origin[k] = static_cast<float>(numbers.coordinate(32));
      ray.direction[k] = static_cast<float>(numbers.coordinate(1));
    }
  }
  HitBuffer hits;
  good = good && partition.all(RayBatch(rays), hits) == Status::ok;
  add(digest, hits.hits());
  for (const Ray& ray : rays) {
    good =
        good && partition.all(SphereCast{{ray.origin, 0.75F}, ray.direction}, hits) == Status::ok;
    add(digest, hits.hits());
    OverlapBuffer objects;
    good = good && partition.overlap(Sphere{ray.origin, 4.0F}, objects) == Status::ok;
    for (const ObjectId id : objects.ids()) digest.add(std::uint64_t{id});
    good = good && partition.nearest({ray.origin, ray.origin}, 9, 50.0F, hits) == Status::ok;
    add(digest, hits.hits());
  }
  digest.add(good ? 1.0 : 0.0);
}

std::vector<ShapeId> shapes(ShapePool& pool, Digest& digest) {
  std::vector<ShapeId> ids(8);
  const std::vector<Vec3d> corners{{1, 0, 0},  {-1, 0, 0}, {0, 0.75, 0},
                                   {0, -1, 0}, {0, 0, 1},  {0, 0, -0.5}};
  const std::vector<std::uint32_t> loops{0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4,
                                         2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
  const std::vector<std::uint32_t> sizes(8, 3);
  const Status answers[] = {
      pool.add(SphereShape{0.5}).get(ids[0]),
      pool.add(CapsuleShape{0.25, 0.75}).get(ids[1]),
      pool.add(BoxShape{{0.5, 0.75, 1.0}}).get(ids[2]),
      pool.add(CylinderShape{0.5, 0.5}).get(ids[3]),
      pool.add(ConeShape{0.5, 0.75, 0.125}).get(ids[4]),
      pool.add_hull(corners, {loops, sizes}, 0.0).get(ids[5]),
      pool.add(TriangleShape{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0.25}}}).get(ids[6]),
      pool.add(HalfSpaceShape{{0.25, 0.5, 1}, -1.0}).get(ids[7]),
  };
  for (const Status status : answers) digest.add(static_cast<std::uint64_t>(status));
  return ids;
}

void narrow(NarrowTier tier, const Execution& execution, Digest& digest) {
  ShapePool pool;
  const std::vector<ShapeId> ids = shapes(pool, digest);
  Numbers numbers(5);
  std::vector<ShapeId> bodies;
  std::vector<Pose> poses;
  std::vector<BodyPair> body_pairs;
  for (std::size_t i = 0; i < 64 * 20; ++i) {
    bodies.insert(bodies.end(), {ids[i % 8], ids[i / 8 % 8]});
    for (int k = 0; k < 2; ++k) poses.push_back(numbers.pose(1));
    const auto n = static_cast<std::uint32_t>(bodies.size());
    body_pairs.push_back({n - 2, n - 1});
  }
  NarrowPhase phase;
  NarrowResult result;
  for (const ContactLevel level :
       {ContactLevel::boolean, ContactLevel::distance, ContactLevel::manifold}) {
    const Status status = phase.collide(
        pool, {bodies, poses}, body_pairs,
        {.level = level, .tier = tier, .contact_margin = 0.125, .execution = execution}, result);
    digest.add(static_cast<std::uint64_t>(status));
    digest.add(phase.statistics());
    for (std::size_t i = 0; i < result.size(); ++i) {
      digest.add(std::uint64_t{result.pair_of(i)} * 2U + (result.overlaps(i) ? 1U : 0U));
      if (level == ContactLevel::boolean) continue;
      digest.add(result.distance()[i]);
      digest.add(result.error_bound()[i]);
      for (int k = 0; k < 3; ++k) digest.add(result.normal(k)[i]);
    }
    for (std::size_t i = 0; i < result.contacts(); ++i) {
      const ContactPoint point = result.contact(i);
      for (const float x : point.position) digest.add(static_cast<double>(x));
      digest.add(static_cast<double>(point.depth));
      digest.add(point.feature);
    }
  }
}

void query(const Scene& scene, Numbers& numbers, Digest& digest) {
  SceneQueries questions(scene);
  for (int i = 0; i < 40; ++i) {
    ShapeRay ray;
    ray.max_t = 100.0;
    for (double& x : ray.origin) x = numbers.coordinate(8);
    for (double& x : ray.direction) x = numbers.coordinate(1);
    std::span<const SceneHit> hits;
    digest.add(static_cast<std::uint64_t>(questions.all(ray).get(hits)));
    for (const SceneHit& hit : hits) {
      digest.add(hit.data);
      digest.add(hit.t);
    }
    std::span<const SceneDistance> near;
    digest.add(static_cast<std::uint64_t>(questions.nearest(ray.origin, 5, 10.0).get(near)));
    for (const SceneDistance& one : near) {
      digest.add(one.data);
      digest.add(one.distance);
    }
  }
}

void scene(const Execution& execution, Digest& digest) {
  ShapePool pool;
  CompositePool composites(pool);
  std::vector<ShapeId> ids = shapes(pool, digest);
  ids.pop_back();
  Numbers numbers(6);
  std::vector<Vec3f> points;
  std::vector<std::uint32_t> corners;
  for (std::uint32_t i = 0; i < 60; ++i) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      // In separate statements: the evaluation order of arguments is unspecified.
      Vec3f& point = points.emplace_back();
      for (const int axis : {2, 1, 0}) point[axis] = static_cast<float>(numbers.coordinate(2));
      corners.push_back(3 * i + k);
    }
  }
  ids.emplace_back();
  digest.add(static_cast<std::uint64_t>(
      composites.add_mesh(std::span(std::as_const(points)), std::span(std::as_const(corners)))
          .get(ids.back())));
  Scene world(pool, {.execution = execution,
                     .contact_margin = 0.0625,
                     .part_manifolds = true,
                     .composites = &composites});
  std::vector<Key> keys(160);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const BodyDefinition body{.shape = ids[i % ids.size()],
                              .pose = numbers.pose(4),
                              .state = static_cast<BodyState>(i % 11 == 0 ? 0 : 1),
                              .data = i};
    digest.add(static_cast<std::uint64_t>(world.add(body).get(keys[i])));
  }
  Contacts contacts;
  for (int frame = 0; frame < 3; ++frame) {
    digest.add(static_cast<std::uint64_t>(world.collide(ContactLevel::manifold, contacts)));
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      digest.add(contacts.data_a()[i] << 32U | contacts.data_b()[i]);
      digest.add(static_cast<std::uint64_t>(contacts.event()[i]));
    }
    for (std::size_t m = 0; m < contacts.manifolds(); ++m) {
      digest.add(std::uint64_t{contacts.part_a()[m]} << 32U | contacts.part_b()[m]);
      digest.add(contacts.distance()[m]);
    }
    const SceneStatistics& counts = world.statistics();
    for (const std::uint64_t number :
         {counts.boxes_updated, counts.body_pairs, counts.rejected_by_spheres, counts.cached_pairs,
          counts.primitive_pairs}) {
      digest.add(number);
    }
    digest.add(counts.convex);
    digest.add(counts.parts);
    for (std::size_t p = 0; p < contacts.points(); ++p) digest.add(contacts.contact(p).feature);
    for (std::size_t i = 0; i < keys.size(); i += 3) {
      digest.add(static_cast<std::uint64_t>(world.move(keys[i], numbers.pose(4))));
    }
  }
  digest.add(static_cast<std::uint64_t>(world.refresh()));
  query(world, numbers, digest);
}

}  // namespace

std::vector<Work> all_work() {
  std::vector<Work> work;
  for (const StructureKind kind : all_structures()) {
    const std::string name(kind.name());
    work.push_back({"pairs/" + name, [kind](const Execution& e, Digest& d) { pairs(kind, e, d); }});
    work.push_back(
        {"queries/" + name, [kind](const Execution& e, Digest& d) { queries(kind, e, d); }});
  }
  for (const NarrowTier tier : {NarrowTier::robust, NarrowTier::reference}) {
    constexpr const char* kNames[] = {"narrow/robust", "narrow/reference"};
    work.push_back({kNames[static_cast<std::size_t>(tier)],
                    [tier](const Execution& e, Digest& d) { narrow(tier, e, d); }});
  }
  work.push_back({"scene", scene});
  for (const auto& more : {shape_works(), refresh_works()}) {
    work.insert(work.end(), more.begin(), more.end());
  }
  return work;
}

}  // namespace winnow::test
