// Cores of all kinds but cylinder, cone and half-space as polytopes, with the candidates for face
// normals and edges that least_overlap needs. oracle.cpp calls it.

#include "bench/oracle/polytope.h"

#include <algorithm>

namespace winnow::oracle {
namespace {

using Vec = Vector<Number>;

Vec exact(const double v[3]) {
  return {v[0], v[1], v[2]};
}

bool is_zero(const Vec& v) {
  return v.x == 0 && v.y == 0 && v.z == 0;
}

/// Adds normals for a core without faces: a segment along `along`, or a point if `along` is zero.
void add_normals_around(Polytope& core, const Vec& along) {
  const Vec axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const Vec& axis : axes) {
    const Vec normal = is_zero(along) ? axis : cross(along, axis);
    if (!is_zero(normal)) core.normal.push_back(normal);
  }
}

void add_segment(Polytope& core, const Vec& from, const Vec& to) {
  core.vertex = {from, to};
  if (is_zero(to - from)) {
    core.vertex.pop_back();
  } else {
    core.edge.push_back({to - from, {}, false});
  }
  add_normals_around(core, to - from);
}

Polytope box(const BoxShape& shape) {
  Polytope core;
  const double* h = shape.half.data();
  for (int i = 0; i < 8; ++i) {
    if ((i & 1 && h[0] == 0.0) || (i & 2 && h[1] == 0.0) || (i & 4 && h[2] == 0.0)) continue;
    core.vertex.push_back(
        {(i & 1) != 0 ? -h[0] : h[0], (i & 2) != 0 ? -h[1] : h[1], (i & 4) != 0 ? -h[2] : h[2]});
  }
  const Vec axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const Vec& axis : axes) {
    core.normal.push_back(axis);
    core.edge.push_back({axis, {}, false});
  }
  core.rounding = shape.rounding;
  return core;
}

/// Returns true if the three points are on a line: points given by doubles cannot be this close to
/// a line without being on it.
bool collinear(const Vec& normal, const Vec& side, const Vec& other) {
  return dot(normal, normal) <= dot(side, side) * dot(other, other) * Number(1e-90);
}

Polytope triangle(const TriangleShape& shape) {
  Polytope core;
  const Vec v[3] = {exact(shape.vertex[0].data()), exact(shape.vertex[1].data()),
                    exact(shape.vertex[2].data())};
  const Vec normal = cross(v[1] - v[0], v[2] - v[0]);
  if (collinear(normal, v[1] - v[0], v[2] - v[0])) {
    int longest = 0;
    const auto squared = [&](int i) {
      const Vec side = v[(i + 1) % 3] - v[i];
      return dot(side, side);
    };
    for (int i = 1; i < 3; ++i) {
      if (squared(i) > squared(longest)) longest = i;
    }
    add_segment(core, v[longest], v[(longest + 1) % 3]);
  } else {
    core.normal.push_back(normal);
    for (int i = 0; i < 3; ++i) {
      core.vertex.push_back(v[i]);
      core.edge.push_back({v[(i + 1) % 3] - v[i], {}, false});
    }
  }
  core.rounding = shape.rounding;
  return core;
}

/// Adds the mean normal of a face and the normals at its corners: a face whose vertices were merged
/// is flat only up to rounding.
void add_face_normals(Polytope& core, const HullShape& shape, const HullFace& face) {
  const auto vertex = [&](std::uint32_t i) -> const Vec& {
    return core.vertex[shape.loop[face.first + i % face.count]];
  };
  Vec sum;
  for (std::uint32_t i = 0; i < face.count; ++i) {
    const Vec& from = vertex(0);
    sum = sum + cross(vertex(i) - from, vertex(i + 1) - from);
    const Vec corner = cross(vertex(i + 1) - vertex(i), vertex(i + 2) - vertex(i + 1));
    if (face.count > 3 && !is_zero(corner)) core.normal.push_back(corner);
  }
  if (!is_zero(sum)) core.normal.push_back(sum);
}

Polytope hull(const HullShape& shape) {
  Polytope core;
  for (std::uint32_t i = 0; i < shape.vertex_count; ++i) {
    core.vertex.push_back({shape.vertex[0][i], shape.vertex[1][i], shape.vertex[2][i]});
  }
  for (std::uint32_t i = 0; i < shape.face_count; ++i) {
    add_face_normals(core, shape, shape.faces[i]);
  }
  for (std::uint32_t i = 0; i < shape.edge_count; ++i) {
    const HullEdge& edge = shape.edges[i];
    Polytope::Edge& added = core.edge.emplace_back();
    added.direction = core.vertex[edge.vertex[1]] - core.vertex[edge.vertex[0]];
    added.has_sides = edge.face[0] < shape.face_count && edge.face[1] < shape.face_count;
    for (int side = 0; side < 2 && added.has_sides; ++side) {
      const double* n = shape.faces[edge.face[side]].normal.data();
      added.beside[side] = {n[0], n[1], n[2]};
    }
  }
  if (shape.face_count == 0) add_normals_around(core, core.vertex.back() - core.vertex.front());
  core.rounding = shape.rounding;
  return core;
}

}  // namespace

bool has_polytope(ShapeKind kind) {
  return kind != ShapeKind::cylinder && kind != ShapeKind::cone && kind != ShapeKind::half_space;
}

Polytope core_of(const ShapeTables& tables, ShapeId shape) {
  const std::uint32_t i = shape.index();
  Polytope core;
  switch (shape.kind()) {
    case ShapeKind::box:
      return box(tables.boxes[i]);
    case ShapeKind::triangle:
      return triangle(tables.triangles[i]);
    case ShapeKind::hull:
      return hull(tables.hulls[i]);
    case ShapeKind::capsule:
      add_segment(core, {0, 0, -Number(tables.capsules[i].half_length)},
                  {0, 0, tables.capsules[i].half_length});
      core.rounding = tables.capsules[i].radius;
      return core;
    default:
      add_segment(core, {}, {});
      core.rounding = tables.spheres[i].radius;
      return core;
  }
}

Vector<Number> rotate(const double orientation[4], const Vector<Number>& v) {
  const Number w = orientation[0];
  const Vec u{orientation[1], orientation[2], orientation[3]};
  const Number square = dot(u, u);
  const Vec turned = v * (w * w - square) + u * (2 * dot(u, v)) + cross(u, v) * (2 * w);
  return turned * (1 / (w * w + square));
}

void place(Polytope& core, const double orientation[4], const Vector<Number>& offset,
           const Number& scale) {
  core.vertex_double.clear();
  for (Vec& v : core.vertex) {
    v = (rotate(orientation, v) + offset) * scale;
    core.vertex_double.push_back(rounded(v));
  }
  for (Vec& n : core.normal) n = rotate(orientation, n);
  for (Polytope::Edge& edge : core.edge) {
    edge.direction = rotate(orientation, edge.direction);
    for (Vector<double>& n : edge.beside) {
      n = rounded(rotate(orientation, {n.x, n.y, n.z}));
    }
  }
  core.rounding *= scale;
}

Number radius_of(const Polytope& core) {
  Vec mean;
  for (const Vec& v : core.vertex) mean = mean + v;
  mean = mean * (Number(1) / core.vertex.size());
  Number radius = 0;
  for (const Vec& v : core.vertex) radius = std::max(radius, length(v - mean));
  return radius + core.rounding;
}

}  // namespace winnow::oracle
