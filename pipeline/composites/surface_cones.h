#pragma once

#include <winnow/pipeline/narrow_phase.h>
#include "pipeline/composites/mid_phase.h"
#include "pipeline/narrow/primitive_pairs.h"
#include "pipeline/shapes/frame.h"

#include <cstddef>
#include <cstdint>

namespace winnow::mid {

/// A triangle of a surface, in the frame of the contacts.
struct Facet {
  Vec corner[3];
  /// Unit normal by the winding; zero if the triangle has no area.
  Vec normal;
  /// Length of the longest edge.
  double size;

  /// Leaves the members uninitialised.
  Facet() noexcept = default;
  /// The triangle at a pose.
  Facet(const TriangleShape& triangle, const Pose& pose) noexcept;

  /// Returns whether the point is on the triangle, up to `slack`; false without area.
  [[nodiscard]] bool contains(const Vec& point, double slack) const noexcept;
  /// Height of the highest corner along a direction.
  [[nodiscard]] double top(const Vec& direction) const noexcept;
  /// Returns whether the triangles share a corner, up to rounding.
  [[nodiscard]] bool shares_corner(const Facet& other) const noexcept;
};

/// Sine of the angle by which a triangle may rise above a plane that bounds it: rounding of
/// vertices to float bends flat surfaces.
inline constexpr double kFlatSine = 1e-4;
/// Sine of the angle up to which a normal counts as that of a face.
inline constexpr double kNearlyFace = 1e-5;

/// Answers of the narrow phase for one pair of bodies whose primitives have the same kinds.
struct AnswerGroup {
  std::size_t first = 0;
  std::size_t end = 0;
  /// The pair of bodies.
  std::size_t bodies = 0;
};

/// Tests contacts of surfaces against the normal cones of the surfaces.
///
/// A triangle touches with its face, an edge or a corner: its supporting feature along the contact
/// normal. An edge or corner can only be touched along a direction in its normal cone: no triangle
/// around the feature reaches farther along the direction. These triangles are found by the touched
/// point, which they contain, as they are placed, scaled, mirrored and deformed; seen from the side
/// of the contact, whatever the winding; and also if vertices are not shared (T-junctions). Most of
/// them touch the other body, too, and have answers in the same group; the others are found in the
/// tree of the mesh.
///
/// Convex parts of a compound are tested likewise, with their faces: a part that contains the
/// touched point and reaches farther along the direction covers it. So parts that lie flush, and
/// parts that overlap, are a union. Only parts of the same group are compared.
class SurfaceCones {
 public:
  SurfaceCones(const CollidedPairs& collided, const ShapeTables& tables,
               const PrimitivePairs& pairs, const NarrowResult& result) noexcept
      : collided_(collided), tables_(tables), pairs_(pairs), result_(result) {}

  /// Returns whether the normal of answer i is in the normal cones of both supporting features.
  /// O(size of the group).
  [[nodiscard]] bool has_normal(std::size_t i, const AnswerGroup& group) const noexcept;

  /// A triangle of a surface, and its primitive if it is in the group, else kNoPrimitive.
  struct Blocker {
    Facet facet;
    std::uint32_t primitive;
  };
  static constexpr std::uint32_t kNoPrimitive = ~0U;

  /// Finds a triangle of the surface that contains the point, up to `slack`, and rises above it
  /// along `outward`: then the direction is not in the normal cone at the point. Returns false if
  /// there is none.
  [[nodiscard]] bool find_blocker(const Vec& point, const Vec& outward, double slack, bool second,
                                  const AnswerGroup& group, Blocker& blocker) const noexcept;

  /// Returns whether a translation that parts the primitives of answer s along its normal also
  /// parts those of answer i: the plane through the supporting feature of s has both on their own
  /// sides.
  [[nodiscard]] bool parts(std::size_t s, std::size_t i) const noexcept;

  /// Returns whether the triangles of the two answers share a corner, in both bodies.
  [[nodiscard]] bool are_neighbours(std::size_t i, std::size_t k) const noexcept;

  [[nodiscard]] bool overlaps(std::size_t i) const noexcept { return result_.overlaps(i); }
  [[nodiscard]] bool is_triangle(std::uint32_t primitive) const noexcept {
    return pairs_.shapes[primitive].kind() == ShapeKind::triangle;
  }
  [[nodiscard]] Facet facet(std::uint32_t primitive) const noexcept;
  [[nodiscard]] Vec normal(std::size_t i) const noexcept {
    return {result_.normal(0)[i], result_.normal(1)[i], result_.normal(2)[i]};
  }
  /// The primitive of body a or, if `second`, of body b.
  [[nodiscard]] std::uint32_t primitive(std::size_t i, bool second) const noexcept {
    const BodyPair& pair = pairs_.pairs[result_.pair_of(i)];
    return second ? pair.b : pair.a;
  }

 private:
  /// What the triangles of a group do at a point of another triangle.
  enum class Surroundings : std::uint8_t { none, below, above };

  /// If `above`, both set `blocker` to the triangle that rises.
  [[nodiscard]] Surroundings around_in_surface(const Vec& point, const Vec& outward, double slack,
                                               bool second, const AnswerGroup& group,
                                               Blocker& blocker) const noexcept;
  [[nodiscard]] Surroundings around(const Vec& point, const Vec& outward, double slack,
                                    std::uint32_t own, bool second, const AnswerGroup& group,
                                    double distance, Blocker& blocker) const noexcept;
  [[nodiscard]] bool has_normal(std::size_t i, const AnswerGroup& group,
                                bool second) const noexcept;
  [[nodiscard]] bool is_covered(std::size_t i, const AnswerGroup& group,
                                bool second) const noexcept;
  [[nodiscard]] bool part_contains(std::uint32_t primitive, const Vec& point,
                                   double slack) const noexcept;
  /// Height of a primitive along a unit direction.
  [[nodiscard]] double top(std::uint32_t primitive, const Vec& direction) const noexcept;
  [[nodiscard]] bool is_near(std::uint32_t primitive, const Vec& point,
                             double slack) const noexcept;
  [[nodiscard]] bool share_corner(std::uint32_t one, std::uint32_t two) const noexcept;
  [[nodiscard]] bool is_below(std::uint32_t primitive, std::uint32_t limit,
                              const Vec& direction) const noexcept;
  [[nodiscard]] Vec middle_of_contact(std::size_t i, bool second) const noexcept;
  /// The deepest point of the contact; on the surface of body a or in the middle of the gap.
  [[nodiscard]] Vec touched_point(std::size_t i) const noexcept;

  const CollidedPairs& collided_;
  const ShapeTables& tables_;
  const PrimitivePairs& pairs_;
  const NarrowResult& result_;
};

}  // namespace winnow::mid
