#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/shapes.h>
#include "bench/oracle/number.h"

#include <cstdint>
#include <vector>

namespace winnow::oracle {

/// The core of a shape: the convex hull of `vertex`, with every direction that can be a face normal
/// (up to sign and length) and every edge; a core that is a point has an edge too. Extra directions
/// and edges are harmless, and so are zero directions.
struct Polytope {
  struct Edge {
    std::uint32_t from;
    std::uint32_t to;
    /// Outward normals of the two faces at the edge; used to skip pairs of edges that cannot form a
    /// face.
    Vector<double> beside[2]{};
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

/// Returns the core in the shape's frame. `vertex_double` is not set.
[[nodiscard]] Polytope core_of(const ShapeTables& tables, ShapeId shape);

/// Sets `vertex_double` and transforms x to scale * (offset + R(orientation) x).
void place(Polytope& core, const Quaternion& orientation, const Vector<Number>& offset,
           const Number& scale);

/// Rotates v by a quaternion of any length but zero.
[[nodiscard]] Vector<Number> rotate(const Quaternion& orientation, const Vector<Number>& v);

/// Radius of a ball around the mean of the vertices that contains the core, rounding included.
[[nodiscard]] Number radius_of(const Polytope& core);

}  // namespace winnow::oracle
