// Benchmarks of triangle meshes: builds, refits, rays, and collisions of two tori, with other
// libraries; depths of two solid tori; and of single queries on a heap of bodies.

#include "bench/micro/micro.h"

#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/scene_queries.h>
#include <winnow/pipeline/surfaces.h>
#include "bench/common/need.h"
#include "bench/common/random.h"
#include "bench/contenders/engines.h"
#include "bench/contenders/winnow_engines.h"
#include "bench/scenes/body_scenes.h"
#include "bench/scenes/random_shapes.h"

#include <winnow/simd/isa.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace winnow::bench::micro {
namespace {

constexpr std::size_t kRays = 4'000;
constexpr std::array kMeshNames{"terrain", "soup"};

/// A terrain, or random triangles in a cube, and rays at it. All numbers of rays are floats, which
/// some engines need.
struct MeshInput {
  Triangles mesh;
  std::vector<ShapeRay> rays;

  MeshInput(const std::string& name, std::size_t triangles) {
    const bool is_terrain = name == "terrain";
    const double cells = std::round(std::sqrt(static_cast<double>(triangles) / 2.0));
    mesh = is_terrain ? make_terrain(make_hills(static_cast<std::uint32_t>(cells), 1.0, 20.0, 1))
                      : make_soup(triangles, 1);
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& vertex : mesh.vertices) box.extend(vertex);
    const Eigen::Vector3d size = box.sizes();
    const double away = 0.5 * size.maxCoeff();
    Random random(2);
    // Rays start above a terrain, up to half its width, or outside one of the six sides of a soup.
    for (std::size_t i = 0; i < kRays; ++i) {
      const int axis = is_terrain ? 2 : static_cast<int>(random.below(3));
      const bool below = !is_terrain && random.below(2) == 0;
      Eigen::AlignedBox3d from = box;
      from.min()[axis] = below ? box.min()[axis] - away : box.max()[axis];
      from.max()[axis] = below ? box.min()[axis] : box.max()[axis] + away;
      Eigen::AlignedBox3d to(box.min() + 0.05 * size, box.max() - 0.05 * size);
      to.min()[axis] = below ? box.max()[axis] : box.min()[axis] - 0.1 * away;
      to.max()[axis] = to.min()[axis];
      rays.push_back(ray_between(random, from, to));
    }
  }

 private:
  static ShapeRay ray_between(Random& random, const Eigen::AlignedBox3d& from,
                              const Eigen::AlignedBox3d& to) {
    const Vec3f start = random.in(from.min(), from.max()).cast<float>();
    const Vec3f end = random.in(to.min(), to.max()).cast<float>();
    return {start.cast<double>(), (end - start).cast<double>()};
  }
};

/// A mesh of a name and size.
struct MeshName {
  std::string name;
  std::size_t triangles;

  [[nodiscard]] std::string path() const {
    return name + "/triangles:" + std::to_string(triangles);
  }
  [[nodiscard]] const MeshInput& input() const {
    return prepared<const MeshInput>(path(), name, triangles);
  }
};

using MakeRays = std::function<std::unique_ptr<RayEngine>()>;

RayEngine& started_rays(const MeshName& mesh, const std::string& name, const MakeRays& make) {
  return started<RayEngine>(mesh.path() + name, make, mesh.input().mesh);
}

/// Runs all rays and returns where they hit.
std::vector<double> hits_of(RayEngine& engine, const std::vector<ShapeRay>& rays,
                            RayQueryType query_type, QueryMode mode) {
  engine.take(rays);
  engine.run(query_type, mode);
  return engine.hits();
}

/// Counts the rays for which one has no hit, or t differs by more than the rounding of float.
std::size_t count_differing(const std::vector<double>& expected, const std::vector<double>& found) {
  std::size_t differ = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (expected[i] == found[i]) continue;
    if (!(std::abs(expected[i] - found[i]) <= 1e-4 * expected[i])) ++differ;
  }
  return differ;
}

