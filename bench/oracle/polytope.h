#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/shapes.h>
#include "bench/oracle/number.h"

#include <vector>

namespace winnow::oracle {

/// The core of a shape: the hull of `vertex`, with every direction that can be the normal of a face
/// of it (both signs are meant) and of every edge. More directions than there are do no harm.
struct Polytope {
  struct Edge {
    Vector<Number> direction;
    /// Outward normals beside it; used to pass over pairs of edges that cannot make a face.
    Vector<double> beside[2];
    bool has_sides = false;
  };

  std::vector<Vector<Number>> vertex;
  std::vector<Vector<double>> vertex_double;
  std::vector<Vector<Number>> normal;
  std::vector<Edge> edge;
  Number rounding = 0;
};

/// True for kinds whose core is a polytope.
[[nodiscard]] bool has_polytope(ShapeKind kind);

/// The core in its own frame. `edge.beside` and `vertex_double` are not set.
[[nodiscard]] Polytope core_of(const ShapeTables& tables, ShapeId shape);

/// x -> offset + R(orientation) x, all of it then times `scale`.
void place(Polytope& core, const double orientation[4], const Vector<Number>& offset,
           const Number& scale);

/// The rotation of a quaternion of any length but zero.
[[nodiscard]] Vector<Number> rotate(const double orientation[4], const Vector<Number>& v);

/// Radius about the mean of its vertices, rounding included.
[[nodiscard]] Number radius_of(const Polytope& core);

}  // namespace winnow::oracle
