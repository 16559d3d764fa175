// The functions of the cores of the solver, on which the other files of this folder build;
// core_forms.h has them for each kind.

#include "pipeline/solver/core.h"

#include "pipeline/kinds/hypotenuse.h"
#include "pipeline/solver/core_forms.h"

#include <cmath>

namespace winnow::solver {

Vec unit(const Vec& v) noexcept {
  const double largest = v.cwiseAbs().maxCoeff();
  if (!(largest > 0.0)) return Vec::Zero();
  // Vectors in this range need no scaling: their squares neither overflow nor underflow, and
  // scaling by a power of two would not change the result.
  constexpr double kSafe = 1e140;
  if (largest > 1.0 / kSafe && largest < kSafe) return v / v.norm();
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

// The maximum of eight products is computed first, then compared with the best so far: only one
// comparison in eight depends on the vertices before.
std::uint32_t farthest_vertex(const HullShape& hull, const Vec& d, double& value) noexcept {
  constexpr int kBlock = 8;
  using Block = Eigen::Array<double, kBlock, 1>;
  double best = -std::numeric_limits<double>::infinity();
  std::uint32_t best_at = 0;
  for (std::uint32_t i = 0; i < hull.vertex_count; i += kBlock) {
    const Block dot = Block::Map(hull.vertex[0] + i) * d.x() +
                      Block::Map(hull.vertex[1] + i) * d.y() +
                      Block::Map(hull.vertex[2] + i) * d.z();
    const double top = dot.maxCoeff();
    if (!(top > best)) continue;
    best = top;
    int k = 0;
    while (k + 1 < kBlock && dot[k] != top) ++k;
    best_at = i + static_cast<std::uint32_t>(k);
  }
  value = best;
  // The columns are padded with copies of vertex 0.
  return best_at < hull.vertex_count ? best_at : 0;
}

// The searches spend most of their time here: everything is inlined.
[[gnu::flatten]] Vec support(const Core& core, const Vec& direction) noexcept {
  return with_form(core, [&](auto form) { return form.support(core, direction); });
}

[[gnu::flatten]] AxisRange project(const Core& core, const Vec& n) noexcept {
  return with_form(core, [&](auto form) { return form.project(core, n); });
}

double highest(const Core& core, const Vec& n) noexcept {
  if (core.kind != ShapeKind::hull) return project(core, n).high;
  double value = 0.0;
  farthest_vertex(*core.hull, core.rotation.transpose() * n, value);
  return core.scale(value);
}

double separation(const Core& a, const Core& b, const Vec& axis) noexcept {
  return axis.dot(b.center - a.center) + project(b, axis).low - project(a, axis).high;
}

Core meridian(const Core& core, const Vec& direction) noexcept {
  if (core.kind != ShapeKind::cylinder && core.kind != ShapeKind::cone) return core;
  const Vec d = core.rotation.transpose() * direction;
  // Along the axis all meridian planes are alike.
  if (hypotenuse(d.x(), d.y()) <= 1e-7 * std::abs(d.z())) return core;
  const double h = core.half.z();
  const Vec low = rim(core, d, -h);
  const Vec high = core.kind == ShapeKind::cone ? Vec(0.0, 0.0, h) : rim(core, d, h);
  const Vec middle(0.0, 0.0, core.kind == ShapeKind::cylinder && d.z() > 0.0 ? h : -h);
  Core triangle = core;
  triangle.kind = ShapeKind::triangle;
  triangle.corner = {core.rotation * low, core.rotation * high, core.rotation * middle};
  for (std::size_t i = 0; i < 3; ++i) {
    triangle.side[i] = unit(triangle.corner[(i + 1) % 3] - triangle.corner[i]);
  }
  return triangle;
}

std::uint32_t vertex_count(const Core& core) noexcept {
  return with_form(core, [&](auto form) { return form.vertex_count(core); });
}
Vec vertex(const Core& core, std::uint32_t i) noexcept {
  return with_form(core, [&](auto form) { return form.vertex(core, i); });
}
std::uint32_t edge_count(const Core& core) noexcept {
  return with_form(core, [&](auto form) { return form.edge_count(core); });
}
Edge edge(const Core& core, std::uint32_t i) noexcept {
  return with_form(core, [&](auto form) { return form.edge(core, i); });
}
std::uint32_t direction_count(const Core& core) noexcept {
  return with_form(core, [&](auto form) { return form.direction_count(core); });
}
Vec direction(const Core& core, std::uint32_t i) noexcept {
  return with_form(core, [&](auto form) { return form.direction(core, i); });
}
std::uint32_t normal_count(const Core& core) noexcept {
  return with_form(core, [&](auto form) { return form.normal_count(core); });
}
Vec normal(const Core& core, std::uint32_t i) noexcept {
  return with_form(core, [&](auto form) { return form.normal(core, i); });
}
std::uint32_t face_count(const Core& core) noexcept {
  return with_form(core, [&](auto form) { return form.face_count(core); });
}
std::uint32_t face_size(const Core& core, std::uint32_t face) noexcept {
  return with_form(core, [&](auto form) { return form.face_size(core, face); });
}
std::uint32_t face_vertex(const Core& core, std::uint32_t face, std::uint32_t i) noexcept {
  return with_form(core, [&](auto form) { return form.face_vertex(core, face, i); });
}
std::uint32_t face_edge(const Core& core, std::uint32_t face, std::uint32_t i) noexcept {
  return with_form(core, [&](auto form) { return form.face_edge(core, face, i); });
}
Vec face_normal(const Core& core, std::uint32_t face) noexcept {
  return with_form(core, [&](auto form) { return form.face_normal(core, face); });
}
bool is_polytope(const Core& core) noexcept {
  return with_form(core, [](auto form) { return form.kIsPolytope; });
}
double inscribe(Core& core) noexcept {
  return with_form(core, [&](auto form) { return form.inscribe(core); });
}

}  // namespace winnow::solver