void add_rays(const MeshName& mesh, const std::string& name, const MakeRays& make, bool is_peer) {
  static constexpr std::array kNames{"closest_ray", "any_ray", "all_rays"};
  for (const RayQueryType type : {RayQueryType::closest, RayQueryType::any, RayQueryType::all}) {
    for (const QueryMode mode : {QueryMode::single, QueryMode::batch}) {
      add(std::string("mesh/") + kNames[static_cast<std::size_t>(type)] + "/" + mesh.path() +
              (mode == QueryMode::single ? "/single/" : "/batch/") + name,
          [=](benchmark::State& state) {
            const std::vector<ShapeRay>& rays = mesh.input().rays;
            RayEngine& reference = started_rays(mesh, "winnow", make_winnow_rays);
            IsaGuard::choose(available_isas().front());
            const auto expected = hits_of(reference, rays, type, QueryMode::single);
            IsaGuard::choose(available_isas().back());
            RayEngine& engine = started_rays(mesh, name, make);
            const auto hits = hits_of(engine, rays, type, mode);
            const std::size_t differ = count_differing(expected, hits);
            check(is_peer || differ == 0, "other rays hit the mesh");
            run(state, 1, [&] { engine.run(type, mode); });
            count_ns(state, "ns_per_ray", rays.size());
            const auto is_hit = [](double t) { return std::isfinite(t); };
            count(state, "hits", static_cast<double>(std::ranges::count_if(hits, is_hit)));
            count(state, "differ", differ);
            if (engine.bytes() == 0) return;
            count(state, "bytes_per_triangle", engine.bytes(), mesh.input().mesh.size());
          });
    }
  }
}

void add_builds(const MeshName& mesh) {
  const auto count_mesh = [mesh](benchmark::State& state, const TriangleMesh& built) {
    const std::size_t triangles = mesh.input().mesh.size();
    count_ns(state, "ns_per_triangle", triangles);
    count(state, "bytes_per_triangle", built.footprint().total().used, triangles);
  };
  add("mesh/build/" + mesh.path() + "/winnow", [=](benchmark::State& state) {
    const Triangles& input = mesh.input().mesh;
    TriangleMesh built;
    run(state, 1, [&] { need(built.build(input.points(), input.indices()), "the mesh"); });
    count_mesh(state, built);
  });
  add("mesh/refit/" + mesh.path() + "/winnow", [=](benchmark::State& state) {
    const Triangles& input = mesh.input().mesh;
    TriangleMesh built;
    need(built.build(input.points(), input.indices()), "the mesh");
    run(state, 1, [&] { need(built.refit(input.points()), "the mesh"); });
    count_mesh(state, built);
  });
}

using MakeMesh = std::function<std::unique_ptr<MeshEngine>()>;

MeshEngine::TrianglePairs sorted(MeshEngine::TrianglePairs pairs) {
  std::ranges::sort(pairs);
  const auto rest = std::ranges::unique(pairs);
  pairs.erase(rest.begin(), rest.end());
  return pairs;
}

/// A pose of an upright copy of the torus, and the approximate number of pairs of triangles that
/// then intersect. From pose to pose the copy is farther from the axis of the torus.
struct TorusPose {
  std::size_t about;
  Pose pose;
};
constexpr double kHalf = 0.70710678118654752;
constexpr std::array<TorusPose, 4> kTorusPoses{{
    {73, {{1.195, 0.05, 0.02}, {kHalf, kHalf, 0.0, 0.0}}},
    {288, {{1.245, 0.05, 0.02}, {kHalf, kHalf, 0.0, 0.0}}},
    {472, {{1.397, 0.05, 0.02}, {kHalf, kHalf, 0.0, 0.0}}},
    {872, {{2.0, 0.05, 0.02}, {kHalf, kHalf, 0.0, 0.0}}},
}};

