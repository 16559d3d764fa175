#include "bench/scenes/solids.h"

#include <winnow/core/eigen.h>
#include <winnow/core/pose.h>
#include "bench/common/random.h"
#include "bench/scenes/random_shapes.h"
#include "core/numbers/rotation.h"

#include <cmath>

namespace winnow::bench {

void Solids::add(const Vec3f& center, const Vec3f& half, const Quaternion& turn) {
  Random random(boxes_.size() + 77);
  const double edge = 2.0 * static_cast<double>(as_eigen(half).mean());
  const Vec3d way{random.normal(), random.normal(), random.normal()};
  boxes_.push_back({center, half, rotation_of_unit(turn).cast<float>()});
  poses_.push_back({center.cast<double>(), turn});
  ids_.push_back(shapes_.add(BoxShape{half.cast<double>()}));
  velocity_.push_back((way * (edge / way.norm())).cast<float>());
}

void Solids::add_turned(const Vec3d& center, const Vec3f& half, std::uint64_t seed) {
  Random random(seed);
  Pose pose;
  turn_at_random(random, pose);
  add(center.cast<float>(), half, pose.orientation);
}

Solids Solids::of_boxes(std::span<const Aabb> boxes) {
  Solids solids;
  for (const Aabb& box : boxes) {
    const Vec3f half = 0.5F * (box.max - box.min);
    if (half.all_finite()) solids.add(box.min + half, half, {});
  }
  return solids;
}

Solids Solids::rotated(std::size_t objects, std::uint64_t seed) {
  Random random(seed);
  const double side = std::cbrt(2.0 * static_cast<double>(objects));
  Solids solids;
  for (std::size_t i = 0; i < objects; ++i) {
    const Vec3d center = random.in_cube(0.0, side);
    solids.add_turned(center, Vec3f::constant(0.5F), random.next());
  }
  return solids;
}

Solids Solids::rods(std::size_t objects, std::uint64_t seed) {
  Random random(seed);
  // At this density a rod of 0.25 x 0.25 x 5 touches one or two others.
  const double side = std::cbrt(8.0 * static_cast<double>(objects));
  Solids solids;
  for (std::size_t i = 0; i < objects; ++i) {
    const Vec3d center = random.in_cube(0.0, side);
    solids.add_turned(center, {0.125F, 0.125F, 2.5F}, random.next());
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
    const float fastest = as_eigen(velocity_[i]).cwiseAbs().maxCoeff();
    const auto since = static_cast<float>(random.in(0.0, 1.0));
    if (!(fastest > 0.0F)) continue;
    then[i].center -=
        since * share * as_eigen(box.max - box.min).maxCoeff() / fastest * velocity_[i];
  }
  return then;
}

void Solids::advance(double step) {
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    boxes_[i].center += static_cast<float>(step) * velocity_[i];
    poses_[i].position = boxes_[i].center.cast<double>();
  }
}

}  // namespace winnow::bench
