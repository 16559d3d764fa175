// Scenes that are hard for partitions: degenerate, infinite and extreme boxes, and numbers of boxes
// near block boundaries.

#include "tests/support/hostile_scenes.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <utility>

#include "tests/support/random.h"
#include "tests/support/reference.h"
#include "tests/support/scenes.h"

namespace winnow::test {
namespace {

using Eigen::Vector3f;

Scene make(std::string name, std::vector<Aabb> boxes) {
  Scene scene{std::move(name), std::move(boxes), {}};
  scene.pairs = true_pairs(numbered(scene.boxes));
  return scene;
}

std::vector<Aabb> lattice(int side, float extent, const Vector3f& origin) {
  std::vector<Aabb> boxes;
  for (int i = 0; i < side * side * side; ++i) {
    const Vector3f low =
        origin + Vector3f(static_cast<float>(i % side), static_cast<float>(i / side % side),
                          static_cast<float>(i / side / side));
    boxes.push_back({low, low + Vector3f::Constant(extent)});
  }
  return boxes;
}

std::vector<Aabb> repeated(const Aabb& box, std::size_t count) {
  return std::vector<Aabb>(count, box);
}

std::vector<Aabb> concentric(std::size_t count) {
  std::vector<Aabb> boxes;
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3f half = Vector3f::Constant(static_cast<float>(i) * 0.25F);
    boxes.push_back({Vector3f::Constant(3) - half, Vector3f::Constant(3) + half});
  }
  return boxes;
}

std::vector<Aabb> diagonal(std::size_t count) {
  std::vector<Aabb> boxes;
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3f low = Vector3f::Constant(static_cast<float>(i) * 0.75F);
    boxes.push_back({low, low + Vector3f::Ones()});
  }
  return boxes;
}

// Returns a quarter each of slabs that are infinite along two axes, boxes that are infinite upward
// or downward along one axis, and boxes that are infinite downward along all axes.
std::vector<Aabb> unbounded(std::size_t count) {
  constexpr float inf = std::numeric_limits<float>::infinity();
  Random random(9);
  std::vector<Aabb> boxes;
  while (boxes.size() < count) {
    const Eigen::Vector3d low(random.uniform(0, 8), random.uniform(0, 8), random.uniform(0, 8));
    Aabb box = Aabb::outward(low, low + Eigen::Vector3d::Constant(0.5));
    const auto axis = static_cast<Eigen::Index>(boxes.size() % 3);
    switch (boxes.size() / 3 % 4) {
      case 0:
        for (Eigen::Index other = 0; other < 3; ++other) {
          if (other == axis) continue;
          box.min[other] = -inf;
          box.max[other] = inf;
        }
        break;
      case 1:
        box.max[axis] = inf;
        break;
      case 2:
        box.min[axis] = -inf;
        break;
      default:
        box.min = Vec3f::constant(-inf);
        box.max[axis] = 0.5F;
    }
    boxes.push_back(box);
  }
  return boxes;
}

std::vector<Aabb> with_unbounded(std::vector<Aabb> boxes, std::size_t count) {
  const std::vector<Aabb> wide = unbounded(count);
  // Distributes the infinite boxes over the rows, so that some are in the middle of a block and
  // some at its ends.
  for (std::size_t i = 0; i < wide.size(); ++i) {
    const std::size_t at = i * boxes.size() / wide.size();
    boxes.insert(boxes.begin() + static_cast<std::ptrdiff_t>(at), wide[i]);
  }
  return boxes;
}

std::vector<Aabb> scaled_by(std::vector<Aabb> boxes, float factor) {
  for (Aabb& box : boxes) {
    box.min *= factor;
    box.max *= factor;
  }
  return boxes;
}

// Corners of the float range, and boxes whose extent overflows float.
std::vector<Aabb> at_flt_max() {
  constexpr float big = std::numeric_limits<float>::max();
  const float below = std::nextafter(big, 0.0F);
  std::vector<Aabb> boxes;
  for (const float x : {-big, -below, -1.0F, 0.0F, 1.0F, below, big}) {
    for (const float y : {-big, 0.0F, big}) {
      const Vector3f corner(x, y, 0.0F);
      boxes.push_back({corner, corner});
      boxes.push_back({corner.cwiseMin(Vector3f::Zero()), corner.cwiseMax(Vector3f::Zero())});
      boxes.push_back({Vector3f(-big, y, -big), Vector3f(x, big, big)});
    }
  }
  return boxes;
}

std::vector<Aabb> signed_zeros() {
  std::vector<Aabb> boxes;
  for (unsigned bits = 0; bits < 64; ++bits) {
    Aabb box;
    for (unsigned axis = 0; axis < 3; ++axis) {
      box.min[axis] = (bits >> axis & 1U) != 0 ? -0.0F : 0.0F;
      box.max[axis] = (bits >> (axis + 3) & 1U) != 0 ? -0.0F : 0.0F;
    }
    boxes.push_back(box);
  }
  // Neighbours that touch a zero from either side.
  for (const float zero : {-0.0F, 0.0F}) {
    boxes.push_back({Vector3f(-1, -1, -1), Vector3f(zero, zero, zero)});
    boxes.push_back({Vector3f(zero, zero, zero), Vector3f(1, 1, 1)});
    boxes.push_back(
        {Vector3f(std::numeric_limits<float>::denorm_min(), zero, zero), Vector3f(1, 1, 1)});
  }
  return boxes;
}

}  // namespace

