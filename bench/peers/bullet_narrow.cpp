// Adapter of Bullet's narrow phase: picks, for each pair of kinds and level, the fastest of
// Bullet's algorithms, and converts its result. It registers itself in registry.h.

#include "bench/contenders/engines.h"
#include "bench/peers/bullet_shapes.h"
#include "bench/peers/narrow_adapter.h"
#include "bench/peers/registry.h"

#include <BulletCollision/CollisionDispatch/SphereTriangleDetector.h>
#include <BulletCollision/CollisionDispatch/btBoxBoxDetector.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionDispatch/btSphereBoxCollisionAlgorithm.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpa2.h>

#include <algorithm>
#include <string>

namespace winnow::bench {
namespace {

using namespace in_bullet;

/// A threshold above every distance, so that algorithms report the distance of every pair.
constexpr btScalar kFar = 1e9F;

/// Margins are 0 if they would enlarge the shape or round its corners.
std::unique_ptr<btCollisionShape> make_bare_shape(const ShapeTables& tables, ShapeId id) {
  if (id.kind() == ShapeKind::half_space) {
    return make_plane(tables.half_spaces[id.index()]);
  }
  std::unique_ptr<btConvexShape> shape = make_shape(tables, id, 0.0);
  if (id.kind() != ShapeKind::sphere && id.kind() != ShapeKind::capsule) shape->setMargin(0);
  if (id.kind() == ShapeKind::hull) {
    static_cast<btConvexHullShape&>(*shape).initializePolyhedralFeatures();
  }
  return shape;
}

/// Receives the points that an algorithm or detector reports, and keeps the deepest.
class Report final : public btManifoldResult {
 public:
  Report(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b, btScalar far)
      : btManifoldResult(a, b) {
    m_closestPointDistanceThreshold = far;
  }

  void addContactPoint(const btVector3& normal_on_b, const btVector3& on_b,
                       btScalar distance) override {
    if (distance >= distance_) return;
    distance_ = distance;
    normal_on_b_ = normal_on_b;
    on_b_ = on_b;
  }

  [[nodiscard]] btScalar distance() const { return distance_; }
  [[nodiscard]] btVector3 normal_on_a() const { return -normal_on_b_; }
  [[nodiscard]] btVector3 on_a() const { return on_b_ + normal_on_b_ * distance_; }

 private:
  btScalar distance_ = kFar;
  btVector3 normal_on_b_{0, 0, 0};
  btVector3 on_b_{0, 0, 0};
};

/// Bullet in float. Manifolds: the algorithm that its dispatcher picks for the kinds (or the one
/// for spheres and boxes, which the dispatcher has but does not pick), into an empty manifold.
/// Verdicts and distances: closed forms if Bullet has them, otherwise GJK and EPA of
/// btGjkEpaSolver2; btGjkPairDetector is slower (measured by bench/micro). Verdicts of boxes:
/// its SAT.
class BulletNarrow final : public NarrowAdapter<BulletNarrow> {
 public:
  BulletNarrow() : dispatcher_(&configuration_) {}
  ~BulletNarrow() override {
    if (algorithm_ != nullptr) {
      algorithm_->~btCollisionAlgorithm();
      dispatcher_.freeCollisionAlgorithm(algorithm_);
    }
    if (manifold_ != nullptr) dispatcher_.releaseManifold(manifold_);
  }

  [[nodiscard]] std::string name() const override { return "Bullet"; }

  [[nodiscard]] static PairFunction pair_function(const PairKind& kind, ContactLevel level) {
    using enum ShapeKind;
    // A scaled btMultiSphereShape does not help: it has other support points than an ellipsoid.
    if (kind.a == ellipsoid || kind.b == ellipsoid) return nullptr;
    if (level == ContactLevel::manifold) return &BulletNarrow::manifold;
    const bool verdict = level == ContactLevel::boolean;
    if (kind.b == sphere || kind.b == capsule) return &BulletNarrow::closed;
    if (kind.a == sphere && kind.b == box) return &BulletNarrow::ball_in_box;
    if (kind.b == half_space) return &BulletNarrow::over_plane;
    if (kind.a == sphere && kind.b == triangle) return &BulletNarrow::ball_on_triangle;
    if (kind.a == box && kind.b == box && verdict) return &BulletNarrow::axes;
    return verdict ? &BulletNarrow::gjk_verdict : &BulletNarrow::gjk_distance;
  }

