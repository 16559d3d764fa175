#pragma once

#include "bench/peers/narrow_adapter.h"
#include "bench/scenes/lens.h"

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btConeShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btConvexInternalShape.h>
#include <BulletCollision/CollisionShapes/btCylinderShape.h>
#include <BulletCollision/CollisionShapes/btMultiSphereShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <BulletCollision/CollisionShapes/btTriangleShape.h>

#include <algorithm>
#include <memory>

/// Conversion of shapes and poses to Bullet's types, in float.
namespace winnow::bench::in_bullet {

inline btVector3 to_bullet(const Vec3d& v) {
  return {static_cast<btScalar>(v[0]), static_cast<btScalar>(v[1]), static_cast<btScalar>(v[2])};
}

inline btTransform transform_of(const Pose& pose) {
  const Eigen::Quaternionf q = orientation_of(pose).cast<float>();
  return btTransform(btQuaternion(q.x(), q.y(), q.z(), q.w()), to_bullet(pose.position));
}

inline std::unique_ptr<btStaticPlaneShape> make_plane(const HalfSpaceShape& half) {
  return std::make_unique<btStaticPlaneShape>(to_bullet(half.normal),
                                              static_cast<btScalar>(half.offset));
}

/// A user shape as Bullet's custom convex shape.
class LensShape final : public btConvexInternalShape {
 public:
  explicit LensShape(const Lens& lens) : lens_(lens) {
    m_shapeType = CUSTOM_CONVEX_SHAPE_TYPE;
    setMargin(0);
  }

  btVector3 localGetSupportingVertexWithoutMargin(const btVector3& along) const override {
    const double length = static_cast<double>(along.length());
    const double direction[3] = {static_cast<double>(along.x()), static_cast<double>(along.y()),
                                 length > 0.0 ? static_cast<double>(along.z()) : 1.0};
    double point[3];
    farthest_of_lens(lens_, direction, point);
    return to_bullet(point);
  }
  void batchedUnitVectorGetSupportingVertexWithoutMargin(const btVector3* along, btVector3* points,
                                                         int count) const override {
    for (int i = 0; i < count; ++i) points[i] = localGetSupportingVertexWithoutMargin(along[i]);
  }
  void calculateLocalInertia(btScalar, btVector3& inertia) const override {
    inertia.setValue(0, 0, 0);
  }
  const char* getName() const override { return "Lens"; }

 private:
  const Lens& lens_;
};

/// Makes a shape. Hulls are shrunk by `hull_margin` and then get it as margin. The margin of a
/// tapered capsule is its smaller radius, which Bullet subtracts from both radii.
inline std::unique_ptr<btConvexShape> make_shape(const ShapeTables& tables, ShapeId id,
                                                 double hull_margin) {
  const std::uint32_t i = id.index();
  switch (id.kind()) {
    case ShapeKind::sphere:
      return std::make_unique<btSphereShape>(static_cast<btScalar>(tables.spheres[i].radius));
    case ShapeKind::capsule:
      return std::make_unique<btCapsuleShapeZ>(
          static_cast<btScalar>(tables.capsules[i].radius),
          static_cast<btScalar>(2.0 * tables.capsules[i].half_length));
    case ShapeKind::box:
      return std::make_unique<btBoxShape>(to_bullet(tables.boxes[i].half));
    case ShapeKind::cylinder: {
      const CylinderShape& cylinder = tables.cylinders[i];
      const double half[3] = {cylinder.radius, cylinder.radius, cylinder.half_length};
      return std::make_unique<btCylinderShapeZ>(to_bullet(half));
    }
    case ShapeKind::cone:
      return std::make_unique<btConeShapeZ>(
          static_cast<btScalar>(tables.cones[i].radius),
          static_cast<btScalar>(2.0 * tables.cones[i].half_length));
    case ShapeKind::tapered_capsule: {
      const TaperedCapsuleShape& taper = tables.tapered_capsules[i];
      const btScalar half = static_cast<btScalar>(taper.half_length);
      const btVector3 middle[2] = {{0, 0, -half}, {0, 0, half}};
      const btScalar radius[2] = {static_cast<btScalar>(taper.radius[0]),
                                  static_cast<btScalar>(taper.radius[1])};
      auto balls = std::make_unique<btMultiSphereShape>(middle, radius, 2);
      balls->setMargin(std::min(radius[0], radius[1]));
      return balls;
    }
    case ShapeKind::support:
      return std::make_unique<LensShape>(*static_cast<const Lens*>(tables.supports[i].context));
    case ShapeKind::triangle: {
      const auto& v = tables.triangles[i].vertex;
      return std::make_unique<btTriangleShape>(to_bullet(v[0]), to_bullet(v[1]), to_bullet(v[2]));
    }
    default: {
      const HullShape& from = tables.hulls[i];
      auto hull = std::make_unique<btConvexHullShape>();
      const double inward = hull_margin == 0.0 ? 0.0 : hull_margin / from.inner_radius;
      for (std::uint32_t v = 0; v < from.vertex_count; ++v) {
        double point[3];
        for (int axis = 0; axis < 3; ++axis) {
          const double vertex = from.vertex[axis][v];
          point[axis] = vertex + inward * (from.center[axis] - vertex);
        }
        hull->addPoint(to_bullet(point), false);
      }
      hull->recalcLocalAabb();
      hull->setMargin(static_cast<btScalar>(hull_margin));
      return hull;
    }
  }
}

}  // namespace winnow::bench::in_bullet