const std::vector<Scene>& random_scenes() {
  static const std::vector<Scene> scenes = [] {
    std::vector<Scene> all;
    for (const std::size_t n : {std::size_t{1000}, scaled(5000)}) {
      const std::string size = " of " + std::to_string(n);
      all.push_back(make("uniform" + size, uniform_boxes(n)));
      all.push_back(make("clustered" + size, clustered_boxes(n)));
      all.push_back(make("mixed 1000 to 1" + size, mixed_boxes(n)));
      all.push_back(make("pile" + size, pile_boxes(n)));
      for (int axis = 0; axis < 3; ++axis) {
        all.push_back(make("wall on axis " + std::to_string(axis) + size, wall_boxes(n, axis)));
      }
    }
    all.push_back(make("rods", rod_boxes(900)));
    return all;
  }();
  return scenes;
}

const std::vector<Scene>& degenerate_scenes() {
  static const std::vector<Scene> scenes = [] {
    const Aabb unit{Vector3f::Zero(), Vector3f::Ones()};
    const Aabb point{Vector3f::Constant(2), Vector3f::Constant(2)};
    std::vector<Scene> all;
    all.push_back(make("touching lattice", lattice(8, 1.0F, Vector3f::Zero())));
    all.push_back(make("touching lattice about the origin", lattice(7, 1.0F, {-3, -3, -3})));
    all.push_back(
        make("lattice an ulp apart", lattice(7, std::nextafter(1.0F, 0.0F), Vector3f::Zero())));
    all.push_back(make("lattice of points", lattice(7, 0.0F, {-3, -3, -3})));
    auto points = lattice(4, 0.0F, Vector3f::Zero());
    points.insert(points.end(), points.begin(), points.end());
    points.insert(points.end(), points.begin(), points.end());
    all.push_back(make("points on points", std::move(points)));
    auto flat = uniform_boxes(600);
    for (Aabb& box : flat) box.max.y() = box.min.y() = std::round(box.min.y());
    all.push_back(make("flat boxes in planes", std::move(flat)));
    all.push_back(make("all identical", repeated(unit, 260)));
    all.push_back(make("identical points", repeated(point, 130)));
    all.push_back(make("concentric", concentric(200)));
    all.push_back(make("diagonal", diagonal(700)));
    return all;
  }();
  return scenes;
}

const std::vector<Scene>& infinite_scenes() {
  static const std::vector<Scene> scenes = [] {
    constexpr float inf = std::numeric_limits<float>::infinity();
    const Aabb everything{Vector3f::Constant(-inf), Vector3f::Constant(inf)};
    std::vector<Scene> all;
    all.push_back(make("only unbounded boxes", unbounded(150)));
    all.push_back(make("only everything", repeated(everything, 40)));
    all.push_back(make("uniform and unbounded", with_unbounded(uniform_boxes(800), 24)));
    all.push_back(make("one ground plane", with_unbounded(clustered_boxes(800), 1)));
    auto crowd = uniform_boxes(500);
    crowd.insert(crowd.begin() + 250, everything);
    all.push_back(make("one box of everything", std::move(crowd)));
    return all;
  }();
  return scenes;
}

const std::vector<Scene>& extreme_float_scenes() {
  static const std::vector<Scene> scenes = [] {
    std::vector<Scene> all;
    all.push_back(make("1e30", scaled_by(uniform_boxes(700), 1e30F)));
    all.push_back(make("ends of the float range", at_flt_max()));
    all.push_back(make("denormals", scaled_by(uniform_boxes(700), 1e-40F)));
    all.push_back(make("signed zeros", signed_zeros()));
    all.push_back(make("one far outlier", outlier_boxes(700)));
    all.push_back(make("two scales", two_scale_boxes(700)));
    all.push_back(make("exponentially spaced", exponential_boxes(700)));
    auto far = uniform_boxes(700);
    for (Aabb& box : far) {
      box.min.x() += 1e7F;
      box.max.x() += 1e7F;
    }
    all.push_back(make("coarse floats far from the origin", std::move(far)));
    auto range = at_flt_max();
    const auto small = uniform_boxes(400);
    range.insert(range.end(), small.begin(), small.end());
    all.push_back(make("small boxes among boxes as large as the float range", std::move(range)));
    return all;
  }();
  return scenes;
}

const std::vector<Scene>& block_boundary_scenes() {
  static const std::vector<Scene> scenes = [] {
    std::vector<Scene> all;
    for (const std::size_t n : {0U, 1U, 2U, 3U, 15U, 16U, 17U, 31U, 32U, 33U, 63U, 64U, 65U, 255U,
                                256U, 257U, 511U, 513U}) {
      all.push_back(make(std::to_string(n) + " boxes", uniform_boxes(n, n)));
    }
    return all;
  }();
  return scenes;
}

}  // namespace winnow::test
