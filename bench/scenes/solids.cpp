#include "bench/scenes/solids.h"

#include <winnow/core/eigen.h>
#include <winnow/core/rotation.h>
#include "bench/common/need.h"
#include "bench/common/random.h"

#include <cmath>

namespace winnow::bench {
namespace {

/// Sets a unit quaternion, uniform over all rotations.
void random_turn(Random& random, double* q) {
  double square = 0.0;
  for (int i = 0; i < 4; ++i) {
    q[i] = random.normal();
    square += q[i] * q[i];
  }
  for (int i = 0; i < 4; ++i) q[i] /= std::sqrt(square);
}

Eigen::Matrix3f matrix_of(const double* q) {
  return rotation_of_unit({q[0], q[1], q[2], q[3]}).cast<float>();
}

Eigen::Vector3f random_point(Random& random, double side) {
  return Eigen::Vector3d(random.in(0.0, side), random.in(0.0, side), random.in(0.0, side))
      .cast<float>();
}

}  // namespace

void Solids::add(const OrientedBox& box, const double* quaternion) {
  Random random(boxes_.size() + 77);
  Pose pose = Pose::at(static_cast<double>(box.center.x()), static_cast<double>(box.center.y()),
                       static_cast<double>(box.center.z()));
  for (int i = 0; i < 4; ++i) pose.orientation[i] = quaternion[i];
  const double edge = 2.0 * static_cast<double>(as_eigen(box.half).mean());
  Eigen::Vector3d way(random.normal(), random.normal(), random.normal());
  way *= edge / way.norm();
  boxes_.push_back(box);
  poses_.push_back(pose);
  ids_.push_back(shape_of(box.half));
  velocity_.push_back(way.cast<float>());
}

ShapeId Solids::shape_of(const Eigen::Vector3f& half) {
  BoxShape shape;
  for (int i = 0; i < 3; ++i) shape.half[i] = static_cast<double>(half[i]);
  ShapeId id;
  need(shapes_.add(shape, id), "a box");
  return id;
}

void Solids::add_turned(const Eigen::Vector3f& center, const Eigen::Vector3f& half,
                        std::uint64_t seed) {
  Random random(seed);
  double q[4];
  random_turn(random, q);
  add({center, half, matrix_of(q)}, q);
}

Solids Solids::of_boxes(std::span<const Aabb> boxes) {
  constexpr double kUpright[4] = {1.0, 0.0, 0.0, 0.0};
  Solids solids;
  for (const Aabb& box : boxes) {
    const Eigen::Vector3f half = 0.5F * (box.max - box.min);
    if (half.allFinite()) solids.add({box.min + half, half, Eigen::Matrix3f::Identity()}, kUpright);
  }
  return solids;
}

Solids Solids::rotated(std::size_t objects, std::uint64_t seed) {
  Random random(seed);
  const double side = std::cbrt(2.0 * static_cast<double>(objects));
  Solids solids;
  for (std::size_t i = 0; i < objects; ++i) {
    solids.add_turned(random_point(random, side), Eigen::Vector3f::Constant(0.5F), random.next());
  }
  return solids;
}

Solids Solids::rods(std::size_t objects, std::uint64_t seed) {
  Random random(seed);
  // At this density a rod of 0.25 x 0.25 x 5 touches one or two others.
  const double side = std::cbrt(8.0 * static_cast<double>(objects));
  Solids solids;
  for (std::size_t i = 0; i < objects; ++i) {
    solids.add_turned(random_point(random, side), {0.125F, 0.125F, 2.5F}, random.next());
  }
  return solids;
}

std::vector<Aabb> Solids::bounds() const {
  std::vector<Aabb> bounds;
  for (const OrientedBox& box : boxes_) bounds.push_back(box.bounds());
  return bounds;
}

std::vector<OrientedBox> Solids::boxes_at_last_refit(float share) const {
  Random random(boxes_.size());
  std::vector<OrientedBox> then = boxes_;
  for (std::size_t i = 0; i < then.size(); ++i) {
    const Aabb box = then[i].bounds();
    const float fastest = velocity_[i].cwiseAbs().maxCoeff();
    const auto since = static_cast<float>(random.in(0.0, 1.0));
    if (!(fastest > 0.0F)) continue;
    then[i].center -=
        since * share * as_eigen(box.max - box.min).maxCoeff() / fastest * velocity_[i];
  }
  return then;
}

void Solids::advance(double step) {
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    put(i, boxes_[i].center + static_cast<float>(step) * velocity_[i]);
  }
}

void Solids::put(std::size_t i, const Eigen::Vector3f& center) {
  boxes_[i].center = center;
  for (int axis = 0; axis < 3; ++axis) {
    poses_[i].position[axis] = static_cast<double>(center[axis]);
  }
}

}  // namespace winnow::bench
