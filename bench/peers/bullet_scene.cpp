#include "bench/contenders/engines.h"
#include "bench/peers/bullet_shapes.h"
#include "bench/peers/registry.h"

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btTriangleIndexVertexArray.h>

#include <string>

namespace winnow::bench {
namespace {

using namespace in_bullet;

/// Margin of hulls, which are shrunk by it: GJK then suffices for shallow contacts, and EPA is
/// needed only for deep ones. Also the margin of boxes in the trees.
constexpr btScalar kMargin = 0.005F;

/// Bullet 3 in float: a btCollisionWorld over btDbvtBroadphase with its default algorithms and
/// margins; meshes are btBvhTriangleMeshShape with quantised nodes. It always keeps pairs and
/// manifolds between frames.
class BulletScene final : public SceneEngine {
 public:
  BulletScene()
      : dispatcher_(&configuration_), world_(&dispatcher_, &broadphase_, &configuration_) {
    broadphase_.m_deferedcollide = true;
  }
  ~BulletScene() override {
    // Removes the pairs first: removing an object searches all pairs in the cache.
    btOverlappingPairCache& pairs = *broadphase_.getOverlappingPairCache();
    for (int last = pairs.getNumOverlappingPairs() - 1; last >= 0; --last) {
      const btBroadphasePair pair = pairs.getOverlappingPairArray()[last];
      pairs.removeOverlappingPair(pair.m_pProxy0, pair.m_pProxy1, &dispatcher_);
    }
    for (btCollisionObject& object : objects_) world_.removeCollisionObject(&object);
    if (has_terrain_) world_.removeCollisionObject(&terrain_);
  }

  [[nodiscard]] std::string name() const override { return "Bullet"; }
  [[nodiscard]] bool caches_contacts() const override { return true; }

  void start(const BodySet& set) override {
    gDbvtMargin = kMargin;  // a global of Bullet; another engine may have changed it
    objects_.resize(set.poses.size());
    for (std::size_t i = 0; i < set.poses.size(); ++i) {
      shapes_.push_back(make_shape(set.pool.tables(), set.shapes[i], static_cast<double>(kMargin)));
      objects_[i].setCollisionShape(shapes_.back().get());
      objects_[i].setCollisionFlags(0);
      objects_[i].setWorldTransform(transform_of(set.poses[i]));
      world_.addCollisionObject(&objects_[i], btBroadphaseProxy::DefaultFilter,
                                btBroadphaseProxy::AllFilter);
    }
    if (set.mesh.size() != 0) add_terrain(set.mesh);
  }

  void frame(std::span<const Pose> poses) override {
    for (std::size_t i = 0; i < poses.size(); ++i) {
      objects_[i].setWorldTransform(transform_of(poses[i]));
    }
    world_.performDiscreteCollisionDetection();
  }

  [[nodiscard]] SceneFinds finds() const override {
    SceneFinds finds;
    for (int i = 0; i < dispatcher_.getNumManifolds(); ++i) {
      const btPersistentManifold& manifold = *dispatcher_.getManifoldByIndexInternal(i);
      std::size_t points = 0;
      for (int p = 0; p < manifold.getNumContacts(); ++p) {
        points += manifold.getContactPoint(p).getDistance() <= 0 ? 1 : 0;
      }
      finds.touching += points > 0 ? 1 : 0;
      finds.points += points;
    }
    return finds;
  }

 private:
  void add_terrain(const Triangles& mesh) {
    for (const Eigen::Vector3d& v : mesh.vertices) {
      for (int axis = 0; axis < 3; ++axis) vertices_.push_back(static_cast<float>(v[axis]));
    }
    corners_.assign(mesh.corners.begin(), mesh.corners.end());
    triangles_ = std::make_unique<btTriangleIndexVertexArray>(
        static_cast<int>(mesh.size()), corners_.data(), static_cast<int>(3 * sizeof(int)),
        static_cast<int>(mesh.vertices.size()), vertices_.data(),
        static_cast<int>(3 * sizeof(float)));
    shapes_.push_back(std::make_unique<btBvhTriangleMeshShape>(triangles_.get(), true));
    terrain_.setCollisionShape(shapes_.back().get());
    terrain_.setCollisionFlags(btCollisionObject::CF_STATIC_OBJECT);
    world_.addCollisionObject(&terrain_, btBroadphaseProxy::StaticFilter,
                              btBroadphaseProxy::AllFilter ^ btBroadphaseProxy::StaticFilter);
    has_terrain_ = true;
  }

  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btCollisionWorld world_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<btCollisionObject> objects_;
  std::vector<float> vertices_;
  std::vector<int> corners_;
  std::unique_ptr<btTriangleIndexVertexArray> triangles_;
  btCollisionObject terrain_;
  bool has_terrain_ = false;
};

const RegisteredPeer<SceneEngine, BulletScene> kBulletScene;

}  // namespace
}  // namespace winnow::bench
