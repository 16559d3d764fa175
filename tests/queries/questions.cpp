// Casts and regions at the boxes of a scene, ordinary and extreme, with their right results;
// created once per process for all tests of queries.

#include "tests/queries/questions.h"
#include <winnow/core/eigen.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "tests/support/hostile_casts.h"

namespace winnow::test {
namespace {

using Eigen::Vector3f;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kLargest = std::numeric_limits<float>::max();

// Returns a box of the scene with finite sides, so that it has a centre.
Aabb some_box(std::span<const Aabb> boxes, Random& random) {
  if (boxes.empty()) return {Vector3f::Zero(), Vector3f::Ones()};
  Aabb box = boxes[random.below(boxes.size())];
  for (int k = 0; k < 3; ++k) {
    if (box.min[k] == -kInf) box.min[k] = std::min(box.max[k], 8.0F) - 8.0F;
    if (box.max[k] == kInf) box.max[k] = std::max(box.min[k], -8.0F) + 8.0F;
  }
  return box;
}

Vec3f center(const Aabb& box) {
  return 0.5F * box.min + 0.5F * box.max;
}

float size(const Aabb& box) {
  return std::min(as_eigen(0.5F * box.max - 0.5F * box.min).maxCoeff(), 1e37F);
}

Vector3f unit(Random& random) {
  for (;;) {
    const Eigen::Vector3d v(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    if (v.norm() > 0.1) return v.normalized().cast<float>();
  }
}

// Axis-aligned one time in three, so that faces and edges are parallel.
Eigen::Matrix3f rotation(Random& random) {
  if (random.chance(0.3)) return Eigen::Matrix3f::Identity();
  const auto angle = static_cast<float>(random.uniform(0.0, 3.0));
  if (random.chance(0.3)) {
    return Eigen::AngleAxisf(angle, Vector3f::Unit(static_cast<int>(random.below(3))))
        .toRotationMatrix();
  }
  return Eigen::AngleAxisf(angle, unit(random)).toRotationMatrix();
}

Region oriented(const Aabb& at, Random& random) {
  OrientedBox box{center(at), Vector3f::Constant(size(at)), rotation(random)};
  for (int k = 0; k < 3; ++k) {
    box.half[k] *= std::array{0.0F, 0.5F, 1.0F, 4.0F}[random.below(4)];
  }
  // Face to face with the box, to the precision of float.
  if (random.chance(0.3)) box.center += as_eigen(box.axes).col(0) * (box.half[0] + size(at));
  if (random.chance(0.1)) as_eigen(box.axes).col(1) += 0.5F * as_eigen(box.axes).col(2);
  return box;
}

Region sphere(const Aabb& at, const Aabb& other, Random& random) {
  Sphere ball{center(at), size(at)};
  if (random.chance(0.3)) ball.radius = 0.0F;
  if (random.chance(0.3)) ball.radius *= 5.0F;
  if (random.chance(0.4)) {
    const double reach = distance({ball.center, ball.center}, finite(other));
    if (reach < 3e38) ball.radius = static_cast<float>(reach);
  }
  return ball;
}

Region frustum(const Aabb& at, const Aabb& other, Random& random) {
  const float depth = std::max(4.0F * size(at), 1e-6F);
  Vector3f forward = center(other) - center(at);
  if (!(forward.cwiseAbs().maxCoeff() > 0.0F) || !forward.allFinite()) forward = unit(random);
  const Frustum result = Frustum::perspective(center(at), forward, unit(random),
                                              static_cast<float>(random.uniform(0.1, 2.5)),
                                              static_cast<float>(random.uniform(0.3, 3.0)),
                                              random.chance(0.3) ? 0.0F : 0.1F * depth, depth);
  if (result.is_valid()) return result;
  return Frustum::perspective(Vector3f::Zero(), Vector3f::UnitX(), Vector3f::UnitZ(), 1.0F, 1.0F,
                              0.0F, 10.0F);
}

std::vector<Plane> some_planes(const Aabb& at, Random& random) {
  std::vector<Plane> planes(random.below(9));
  for (Plane& plane : planes) {
    const auto axis = static_cast<int>(random.below(3));
    if (random.chance(0.5)) {
      // Exactly along a face.
      const float end = random.chance(0.5) ? at.min[axis] : at.max[axis];
      plane = {Vector3f::Unit(axis), -end};
      if (random.chance(0.5)) plane = {-plane.normal, -plane.offset};
      continue;
    }
    plane.normal = unit(random) * static_cast<float>(random.log_uniform(1e-3, 1e3));
    const float offset = -plane.normal.dot(random.chance(0.5) ? at.min : center(at));
    plane.offset = std::isfinite(offset) ? offset : 0.0F;
  }
  return planes;
}

// Uses the ends of the float range, and numbers whose products overflow or underflow.
Region extreme_region(std::size_t kind, Random& random, std::deque<std::vector<Plane>>& planes) {
  const auto value = [&] {
    constexpr std::array<float, 8> kValues{0.0F,  1.0F,  1e-30F,   1e-42F,
                                           1e30F, 2e38F, kLargest, 1e19F};
    return std::copysign(kValues[random.below(kValues.size())], random.chance(0.5) ? 1.0F : -1.0F);
  };
  const auto vector = [&] { return Vector3f(value(), value(), value()); };
  switch (kind % 6) {
    case 0:
      return vector();
    case 1: {
      const Vector3f a = vector();
      const Vector3f b = vector();
      return Aabb{a.cwiseMin(b), a.cwiseMax(b)};
    }
    case 2: {
      OrientedBox box{vector(), vector().cwiseAbs(), rotation(random)};
      if (random.chance(0.3)) as_eigen(box.axes).col(static_cast<int>(random.below(3))) = vector();
      return box;
    }
    case 3:
      return Sphere{vector(), std::abs(value())};
    case 4:
      return Capsule{vector(), vector(), std::abs(value())};
    default:
      planes.emplace_back();
      for (std::size_t n = 1 + random.below(4); n > 0; --n) {
        const Plane plane{vector(), value()};
        if (plane.is_valid()) planes.back().push_back(plane);
      }
      return std::span<const Plane>(planes.back());
  }
}

Region some_region(std::span<const Aabb> boxes, std::size_t kind, Random& random,
                   std::deque<std::vector<Plane>>& planes) {
  const Aabb at = some_box(boxes, random);
  const Aabb other = some_box(boxes, random);
  switch (kind % 7) {
    case 0:
      return random.chance(0.5) ? center(at) : (random.chance(0.5) ? at.min : at.max);
    case 1: {
      Aabb box = at;
      if (random.chance(0.5)) box.merge(other);
      if (random.chance(0.2)) box.min[static_cast<int>(random.below(3))] = -kInf;
      if (random.chance(0.2)) box.max[static_cast<int>(random.below(3))] = kInf;
      if (random.chance(0.3)) box.max.x() = std::nextafter(box.min.x(), kLargest);
      return box.is_valid() ? box : at;
    }
    case 2:
      return oriented(at, random);
    case 3:
      return sphere(at, other, random);
    case 4: {
      const float radius = size(at) * std::array{0.0F, 0.5F, 3.0F}[random.below(3)];
      return Capsule{center(at), random.chance(0.8) ? center(other) : center(at), radius};
    }
    case 5:
      return frustum(at, other, random);
    default:
      planes.push_back(some_planes(at, random));
      return std::span<const Plane>(planes.back());
  }
}

void add(std::deque<QuestionSet>& sets, const Scene& scene) {
  add_questions(sets, scene, scaled(32), scaled(48));
}

std::ostream& operator<<(std::ostream& out, const Aabb& box) {
  return out << "{" << as_eigen(box.min).transpose() << "} .. {" << as_eigen(box.max).transpose()
             << "}";
}

std::ostream& operator<<(std::ostream& out, const Capsule& capsule) {
  return out << "{" << as_eigen(capsule.a).transpose() << "} to {"
             << as_eigen(capsule.b).transpose() << "} radius " << capsule.radius;
}

}  // namespace

std::vector<Region> some_regions(std::span<const Aabb> boxes, std::size_t count, Random& random,
                                 std::deque<std::vector<Plane>>& planes) {
  std::vector<Region> regions;
  while (regions.size() < count) {
    const std::size_t n = regions.size();
    regions.push_back(n % 4 == 3 ? extreme_region(n / 4, random, planes)
                                 : some_region(boxes, n - n / 4, random, planes));
  }
  return regions;
}

std::vector<Cast> some_casts(std::span<const Aabb> boxes, std::size_t count, Random& random) {
  if (boxes.empty()) return std::vector<Cast>(count, Ray{});
  std::vector<Cast> casts;
  for (const Ray& ray : plain_rays(boxes, boxes.size() < 2 ? 0 : count / 6, random)) {
    casts.emplace_back(ray);
  }
  while (casts.size() < count) {
    const Aabb& box = boxes[random.below(boxes.size())];
    if (casts.size() % 2 == 0) {
      casts.emplace_back(hostile_ray(box, random));
    } else {
      casts.push_back(hostile_cast(box, random));
    }
  }
  return casts;
}

void add_questions(std::deque<QuestionSet>& sets, const Scene& scene, std::size_t casts,
                   std::size_t regions) {
  QuestionSet& set = sets.emplace_back();
  set.name = scene.name;
  set.boxes = scene.boxes;
  set.objects = numbered(scene.boxes);
  Random random(sets.size());
  set.casts = some_casts(set.boxes, casts, random);
  set.regions = some_regions(set.boxes, regions, random, set.planes);
  for (const Cast& cast : set.casts) set.cast_truths.push_back(candidates(cast, set.objects));
  for (const Region& region : set.regions) {
    set.region_truths.push_back(candidates(region, set.objects));
  }
}

const std::deque<QuestionSet>& question_sets() {
  static const std::deque<QuestionSet> sets = [] {
    std::deque<QuestionSet> all;
    for (const Scene& scene : random_scenes()) {
      if (scene.boxes.size() <= 1000) add(all, scene);
    }
    for (const auto* scenes : {&degenerate_scenes(), &infinite_scenes(), &extreme_float_scenes(),
                               &block_boundary_scenes()}) {
      for (const Scene& scene : *scenes) add(all, scene);
    }
    return all;
  }();
  return sets;
}

std::string to_string(const Cast& cast) {
  std::ostringstream out;
  out.precision(9);
  std::visit(
      [&](const auto& c) {
        using Kind = std::decay_t<decltype(c)>;
        if constexpr (std::is_same_v<Kind, Ray>) {
          out << "ray from {" << as_eigen(c.origin).transpose() << "}";
        } else if constexpr (std::is_same_v<Kind, BoxCast>) {
          out << "box " << c.box;
        } else if constexpr (std::is_same_v<Kind, SphereCast>) {
          out << "sphere at {" << as_eigen(c.sphere.center).transpose() << "} radius "
              << c.sphere.radius;
        } else {
          out << "capsule " << c.capsule;
        }
        out << " along {" << as_eigen(c.direction).transpose() << "} t " << c.min_t << " .. "
            << c.max_t;
      },
      cast);
  return out.str();
}

std::string to_string(const Region& region) {
  std::ostringstream out;
  out.precision(9);
  const auto plane = [&](const Plane& p) {
    out << " {" << as_eigen(p.normal).transpose() << "} + " << p.offset;
  };
  std::visit(
      [&](const auto& r) {
        using Kind = std::decay_t<decltype(r)>;
        if constexpr (std::is_same_v<Kind, Vec3f>) {
          out << "point {" << as_eigen(r).transpose() << "}";
        } else if constexpr (std::is_same_v<Kind, Aabb>) {
          out << "box " << r;
        } else if constexpr (std::is_same_v<Kind, OrientedBox>) {
          out << "oriented box at {" << as_eigen(r.center).transpose() << "} half {"
              << as_eigen(r.half).transpose() << "} axes\n"
              << as_eigen(r.axes);
        } else if constexpr (std::is_same_v<Kind, Sphere>) {
          out << "sphere at {" << as_eigen(r.center).transpose() << "} radius " << r.radius;
        } else if constexpr (std::is_same_v<Kind, Capsule>) {
          out << "capsule " << r;
        } else if constexpr (std::is_same_v<Kind, Frustum>) {
          out << "frustum in " << r.bounds;
          for (const Plane& p : r.planes) plane(p);
        } else {
          out << "planes";
          for (const Plane& p : r) plane(p);
        }
      },
      region);
  return out.str();
}

}  // namespace winnow::test
