// Tests in double of shapes against the box of one row; see box_intersection.h.

#include "partitions/queries/box_intersection.h"

#include <winnow/core/regions.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace winnow {
namespace {

using Vector = Eigen::Vector3d;

// A few roundings in double.
constexpr double kRounding = 8.0 * std::numeric_limits<double>::epsilon();

struct RowBox {
  Vector low;
  Vector high;
  explicit RowBox(const float* box) noexcept {
    for (int i = 0; i < 3; ++i) {
      low[i] = static_cast<double>(box[i]);
      high[i] = static_cast<double>(box[3 + i]);
    }
  }
};

/// Distance of a point from a box.
struct BoxDistance {
  Vector away = Vector::Zero();  ///< from the closest point of the box to the point
  double distance = 0.0;
  double error = 0.0;  ///< error bound of `distance`
};

/// `size` bounds the terms from which the coordinates of `p` were computed.
BoxDistance gap_to(const RowBox& box, const Vector& p, const Vector& size) noexcept {
  BoxDistance gap;
  for (int i = 0; i < 3; ++i) {
    const double end = p[i] < box.low[i] ? box.low[i] : box.high[i];
    if (p[i] >= box.low[i] && p[i] <= box.high[i]) continue;
    gap.away[i] = p[i] - end;
    gap.error += kRounding * (std::abs(end) + size[i]);
  }
  gap.distance = gap.away.norm();
  return gap;
}

/// Returns the parameter s in [0, 1] at which a + s * along is closest to the box: the root of the
/// derivative of the squared distance, which increases and is linear between the crossings of the
/// six planes.
double nearest_on_segment(const RowBox& box, const Vector& a, const Vector& along) noexcept {
  const auto slope = [&](double s) {
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) {
      const double p = a[i] + s * along[i];
      if (p < box.low[i]) sum += (p - box.low[i]) * along[i];
      if (p > box.high[i]) sum += (p - box.high[i]) * along[i];
    }
    return sum;
  };
  if (slope(0.0) >= 0.0) return 0.0;
  if (slope(1.0) <= 0.0) return 1.0;
  double below = 0.0;
  double above = 1.0;
  for (int i = 0; i < 3; ++i) {
    if (along[i] == 0.0) continue;
    for (const double end : {box.low[i], box.high[i]}) {
      const double s = (end - a[i]) / along[i];
      if (!(s > below && s < above)) continue;
      (slope(s) < 0.0 ? below : above) = s;
    }
  }
  const double low = slope(below);
  const double high = slope(above);
  return high > low ? std::clamp(below - low * (above - below) / (high - low), below, above)
                    : below;
}

/// Returns the gap between a capsule's axis, moved by `shift`, and a box.
BoxDistance axis_gap(const Capsule& capsule, const Vector& shift, const RowBox& box) noexcept {
  const Vector a = capsule.a.cast<double>();
  const Vector b = capsule.b.cast<double>();
  const Vector size = a.cwiseAbs().cwiseMax(b.cwiseAbs()) + shift.cwiseAbs();
  const Vector from = a + shift;
  if (capsule.a == capsule.b) return gap_to(box, from, size);
  const Vector along = b - a;
  const double s = nearest_on_segment(box, from, along);
  BoxDistance gap = gap_to(box, from + s * along, size);
  gap.error += kRounding * along.norm();
  return gap;
}

/// Returns the distance of the farthest corner from a point.
double farthest(const RowBox& box, const Vector& p) noexcept {
  return (box.low - p).cwiseAbs().cwiseMax((box.high - p).cwiseAbs()).norm();
}

}  // namespace

double touch_capsule(const void* shape, const float* six, double from) {
  const auto& moving = *static_cast<const MovingCapsule*>(shape);
  const RowBox box(six);
  const auto radius = static_cast<double>(moving.capsule.radius);
  constexpr int kSteps = 200;
  double t = from;
  for (int step = 0; step < kSteps; ++step) {
    const BoxDistance gap = axis_gap(moving.capsule, t * moving.direction, box);
    const double left = gap.distance - radius;
    if (left <= gap.error + kRounding * radius) return t;
    const double closing = -gap.away.dot(moving.direction) / gap.distance;
    if (!(closing > 0.0)) return -1.0;
    const double next = t + left / closing;
    if (next * (1.0 - kRounding) > moving.max_t) return -1.0;
    if (next <= t) return t;
    t = std::min(next, moving.max_t);
  }
  // A grazing contact, at which the distance keeps halving.
  return t;
}

Containment classify_sphere(const void* region, const float* six) {
  const auto& sphere = *static_cast<const Sphere*>(region);
  const RowBox box(six);
  const Vector center = sphere.center.cast<double>();
  const auto radius = static_cast<double>(sphere.radius);
  const BoxDistance gap = gap_to(box, center, center.cwiseAbs());
  if (gap.distance - gap.error > radius * (1.0 + kRounding)) return Containment::apart;
  return farthest(box, center) * (1.0 + kRounding) <= radius ? Containment::inside
                                                             : Containment::crossing;
}

