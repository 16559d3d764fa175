#include "bench/oracle/round_core.h"

#include <algorithm>

namespace winnow::oracle {
namespace {

using Vec = Vector<Number>;

struct Round {
  double radius;
  double half_length;
  double rounding;
  bool has_apex;
};

Round round_of(const ShapeTables& tables, ShapeId shape) {
  const std::uint32_t i = shape.index();
  if (shape.kind() == ShapeKind::cylinder) {
    const CylinderShape& s = tables.cylinders[i];
    return {s.radius, s.half_length, s.rounding, false};
  }
  const ConeShape& s = tables.cones[i];
  return {s.radius, s.half_length, s.rounding, true};
}

/// Points of the unit circle in order, denser near the direction of (x, y).
std::vector<Vec> circle(const Vec& aim) {
  const Number size = sqrt(aim.x * aim.x + aim.y * aim.y);
  const Vec to = size == 0 ? Vec{1, 0, 0} : Vec{aim.x / size, aim.y / size, 0};
  // Tangents of half the angles to that direction: a rotation by 2 atan t is rational in t.
  std::vector<Number> tangents{0};
  for (int i = 2; i < 24; ++i) tangents.push_back(ldexp(Number(1), -i));
  for (const double t : {0.5, 0.75, 1.0, 1.5, 2.5, 6.0}) tangents.push_back(t);
  std::sort(tangents.begin(), tangents.end());
  std::vector<Vec> points;
  const auto add = [&](const Number& t) {
    const Number c = (1 - t * t) / (1 + t * t);
    const Number s = 2 * t / (1 + t * t);
    points.push_back({to.x * c - to.y * s, to.x * s + to.y * c, 0});
  };
  for (auto t = tangents.rbegin(); t + 1 != tangents.rend(); ++t) add(-*t);
  for (const Number& t : tangents) add(t);
  return points;
}

void add_edge(Polytope& core, std::size_t from, std::size_t to, const Vec& beside,
              const Vec& other) {
  core.edge.push_back({static_cast<std::uint32_t>(from),
                       static_cast<std::uint32_t>(to),
                       {unit(rounded(beside)), unit(rounded(other))},
                       true});
}

}  // namespace

Polytope inscribed(const ShapeTables& tables, ShapeId shape, const Vector<Number>& aim) {
  const Round round = round_of(tables, shape);
  const Vec up{0, 0, 1};
  const Vec down{0, 0, -1};
  Polytope core;
  core.rounding = round.rounding;
  core.normal = {up, {1, 0, 0}, {0, 1, 0}};
  const Vec top{0, 0, round.half_length};
  if (round.radius == 0.0) {
    core.vertex = {top, top * Number(-1)};
    core.edge.push_back({0, 1});
    return core;
  }
  const std::vector<Vec> rim = circle(aim);
  const std::size_t count = rim.size();
  std::vector<Vec> side;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec middle = rim[i] + rim[(i + 1) % count];
    const Vec out = middle * (1 / length(middle));
    // A side facet of a cone rises from its chord to the apex: by the cone's height over the
    // distance of the chord from the axis.
    const Number chord = round.radius * length(middle) / 2;
    side.push_back(round.has_apex ? out * (2 * Number(round.half_length)) + up * chord : out);
    core.normal.push_back(side.back());
  }
  // The vertices are the lower rim and then the upper rim or the apex.
  for (const Vec& point : rim) core.vertex.push_back(point * Number(round.radius) - top);
  for (std::size_t i = 0; i < (round.has_apex ? 1 : count); ++i) {
    core.vertex.push_back(round.has_apex ? top : rim[i] * Number(round.radius) + top);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t next = (i + 1) % count;
    add_edge(core, i, next, down, side[i]);
    if (!round.has_apex) add_edge(core, count + i, count + next, up, side[i]);
    add_edge(core, i, round.has_apex ? count : count + i, side[(i + count - 1) % count], side[i]);
  }
  return core;
}

Number least_along(const ShapeTables& tables, ShapeId shape, const Vector<Number>& n) {
  if (has_polytope(shape.kind())) {
    const Polytope core = core_of(tables, shape);
    Number least = dot(n, core.vertex.front());
    for (const Vec& v : core.vertex) least = std::min(least, dot(n, v));
    return least - core.rounding;
  }
  const Round round = round_of(tables, shape);
  const Number side = sqrt(n.x * n.x + n.y * n.y) * round.radius;
  const Number end = n.z * round.half_length - (round.has_apex ? Number(0) : side);
  return std::min(end, Number(-n.z * round.half_length - side)) - round.rounding;
}

}  // namespace winnow::oracle
