// Reference implementation of overlaps of regions and one box. `must` is computed in exact
// arithmetic, for capsules in long double; other results in double or long double with error
// bounds.

#include "tests/support/region_reference.h"
#include <winnow/core/eigen.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tests/support/cast_reference.h"
#include "tests/support/exact.h"

namespace winnow::test {
namespace {

using Real = long double;
using Point = Eigen::Vector3<Real>;
using Eigen::Vector3d;

Exact exact(float value) {
  return {static_cast<double>(value)};
}

Vector3d corner(const Aabb& box, unsigned i) {
  Vector3d result;
  for (int k = 0; k < 3; ++k) {
    result[k] =
        static_cast<double>((i >> static_cast<unsigned>(k) & 1U) != 0 ? box.max[k] : box.min[k]);
  }
  return result;
}

RegionTruth about(bool must, bool inside) {
  return {must, must, inside, inside};
}

RegionTruth truth_of_box(const Aabb& region, const Aabb& box) {
  const bool inside = (as_eigen(region.min).array() <= as_eigen(box.min).array()).all() &&
                      (as_eigen(box.max).array() <= as_eigen(region.max).array()).all();
  return about(region.overlaps(box), inside);
}

// Compares the radius with the distance from the centre to the nearest point of the box, exactly,
// and to the farthest point, in long double.
RegionTruth truth_of_sphere(const Sphere& sphere, const Aabb& box) {
  Exact nearest(0.0);
  Real farthest = 0.0L;
  for (int k = 0; k < 3; ++k) {
    const Exact below = exact(box.min[k]) - exact(sphere.center[k]);
    const Exact above = exact(sphere.center[k]) - exact(box.max[k]);
    const Exact gap = below.sign() > 0 ? below : above;
    if (gap.sign() > 0) nearest = nearest + gap * gap;
    const auto c = static_cast<Real>(sphere.center[k]);
    const Real far = std::max(c - static_cast<Real>(box.min[k]), static_cast<Real>(box.max[k]) - c);
    farthest += far * far;
  }
  const auto radius = static_cast<double>(sphere.radius);
  const double size =
      std::max(magnitude(box), static_cast<double>(as_eigen(sphere.center).cwiseAbs().maxCoeff()));
  const double wide = radius + 1e-12 * std::max(size, radius);
  RegionTruth truth;
  truth.must = nearest <= exact(sphere.radius) * exact(sphere.radius);
  truth.may = truth.must || nearest <= Exact(wide) * Exact(wide);
  const Real far = std::sqrt(farthest);
  truth.may_inside = far <= static_cast<Real>(wide);
  truth.must_inside = far < static_cast<Real>(radius - 1e-5 * std::max(size, radius));
  return truth;
}

RegionTruth truth_of_capsule(const Capsule& capsule, const Aabb& box) {
  const Point a = capsule.a.cast<Real>();
  const Point b = capsule.b.cast<Real>();
  const Real nearest = std::sqrt(segment_box_square(a, b, box));
  Real farthest = 0.0L;
  for (unsigned i = 0; i < 8; ++i) {
    const Aabb point{corner(box, i).cast<float>(), corner(box, i).cast<float>()};
    farthest = std::max(farthest, segment_box_square(a, b, point));
  }
  farthest = std::sqrt(farthest);
  const auto radius = static_cast<Real>(capsule.radius);
  const double size = std::max({magnitude(box), static_cast<double>(capsule.radius),
                                static_cast<double>(as_eigen(capsule.a).cwiseAbs().maxCoeff()),
                                static_cast<double>(as_eigen(capsule.b).cwiseAbs().maxCoeff())});
  const auto slack = static_cast<Real>(1e-6 * size);
  RegionTruth truth;
  truth.must = nearest <= radius - static_cast<Real>(1e-17 * size);
  truth.may = truth.must || nearest <= radius + slack;
  truth.may_inside = farthest <= radius + slack;
  truth.must_inside = farthest < radius - 10.0L * slack;
  return truth;
}

// Returns the sign of the largest or least value of normal . p + offset over the box, exactly.
int sign_of_extreme(const Plane& plane, const Aabb& box, bool largest) {
  Exact value = exact(plane.offset);
  for (int k = 0; k < 3; ++k) {
    const bool high = (plane.normal[k] > 0.0F) == largest;
    value = value + exact(plane.normal[k]) * exact(high ? box.max[k] : box.min[k]);
  }
  return value.sign();
}

// As above in double, with the magnitude of its terms.
struct Extreme {
  double value = 0.0;
  double size = 0.0;