  void start(const PairSet& set) override {
    set_kind(set.kind);
    std::vector<btCollisionShape*> hulls(
        set.pool.tables().count[static_cast<int>(ShapeKind::hull)]);
    objects_.resize(set.poses.size());
    for (std::size_t i = 0; i < set.poses.size(); ++i) {
      const ShapeId id = set.shapes[i];
      btCollisionShape* shape = id.kind() == ShapeKind::hull ? hulls[id.index()] : nullptr;
      if (shape == nullptr) {
        shapes_.push_back(make_bare_shape(set.pool.tables(), id));
        shape = shapes_.back().get();
        if (id.kind() == ShapeKind::hull) hulls[id.index()] = shape;
      }
      objects_[i].setCollisionShape(shape);
      objects_[i].setWorldTransform(transform_of(set.poses[i]));
    }
    if (!set.pairs.empty()) make_algorithm(set.kind, set.pairs.front());
  }

 private:
  struct Wrapped {
    explicit Wrapped(const btCollisionObject& object)
        : wrapper(nullptr, object.getCollisionShape(), &object, object.getWorldTransform(), -1,
                  -1) {}
    btCollisionObjectWrapper wrapper;
  };

  template <typename Shape>
  [[nodiscard]] const Shape& shape_of(std::uint32_t body) const {
    return *static_cast<const Shape*>(objects_[body].getCollisionShape());
  }

  void make_algorithm(const PairKind& kind, const BodyPair& pair) {
    const Wrapped a(objects_[pair.a]);
    const Wrapped b(objects_[pair.b]);
    manifold_ = dispatcher_.getNewManifold(&objects_[pair.a], &objects_[pair.b]);
    if (kind.a == ShapeKind::sphere && kind.b == ShapeKind::box) {
      btSphereBoxCollisionAlgorithm::CreateFunc make;
      btCollisionAlgorithmConstructionInfo info(&dispatcher_, 1);
      algorithm_ = make.CreateCollisionAlgorithm(info, &a.wrapper, &b.wrapper);
    } else {
      algorithm_ =
          dispatcher_.findAlgorithm(&a.wrapper, &b.wrapper, manifold_, BT_CONTACT_POINT_ALGORITHMS);
    }
    // Some algorithms use a manifold of their own.
    btManifoldArray own;
    algorithm_->getAllContactManifolds(own);
    written_ = own.size() > 0 ? own[0] : manifold_;
  }

  void manifold(const BodyPair& pair, NarrowAnswer& answer) {
    const Wrapped a(objects_[pair.a]);
    const Wrapped b(objects_[pair.b]);
    btManifoldResult result(&a.wrapper, &b.wrapper);
    written_->clearManifold();
    written_->setBodies(&objects_[pair.a], &objects_[pair.b]);
    result.setPersistentManifold(written_);
    algorithm_->processCollision(&a.wrapper, &b.wrapper, info_, &result);
    answer = {};
    for (int i = 0; i < written_->getNumContacts(); ++i) {
      const btManifoldPoint& point = written_->getContactPoint(i);
      if (point.getDistance() > 0) continue;
      ++answer.contacts;
      if (answer.overlap && static_cast<double>(point.getDistance()) >= answer.distance) continue;
      answer.overlap = true;
      answer.distance = static_cast<double>(point.getDistance());
      answer.normal = -point.m_normalWorldOnB;
    }
  }

  /// Returns the distance above which an algorithm needs to report nothing.
  [[nodiscard]] btScalar farthest() const { return only_verdicts() ? 0 : kFar; }

  void write(btScalar distance, const btVector3& to_b, const btVector3& on_a,
             NarrowAnswer& answer) const {
    answer.overlap = distance <= 0;
    if (only_verdicts()) return;
    answer.distance = static_cast<double>(distance);
    answer.normal = to_b;
    answer.point = on_a;
  }
  void write(const Report& report, NarrowAnswer& answer) const {
    write(report.distance(), report.normal_on_a(), report.on_a(), answer);
  }

  void closed(const BodyPair& pair, NarrowAnswer& answer) {
    const Wrapped a(objects_[pair.a]);
    const Wrapped b(objects_[pair.b]);
    Report report(&a.wrapper, &b.wrapper, farthest());
    written_->setBodies(&objects_[pair.a], &objects_[pair.b]);
    report.setPersistentManifold(written_);
    algorithm_->processCollision(&a.wrapper, &b.wrapper, info_, &report);
    write(report, answer);
  }

  void ball_in_box(const BodyPair& pair, NarrowAnswer& answer) {
    const Wrapped box(objects_[pair.b]);
    btVector3 on_box;
    btVector3 normal;
    btScalar depth = kFar;
    auto& algorithm = static_cast<btSphereBoxCollisionAlgorithm&>(*algorithm_);
    const bool found = algorithm.getSphereDistance(
        &box.wrapper, on_box, normal, depth, objects_[pair.a].getWorldTransform().getOrigin(),
        shape_of<btSphereShape>(pair.a).getRadius(), farthest());
    write(found ? depth : kFar, -normal, on_box + normal * depth, answer);
  }

