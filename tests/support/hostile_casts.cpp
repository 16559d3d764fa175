// Casts that are hard for a box; hostile_casts.h lists the kinds.

#include "tests/support/hostile_casts.h"
#include <winnow/core/eigen.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tests/support/cast_reference.h"

namespace winnow::test {
namespace {

using Eigen::Vector3f;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kLargest = std::numeric_limits<float>::max();

template <std::size_t N>
float one_of(const std::array<float, N>& values, Random& random) {
  return values[random.below(N)];
}

float sign(Random& random) {
  return random.chance(0.5) ? 1.0F : -1.0F;
}

// Returns a point of the box: on a face, on an edge, a corner, inside, or an ulp off any of them.
Vector3f point_of(const Aabb& box, Random& random) {
  Vector3f point;
  for (int k = 0; k < 3; ++k) {
    const float low = box.min[k];
    const float high = box.max[k];
    const auto inner =
        static_cast<float>(random.uniform(static_cast<double>(low), static_cast<double>(high)));
    const std::array<float, 9> choices{
        low,
        high,
        low,
        high,
        inner,
        inner,
        inner,
        std::nextafter(low, random.chance(0.5) ? -kLargest : kLargest),
        std::nextafter(high, random.chance(0.5) ? -kLargest : kLargest)};
    point[k] = one_of(choices, random);
  }
  return point;
}

Vector3f some_direction(Random& random) {
  for (;;) {
    Vector3f direction;
    for (int k = 0; k < 3; ++k) {
      const std::array<float, 8> sizes{0.0F,
                                       0.0F,
                                       1.0F,
                                       1.0F,
                                       static_cast<float>(random.unit()),
                                       static_cast<float>(random.log_uniform(1e-7, 1.0)),
                                       static_cast<float>(random.log_uniform(1e-38, 1.0)),
                                       static_cast<float>(random.log_uniform(1e-44, 1e-38))};
      direction[k] = std::copysign(one_of(sizes, random), sign(random));
    }
    if ((direction.array() != 0.0F).any()) return direction;
  }
}

// Scales the direction, if it remains valid.
void scale_direction(Vec3f& direction, Random& random) {
  if (random.chance(0.6)) return;
  const Vector3f scaled_direction =
      direction * one_of(std::array{1e-30F, 1e30F, 1e-42F, 3.0F, 0x1p60F, 0x1p-60F}, random);
  if (scaled_direction.allFinite() && (scaled_direction.array() != 0.0F).any())
    direction = scaled_direction;
}

// Sets ranges that end at critical times.
template <typename AnyCast>
void limit(AnyCast& cast, const Aabb& box, Random& random) {
  if (random.chance(0.5)) return;
  const double touch = truth_of(cast, box).earliest;
  float near_touch = touch <= 3e38 ? static_cast<float>(touch) : kLargest;
  if (random.chance(0.5)) near_touch = std::nextafter(near_touch, random.chance(0.5) ? 0.0F : kInf);
  near_touch = std::min(near_touch, kLargest);
  switch (random.below(6)) {
    case 0:
      cast.max_t = 0.0F;
      break;
    case 1:
      cast.max_t = std::numeric_limits<float>::denorm_min();
      break;
    case 2:
      cast.max_t = near_touch;
      break;
    case 3:
      cast.min_t = cast.max_t = near_touch;
      break;
    case 4:
      cast.min_t = near_touch;
      break;
    default:
      cast.min_t = static_cast<float>(random.log_uniform(1e-3, 1e3));
      cast.max_t = kLargest;
  }
}

// Origins are finite: replaces infinite ends.
Aabb bounded(const Aabb& box) {
  Aabb result = box;
  for (int k = 0; k < 3; ++k) {
    if (box.min[k] == -kInf) result.min[k] = std::min(box.max[k], 8.0F) - 8.0F;
    if (box.max[k] == kInf) result.max[k] = std::max(result.min[k], -8.0F) + 8.0F;
  }
  return finite(result);
}

// Returns a point from which motion along the direction reaches the given point, up to rounding.
Vector3f before(const Vector3f& point, const Vector3f& direction, const Aabb& box, Random& random) {
  if (random.chance(0.2)) return point;
  float size =
      std::max(as_eigen(box.max - box.min).maxCoeff(), 1e-3F * point.cwiseAbs().maxCoeff());
  if (!(size > 0.0F)) size = 1.0F;
  const float way = std::min(size, 1e37F) * one_of(std::array{0.5F, 1.0F, 2.0F, 16.0F}, random) *
                    (random.chance(0.1) ? -1.0F : 1.0F);
  const Vector3f unit = direction / direction.cwiseAbs().maxCoeff();
  const Vector3f origin = point - way * (unit.allFinite() ? unit : direction);
  return origin.cwiseMax(-kLargest).cwiseMin(kLargest);
}

float some_size(const Aabb& box, Random& random) {
  const float size = std::min(as_eigen(box.max - box.min).maxCoeff(), 1e37F);
  return size * one_of(std::array{0.0F, 0.25F, 1.0F, 3.0F}, random);
}

BoxCast box_cast(const Ray& ray, const Aabb& box, Random& random) {
  BoxCast cast{{ray.origin, ray.origin}, ray.direction};
  for (int k = 0; k < 3; ++k) {
    (random.chance(0.5) ? cast.box.min : cast.box.max)[k] = ray.origin[k];
    cast.box.min[k] = std::max(cast.box.min[k] - some_size(box, random), -kLargest);
    if (random.chance(0.5)) {
      cast.box.max[k] = std::min(cast.box.max[k] + some_size(box, random), kLargest);
    }
  }
  return cast;
}

}  // namespace

Ray hostile_ray(const Aabb& given, Random& random) {
  const Aabb box = bounded(given);
  Ray ray;
  ray.direction = some_direction(random);
  ray.origin = before(point_of(box, random), ray.direction, box, random);
  scale_direction(ray.direction, random);
  limit(ray, given, random);
  return ray;
}

Cast hostile_cast(const Aabb& given, Random& random) {
  const Aabb box = bounded(given);
  Ray ray;
  ray.direction = some_direction(random);
  ray.origin = before(point_of(box, random), ray.direction, box, random);
  scale_direction(ray.direction, random);
  switch (random.below(3)) {
    case 0: {
      BoxCast cast = box_cast(ray, box, random);
      limit(cast, given, random);
      return cast;
    }
    case 1: {
      SphereCast cast{{ray.origin, some_size(box, random)}, ray.direction};
      if (random.chance(0.05)) cast.sphere.radius = kLargest;
      // Moves the sphere so that it grazes.
      cast.sphere.center[static_cast<int>(random.below(3))] += sign(random) * cast.sphere.radius;
      cast.sphere.center = as_eigen(cast.sphere.center).cwiseMax(-kLargest).cwiseMin(kLargest);
      limit(cast, given, random);
      return cast;
    }
    default: {
      CapsuleCast cast{{ray.origin, ray.origin, some_size(box, random)}, ray.direction};
      cast.capsule.b += some_size(box, random) * some_direction(random);
      cast.capsule.b = as_eigen(cast.capsule.b).cwiseMax(-kLargest).cwiseMin(kLargest);
      limit(cast, given, random);
      return cast;
    }
  }
}

std::vector<Ray> plain_rays(std::span<const Aabb> boxes, std::size_t count, Random& random) {
  std::vector<Ray> rays;
  while (rays.size() < count) {
    const Aabb from = bounded(boxes[random.below(boxes.size())]);
    const Aabb to = bounded(boxes[random.below(boxes.size())]);
    const Vector3f origin = 0.5F * from.min + 0.5F * from.max;
    const Vector3f way = 0.5F * to.min + 0.5F * to.max - origin;
    Ray ray{origin, way};
    if (rays.size() % 4 == 1) ray.max_t = 0.5F;
    if (rays.size() % 4 == 2) ray.min_t = 0.25F;
    if (rays.size() % 8 == 3) ray.direction = Vector3f::Unit(static_cast<int>(random.below(3)));
    // The direction is zero or beyond the range of float.
    if (!ray.is_valid()) ray.direction = Vector3f(1.0F, 0.5F, static_cast<float>(random.unit()));
    rays.push_back(ray);
  }
  return rays;
}

}  // namespace winnow::test