  Extreme(const Plane& plane, const Aabb& box, bool largest)
      : value(static_cast<double>(plane.offset)), size(std::abs(value)) {
    for (int k = 0; k < 3; ++k) {
      const bool high = (plane.normal[k] > 0.0F) == largest;
      const double term = static_cast<double>(plane.normal[k]) *
                          static_cast<double>(high ? box.max[k] : box.min[k]);
      value += term;
      size += std::abs(term);
    }
  }
};

RegionTruth truth_of_planes(std::span<const Plane> planes, const Aabb& box) {
  RegionTruth truth{true, true, true, true};
  for (const Plane& plane : planes) {
    const Extreme most(plane, box, true);
    const Extreme least(plane, box, false);
    if (std::abs(most.value) > 1e-14 * most.size) {
      truth.must = truth.must && most.value > 0.0;
    } else {
      truth.must = truth.must && sign_of_extreme(plane, box, true) >= 0;
    }
    truth.may = truth.may && most.value >= -1e-6 * most.size;
    truth.may_inside = truth.may_inside && least.value >= -1e-6 * least.size;
    truth.must_inside = truth.must_inside && least.value > 1e-5 * least.size;
  }
  return truth;
}

RegionTruth truth_of_frustum(const Frustum& frustum, const Aabb& box) {
  RegionTruth truth = truth_of_planes(frustum.planes, box);
  // Boxes outside of the bounds of the frustum may be left out.
  if (!frustum.bounds.overlaps(box)) truth.must = truth.must_inside = false;
  const RegionTruth in_bounds = truth_of_box(frustum.bounds, box);
  truth.must_inside = truth.must_inside && in_bounds.must_inside;
  return truth;
}

using ExactPoint = std::array<Exact, 3>;

ExactPoint column(const OrientedBox& box, int i) {
  return {exact(box.axes(0, i)), exact(box.axes(1, i)), exact(box.axes(2, i))};
}

ExactPoint cross(const ExactPoint& a, const ExactPoint& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

ExactPoint unit(int k) {
  ExactPoint result{0.0, 0.0, 0.0};
  result[static_cast<std::size_t>(k)] = 1.0;
  return result;
}

Exact dot(const ExactPoint& a, const ExactPoint& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Returns true if the direction separates the two boxes.
bool apart(const ExactPoint& direction, const OrientedBox& oriented, const Aabb& box) {
  const ExactPoint center{exact(oriented.center[0]), exact(oriented.center[1]),
                          exact(oriented.center[2])};
  const Exact middle = dot(direction, center);
  Exact half(0.0);
  for (int i = 0; i < 3; ++i) {
    half = half + exact(oriented.half[i]) * abs(dot(direction, column(oriented, i)));
  }
  Exact low(0.0);
  Exact high(0.0);
  for (int k = 0; k < 3; ++k) {
    const Exact& d = direction[static_cast<std::size_t>(k)];
    low = low + d * exact(d.sign() > 0 ? box.min[k] : box.max[k]);
    high = high + d * exact(d.sign() > 0 ? box.max[k] : box.min[k]);
  }
  return high < middle - half || middle + half < low;
}

// The gap of two boxes along a direction in double, negative if they overlap, and the magnitude of
// its terms.
struct Gap {
  double value = 0.0;
  double size = 0.0;

  Gap(const Vector3d& direction, const OrientedBox& oriented, const Aabb& box) {
    const Vector3d center = oriented.center.cast<double>();
    const double middle = direction.dot(center);
    double half = 0.0;
    size = direction.cwiseAbs().dot(center.cwiseAbs());
    for (int i = 0; i < 3; ++i) {
      const Vector3d edge =
          as_eigen(oriented.axes).col(i).cast<double>() * static_cast<double>(oriented.half[i]);
      half += std::abs(direction.dot(edge));
      size += direction.cwiseAbs().dot(edge.cwiseAbs());
    }
    double low = 0.0;
    double high = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double a = direction[k] * static_cast<double>(box.min[k]);
      const double b = direction[k] * static_cast<double>(box.max[k]);
      low += std::min(a, b);
      high += std::max(a, b);
      size += std::abs(a) + std::abs(b);
    }
    value = std::max(low - middle - half, middle - half - high);
  }
};

// Directions for a separating-axis test of a box and a parallelepiped: normals of faces and
// products of edges (Gottschalk, Lin, Manocha, "OBBTree", 1996).
template <typename Vector, typename Unit, typename Column, typename Cross>
std::array<Vector, 15> directions(Unit unit_of, Column column_of, Cross cross_of) {
  return {unit_of(0),
          unit_of(1),
          unit_of(2),
          cross_of(column_of(1), column_of(2)),
          cross_of(column_of(2), column_of(0)),
          cross_of(column_of(0), column_of(1)),
          cross_of(unit_of(0), column_of(0)),
          cross_of(unit_of(0), column_of(1)),
          cross_of(unit_of(0), column_of(2)),
          cross_of(unit_of(1), column_of(0)),
          cross_of(unit_of(1), column_of(1)),
          cross_of(unit_of(1), column_of(2)),
          cross_of(unit_of(2), column_of(0)),
          cross_of(unit_of(2), column_of(1)),
          cross_of(unit_of(2), column_of(2))};
}

RegionTruth truth_of_oriented(const OrientedBox& oriented, const Aabb& box) {
  const auto rough = directions<Vector3d>(
      [](int k) -> Vector3d { return Vector3d::Unit(k); },
      [&](int i) -> Vector3d { return as_eigen(oriented.axes).col(i).cast<double>(); },
      [](const Vector3d& a, const Vector3d& b) -> Vector3d { return a.cross(b); });
  const double axes =
      std::max(1.0, static_cast<double>(as_eigen(oriented.axes).cwiseAbs().maxCoeff()));
  const double wide = static_cast<double>(as_eigen(oriented.half).maxCoeff()) * axes;
  const double size =
      magnitude(box) + wide + static_cast<double>(as_eigen(oriented.center).cwiseAbs().maxCoeff());
  RegionTruth truth{true, true, true, true};
  bool decided = true;
  for (const Vector3d& direction : rough) {
    const Gap away(direction, oriented, box);
    // The product of nearly parallel edges has an additional error, relative to the edges.
    const double error = 1e-14 * (away.size + axes * size);
    if (away.value > error) truth.must = false;
    if (std::abs(away.value) <= error) decided = false;
    if (direction.norm() > 1e-3 * axes && away.value > error + 1e-12 * size * direction.norm()) {
      truth.may = false;
    }
  }
  if (truth.must && !decided) {
    const auto all = directions<ExactPoint>(
        [](int k) { return unit(k); }, [&](int i) { return column(oriented, i); },
        [](const ExactPoint& a, const ExactPoint& b) { return cross(a, b); });
    truth.must = std::none_of(all.begin(), all.end(), [&](const ExactPoint& direction) {
      return apart(direction, oriented, box);
    });
  }
  // Inside is tested only if the axes span space: then coordinates along them can be computed.
  const Eigen::Matrix3d matrix = oriented.axes.cast<double>();
  if (std::abs(matrix.determinant()) < 1e-3 * axes * axes * axes) {
    truth.must_inside = false;
    return truth;
  }
  for (unsigned i = 0; i < 8; ++i) {
    const Vector3d p = corner(box, i) - oriented.center.cast<double>();
    const Vector3d s = (matrix.inverse() * p).cwiseAbs() - oriented.half.cast<double>();
    truth.may_inside = truth.may_inside && s.maxCoeff() <= 1e-11 * size;
    truth.must_inside = truth.must_inside && s.maxCoeff() < -1e-5 * size;
  }
  return truth;
}

}  // namespace

double distance(const Aabb& a, const Aabb& b) {
  double square = 0.0;
  for (int k = 0; k < 3; ++k) {
    const double below = static_cast<double>(a.min[k]) - static_cast<double>(b.max[k]);
    const double above = static_cast<double>(b.min[k]) - static_cast<double>(a.max[k]);
    const double gap = std::max({0.0, below, above});
    square += gap * gap;
  }
  return std::sqrt(square);
}

RegionTruth truth_of(const Region& region, const Aabb& given) {
  const Aabb box = finite(given);
  if (const auto* point = std::get_if<Vec3f>(&region)) {
    RegionTruth truth = truth_of_box({*point, *point}, box);
    truth.must_inside = false;
    return truth;
  }
  if (const auto* wide = std::get_if<Aabb>(&region)) return truth_of_box(finite(*wide), box);
  if (const auto* oriented = std::get_if<OrientedBox>(&region)) {
    return truth_of_oriented(*oriented, box);
  }
  if (const auto* sphere = std::get_if<Sphere>(&region)) return truth_of_sphere(*sphere, box);
  if (const auto* capsule = std::get_if<Capsule>(&region)) return truth_of_capsule(*capsule, box);
  if (const auto* frustum = std::get_if<Frustum>(&region)) return truth_of_frustum(*frustum, box);
  return truth_of_planes(std::get<std::span<const Plane>>(region), box);
}

}  // namespace winnow::test
