#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/shapes.h>
#include "bench/oracle/number.h"

#include <vector>

namespace winnow::oracle {

/// The core of a shape: the convex hull of `vertex`, with every direction that can be a face normal
/// (up to sign) and every edge. Extra directions are harmless.
struct Polytope {
  struct Edge {
    Vector<Number> direction;
    /// Outward normals of the two faces at the edge; used to skip pairs of edges that cannot form a
    /// face.
    Vector<double> beside[2];
    bool has_sides = false;
  };

  std::vector<Vector<Number>> vertex;
  std::vector<Vector<double>> vertex_double;
  std::vector<Vector<Number>> normal;
  std::vector<Edge> edge;
  Number rounding = 0;
};

/// Returns true for kinds whose core is a polytope.
[[nodiscard]] bool has_polytope(ShapeKind kind);

/// Returns the core in the shape's frame. `edge.beside` and `vertex_double` are not set.
[[nodiscard]] Polytope core_of(const ShapeTables& tables, ShapeId shape);

/// Transforms x to scale * (offset + R(orientation) x).
void place(Polytope& core, const double orientation[4], const Vector<Number>& offset,
           const Number& scale);

/// Rotates v by a quaternion of any length but zero.
[[nodiscard]] Vector<Number> rotate(const double orientation[4], const Vector<Number>& v);

/// Radius of a ball around the mean of the vertices that contains the core, rounding included.
[[nodiscard]] Number radius_of(const Polytope& core);

}  // namespace winnow::oracle
