#pragma once

#include <winnow/core/eigen.h>
#include "bench/peers/narrow_adapter.h"

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/sphere.h>

#include <memory>
#include <vector>

/// Conversion of shapes and poses to FCL's types, in double.
namespace winnow::bench::in_fcl {

using Vector = fcl::Vector3<double>;
using Transform = fcl::Transform3<double>;
using Geometry = fcl::CollisionGeometry<double>;
using SphereGeometry = fcl::Sphere<double>;
using CapsuleGeometry = fcl::Capsule<double>;
using BoxGeometry = fcl::Box<double>;
using CylinderGeometry = fcl::Cylinder<double>;
using ConeGeometry = fcl::Cone<double>;
using EllipsoidGeometry = fcl::Ellipsoid<double>;
using HalfSpaceGeometry = fcl::Halfspace<double>;
using HullGeometry = fcl::Convex<double>;

/// Returns null for a shape that is not a solid.
inline std::shared_ptr<Geometry> make_geometry(const ShapeTables& tables, ShapeId id) {
  const std::uint32_t i = id.index();
  switch (id.kind()) {
    case ShapeKind::sphere:
      return std::make_shared<SphereGeometry>(tables.spheres[i].radius);
    case ShapeKind::capsule:
      return std::make_shared<CapsuleGeometry>(tables.capsules[i].radius,
                                               2.0 * tables.capsules[i].half_length);
    case ShapeKind::box: {
      const Vec3d& half = tables.boxes[i].half;
      return std::make_shared<BoxGeometry>(2.0 * half[0], 2.0 * half[1], 2.0 * half[2]);
    }
    case ShapeKind::cylinder:
      return std::make_shared<CylinderGeometry>(tables.cylinders[i].radius,
                                                2.0 * tables.cylinders[i].half_length);
    case ShapeKind::cone:
      return std::make_shared<ConeGeometry>(tables.cones[i].radius,
                                            2.0 * tables.cones[i].half_length);
    case ShapeKind::ellipsoid: {
      const Vec3d& radius = tables.ellipsoids[i].radius;
      return std::make_shared<EllipsoidGeometry>(radius[0], radius[1], radius[2]);
    }
    case ShapeKind::half_space: {
      const HalfSpaceShape& half = tables.half_spaces[i];
      return std::make_shared<HalfSpaceGeometry>(half.normal, half.offset);
    }
    case ShapeKind::hull: {
      const HullShape& hull = tables.hulls[i];
      auto vertices = std::make_shared<std::vector<Vector>>();
      for (std::uint32_t v = 0; v < hull.vertex_count; ++v) {
        vertices->emplace_back(hull.vertex[0][v], hull.vertex[1][v], hull.vertex[2][v]);
      }
      auto faces = std::make_shared<std::vector<int>>();
      for (std::uint32_t f = 0; f < hull.face_count; ++f) {
        faces->push_back(static_cast<int>(hull.faces[f].count));
        for (std::uint32_t k = 0; k < hull.faces[f].count; ++k) {
          faces->push_back(static_cast<int>(hull.loop[hull.faces[f].first + k]));
        }
      }
      return std::make_shared<HullGeometry>(vertices, static_cast<int>(hull.face_count), faces);
    }
    default:
      return nullptr;
  }
}

inline Transform transform_of(const Pose& pose) {
  Transform at = Transform::Identity();
  at.linear() = orientation_of(pose).toRotationMatrix();
  at.translation() = as_eigen(pose.position);
  return at;
}

}  // namespace winnow::bench::in_fcl
