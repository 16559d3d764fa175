#include "bench/contenders/engines.h"
#include "bench/peers/fcl_shapes.h"
#include "bench/peers/registry.h"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>

#include <string>

namespace winnow::bench {
namespace {

using namespace in_fcl;

using Object = fcl::CollisionObject<double>;
using Mesh = fcl::BVHModel<fcl::OBBRSS<double>>;

/// Above the number of contacts of any pair.
constexpr std::size_t kMaxContacts = 100'000;

std::shared_ptr<Mesh> make_model(const Triangles& triangles) {
  auto model = std::make_shared<Mesh>();
  std::vector<fcl::Triangle> corners;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const std::uint32_t* c = &triangles.corners[3 * i];
    corners.emplace_back(c[0], c[1], c[2]);
  }
  model->beginModel(static_cast<int>(triangles.size()),
                    static_cast<int>(triangles.vertices.size()));
  model->addSubModel(std::vector<Vector>(triangles.vertices.begin(), triangles.vertices.end()),
                     corners);
  model->endModel();
  return model;
}

/// FCL in double, the type that its library is built for: its dynamic AABB tree, and collide() with
/// all contacts; meshes have OBBRSS trees. It keeps no data per pair.
class FclScene final : public SceneEngine {
 public:
  [[nodiscard]] std::string name() const override { return "FCL"; }
  [[nodiscard]] bool caches_contacts() const override { return false; }

  void start(const BodySet& set) override {
    for (std::size_t i = 0; i < set.poses.size(); ++i) {
      objects_.push_back(std::make_unique<Object>(make_geometry(set.pool.tables(), set.shapes[i]),
                                                  transform_of(set.poses[i])));
      moving_.registerObject(objects_.back().get());
    }
    moving_.setup();
    if (set.mesh.size() == 0) return;
    terrain_ = std::make_unique<Object>(make_model(set.mesh));
    terrain_->computeAABB();
  }

  void frame(std::span<const Pose> poses) override {
    for (std::size_t i = 0; i < poses.size(); ++i) {
      objects_[i]->setTransform(transform_of(poses[i]));
      objects_[i]->computeAABB();
    }
    moving_.update();
    finds_ = {};
    moving_.collide(this, &FclScene::collide_pair);
    if (terrain_ != nullptr) moving_.collide(terrain_.get(), this, &FclScene::collide_pair);
  }

  [[nodiscard]] SceneFinds finds() const override { return finds_; }

 private:
  static bool collide_pair(Object* a, Object* b, void* data) {
    auto& scene = *static_cast<FclScene*>(data);
    const fcl::CollisionRequest<double> request(kMaxContacts, true);
    scene.result_.clear();
    fcl::collide(a, b, request, scene.result_);
    scene.finds_.touching += scene.result_.isCollision() ? 1 : 0;
    scene.finds_.points += scene.result_.numContacts();
    return false;
  }

  std::vector<std::unique_ptr<Object>> objects_;
  std::unique_ptr<Object> terrain_;
  fcl::DynamicAABBTreeCollisionManager<double> moving_;
  fcl::CollisionResult<double> result_;
  SceneFinds finds_;
};

class FclMesh final : public MeshEngine {
 public:
  [[nodiscard]] std::string name() const override { return "FCL OBBRSS"; }

  void build(const Triangles& mesh) override { model_ = make_model(mesh); }

  [[nodiscard]] std::size_t bytes() const override {
    const auto count = [](int n) { return static_cast<std::size_t>(n); };
    return count(model_->num_vertices) * sizeof(Vector) +
           count(model_->num_tris) * (sizeof(fcl::Triangle) + sizeof(unsigned)) +
           count(model_->getNumBVs()) * sizeof(fcl::BVNode<fcl::OBBRSS<double>>);
  }

  void collide(const Pose& a, const Pose& b) override {
    const fcl::CollisionRequest<double> request(kMaxContacts, true);
    result_.clear();
    fcl::collide(model_.get(), transform_of(a), model_.get(), transform_of(b), request, result_);
  }

  [[nodiscard]] TrianglePairs pairs() const override {
    TrianglePairs pairs;
    for (std::size_t i = 0; i < result_.numContacts(); ++i) {
      const fcl::Contact<double>& contact = result_.getContact(i);
      pairs.emplace_back(static_cast<std::uint32_t>(contact.b1),
                         static_cast<std::uint32_t>(contact.b2));
    }
    return pairs;
  }

 private:
  std::shared_ptr<Mesh> model_;
  fcl::CollisionResult<double> result_;
};

const RegisteredPeer<SceneEngine, FclScene> kFclScene;
const RegisteredPeer<MeshEngine, FclMesh> kFclMesh;

}  // namespace
}  // namespace winnow::bench
