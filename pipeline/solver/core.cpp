#include "pipeline/solver/core.h"

#include <algorithm>
#include <cmath>

namespace winnow::solver {
namespace {

/// The vertex of a hull that is farthest along a direction in the hull's frame. Blocks of eight
/// keep independent maxima, so that the loop does not wait for each comparison.
std::uint32_t farthest_vertex(const HullShape& hull, const Vec& d, double& value) noexcept {
  constexpr std::uint32_t kBlock = 8;
  double best = -std::numeric_limits<double>::infinity();
  std::uint32_t best_at = 0;
  for (std::uint32_t i = 0; i < hull.vertex_count; i += kBlock) {
    double dot[kBlock];
    for (std::uint32_t k = 0; k < kBlock; ++k) {
      dot[k] = hull.vertex[0][i + k] * d.x() + hull.vertex[1][i + k] * d.y() +
               hull.vertex[2][i + k] * d.z();
    }
    double top = dot[0];
    for (std::uint32_t k = 1; k < kBlock; ++k) top = dot[k] > top ? dot[k] : top;
    if (!(top > best)) continue;
    best = top;
    std::uint32_t k = 0;
    while (k + 1 < kBlock && dot[k] != top) ++k;
    best_at = i + k;
  }
  value = best;
  // Padding repeats vertex 0.
  return best_at < hull.vertex_count ? best_at : 0;
}

Vec rim(const Core& core, const Vec& local, double z) noexcept {
  const double length = std::hypot(local.x(), local.y());
  if (length == 0.0) return {0.0, 0.0, z};
  // Divided first: directions may be short enough for the quotient of the radius to overflow.
  return {core.half.x() * (local.x() / length), core.half.x() * (local.y() / length), z};
}

double radial(const Core& core, const Vec& local) noexcept {
  return core.half.x() * std::hypot(local.x(), local.y());
}

}  // namespace

Vec unit(const Vec& v) noexcept {
  const double largest = v.cwiseAbs().maxCoeff();
  if (!(largest > 0.0)) return Vec::Zero();
  int exponent = 0;
  std::frexp(largest, &exponent);
  const int half = exponent / 2;
  const Vec scaled = v * std::ldexp(1.0, -half) * std::ldexp(1.0, half - exponent);
  return scaled / scaled.norm();
}

Vec perpendicular(const Vec& e, const Vec& f) noexcept {
  return without(unit(e.cross(f)), e);
}

Vec without(const Vec& v, const Vec& e) noexcept {
  const Vec once = unit(v - e * e.dot(v));
  return unit(once - e * e.dot(once));
}

Vec support(const Core& core, const Vec& direction) noexcept {
  switch (core.kind) {
    case CoreKind::point:
      return core.center;
    case CoreKind::triangle: {
      const double d0 = core.corner[0].dot(direction);
      const double d1 = core.corner[1].dot(direction);
      const double d2 = core.corner[2].dot(direction);
      return core.center + core.corner[d0 >= d1 && d0 >= d2 ? 0 : (d1 >= d2 ? 1 : 2)];
    }
    default:
      break;
  }
  const Vec d = core.rotation.transpose() * direction;
  const Vec& h = core.half;
  const double z = d.z() < 0.0 ? -h.z() : h.z();
  Vec local = Vec::Zero();
  switch (core.kind) {
    case CoreKind::segment:
      local.z() = z;
      break;
    case CoreKind::box:
      local = {d.x() < 0.0 ? -h.x() : h.x(), d.y() < 0.0 ? -h.y() : h.y(), z};
      break;
    case CoreKind::cylinder:
      local = rim(core, d, z);
      break;
    case CoreKind::cone:
      local = h.z() * d.z() >= radial(core, d) - h.z() * d.z() ? Vec(0.0, 0.0, h.z())
                                                               : rim(core, d, -h.z());
      break;
    default: {
      double value = 0.0;
      return vertex(core, farthest_vertex(*core.hull, d, value));
    }
  }
  return core.center + core.rotation * local;
}

Range project(const Core& core, const Vec& n) noexcept {
  switch (core.kind) {
    case CoreKind::point:
      return {0.0, 0.0};
    case CoreKind::triangle: {
      const double d0 = core.corner[0].dot(n);
      const double d1 = core.corner[1].dot(n);
      const double d2 = core.corner[2].dot(n);
      return {std::min({d0, d1, d2}), std::max({d0, d1, d2})};
    }
    default:
      break;
  }
  const Vec d = core.rotation.transpose() * n;
  const double along = std::abs(d.z()) * core.half.z();
  switch (core.kind) {
    case CoreKind::segment:
      return {-along, along};
    case CoreKind::box: {
      const double reach = d.cwiseAbs().dot(core.half);
      return {-reach, reach};
    }
    case CoreKind::cylinder: {
      const double reach = radial(core, d) + along;
      return {-reach, reach};
    }
    case CoreKind::cone: {
      const double tip = core.half.z() * d.z();
      const double side = radial(core, d);
      return {std::min(tip, -side - tip), std::max(tip, side - tip)};
    }
    default: {
      Range range{};
      farthest_vertex(*core.hull, d, range.high);
      farthest_vertex(*core.hull, -d, range.low);
      range.low = -range.low * core.unit[0] * core.unit[1];
      range.high = range.high * core.unit[0] * core.unit[1];
      return range;
    }
  }
}

double separation(const Core& a, const Core& b, const Vec& axis) noexcept {
  return axis.dot(b.center - a.center) + project(b, axis).low - project(a, axis).high;
}

Core meridian(const Core& core, const Vec& direction) noexcept {
  if (core.kind != CoreKind::cylinder && core.kind != CoreKind::cone) return core;
  const Vec d = core.rotation.transpose() * direction;
  // Along the axis all planes are alike.
  if (std::hypot(d.x(), d.y()) <= 1e-7 * std::abs(d.z())) return core;
  const double h = core.half.z();
  const Vec low = rim(core, d, -h);
  const Vec high = core.kind == CoreKind::cone ? Vec(0.0, 0.0, h) : rim(core, d, h);
  const Vec middle(0.0, 0.0, core.kind == CoreKind::cylinder && d.z() > 0.0 ? h : -h);
  Core triangle = core;
  triangle.kind = CoreKind::triangle;
  triangle.corner = {core.rotation * low, core.rotation * high, core.rotation * middle};
  for (std::size_t i = 0; i < 3; ++i) {
    triangle.side[i] = unit(triangle.corner[(i + 1) % 3] - triangle.corner[i]);
  }
  return triangle;
}

}  // namespace winnow::solver
