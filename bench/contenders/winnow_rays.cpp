#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/scene_queries.h>
#include "bench/common/need.h"
#include "bench/contenders/ray_engine.h"

#include <limits>

namespace winnow::bench {
namespace {

class WinnowRays final : public RayEngine {
 public:
  [[nodiscard]] std::string name() const override { return "winnow"; }

  void start(const Triangles& mesh) override {
    ShapeId shape;
    need(composites_.add_mesh(mesh.points(), mesh.indices(), shape), "the mesh");
    Key key;
    need(scene_.add({.shape = shape, .state = BodyState::fixed}, key), "the body");
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
    SceneHit hit;
    std::span<const SceneHit> hits;
    Status status = Status::ok;
    if (query_type_ == RayQueryType::all) {
      status = queries_.all(rays_[i], hits);
      if (!hits.empty()) hit = hits.front();
    } else {
      status = query_type_ == RayQueryType::any ? queries_.any(rays_[i], hit)
                                                : queries_.closest(rays_[i], hit);
    }
    need(status, "a ray");
    put(i, hit);
  }

  void run_batch() {
    const SceneHitColumns columns{.key = key_.data(), .t = t_.data()};
    SceneHitLists lists;
    switch (query_type_) {
      case RayQueryType::closest:
        return need(queries_.closest(rays_, columns), "rays");
      case RayQueryType::any:
        return need(queries_.any(rays_, columns), "rays");
      case RayQueryType::all:
        break;
    }
    need(queries_.all(rays_, lists), "rays");
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

std::unique_ptr<RayEngine> make_winnow_rays() {
  return std::make_unique<WinnowRays>();
}

}  // namespace winnow::bench
