// Preparation of regions for the kernels: each kind of region becomes a set of planes, a ball or a
// moving box, with the test in double that decides in the end (box_intersection.h). Called by
// overlaps.cpp.

#include "partitions/queries/regions.h"

#include "partitions/queries/box_intersection.h"
#include "partitions/queries/kernel_arguments.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cfloat>
#include <cmath>
#include <variant>

namespace winnow {

WINNOW_DEFINE_KERNELS(RegionKernels, region_kernels)

namespace {

// Error bound of a float plane test relative to the largest coordinate, with rounded coefficients.
// Each rounding is relative to at most 3/8 of that coordinate.
constexpr float kPlaneRounding = 8 * 0x1p-24F;

/// `size` bounds the terms from which `offset` was computed; it is 0 if the caller gave the offset.
/// `slack` is raised to cover the error of heights above the plane.
WidePlane widen(const Eigen::Vector3d& normal, double offset, double size, float& slack) noexcept {
  int exponent = 0;
  (void)std::frexp(normal.cwiseAbs().maxCoeff(), &exponent);
  const double scale = std::ldexp(1.0, -exponent - 3);
  WidePlane wide;
  for (int i = 0; i < 3; ++i) {
    wide.normal[i] = static_cast<float>(normal[i] * scale);
    wide.farthest[i] = static_cast<std::uint8_t>(wide.normal[i] < 0.0F ? i : i + 3);
  }
  // An offset beyond the largest float outweighs every point.
  const auto most = static_cast<double>(FLT_MAX);
  wide.offset = static_cast<float>(std::clamp(offset * scale, -most, most));
  // 1e-36 covers products of tiny normals and coordinates that underflow.
  slack = std::max(slack, std::abs(wide.offset) * kPlaneRounding + 1e-36F +
                              static_cast<float>(std::min(1e-14 * size * scale, most)));
  return wide;
}

}  // namespace

PreparedRegion::PreparedRegion(const Region& region) noexcept {
  within({Vec3f::constant(-FLT_MAX), Vec3f::constant(FLT_MAX)});
  status_ = std::visit([this](const auto& r) { return prepare(r); }, region);
}

bool PreparedRegion::run(const QueryView& view, const QueryFilter& filter,
                         RegionSinks& sinks) const {
  const RegionKernels& kernels = region_kernels();
  switch (kind_) {
    case RegionKind::planes:
      return kernels.planes(view, planes_, filter, sinks);
    case RegionKind::ball:
      return kernels.ball(view, ball_, filter, sinks);
    case RegionKind::capsule:
      return kernels.capsule(view, capsule_, filter, sinks);
  }
  return true;
}

void PreparedRegion::within(const Aabb& box) noexcept {
  for (int i = 0; i < 3; ++i) {
    planes_.low[i] = std::max(box.min[i], -FLT_MAX);
    planes_.high[i] = std::min(box.max[i], FLT_MAX);
  }
}

void PreparedRegion::prune_by(const Eigen::Vector3d& normal, double offset, double size) noexcept {
  planes_.planes = wide_.data();
  if (planes_.count == kMaxPlanes) {
    planes_.more = true;
    return;
  }
  planes_.rounding = kPlaneRounding;
  wide_[planes_.count++] = widen(normal, offset, size, planes_.slack);
}

Status PreparedRegion::prepare(const Vec3f& point) noexcept {
  if (!point.all_finite()) return Status::invalid_argument;
  within({point, point});
  return Status::ok;
}

Status PreparedRegion::prepare(const Aabb& box) noexcept {
  if (!box.is_valid()) return Status::invalid_argument;
  within(box);
  return Status::ok;
}

Status PreparedRegion::prepare(const OrientedBox& box) noexcept {
  if (!box.is_valid()) return Status::invalid_argument;
  within(box.bounds());
  const Eigen::Matrix3d axes = box.axes.cast<double>();
  const Eigen::Vector3d center = box.center.cast<double>();
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d normal = axes.col((i + 1) % 3).cross(axes.col((i + 2) % 3));
    // A degenerate face has no normal, so the float tests cannot use it.
    if (normal.isZero(0.0)) {
      planes_.more = true;
      continue;
    }
    const double reach = std::abs(normal.dot(axes.col(i))) * static_cast<double>(box.half[i]);
    const double size = normal.cwiseAbs().dot(
        center.cwiseAbs() + axes.col(i).cwiseAbs() * static_cast<double>(box.half[i]));
    prune_by(normal, reach - normal.dot(center), size);
    prune_by(-normal, reach + normal.dot(center), size);
  }
  planes_.exact = {classify_oriented_box, &box};
  return Status::ok;
}

Status PreparedRegion::prepare(const Sphere& sphere) noexcept {
  if (!sphere.is_valid()) return Status::invalid_argument;
  kind_ = RegionKind::ball;
  for (int i = 0; i < 3; ++i) ball_.center[i] = sphere.center[i];
  ball_.radius = sphere.radius;
  ball_.exact = {classify_sphere, &sphere};
  return Status::ok;
}

Status PreparedRegion::prepare(const Capsule& capsule) noexcept {
  if (!capsule.is_valid()) return Status::invalid_argument;
  // The ball at one end moves to the other.
  const Eigen::Vector3d along = capsule.b.cast<double>() - capsule.a.cast<double>();
  if (along.isZero(0.0)) {
    kind_ = RegionKind::ball;
    for (int i = 0; i < 3; ++i) ball_.center[i] = capsule.a[i];
    ball_.radius = capsule.radius;
    ball_.exact = {classify_capsule, &capsule};
    return Status::ok;
  }
  kind_ = RegionKind::capsule;
  prepare_cast(capsule_.cast, Sphere{capsule.a, capsule.radius}.bounds(), along, 0.0, 1.0);
  capsule_.exact = {classify_capsule, &capsule};
  return Status::ok;
}

Status PreparedRegion::prepare(const Frustum& frustum) noexcept {
  if (!frustum.is_valid()) return Status::invalid_argument;
  within(frustum.bounds);
  return prepare(std::span<const Plane>(frustum.planes));
}

Status PreparedRegion::prepare(const std::span<const Plane>& planes) noexcept {
  for (const Plane& plane : planes) {
    if (!plane.is_valid()) return Status::invalid_argument;
  }
  for (const Plane& plane : planes) {
    prune_by(plane.normal.cast<double>(), static_cast<double>(plane.offset), 0.0);
  }
  exact_planes_ = planes;
  planes_.planes_decide = !planes_.more;
  planes_.exact = {classify_planes, &exact_planes_};
  return Status::ok;
}

}  // namespace winnow
