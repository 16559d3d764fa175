#include "tests/support/scenes.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <utility>

#include "tests/support/random.h"

namespace winnow::test {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

Aabb box_at(const Vector3d& center, const Vector3d& extent) {
  return Aabb::outward(center - 0.5 * extent, center + 0.5 * extent);
}

Vector3d point_in(Random& random, double side) {
  return {random.uniform(0, side), random.uniform(0, side), random.uniform(0, side)};
}

double normal(Random& random) {
  return std::sqrt(-2.0 * std::log(1.0 - random.unit())) *
         std::cos(2.0 * std::numbers::pi * random.unit());
}

}  // namespace

std::vector<Aabb> uniform_boxes(std::size_t count, std::uint64_t stream) {
  Random random(stream);
  const double side = std::cbrt(2.0 * static_cast<double>(count));
  std::vector<Aabb> boxes;
  while (boxes.size() < count) boxes.push_back(box_at(point_in(random, side), Vector3d::Ones()));
  return boxes;
}

std::vector<Aabb> clustered_boxes(std::size_t count, std::uint64_t stream) {
  Random random(stream);
  std::vector<Vector3d> centers;
  for (int i = 0; i < 4; ++i) centers.push_back(point_in(random, 1000.0));
  const double spread = 0.6 * std::cbrt(static_cast<double>(count));
  std::vector<Aabb> boxes;
  while (boxes.size() < count) {
    const Vector3d offset(normal(random), normal(random), normal(random));
    boxes.push_back(
        box_at(centers[boxes.size() % centers.size()] + spread * offset, Vector3d::Ones()));
  }
  return boxes;
}

std::vector<Aabb> mixed_boxes(std::size_t count, std::uint64_t stream) {
  Random random(stream);
  const double side = 4.0 * std::cbrt(static_cast<double>(count));
  std::vector<Aabb> boxes;
  while (boxes.size() < count) {
    const Vector3d extent(random.log_uniform(0.01, 10), random.log_uniform(0.01, 10),
                          random.log_uniform(0.01, 10));
    boxes.push_back(box_at(point_in(random, side), extent));
  }
  return boxes;
}

std::vector<Aabb> wall_boxes(std::size_t count, int axis, std::uint64_t stream) {
  Random random(stream);
  const double side = std::sqrt(2.0 * static_cast<double>(count));
  std::vector<Aabb> boxes;
  while (boxes.size() < count) {
    Vector3d extent = Vector3d::Ones();
    Vector3d center = point_in(random, side);
    extent[axis] = side;
    center[axis] = random.uniform(-0.4, 0.4) * side;
    boxes.push_back(box_at(center, extent));
  }
  return boxes;
}

std::vector<Aabb> two_scale_boxes(std::size_t count, std::uint64_t stream) {
  std::vector<Aabb> boxes = uniform_boxes(count, stream);
  for (std::size_t i = 0; i < count; ++i) {
    const float scale = i % 2 == 0 ? 1e-20F : 1e20F;
    boxes[i].min *= scale;
    boxes[i].max *= scale;
  }
  return boxes;
}

std::vector<Aabb> outlier_boxes(std::size_t count, std::uint64_t stream) {
  std::vector<Aabb> boxes = uniform_boxes(count, stream);
  if (count > 0) boxes[count / 2] = {Vector3f::Constant(1e30F), Vector3f::Constant(1.1e30F)};
  return boxes;
}

std::vector<Aabb> exponential_boxes(std::size_t count) {
  std::vector<Aabb> boxes;
  for (std::size_t i = 0; i < count; ++i) {
    const double exponent = 200.0 * static_cast<double>(i) / static_cast<double>(count) - 100.0;
    const double x = std::exp2(exponent);
    boxes.push_back(Aabb::outward(Vector3d(x, -x, 0.5 * x), Vector3d(1.4 * x, -0.7 * x, x)));
  }
  return boxes;
}

std::vector<Aabb> rod_boxes(std::size_t count) {
  Random random(7);
  std::vector<Aabb> boxes;
  for (std::size_t i = 0; i < count; ++i) {
    Vector3d extent = Vector3d::Constant(0.1);
    extent[static_cast<Eigen::Index>(i % 3)] = 100.0;
    boxes.push_back(box_at(point_in(random, 100.0), extent));
  }
  return boxes;
}

std::vector<Aabb> pile_boxes(std::size_t count) {
  Random random(8);
  const double side = std::sqrt(static_cast<double>(count) / 3.0);
  std::vector<Aabb> boxes{Aabb::outward(Vector3d(-1, -1, -1), Vector3d(side + 1, side + 1, 0))};
  while (boxes.size() < count) {
    Vector3d center = point_in(random, side);
    center.z() = 0.45 + 0.9 * static_cast<double>(boxes.size() % 4);
    boxes.push_back(box_at(center, Vector3d::Ones()));
  }
  return boxes;
}

}  // namespace winnow::test
