// Cores of all kinds but cylinder, cone and half-space as polytopes, with the candidates for face
// normals and edges that widest_gap needs. oracle.cpp calls it.

#include "bench/oracle/polytope.h"

#include <algorithm>

namespace winnow::oracle {
namespace {

using Vec = Vector<Number>;

/// Adds normals for a core without faces: a segment along `along`, or a point if `along` is zero.
void add_normals_around(Polytope& core, const Vec& along) {
  const Vec axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const Vec& axis : axes) core.normal.push_back(is_zero(along) ? axis : cross(along, axis));
}

void add_segment(Polytope& core, const Vec& from, const Vec& to) {
  core.vertex = {from, to};
  core.edge.push_back({0, 1});
  add_normals_around(core, to - from);
}

Polytope box(const BoxShape& shape) {
  Polytope core;
  const double* h = shape.half.data();
  for (std::uint32_t i = 0; i < 8; ++i) {
    core.vertex.push_back(
        {(i & 1U) != 0 ? -h[0] : h[0], (i & 2U) != 0 ? -h[1] : h[1], (i & 4U) != 0 ? -h[2] : h[2]});
    for (const std::uint32_t bit : {1U, 2U, 4U}) {
      if ((i & bit) == 0) core.edge.push_back({i, i | bit});
    }
  }
  core.normal = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  core.rounding = shape.rounding;
  return core;
}

Polytope triangle(const TriangleShape& shape) {
  Polytope core;
  for (const Vec3d& vertex : shape.vertex) core.vertex.push_back(exact(vertex));
  for (std::uint32_t i = 0; i < 3; ++i) {
    const std::uint32_t next = (i + 1) % 3;
    core.edge.push_back({i, next});
    // For a triangle without area.
    add_normals_around(core, core.vertex[next] - core.vertex[i]);
  }
  core.normal.push_back(cross(core.vertex[1] - core.vertex[0], core.vertex[2] - core.vertex[0]));
  core.rounding = shape.rounding;
  return core;
}

/// Adds the normal of a face. A face whose vertices were merged is flat only up to rounding: any
/// three of its vertices may be a face of the core, and any two of them an edge.
void add_face(Polytope& core, const HullShape& shape, const HullFace& face) {
  const std::uint32_t* const loop = &shape.loop[face.first];
  const auto normal = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) {
    const Vec& from = core.vertex[loop[i]];
    return cross(core.vertex[loop[j]] - from, core.vertex[loop[k]] - from);
  };
  const Vec first = normal(0, 1, 2);
  bool is_flat = !is_zero(first);
  for (std::uint32_t i = 3; i < face.count; ++i) {
    is_flat = is_flat && dot(first, core.vertex[loop[i]] - core.vertex[loop[0]]) == 0;
  }
  core.normal.push_back(first);
  for (std::uint32_t i = 0; i < face.count && !is_flat; ++i) {
    for (std::uint32_t j = i + 1; j < face.count; ++j) {
      core.edge.push_back({loop[i], loop[j]});
      for (std::uint32_t k = j + 1; k < face.count; ++k) core.normal.push_back(normal(i, j, k));
    }
  }
}

Polytope hull(const HullShape& shape) {
  Polytope core;
  for (std::uint32_t i = 0; i < shape.vertex_count; ++i) {
    core.vertex.push_back({shape.vertex[0][i], shape.vertex[1][i], shape.vertex[2][i]});
  }
  for (std::uint32_t i = 0; i < shape.face_count; ++i) add_face(core, shape, shape.faces[i]);
  for (std::uint32_t i = 0; i < shape.edge_count; ++i) {
    const HullEdge& edge = shape.edges[i];
    Polytope::Edge added{edge.vertex[0], edge.vertex[1]};
    added.has_sides = edge.face[0] < shape.face_count && edge.face[1] < shape.face_count;
    for (int side = 0; side < 2 && added.has_sides; ++side) {
      const double* n = shape.faces[edge.face[side]].normal.data();
      added.beside[side] = {n[0], n[1], n[2]};
    }
    core.edge.push_back(added);
  }
  if (shape.face_count == 0) {
    core.edge.push_back({0, shape.vertex_count - 1});
    add_normals_around(core, core.vertex.back() - core.vertex.front());
  }
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

Vector<Number> rotate(const Quaternion& orientation, const Vector<Number>& v) {
  const Number w = orientation.w();
  const Vec u{orientation.x(), orientation.y(), orientation.z()};
  const Number square = dot(u, u);
  const Vec turned = v * (w * w - square) + u * (2 * dot(u, v)) + cross(u, v) * (2 * w);
  return turned * (1 / (w * w + square));
}

void place(Polytope& core, const Quaternion& orientation, const Vector<Number>& offset,
           const Number& scale) {
  core.vertex_double.clear();
  for (Vec& v : core.vertex) {
    v = (rotate(orientation, v) + offset) * scale;
    core.vertex_double.push_back(rounded(v));
  }
  for (Vec& n : core.normal) n = rotate(orientation, n);
  for (Polytope::Edge& edge : core.edge) {
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
