#pragma once

#include <winnow/core/pose.h>
#include <winnow/pipeline/shapes.h>
#include "pipeline/exact/exact_vector.h"

#include <cstdint>

namespace winnow {

/// A disc about the z axis, at right angles to it.
struct CoreDisc {
  double z = 0.0;
  double radius = 0.0;
};

/// The vertices of a shape's core, in the shape's frame. The core of a cylinder or cone is the hull
/// of two discs; its vertices here are those of polygons inscribed in them. Points into itself or
/// into the shape.
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
  /// Coordinates of the vertices, among which are the places and radii of discs, and the rounding.
  void include_lengths(BitSpan& span) const noexcept;
};

/// Fills `core`; false for half-spaces and for what is known by a support function.
bool core_vertices(const ShapeTables& tables, ShapeId id, CoreVertices& core) noexcept;

/// The vertex farthest along a direction and how far, exactly. Products in double leave only those
/// near the maximum to exact arithmetic. O(vertices).
std::uint32_t farthest_vertex(const CoreVertices& core, const ExactVector& direction,
                              Dyadic& height) noexcept;

/// The points x - y, x in the core of a and y in that of b, times `scale`: the product of the
/// squares of both quaternions' lengths, which makes them polynomials of the input.
class CoreDifference {
 public:
  /// `core_a` and `core_b` must outlive it.
  CoreDifference(const CoreVertices& core_a, const Pose& pose_a, const CoreVertices& core_b,
                 const Pose& pose_b) noexcept;

  /// True if polynomials of degree 6 in the vertices and the roundings fit a Dyadic.
  [[nodiscard]] bool in_range() const noexcept { return in_range_; }
  /// True if those of degree one do, times products of four rotations: heights along products of
  /// two axes.
  [[nodiscard]] bool heights_in_range() const noexcept { return heights_in_range_; }
  [[nodiscard]] const Dyadic& scale() const noexcept { return scale_; }

  /// Axis `k` of the frame of a, of b, in the world, times a positive number.
  [[nodiscard]] ExactVector axis_a(int k) const noexcept { return column(turn_a_, k); }
  [[nodiscard]] ExactVector axis_b(int k) const noexcept { return column(turn_b_, k); }

  /// The vertex farthest along `direction` and its height: the product with the direction.
  void support(const ExactVector& direction, ExactVector& vertex, Dyadic& height) const noexcept;

  /// At least the height of every point along `direction`, discs included; more by 2^-50 of what
  /// the discs add, or exact where the roots are.
  [[nodiscard]] Dyadic height_bound(const ExactVector& direction) const noexcept;

 private:
  const CoreVertices& a_;
  const CoreVertices& b_;
  ExactMatrix turn_a_;
  ExactMatrix turn_b_;
  ExactVector offset_;  // of b from a, scaled
  Dyadic scale_;
  bool in_range_;
  bool heights_in_range_;
};

}  // namespace winnow
