// winnow's engines for scenes of bodies and for triangle meshes.

#include "bench/contenders/winnow_engines.h"

#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/contacts.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/scene_queries.h>
#include <winnow/pipeline/surfaces.h>
#include "bench/common/need.h"
#include "bench/contenders/partitions.h"

#include <array>
#include <limits>
#include <optional>
#include <vector>

namespace winnow::bench {
namespace {

class WinnowScene final : public SceneEngine {
 public:
  WinnowScene(int threads, const WinnowSceneOptions& options)
      : execution_(execution_for(threads)), options_(options) {}

  [[nodiscard]] std::string name() const override {
    return caches_contacts() ? "winnow, carrying over" : "winnow";
  }
  [[nodiscard]] bool caches_contacts() const override { return options_.cache_tolerance > 0.0; }

  void start(const BodySet& set) override {
    composites_.emplace(set.pool);
    scene_.emplace(set.pool, SceneOptions{.execution = execution_,
                                          .contact_margin = options_.contact_margin,
                                          .cache_tolerance = options_.cache_tolerance,
                                          .composites = &*composites_});
    keys_ = add_bodies(set, *scene_);
    if (set.mesh.size() == 0) return;
    BodyDefinition terrain;
    terrain.state = BodyState::fixed;
    terrain.shape = need(composites_->add_mesh(set.mesh.points(), set.mesh.indices()), "the mesh");
    need(scene_->add(terrain), "the mesh");
  }

  void frame(std::span<const Pose> poses) override {
    need(scene_->move(keys_, poses), "poses");
    need(scene_->collide(options_.level, contacts_), "contacts");
  }

  [[nodiscard]] SceneFinds finds() const override { return {contacts_.size(), contacts_.points()}; }
  [[nodiscard]] std::size_t bytes() const override {
    return scene_->footprint().total().reserved + contacts_.footprint().total().reserved;
  }

 private:
  Execution execution_;
  WinnowSceneOptions options_;
  std::optional<CompositePool> composites_;
  std::optional<Scene> scene_;
  std::vector<Key> keys_;
  Contacts contacts_;
};

class WinnowMesh final : public MeshEngine {
 public:
  WinnowMesh()
      : composites_(shapes_),
        scene_(shapes_, {.execution = Execution::serial(), .composites = &composites_}) {}

  [[nodiscard]] std::string name() const override { return "winnow"; }

  void build(const Triangles& mesh) override {
    need(mesh_.build(mesh.points(), mesh.indices()), "the mesh");
    triangles_ = &mesh;
  }

  [[nodiscard]] std::size_t bytes() const override { return mesh_.footprint().total().used; }

  void collide(const Pose& a, const Pose& b) override {
    if (keys_.empty()) add_bodies();
    poses_ = {a, b};
    need(scene_.move(keys_, poses_), "poses");
    need(scene_.collide(ContactLevel::manifold, contacts_), "contacts");
  }

  // A contact may stand for several pairs of triangles: level boolean lists them all.
  [[nodiscard]] TrianglePairs pairs() const override {
    Scene scene(shapes_, {.execution = Execution::serial(), .composites = &composites_});
    std::vector<Key> keys(2);
    need(scene.add(bodies_, keys), "two bodies");
    need(scene.move(keys, poses_), "poses");
    Contacts contacts;
    need(scene.collide(ContactLevel::boolean, contacts), "pairs of triangles");
    TrianglePairs pairs;
    for (std::size_t m = 0; m < contacts.manifolds(); ++m) {
      pairs.emplace_back(contacts.part_a()[m], contacts.part_b()[m]);
    }
    return pairs;
  }

 private:
  void add_bodies() {
    bodies_.resize(2);
    bodies_[0].shape =
        need(composites_.add_mesh(triangles_->points(), triangles_->indices()), "the mesh");
    bodies_[1].shape = bodies_[0].shape;
    keys_.resize(2);
    need(scene_.add(bodies_, keys_), "two bodies");
  }

  ShapePool shapes_;
  CompositePool composites_;
  Scene scene_;
  Contacts contacts_;
  TriangleMesh mesh_;
  const Triangles* triangles_ = nullptr;
  std::vector<BodyDefinition> bodies_;
  std::array<Pose, 2> poses_;
  std::vector<Key> keys_;
};

class WinnowRays final : public RayEngine {
 public:
  [[nodiscard]] std::string name() const override { return "winnow"; }

  void start(const Triangles& mesh) override {
    const ShapeId shape = need(composites_.add_mesh(mesh.points(), mesh.indices()), "the mesh");
    need(scene_.add({.shape = shape, .state = BodyState::fixed}), "the body");
    need(scene_.refresh(), "the scene");
  }

  [[nodiscard]] std::size_t bytes() const override { return composites_.footprint().total().used; }

  void take(std::span<const ShapeRay> rays) override {
    rays_ = rays;
    key_.assign(rays.size(), Key{});
    t_.assign(rays.size(), 0.0);
  }

  void run(RayQueryType query_type, QueryMode mode) override {
    query_type_ = query_type;
    if (mode == QueryMode::batch) {
      run_batch();
    } else {
      for (std::size_t i = 0; i < rays_.size(); ++i) run_one(i);
    }
  }

  [[nodiscard]] std::vector<double> hits() const override {
    std::vector<double> result(rays_.size(), std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < result.size(); ++i) {
      if (key_[i] != Key{}) result[i] = query_type_ == RayQueryType::any ? 0.0 : t_[i];
    }
    return result;
  }

 private:
  void put(std::size_t i, const SceneHit& hit) {
    key_[i] = hit.key;
    t_[i] = hit.t;
  }

  void run_one(std::size_t i) {
    if (query_type_ == RayQueryType::all) {
      const std::span<const SceneHit> hits = need(queries_.all(rays_[i]), "a ray");
      return put(i, hits.empty() ? SceneHit{} : hits.front());
    }
    const bool any = query_type_ == RayQueryType::any;
    put(i, need(any ? queries_.any(rays_[i]) : queries_.closest(rays_[i]), "a ray"));
  }

  void run_batch() {
    const SceneHitColumns columns{.key = key_.data(), .t = t_.data()};
    switch (query_type_) {
      case RayQueryType::closest:
        return need(queries_.closest(rays_, columns), "rays");
      case RayQueryType::any:
        return need(queries_.any(rays_, columns), "rays");
      case RayQueryType::all:
        break;
    }
    const SceneHitLists lists = need(queries_.all(rays_), "rays");
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      put(i, lists.first[i] == lists.first[i + 1] ? SceneHit{} : lists.hits[lists.first[i]]);
    }
  }

  ShapePool shapes_;
  CompositePool composites_{shapes_};
  Scene scene_{shapes_, {.composites = &composites_}};
  SceneQueries queries_{scene_};
  std::span<const ShapeRay> rays_;
  RayQueryType query_type_ = RayQueryType::closest;
  std::vector<Key> key_;
  std::vector<double> t_;
};

}  // namespace

std::unique_ptr<SceneEngine> make_winnow_scene(int threads, const WinnowSceneOptions& options) {
  return std::make_unique<WinnowScene>(threads, options);
}

std::unique_ptr<MeshEngine> make_winnow_mesh() {
  return std::make_unique<WinnowMesh>();
}

std::unique_ptr<RayEngine> make_winnow_rays() {
  return std::make_unique<WinnowRays>();
}

}  // namespace winnow::bench
