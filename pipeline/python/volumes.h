#pragma once

#include "pipeline/python/inputs.h"

#include <winnow/core/regions.h>
#include <winnow/core/volumes.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace winnow::python {

// Volumes in float that contain volumes given in double.

[[nodiscard]] inline Vec3f point_at(const Numbers& numbers, std::size_t i) {
  Vec3f point;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    point[axis] = static_cast<float>(numbers.at(i, axis));
  }
  return point;
}

/// Upper bound on the distance between the point in float and the given one.
[[nodiscard]] inline double off_point_at(const Numbers& numbers, std::size_t i) {
  const Vec3f point = point_at(numbers, i);
  double square = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double off = numbers.at(i, axis) - static_cast<double>(point[axis]);
    square += off * off;
  }
  return std::sqrt(square) * (1.0 + 1e-15);
}

/// Returns an upper bound of the sum in float; a negative length is only rounded, NaN stays NaN.
[[nodiscard]] inline float grown(double length, double by) {
  return round_up(length >= 0.0 && by > 0.0 ? add_up(length, by) : length);
}

[[nodiscard]] inline Aabb box_at(const Numbers& point, std::size_t i) {
  Aabb box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.min[axis] = round_down(point.at(i, axis));
    box.max[axis] = round_up(point.at(i, axis));
  }
  return box;
}

/// Spheres as `centers` and `radii`.
class SphereInput : public Input {
 public:
  SphereInput(py::handle centers, py::handle radii)
      : Input("centers"),
        center_(centers, "centers", {3}, Valid::finite),
        radius_(radii, "radii", {}, Valid::length) {
    set(agree({&center_, &radius_}), center_.is_one() && radius_.is_one());
  }
  [[nodiscard]] Sphere operator[](std::size_t i) const {
    return {point_at(center_, i), grown(radius_.at(i), off_point_at(center_, i))};
  }
  [[nodiscard]] std::vector<Sphere> list() const {
    std::vector<Sphere> spheres(count());
    for (std::size_t i = 0; i < spheres.size(); ++i) spheres[i] = (*this)[i];
    return spheres;
  }

 private:
  void repeat() override { expect_all(count(), {&center_, &radius_}); }
  Numbers center_;
  Numbers radius_;
};

/// Capsules as the ends `a` and `b` of their segments, and `radii`.
class CapsuleInput : public Input {
 public:
  CapsuleInput(py::handle a, py::handle b, py::handle radii)
      : Input("a"),
        a_(a, "a", {3}, Valid::finite),
        b_(b, "b", {3}, Valid::finite),
        radius_(radii, "radii", {}, Valid::length) {
    set(agree({&a_, &b_, &radius_}), a_.is_one() && b_.is_one() && radius_.is_one());
  }
  [[nodiscard]] Capsule operator[](std::size_t i) const {
    return {point_at(a_, i), point_at(b_, i),
            grown(radius_.at(i), std::max(off_point_at(a_, i), off_point_at(b_, i)))};
  }

 private:
  void repeat() override { expect_all(count(), {&a_, &b_, &radius_}); }
  Numbers a_;
  Numbers b_;
  Numbers radius_;
};

}  // namespace winnow::python