/// Two tori at a pose, from the build of the mesh to pairs of triangles.
void add_tori(const std::string& name, const MakeMesh& make) {
  const auto torus = []() -> const Triangles& {
    static const Triangles made = make_torus(100, 100, 1.0, 0.4);
    return made;
  };
  const auto built = [torus](const std::string& engine_name, const MakeMesh& make_engine) -> auto& {
    return prepared_by<MeshEngine>("torus " + engine_name, [&] {
      std::unique_ptr<MeshEngine> engine = make_engine();
      engine->build(torus());
      return engine;
    });
  };
  add("mesh/build/triangles:20000/" + name, [=](benchmark::State& state) {
    const auto engine = make();
    run(state, 1, [&] { engine->build(torus()); });
    count_ns(state, "ns_per_triangle", torus().size());
    count(state, "bytes_per_triangle", engine->bytes(), torus().size());
  });
  for (std::size_t p = 0; p < kTorusPoses.size(); ++p) {
    add("mesh/tori/pose:" + std::to_string(p + 1) + "/" + name, [=](benchmark::State& state) {
      const Pose& pose = kTorusPoses[p].pose;
      MeshEngine& reference = built("winnow", make_winnow_mesh);
      reference.collide(Pose{}, pose);
      const auto expected = sorted(reference.pairs());
      MeshEngine& engine = built(name, make);
      engine.collide(Pose{}, pose);
      const auto found = sorted(engine.pairs());
      MeshEngine::TrianglePairs differ;
      std::ranges::set_symmetric_difference(expected, found, std::back_inserter(differ));
      const double about = static_cast<double>(kTorusPoses[p].about);
      check(std::abs(static_cast<double>(expected.size()) - about) <= 0.5 * about,
            "another number of triangles");
      run(state, 1, [&] { engine.collide(Pose{}, pose); });
      count(state, "pairs", found.size());
      count(state, "differ", differ.size());
    });
  }
}

/// The penetration depth of two solid tori at a pose, from `rings` times `rings` quads each.
void add_solid_depth(std::uint32_t rings, std::size_t pose) {
  const std::size_t triangles = std::size_t{2} * rings * rings;
  add("mesh/solid_depth/triangles:" + std::to_string(triangles) +
          "/pose:" + std::to_string(pose + 1),
      [=](benchmark::State& state) {
        const Triangles torus = make_torus(rings, rings, 1.0, 0.4);
        ShapePool shapes;
        CompositePool meshes(shapes);
        const ShapeId id = need(meshes.add_mesh(torus.points(), torus.indices()), "the torus");
        need(meshes.set_solid(id), "the solid");
        Scene scene(shapes, {.execution = Execution::serial(), .composites = &meshes});
        const Key still = need(scene.add({.shape = id}), "a torus");
        const Key moved = need(scene.add({.shape = id, .pose = kTorusPoses[pose].pose}), "a torus");
        need(scene.refresh(), "the scene");
        SceneQueries queries(scene);
        const SceneDistance depth = need(queries.distance(still, moved), "the depth");
        check(depth.distance < 0.0, "the tori are apart");
        run(state, 1, [&] { benchmark::DoNotOptimize(queries.distance(still, moved)); });
        count_ns(state, "ns_per_pair", 1);
        state.counters["bound_width"] = depth.error_bound / -depth.distance;
      });
}

/// Bodies of one shape that lie about in hills, each at a random angle.
class BodiesOnTerrain {
 public:
  static constexpr std::size_t kBodies = 1'000;

  explicit BodiesOnTerrain(const std::string& shape)
      : shapes_{}, composites_(shapes_), body_(make_body(shape)) {
    const Heights hills = make_hills(200, 0.5, 2.0, 1);
    const Triangles terrain = make_terrain(hills);
    ground_ = need(composites_.add_mesh(terrain.points(), terrain.indices()), "the terrain");
    Random random(5);
    for (std::size_t i = 0; i < kBodies; ++i) {
      const double x = random.in(5.0, 95.0);
      const double y = random.in(5.0, 95.0);
      const Quaternion turn{1.0, random.in(-0.2, 0.2), random.in(-0.2, 0.2), random.in(-1.0, 1.0)};
      poses_.push_back({{x, y, hills.at(x, y) + 0.2}, turn});
    }
  }
  BodiesOnTerrain(const BodiesOnTerrain&) = delete;
  BodiesOnTerrain& operator=(const BodiesOnTerrain&) = delete;

  /// Calls visit(scene) with a scene of these bodies.
  template <typename Visit>
  void with_scene(bool part_manifolds, Visit&& visit) const {
    Scene scene(shapes_, {.execution = Execution::serial(),
                          .contact_margin = 0.02,
                          .part_manifolds = part_manifolds,
                          .composites = &composites_});
    need(scene.add({.shape = ground_, .state = BodyState::fixed}), "the ground");
    for (const Pose& pose : poses_) need(scene.add({.shape = body_, .pose = pose}), "a body");
    visit(scene);
  }

