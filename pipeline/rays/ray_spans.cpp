// Spans of a ray within balls, capsules, infinite cylinders and prisms, and their unions
// (FirstEntry) and intersections. The ray tests in shape_entries.cpp are built from them.

#include "pipeline/rays/shape_entries.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>

namespace winnow {
namespace {

/// A ray counts as parallel to a plane or axis if its rate of approach is below this fraction of
/// its speed.
constexpr double kParallelRate = 1e-15;

[[nodiscard]] Eigen::Vector3d unit_or_zero(const Eigen::Vector3d& v) noexcept {
  const double length = v.stableNorm();
  return length > 0.0 ? Eigen::Vector3d(v / length) : Eigen::Vector3d::Zero();
}

/// Normalises the offset from a round set's centre; zero if its length is at most kGrazing.
[[nodiscard]] Eigen::Vector3d outward(const Eigen::Vector3d& v) noexcept {
  const double length = v.stableNorm();
  return length > kGrazing ? Eigen::Vector3d(v / length) : Eigen::Vector3d::Zero();
}

/// The t for which |offset + t * velocity| <= radius. Computed from the closest approach, where the
/// difference of squares is a product and does not cancel.
[[nodiscard]] RaySpan round_span(const Eigen::Vector3d& offset, const Eigen::Vector3d& velocity,
                                 double radius) noexcept {
  const double square = velocity.squaredNorm();
  const double nearest = -offset.dot(velocity) / square;
  const double distance = (offset + nearest * velocity).stableNorm();
  if (!(distance <= radius + kGrazing)) return {};
  const double half = std::sqrt(std::max(0.0, (radius - distance) * (radius + distance)) / square);
  return {nearest - half, nearest + half, outward(offset + (nearest - half) * velocity)};
}

}  // namespace

void FirstEntry::merge_span(const LocalRay& ray, const RaySpan& span) noexcept {
  if (span.is_empty() || span.out < ray.low - kGrazing / ray.speed) return;
  inside = inside || span.in < ray.low;
  const double entry = std::max(span.in, ray.low);
  if (found && entry >= t) return;
  found = true;
  t = entry;
  normal = span.normal;
}

void PlaneClip::below(const Eigen::Vector3d& normal, double offset) noexcept {
  const double rate = normal.dot(ray_.direction);
  const double height = normal.dot(ray_.origin) - offset;
  if (std::fabs(rate) <= kParallelRate * ray_.speed) {
    // A rate of exactly zero is typical of axis-aligned normals, for which the height is exact,
    // too; then there is no tolerance.
    if (height > (rate == 0.0 ? 0.0 : kGrazing)) span_ = RaySpan{};
    return;
  }
  const double t = -height / rate;
  if (rate > 0.0) {
    span_.out = std::min(span_.out, t + kGrazing / rate);
  } else if (t > span_.in) {
    span_.in = t;
    span_.normal = normal;
  }
}

RaySpan ball_span(const LocalRay& ray, const Eigen::Vector3d& center, double radius) noexcept {
  return round_span(ray.origin - center, ray.direction, radius);
}

RaySpan capsule_span(const LocalRay& ray, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                     double radius) noexcept {
  const Eigen::Vector3d axis = unit_or_zero(b - a);
  const double length = axis.dot(b - a);
  const double along = axis.dot(ray.direction);
  const double begin = axis.dot(ray.origin - a);
  const Eigen::Vector3d velocity = ray.direction - along * axis;
  const Eigen::Vector3d offset = ray.origin - a - begin * axis;
  RaySpan span;
  double first = along > 0.0
                     ? -1.0
                     : length + 1.0;  // positions along the axis where the ray enters and leaves
  double last = length - first;
  if (velocity.norm() > kParallelRate * ray.speed) {
    span = round_span(offset, velocity, radius);
    if (span.is_empty()) return span;
    first = begin + along * span.in;
    last = begin + along * span.out;
  } else if (offset.norm() > radius + kGrazing) {
    return span;
  }
  // If the ray enters the infinite cylinder beyond an end of the segment, it enters the capsule
  // through the ball at that end.
  if (!(first >= 0.0 && first <= length)) {
    const RaySpan ball = ball_span(ray, first < 0.0 ? a : b, radius);
    if (ball.is_empty()) return {};
    span.in = ball.in;
    span.normal = ball.normal;
  }
  if (!(last >= 0.0 && last <= length)) {
    const RaySpan ball = ball_span(ray, last < 0.0 ? a : b, radius);
    if (ball.is_empty()) return {};
    span.out = ball.out;
  }
  return span;
}

RaySpan tube_span(const LocalRay& ray, double radius) noexcept {
  const Eigen::Vector3d offset(ray.origin.x(), ray.origin.y(), 0.0);
  const Eigen::Vector3d velocity(ray.direction.x(), ray.direction.y(), 0.0);
  if (velocity.norm() > kParallelRate * ray.speed) return round_span(offset, velocity, radius);
  if (offset.norm() > radius + kGrazing) return {};
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  return {-kInfinity, kInfinity, Eigen::Vector3d::Zero()};
}

RaySpan common(const RaySpan& a, const RaySpan& b) noexcept {
  return {std::max(a.in, b.in), std::min(a.out, b.out), a.in >= b.in ? a.normal : b.normal};
}

namespace {

/// The slab of a polygon's extent along its longest side, widened by the grazing tolerance.
RaySpan length_span(const LocalRay& ray, std::span<const Eigen::Vector3d> vertices) noexcept {
  Eigen::Vector3d longest = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Eigen::Vector3d side = vertices[i + 1 < vertices.size() ? i + 1 : 0] - vertices[i];
    if (side.squaredNorm() > longest.squaredNorm()) longest = side;
  }
  const Eigen::Vector3d axis = unit_or_zero(longest);
  double low = axis.dot(vertices[0]);
  double high = low;
  for (const Eigen::Vector3d& vertex : vertices) {
    low = std::min(low, axis.dot(vertex));
    high = std::max(high, axis.dot(vertex));
  }
  PlaneClip clip(ray);
  clip.below(axis, high + kGrazing);
  clip.below(-axis, -low + kGrazing);
  return clip.span();
}

}  // namespace

RaySpan prism_span(const LocalRay& ray, std::span<const Eigen::Vector3d> vertices,
                   const Eigen::Vector3d& normal, double bottom, double top) noexcept {
  PlaneClip clip(ray);
  const double level = normal.dot(vertices[0]);
  clip.below(normal, level + top);
  clip.below(-normal, -(level + bottom));
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Eigen::Vector3d& a = vertices[i];
    const Eigen::Vector3d& b = vertices[i + 1 < vertices.size() ? i + 1 : 0];
    const Eigen::Vector3d side = unit_or_zero((b - a).cross(normal));
    clip.below(side, side.dot(a));
    if (clip.span().is_empty()) return {};
  }
  // The side planes of a sliver may be parallel within rounding, so that they do not bound the
  // sliver along its length.
  return common(clip.span(), length_span(ray, vertices));
}

}  // namespace winnow