Containment classify_capsule(const void* region, const float* six) {
  const auto& capsule = *static_cast<const Capsule*>(region);
  const RowBox box(six);
  const auto radius = static_cast<double>(capsule.radius);
  const BoxDistance gap = axis_gap(capsule, Vector::Zero(), box);
  if (gap.distance - gap.error > radius * (1.0 + kRounding)) return Containment::apart;
  // A convex region contains the box if it contains the corners.
  const Vector a = capsule.a.cast<double>();
  const Vector along = capsule.b.cast<double>() - a;
  const double square = along.squaredNorm();
  for (unsigned corner = 0; corner < 8; ++corner) {
    const Vector p((corner & 1U) != 0 ? box.high.x() : box.low.x(),
                   (corner & 2U) != 0 ? box.high.y() : box.low.y(),
                   (corner & 4U) != 0 ? box.high.z() : box.low.z());
    const double s = square > 0.0 ? std::clamp((p - a).dot(along) / square, 0.0, 1.0) : 0.0;
    const double reach = (p - a - s * along).norm();
    const double error = kRounding * (p.cwiseAbs().maxCoeff() + a.cwiseAbs().maxCoeff());
    if (!(reach + error <= radius)) return Containment::crossing;
  }
  return Containment::inside;
}

namespace {

/// The interval of normal . (p - center) over a box, with error bounds.
struct Shadow {
  double low = 0.0;
  double high = 0.0;
  double low_error = 0.0;
  double high_error = 0.0;

  Shadow(const RowBox& box, const Vector& center, const Vector& normal) noexcept {
    for (int i = 0; i < 3; ++i) {
      const double n = normal[i];
      if (n == 0.0) continue;
      const double near = n > 0.0 ? box.low[i] : box.high[i];
      const double far = n > 0.0 ? box.high[i] : box.low[i];
      low += n * (near - center[i]);
      high += n * (far - center[i]);
      low_error += kRounding * std::abs(n) * (std::abs(near) + std::abs(center[i]));
      high_error += kRounding * std::abs(n) * (std::abs(far) + std::abs(center[i]));
    }
  }
};

}  // namespace

Containment classify_oriented_box(const void* region, const float* six) {
  const auto& oriented = *static_cast<const OrientedBox*>(region);
  const RowBox box(six);
  const Vector center = oriented.center.cast<double>();
  const Eigen::Matrix3d axes = oriented.axes.cast<double>();
  const Vector half = oriented.half.cast<double>();
  const auto apart = [&](const Vector& normal) {
    double reach = 0.0;
    for (int k = 0; k < 3; ++k) reach += std::abs(normal.dot(axes.col(k))) * half[k];
    double size = 0.0;
    for (int k = 0; k < 3; ++k) size += axes.col(k).cwiseAbs().dot(normal.cwiseAbs()) * half[k];
    const Shadow shadow(box, center, normal);
    const double error = kRounding * size;
    return shadow.low > reach + error + shadow.low_error ||
           -shadow.high > reach + error + shadow.high_error;
  };
  for (int i = 0; i < 3; ++i) {
    if (apart(Vector::Unit(i))) return Containment::apart;
  }
  bool inside = true;
  for (int i = 0; i < 3; ++i) {
    const Vector normal = axes.col((i + 1) % 3).cross(axes.col((i + 2) % 3));
    if (apart(normal)) return Containment::apart;
    const Shadow shadow(box, center, normal);
    const double reach = std::abs(normal.dot(axes.col(i))) * half[i] * (1.0 - 4.0 * kRounding);
    inside = inside && reach > 0.0 && shadow.high + shadow.high_error <= reach &&
             -shadow.low + shadow.low_error <= reach;
  }
  if (inside) return Containment::inside;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      if (apart(Vector::Unit(i).cross(axes.col(k)))) return Containment::apart;
    }
  }
  return Containment::crossing;
}

Containment classify_planes(const void* region, const float* six) {
  const auto& planes = *static_cast<const std::span<const Plane>*>(region);
  const RowBox box(six);
  Containment result = Containment::inside;
  for (const Plane& plane : planes) {
    const Shadow shadow(box, Vector::Zero(), plane.normal.cast<double>());
    const auto offset = static_cast<double>(plane.offset);
    const double error = kRounding * std::abs(offset);
    if (shadow.high + offset < -(shadow.high_error + error)) return Containment::apart;
    if (!(shadow.low + offset >= shadow.low_error + error)) result = Containment::crossing;
  }
  return result;
}

}  // namespace winnow