 private:
  [[nodiscard]] ShapeId make_body(const std::string& shape) {
    if (shape == "capsule") return need(shapes_.add(CapsuleShape{0.3, 0.4}), "the capsule");
    const ShapeId box = need(shapes_.add(BoxShape{{0.4, 0.4, 0.2}}), "the box");
    if (shape == "box") return box;
    std::vector<CompoundChild> children;
    for (int i = 0; i < 4; ++i) children.push_back({box, Pose::at(0.3 * i - 0.45, 0.0, 0.1 * i)});
    return need(composites_.add_compound(children), "the compound");
  }

  ShapePool shapes_;
  CompositePool composites_;
  ShapeId body_;
  ShapeId ground_;
  std::vector<Pose> poses_;
};

/// The contacts of bodies with a terrain: of regions, or of all pairs of parts.
void add_contacts(const std::string& shape, bool part_manifolds) {
  add("mesh/contacts/body:" + shape + (part_manifolds ? "/parts" : "/regions"),
      [=](benchmark::State& state) {
        const auto& bodies = prepared<const BodiesOnTerrain>("terrain " + shape, shape);
        bodies.with_scene(part_manifolds, [&](Scene& scene) {
          Contacts contacts;
          run(state, 1, [&] { need(scene.collide(ContactLevel::manifold, contacts), "contacts"); });
          check(contacts.points() > 0, "nothing touches");
          count_ns(state, "ns_per_body", BodiesOnTerrain::kBodies);
          count(state, "manifolds", contacts.manifolds(), BodiesOnTerrain::kBodies);
          count(state, "points", contacts.points(), BodiesOnTerrain::kBodies);
        });
      });
}

/// A heap of bodies, and places and shapes of queries.
struct QueryScene {
  static constexpr std::size_t kBodies = 2'000;
  static constexpr std::size_t kQueries = 500;

  std::unique_ptr<BodySet> set = make_heap(kBodies, 1);
  Scene scene{set->pool, {.execution = Execution::serial()}};
  std::vector<Key> keys = add_bodies(*set, scene);
  std::vector<ShapeRay> rays;
  std::vector<Pose> starts;
  std::vector<Pose> ends;

  QueryScene() {
    need(scene.refresh(), "the scene");
    Random random(3);
    for (std::size_t i = 0; i < kQueries; ++i) {
      const auto body = random.below(static_cast<std::uint32_t>(kBodies));
      starts.push_back(set->poses[body]);
      ends.push_back(set->poses[random.below(static_cast<std::uint32_t>(kBodies))]);
      starts.back().position += random.in_cube(-1.0, 1.0);
      const Vec3d from = starts.back().position;
      rays.push_back({from, ends.back().position - from});
    }
  }
};

/// A query about place i, which returns a number that depends on its results.
using SceneQuery = std::function<double(const QueryScene&, SceneQueries&, std::size_t i)>;

/// Registers a query, whose results must be equal on all instruction sets.
void add_scene_query(const std::string& name, const SceneQuery& query) {
  add("scene/" + name + "/bodies:" + std::to_string(QueryScene::kBodies),
      [=](benchmark::State& state) {
        const auto& scene = prepared<const QueryScene>("queries");
        SceneQueries queries(scene.scene);
        std::vector<double> results[2];
        for (const std::size_t which : {0, 1}) {
          IsaGuard::choose(which == 0 ? available_isas().front() : available_isas().back());
          for (std::size_t i = 0; i < QueryScene::kQueries; ++i) {
            results[which].push_back(query(scene, queries, i));
          }
        }
        check(results[0] == results[1], "the results depend on the instruction set");
        double found = 0.0;
        for (const double one : results[0]) found += one != 0.0 ? 1.0 : 0.0;
        check(found > 0.0, "nothing was found");
        run(state, 1, [&] {
          for (std::size_t i = 0; i < QueryScene::kQueries; ++i) {
            benchmark::DoNotOptimize(query(scene, queries, i));
          }
        });
        count_ns(state, "ns_per_query", QueryScene::kQueries);
        count(state, "found", found / static_cast<double>(QueryScene::kQueries));
      });
}

double number_of(const SceneHit& hit) {
  return hit ? 1.0 + hit.t + hit.key.id : 0.0;
}

}  // namespace

