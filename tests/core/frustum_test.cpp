// Frustum: planes and bounds from a camera and from a matrix, compared with projected points;
// invalid cameras, matrices and planes.

#include <gtest/gtest.h>
#include <winnow/core/eigen.h>
#include <winnow/core/regions.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "tests/support/random.h"

namespace winnow::test {
namespace {

using Eigen::Matrix4d;
using Eigen::Vector3d;
using Eigen::Vector3f;
using Eigen::Vector4d;

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Camera {
  Vector3f eye = Vector3f::Zero();
  Vector3f forward = Vector3f::UnitX();
  Vector3f up = Vector3f::UnitZ();
  float fov = 1.0F;
  float aspect = 1.5F;
  float near_t = 0.5F;
  float far_t = 50.0F;

  [[nodiscard]] Frustum frustum() const {
    return Frustum::perspective(eye, forward, up, fov, aspect, near_t, far_t);
  }

  // Right, up and backward in rows.
  [[nodiscard]] Eigen::Matrix3d axes() const {
    const Vector3d f = forward.cast<double>().normalized();
    const Vector3d r = f.cross(up.cast<double>()).normalized();
    Eigen::Matrix3d m;
    m << r.transpose(), r.cross(f).transpose(), -f.transpose();
    return m;
  }

  [[nodiscard]] Matrix4d matrix(Frustum::NearDepth depth, bool endless = false) const {
    Matrix4d view = Matrix4d::Identity();
    view.topLeftCorner<3, 3>() = axes();
    view.topRightCorner<3, 1>() = -axes() * eye.cast<double>();
    const auto n = static_cast<double>(near_t);
    const auto f = static_cast<double>(far_t);
    const double y = 1.0 / std::tan(0.5 * static_cast<double>(fov));
    Matrix4d clip = Matrix4d::Zero();
    clip(0, 0) = y / static_cast<double>(aspect);
    clip(1, 1) = y;
    clip(3, 2) = -1.0;
    if (depth == Frustum::NearDepth::zero) {
      clip(2, 2) = endless ? -1.0 : f / (n - f);
      clip(2, 3) = endless ? -n : n * f / (n - f);
    } else {
      clip(2, 2) = endless ? -1.0 : (f + n) / (n - f);
      clip(2, 3) = endless ? -2.0 * n : 2.0 * f * n / (n - f);
    }
    return clip * view;
  }

  // Returns the point at a screen position in [-1, 1] and a depth.
  [[nodiscard]] Vector3d at(double x, double y, double depth) const {
    const double half = std::tan(0.5 * static_cast<double>(fov));
    const Vector3d local(x * half * static_cast<double>(aspect) * depth, y * half * depth, -depth);
    return eye.cast<double>() + axes().transpose() * local;
  }
};

std::vector<Camera> cameras() {
  std::vector<Camera> all{{}};
  Random random(71);
  const auto some = [&] {
    return Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  };
  while (all.size() < 60) {
    Camera camera;
    camera.eye = (random.log_uniform(0.01, 1e4) * some()).cast<float>();
    camera.forward = (random.log_uniform(1e-20, 1e15) * some()).cast<float>();
    camera.up = some().cast<float>();
    camera.fov = static_cast<float>(random.uniform(0.05, 2.8));
    camera.aspect = static_cast<float>(random.uniform(0.2, 5.0));
    camera.near_t = static_cast<float>(random.uniform(0.01, 5.0));
    camera.far_t = camera.near_t * static_cast<float>(random.log_uniform(1.5, 1e4));
    const Vector3d f = camera.forward.cast<double>().normalized();
    if (f.cross(camera.up.cast<double>().normalized()).norm() > 0.1) all.push_back(camera);
  }
  return all;
}

// The signed distance of a point to a plane, relative to the sizes that it is computed from.
double side(const Plane& plane, const Vector3d& p) {
  const Vector3d n = plane.normal.cast<double>();
  const auto offset = static_cast<double>(plane.offset);
  return (n.dot(p) + offset) / (n.cwiseAbs().dot(p.cwiseAbs()) + std::abs(offset) + 1e-30);
}

void expect_sees_what_the_camera_sees(const Frustum& frustum, const Camera& camera, bool endless) {
  ASSERT_TRUE(frustum.is_valid());
  const auto n = static_cast<double>(camera.near_t);
  const auto f = static_cast<double>(camera.far_t);
  for (const double x : {-1.0, -0.5, 0.0, 1.0}) {
    for (const double y : {-1.0, 0.0, 0.7, 1.0}) {
      for (const double depth : {n, 0.5 * (n + f), f}) {
        const Vector3d p = camera.at(x, y, depth);
        for (const Plane& plane : frustum.planes) EXPECT_GE(side(plane, p), -1e-6);
        const Aabb point = Aabb::outward(p, p);
        EXPECT_TRUE(frustum.bounds.overlaps(point));
      }
    }
  }
  // Each plane cuts off the points beyond it.
  const double middle = 0.5 * (n + f);
  const std::array<Vector3d, 6> beyond{camera.at(-1.1, 0, middle), camera.at(1.1, 0, middle),
                                       camera.at(0, -1.1, middle), camera.at(0, 1.1, middle),
                                       camera.at(0, 0, 0.5 * n),   camera.at(0, 0, 1.5 * f)};
  for (std::size_t i = 0; i < beyond.size(); ++i) {
    if (i == 5 && endless) continue;
    const Plane& plane = frustum.planes[i];
    EXPECT_LT(plane.normal.cast<double>().dot(beyond[i]) + static_cast<double>(plane.offset), 0.0)
        << "plane " << i;
  }
}

TEST(Frustum, frustum_holds_exactly_the_view_of_the_camera) {
  for (const Camera& camera : cameras()) {
    expect_sees_what_the_camera_sees(camera.frustum(), camera, false);
    // The bounds are not much larger than the frustum.
    const Aabb bounds = camera.frustum().bounds;
    const auto reach =
        static_cast<double>(camera.far_t) * (1.0 + std::tan(0.5 * static_cast<double>(camera.fov)) *
                                                       (1.0 + static_cast<double>(camera.aspect)));
    EXPECT_LE(static_cast<double>(as_eigen(bounds.max - bounds.min).maxCoeff()),
              2.0 * reach + 1e-6 * static_cast<double>(camera.eye.cwiseAbs().maxCoeff()));
  }
}

TEST(Frustum, frustum_from_a_matrix_equals_the_camera) {
  for (const Camera& camera : cameras()) {
    const Frustum expected = camera.frustum();
    for (const auto depth : {Frustum::NearDepth::zero, Frustum::NearDepth::minus_one}) {
      const Frustum frustum = Frustum::from_matrix(camera.matrix(depth), depth);
      expect_sees_what_the_camera_sees(frustum, camera, false);
      for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_LT((frustum.planes[i].normal - expected.planes[i].normal).norm(), 1e-5F) << i;
      }
    }
  }
}

TEST(Frustum, frustum_without_a_far_plane_is_unbounded) {
  std::vector<Camera> all = cameras();
  // Adds cameras far from the origin, where the matrix itself is inaccurate.
  all.push_back({{1e6F, -2e6F, 3e5F}, {1, 2, 3}});
  all.push_back(
      {{1e6F, 1e6F, 1e6F}, {-1, 0.3F, 0.1F}, Vector3f::UnitZ(), 1.0F, 1.0F, 0.01F, 90.0F});
  for (const Camera& camera : all) {
    for (const auto depth : {Frustum::NearDepth::zero, Frustum::NearDepth::minus_one}) {
      const Frustum frustum = Frustum::from_matrix(camera.matrix(depth, true), depth);
      ASSERT_TRUE(frustum.is_valid());
      for (const double far : {1e5, 1e9, 1e20}) {
        const Vector3d p = camera.at(0.1, -0.2, far);
        for (const Plane& plane : frustum.planes) EXPECT_GE(side(plane, p), -1e-6);
        EXPECT_TRUE(frustum.bounds.overlaps(Aabb::outward(p, p))) << far;
      }
    }
  }
}

TEST(Frustum, bad_camera_gives_an_invalid_frustum) {
  EXPECT_TRUE(Camera{}.frustum().is_valid());
  std::vector<Camera> bad;
  const auto add = [&](const auto& spoil) {
    bad.emplace_back();
    spoil(bad.back());
  };
  for (const float value : {kNan, kInf, -kInf}) {
    add([&](Camera& c) { c.eye.y() = value; });
    add([&](Camera& c) { c.forward.x() = value; });
    add([&](Camera& c) { c.up.z() = value; });
    add([&](Camera& c) { c.fov = value; });
    add([&](Camera& c) { c.aspect = value; });
    add([&](Camera& c) { c.near_t = value; });
    add([&](Camera& c) { c.far_t = value; });
  }
  add([](Camera& c) { c.forward.setZero(); });
  add([](Camera& c) { c.up.setZero(); });
  add([](Camera& c) { c.up = c.forward; });
  add([](Camera& c) { c.up = -3.0F * c.forward; });
  add([](Camera& c) { c.fov = 0.0F; });
  add([](Camera& c) { c.fov = -1.0F; });
  add([](Camera& c) { c.fov = std::numbers::pi_v<float>; });
  add([](Camera& c) { c.aspect = 0.0F; });
  add([](Camera& c) { c.aspect = -1.0F; });
  add([](Camera& c) { c.near_t = -1.0F; });
  add([](Camera& c) { c.far_t = c.near_t; });
  for (std::size_t i = 0; i < bad.size(); ++i) EXPECT_FALSE(bad[i].frustum().is_valid()) << i;
}

TEST(Frustum, bad_matrix_or_plane_is_invalid) {
  EXPECT_FALSE(Frustum{}.is_valid() && Frustum{}.planes[0].normal.is_zero());
  EXPECT_FALSE(Frustum::from_matrix(Matrix4d::Zero()).is_valid());
  for (const double value : {std::nan(""), static_cast<double>(kInf)}) {
    for (int i = 0; i < 16; ++i) {
      Matrix4d m = Camera{}.matrix(Frustum::NearDepth::zero);
      m(i / 4, i % 4) = value;
      EXPECT_FALSE(Frustum::from_matrix(m).is_valid());
    }
  }
  for (std::size_t i = 0; i < 6; ++i) {
    Frustum frustum = Camera{}.frustum();
    frustum.planes[i].normal = {};
    EXPECT_FALSE(frustum.is_valid());
    frustum = Camera{}.frustum();
    frustum.planes[i].offset = kNan;
    EXPECT_FALSE(frustum.is_valid());
  }
  Frustum frustum = Camera{}.frustum();
  std::swap(frustum.bounds.min, frustum.bounds.max);
  EXPECT_FALSE(frustum.is_valid());
}

}  // namespace
}  // namespace winnow::test