  void detect(btDiscreteCollisionDetectorInterface& detector, const BodyPair& pair,
              NarrowAnswer& answer) const {
    btDiscreteCollisionDetectorInterface::ClosestPointInput input;
    input.m_transformA = objects_[pair.a].getWorldTransform();
    input.m_transformB = objects_[pair.b].getWorldTransform();
    Report report(nullptr, nullptr, 0);
    detector.getClosestPoints(input, report, nullptr);
    write(report, answer);
  }

  void ball_on_triangle(const BodyPair& pair, NarrowAnswer& answer) {
    auto* ball = const_cast<btSphereShape*>(&shape_of<btSphereShape>(pair.a));
    auto* triangle = const_cast<btTriangleShape*>(&shape_of<btTriangleShape>(pair.b));
    SphereTriangleDetector detector(ball, triangle, farthest());
    detect(detector, pair, answer);
  }

  /// Finds the lowest point, as btConvexPlaneCollisionAlgorithm does.
  void over_plane(const BodyPair& pair, NarrowAnswer& answer) {
    const auto& plane = shape_of<btStaticPlaneShape>(pair.b);
    const btTransform& a = objects_[pair.a].getWorldTransform();
    const btTransform& b = objects_[pair.b].getWorldTransform();
    const btVector3 normal = b.getBasis() * plane.getPlaneNormal();
    const btVector3 lowest =
        a(shape_of<btConvexShape>(pair.a).localGetSupportingVertex(-normal * a.getBasis()));
    const btScalar distance = normal.dot(lowest - b.getOrigin()) - plane.getPlaneConstant();
    write(distance, -normal, lowest, answer);
  }

  void axes(const BodyPair& pair, NarrowAnswer& answer) {
    btBoxBoxDetector detector(&shape_of<btBoxShape>(pair.a), &shape_of<btBoxShape>(pair.b));
    detect(detector, pair, answer);
  }

  /// Returns the radius around the core, which a capsule has.
  [[nodiscard]] btScalar rounding_of(std::uint32_t body) const {
    return shape_of<btConvexShape>(body).getMargin();
  }

  bool gjk(const BodyPair& pair, btGjkEpaSolver2::sResults& results) const {
    const btTransform& a = objects_[pair.a].getWorldTransform();
    const btTransform& b = objects_[pair.b].getWorldTransform();
    return btGjkEpaSolver2::Distance(&shape_of<btConvexShape>(pair.a), a,
                                     &shape_of<btConvexShape>(pair.b), b,
                                     b.getOrigin() - a.getOrigin(), results);
  }

  void gjk_verdict(const BodyPair& pair, NarrowAnswer& answer) {
    btGjkEpaSolver2::sResults results;
    answer.overlap =
        !gjk(pair, results) || results.distance <= rounding_of(pair.a) + rounding_of(pair.b);
  }

  void gjk_distance(const BodyPair& pair, NarrowAnswer& answer) {
    btGjkEpaSolver2::sResults results;
    const btScalar rounding = rounding_of(pair.a) + rounding_of(pair.b);
    btScalar distance = -kFar;
    btVector3 to_b(0, 0, 0);
    btVector3 on_a(0, 0, 0);
    if (gjk(pair, results)) {
      to_b = (results.witnesses[1] - results.witnesses[0]).normalized();
      on_a = results.witnesses[0] + to_b * rounding_of(pair.a);
      distance = results.distance - rounding;
    } else {
      const btTransform& a = objects_[pair.a].getWorldTransform();
      const btTransform& b = objects_[pair.b].getWorldTransform();
      btGjkEpaSolver2::Penetration(&shape_of<btConvexShape>(pair.a), a,
                                   &shape_of<btConvexShape>(pair.b), b,
                                   b.getOrigin() - a.getOrigin(), results);
      // The normal is in the axes of a.
      to_b = a.getBasis() * -results.normal;
      on_a = results.witnesses[0];
      distance = results.distance;
    }
    write(distance, to_b, on_a, answer);
  }

  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDispatcherInfo info_;
  btCollisionAlgorithm* algorithm_ = nullptr;
  btPersistentManifold* manifold_ = nullptr;
  btPersistentManifold* written_ = nullptr;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<btCollisionObject> objects_;
};

const RegisteredPeer<NarrowEngine, BulletNarrow> kBulletNarrow;

}  // namespace
}  // namespace winnow::bench