void add_meshes() {
  for (const std::string name : kMeshNames) {
    for (const std::size_t triangles : {std::size_t{100'000}, std::size_t{500'000}}) {
      const MeshName mesh{name, triangles};
      add_rays(mesh, "winnow", make_winnow_rays, false);
      each_peer<RayEngine>([&](const RayEngine& peer, const MakeRays& make) {
        add_rays(mesh, word_of(peer.name()), make, true);
      });
      add_builds(mesh);
    }
  }
  add_tori("winnow", make_winnow_mesh);
  each_peer<MeshEngine>(
      [](const MeshEngine& peer, const MakeMesh& make) { add_tori(word_of(peer.name()), make); });
  for (const std::uint32_t rings : {10U, 100U}) {
    for (std::size_t pose = 0; pose < kTorusPoses.size(); ++pose) add_solid_depth(rings, pose);
  }
  for (const char* const shape : {"box", "capsule", "compound"}) {
    for (const bool part_manifolds : {false, true}) add_contacts(shape, part_manifolds);
  }
}

void add_scenes() {
  add_scene_query("closest_ray", [](const QueryScene& scene, SceneQueries& queries, std::size_t i) {
    const SceneHit hit = need(queries.closest(scene.rays[i]), "a ray");
    return number_of(hit);
  });
  add_scene_query("any_ray", [](const QueryScene& scene, SceneQueries& queries, std::size_t i) {
    const SceneHit hit = need(queries.any(scene.rays[i]), "a ray");
    return hit ? 1.0 : 0.0;
  });
  add_scene_query("all_rays", [](const QueryScene& scene, SceneQueries& queries, std::size_t i) {
    const std::span<const SceneHit> hits = need(queries.all(scene.rays[i]), "a ray");
    double sum = 0.0;
    for (const SceneHit& hit : hits) sum += number_of(hit);
    return sum;
  });
  add_scene_query("overlap", [](const QueryScene& scene, SceneQueries& queries, std::size_t i) {
    const std::span<const SceneOverlap> bodies =
        need(queries.overlap(scene.set->shapes[i], scene.starts[i]), "a shape");
    double sum = 0.0;
    for (const SceneOverlap& body : bodies) sum += 1.0 + body.key.id;
    return sum;
  });
  add_scene_query("crossings", [](const QueryScene& scene, SceneQueries& queries, std::size_t i) {
    const std::span<const SceneCrossing> points = need(queries.crossings(scene.rays[i]), "a ray");
    double sum = 0.0;
    for (const SceneCrossing& point : points) sum += 1.0 + point.t + point.key.id;
    return sum;
  });
  add_scene_query("distances", [](const QueryScene& scene, SceneQueries& queries, std::size_t i) {
    const std::span<const SceneDistance> bodies =
        need(queries.distances(scene.set->shapes[i], scene.starts[i]), "a shape");
    double sum = 0.0;
    for (const SceneDistance& body : bodies) sum += 1.0 + body.distance + body.key.id;
    return sum;
  });
  add_scene_query("shape_cast", [](const QueryScene& scene, SceneQueries& queries, std::size_t i) {
    ShapeCast cast{.shape = scene.set->shapes[i], .pose = scene.starts[i]};
    cast.direction = scene.rays[i].direction;
    const SceneHit hit = need(queries.closest(cast), "a shape cast");
    return number_of(hit);
  });
  add_scene_query("motion_cast", [](const QueryScene& scene, SceneQueries& queries, std::size_t i) {
    const MotionCast cast{.shape = scene.set->shapes[i],
                          .motion = RigidMotion::between(scene.starts[i], scene.ends[i])};
    const SceneHit hit = need(queries.closest(cast), "a motion cast");
    return number_of(hit);
  });
  add_scene_query("distance", [](const QueryScene& scene, SceneQueries& queries, std::size_t i) {
    const SceneDistance answer = need(
        queries.distance(scene.keys[i], scene.keys[QueryScene::kBodies - 1 - i]), "a distance");
    return answer.distance;
  });
  add_scene_query("nearest_4", [](const QueryScene& scene, SceneQueries& queries, std::size_t i) {
    constexpr double kAnyDistance = std::numeric_limits<double>::infinity();
    const std::span<const SceneDistance> bodies =
        need(queries.nearest(scene.starts[i].position, 4, kAnyDistance), "a point");
    double sum = 0.0;
    for (const SceneDistance& body : bodies) sum += 1.0 + body.distance + body.key.id;
    return sum;
  });
}

}  // namespace winnow::bench::micro
