#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/shapes.h>
#include "pipeline/exact/exact_vector.h"
#include "pipeline/kinds/shape_core.h"

#include <cstdint>

namespace winnow {

/// A disc centered on the z axis and orthogonal to it.
struct CoreDisc {
  double z = 0.0;
  double radius = 0.0;
};

/// The vertices of a shape's core, in the shape's frame. The core of a cylinder or cone is the
/// convex hull of two discs; `column` then contains polygons inscribed in the discs. `column`
/// points into this object, which has room for two polygons of 16 corners, or into the shape.
struct CoreVertices {
  CoreVertices() noexcept = default;
  CoreVertices(const CoreVertices&) = delete;
  CoreVertices& operator=(const CoreVertices&) = delete;

  std::uint32_t count = 0;
  const double* column[3] = {own[0], own[1], own[2]};
  double own[3][32];
  double rounding = 0.0;
  bool has_discs = false;
  CoreDisc disc[2];

  [[nodiscard]] ExactVector at(std::uint32_t i) const noexcept {
    return {{column[0][i], column[1][i], column[2][i]}};
  }
  /// Extends `span` by the bits of the rounding and of all vertex coordinates. The position and the
  /// radius of a disc are coordinates of its polygon.
  void include_lengths(BitSpan& span) const noexcept;
};

/// Fills `core`; returns false for half-spaces and support functions.
bool core_vertices(const ShapeCore& shape, CoreVertices& core) noexcept;

/// Returns the vertex farthest along `direction` and its exact height. Bounds in double exclude
/// most vertices; only those near the maximum are computed exactly. O(vertices).
std::uint32_t farthest_vertex(const CoreVertices& core, const ExactVector& direction,
                              Dyadic& height) noexcept;

/// The Minkowski difference a - b of two cores (the solver's GJK uses b - a): the points x - y with
/// x in core a and y in core b, times `scale`. The scale is the product of the squared lengths of
/// both quaternions; with it coordinates are polynomials of the input.
class CoreDifference {
 public:
  /// `core_a` and `core_b` must outlive it.
  CoreDifference(const CoreVertices& core_a, const Pose& pose_a, const CoreVertices& core_b,
                 const Pose& pose_b) noexcept;

  /// Returns whether polynomials of degree 6 in the vertices, and the roundings, fit a Dyadic.
  [[nodiscard]] bool in_range() const noexcept { return in_range_; }
  /// Returns whether polynomials of degree 1 in the vertices times products of four rotations fit a
  /// Dyadic: heights along cross products of two axes.
  [[nodiscard]] bool heights_in_range() const noexcept { return heights_in_range_; }
  [[nodiscard]] const Dyadic& scale() const noexcept { return scale_; }

  /// Axis `k` of the frame of a (or b) in the world, times a positive number.
  [[nodiscard]] ExactVector axis_a(int k) const noexcept { return column(turn_a_, k); }
  [[nodiscard]] ExactVector axis_b(int k) const noexcept { return column(turn_b_, k); }

  /// Support function: the vertex farthest along `direction`, and its dot product with the
  /// direction.
  void support(const ExactVector& direction, ExactVector& vertex, Dyadic& height) const noexcept;

  /// Upper bound on the height of all points along `direction`, discs included. It exceeds the
  /// maximum by at most 2^-50 of the discs' contribution, and is exact if the square roots are.
  [[nodiscard]] Dyadic height_bound(const ExactVector& direction) const noexcept;

 private:
  const CoreVertices& a_;
  const CoreVertices& b_;
  ExactMatrix turn_a_;
  ExactMatrix turn_b_;
  ExactVector offset_;  // position of b relative to a, scaled
  Dyadic scale_;
  bool in_range_;
  bool heights_in_range_;
};

}  // namespace winnow
