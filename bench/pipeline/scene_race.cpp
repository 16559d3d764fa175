#include "pipeline/scene_race.h"

#include "engine/timed.h"

#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/contacts.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/triangle_mesh.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <stdexcept>

namespace winnow::bench {
namespace {

constexpr std::size_t kWarming = 2;

void need(Status status, const char* what) {
  if (status != Status::ok) {
    throw std::runtime_error(std::string(what) + ": " + to_string(status));
  }
}

Execution execution_for(int threads) {
  return threads == 1 ? Execution::serial() : Execution::parallel();
}

std::span<const Eigen::Vector3d> vertices_of(const Triangles& mesh) {
  return mesh.vertices;
}
std::span<const std::uint32_t> corners_of(const Triangles& mesh) {
  return mesh.corners;
}

class WinnowScene final : public SceneEngine {
 public:
  WinnowScene(int threads, double carry_over, ContactLevel level)
      : execution_(execution_for(threads)), carry_over_(carry_over), level_(level) {}

  [[nodiscard]] std::string name() const override {
    return carry_over_ > 0.0 ? "winnow, carrying over" : "winnow";
  }
  [[nodiscard]] bool carries_over() const override { return carry_over_ > 0.0; }

  void start(const BodySet& set) override {
    composites_.emplace(set.pool);
    scene_.emplace(set.pool, SceneOptions{.execution = execution_,
                                          .carry_over = carry_over_,
                                          .composites = &*composites_});
    std::vector<BodyDefinition> bodies(set.poses.size());
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      bodies[i].shape = set.shapes[i];
      bodies[i].pose = set.poses[i];
    }
    keys_.resize(bodies.size());
    need(scene_->add(bodies, keys_), "the bodies");
    if (set.mesh.size() == 0) return;
    BodyDefinition terrain;
    terrain.motion = Motion::fixed;
    need(composites_->add_mesh(vertices_of(set.mesh), corners_of(set.mesh), terrain.shape),
         "the mesh");
    Key key;
    need(scene_->add(terrain, key), "the mesh");
  }

  void frame(std::span<const Pose> poses) override {
    need(scene_->move(keys_, poses), "poses");
    need(scene_->collide(level_, contacts_), "contacts");
  }

  [[nodiscard]] SceneFinds finds() const override { return {contacts_.size(), contacts_.points()}; }

 private:
  Execution execution_;
  double carry_over_;
  ContactLevel level_;
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
    need(mesh_.build(vertices_of(mesh), corners_of(mesh)), "the mesh");
    triangles_ = &mesh;
  }

  [[nodiscard]] std::size_t bytes() const override { return mesh_.footprint().total().used; }

  void collide(const Pose& a, const Pose& b) override {
    if (keys_.empty()) add_bodies();
    const Pose poses[] = {a, b};
    need(scene_.move(keys_, poses), "poses");
    need(scene_.collide(ContactLevel::manifold, contacts_), "contacts");
  }

  [[nodiscard]] TrianglePairs pairs() const override {
    TrianglePairs pairs;
    for (std::size_t m = 0; m < contacts_.manifolds(); ++m) {
      pairs.emplace_back(contacts_.part_a()[m], contacts_.part_b()[m]);
    }
    return pairs;
  }

 private:
  void add_bodies() {
    std::vector<BodyDefinition> bodies(2);
    need(composites_.add_mesh(vertices_of(*triangles_), corners_of(*triangles_), bodies[0].shape),
         "the mesh");
    bodies[1].shape = bodies[0].shape;
    keys_.resize(2);
    need(scene_.add(bodies, keys_), "two bodies");
  }

  ShapePool shapes_;
  CompositePool composites_;
  Scene scene_;
  Contacts contacts_;
  TriangleMesh mesh_;
  const Triangles* triangles_ = nullptr;
  std::vector<Key> keys_;
};

/// Makes every pair of both lists single first.
std::size_t count_differing(MeshEngine::TrianglePairs& a, MeshEngine::TrianglePairs& b) {
  for (MeshEngine::TrianglePairs* pairs : {&a, &b}) {
    std::sort(pairs->begin(), pairs->end());
    pairs->erase(std::unique(pairs->begin(), pairs->end()), pairs->end());
  }
  MeshEngine::TrianglePairs differ;
  std::set_symmetric_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(differ));
  return differ.size();
}

}  // namespace

std::unique_ptr<SceneEngine> make_winnow_scene(int threads, double carry_over, ContactLevel level) {
  return std::make_unique<WinnowScene>(threads, carry_over, level);
}

std::unique_ptr<MeshEngine> make_winnow_mesh() {
  return std::make_unique<WinnowMesh>();
}

std::vector<SceneTiming> race_scene(const BodySet& set, const Stray& by,
                                    std::span<SceneContender> contenders, std::size_t frames) {
  int most_threads = 1;
  std::vector<SceneTiming> timings;
  for (const SceneContender& contender : contenders) {
    most_threads = std::max(most_threads, contender.threads);
    timings.push_back({.engine = contender.engine->name(), .threads = contender.threads});
  }
  Arenas arenas(most_threads);
  for (const SceneContender& contender : contenders) contender.engine->start(set);
  std::vector<Pose> poses;
  for (std::size_t f = 0; f < frames + kWarming; ++f) {
    stray(set, by, f, poses);
    for (std::size_t i = 0; i < contenders.size(); ++i) {
      SceneEngine& engine = *contenders[i].engine;
      const double ms = timed(contenders[i].threads, arenas, [&] { engine.frame(poses); });
      if (f >= kWarming) timings[i].ms.push_back(ms);
    }
  }
  for (std::size_t i = 0; i < contenders.size(); ++i) {
    timings[i].finds = contenders[i].engine->finds();
  }
  return timings;
}

std::vector<MeshTiming> race_meshes(std::span<const std::unique_ptr<MeshEngine>> engines,
                                    std::size_t rounds) {
  const Triangles torus = make_race_torus();
  Arenas arenas(1);
  std::vector<MeshTiming> timings(engines.size());
  for (std::size_t round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < engines.size(); ++i) {
      timings[i].engine = engines[i]->name();
      timings[i].build_ms.push_back(timed(1, arenas, [&] { engines[i]->build(torus); }));
    }
  }
  for (std::size_t p = 0; p < torus_poses().size(); ++p) {
    MeshEngine::TrianglePairs expected;
    for (std::size_t round = 0; round < rounds + kWarming; ++round) {
      for (std::size_t i = 0; i < engines.size(); ++i) {
        const double ms =
            timed(1, arenas, [&] { engines[i]->collide(Pose{}, torus_poses()[p].pose); });
        if (round >= kWarming) timings[i].collide_ms[p].push_back(ms);
      }
    }
    for (std::size_t i = 0; i < engines.size(); ++i) {
      MeshEngine::TrianglePairs found = engines[i]->pairs();
      if (i == 0) expected = found;
      timings[i].differ[p] = count_differing(expected, found);
      timings[i].pairs[p] = found.size();
      timings[i].bytes_per_triangle =
          static_cast<double>(engines[i]->bytes()) / static_cast<double>(torus.size());
    }
  }
  return timings;
}

}  // namespace winnow::bench
