#pragma once

#include "pipeline/composites/composites.h"
#include "pipeline/mesh/mesh_view.h"
#include "pipeline/shapes/frame.h"
#include "pipeline/shapes/front.h"

#include <cstdint>
#include <optional>

namespace winnow::mid {

/// Corner 0 of a triangle and the edges from it to the others.
struct Corners {
  Vec first;
  Vec edge[2];

  /// With corner 0 at the origin.
  [[nodiscard]] TriangleShape triangle() const noexcept;
  /// To the side from which the corners run counter-clockwise; not of unit length.
  [[nodiscard]] Vec normal() const noexcept { return edge[0].cross(edge[1]); }
  [[nodiscard]] Box box() const noexcept;
};

/// A convex shape where it stands.
struct PlacedPart {
  ShapeId shape;
  /// 0 or the number of a child.
  std::uint32_t number;
  Mat rotation;
  Vec position;
  /// No point is farther from the position.
  double radius = 0.0;
  /// A point inside, turned and relative to the position: no point of the shape is farther from it
  /// than `reach`, none within `inner` of it is outside.
  Vec middle = Vec::Zero();
  double reach = 0.0;
  double inner = 0.0;

  PlacedPart(const ShapeTables& tables, ShapeId id, std::uint32_t number, const Mat& turned,
             const Vec& at) noexcept;
};

/// One body of a pair where it stands: relative to the position of body a, in the axes of the
/// world. What it is made of has numbers: 0 for a convex shape, the child of a compound, the slot
/// of a mesh, the triangle of a height field. A compound with surfaces is taken child by child:
/// each is a body by itself, whose numbers begin at `first_number` in the compound.
struct PlacedBody {
  enum class Kind : std::uint8_t { convex, compound, mesh, field };

  /// `at`: its position relative to that of body a.
  PlacedBody(const Composites& all, const ShapeTables& tables, ShapeId shape, const Pose& pose,
             const Vec& at) noexcept;

  /// A child of this, which has surfaces among them.
  [[nodiscard]] PlacedBody child(std::uint32_t number) const noexcept;
  /// Where its pose says.
  [[nodiscard]] static PlacedBody at(const Composites& all, ShapeId shape,
                                     const Pose& pose) noexcept;

  [[nodiscard]] bool is_surface() const noexcept { return kind >= Kind::mesh; }
  [[nodiscard]] bool has_surfaces() const noexcept {
    return kind == Kind::compound && compound->has_surfaces();
  }
  /// Of all of this, grown by `margin` in the world, in the frame of `other`.
  [[nodiscard]] Box box_in(const PlacedBody& other, double margin) const noexcept;
  [[nodiscard]] PlacedPart part(std::uint32_t number) const noexcept;
  [[nodiscard]] Quaternion part_turn(std::uint32_t number) const noexcept;
  /// False for a triangle of a hole.
  [[nodiscard]] bool corners(std::uint32_t number, Corners& out) const noexcept;
  /// The same by itself, with its own position; false for a triangle of a hole.
  [[nodiscard]] bool primitive(std::uint32_t number, Primitive& out) const noexcept;
  /// The corners of a triangle in the body's own frame; false for one of a hole.
  [[nodiscard]] bool own_corners(std::uint32_t number, double (&corner)[3][3]) const noexcept;
  /// As callers know it: see Primitive::part.
  [[nodiscard]] std::uint32_t shown_number(std::uint32_t number) const noexcept;
  /// Active edges and corners of a triangle: see PrimitivePairs::active_edges.
  [[nodiscard]] std::uint8_t active(std::uint32_t number) const noexcept;
  /// True if what the box is about stands behind a triangle of this.
  [[nodiscard]] bool is_behind(const Corners& triangle, const Box& box) const noexcept {
    return front != 0 &&
           winnow::is_behind(triangle.normal() * front, triangle.first, box.min, box.max);
  }

  const Composites& all;
  const ShapeTables& tables;
  Kind kind = Kind::convex;
  ShapeId id;
  /// Of a child of a compound with surfaces.
  bool is_child = false;
  std::uint32_t first_number = 0;
  Quaternion turn;
  Mat rotation;
  Vec position;
  /// Own units to the world's without the position, scale included, and back.
  Mat to_world;
  Mat to_local;
  /// No length of the world is longer than this many times itself in own units.
  double most_shrunk = 1.0;
  /// Of one-sided triangles in the world: see Primitive::front.
  int front = 0;
  const MeshView* mesh = nullptr;
  const SharedMesh* shared = nullptr;
  const HeightField* field = nullptr;
  const Compound* compound = nullptr;
  /// Of a composite in its own frame.
  Box bounds;

 private:
  /// A turn and its matrix.
  struct Turned {
    explicit Turned(const double (&orientation)[4]) noexcept;
    Turned(const Quaternion& by, const Mat& matrix) noexcept : turn(by), rotation(matrix) {}

    Quaternion turn;
    Mat rotation;
  };
  PlacedBody(const Composites& all, const ShapeTables& tables, ShapeId shape, const Turned& turned,
             const Vec& at) noexcept;
};

/// Children of a compound with surfaces, found again by their parts. Numbers that follow each other
/// are mostly of one child.
class ChildOfPart {
 public:
  explicit ChildOfPart(const PlacedBody& body) noexcept : body_(body) {}

  /// The body that a number is of, which becomes that body's own: the same one if it has no
  /// surfaces as children.
  [[nodiscard]] const PlacedBody& find(std::uint32_t& number) noexcept {
    if (!body_.has_surfaces()) return body_;
    const std::uint32_t child = body_.compound->child_of(number);
    if (!last_ || child != last_child_) last_.emplace(body_.child(child));
    last_child_ = child;
    number -= last_->first_number;
    return *last_;
  }

 private:
  const PlacedBody& body_;
  std::optional<PlacedBody> last_;
  std::uint32_t last_child_ = 0;
};

/// Is shown the numbers of children of a compound with surfaces, as a PrimitiveVisitor is shown
/// primitives.
struct ChildVisitor {
  double (*visit)(void* context, std::uint32_t child, double limit) = nullptr;
  void* context = nullptr;

  /// Calls visit(child, limit).
  template <typename Visit>
  [[nodiscard]] static ChildVisitor of(Visit& visit) noexcept {
    return {[](void* called, std::uint32_t child, double limit) {
              return (*static_cast<Visit*>(called))(child, limit);
            },
            &visit};
  }
};

/// Shows the primitives of a body that the sweep may meet: see MidPhase::visit. Where a compound
/// has surfaces, its children are shown instead.
void visit(const PlacedBody& body, const BoxSweep& sweep, const PrimitiveVisitor& visitor,
           const ChildVisitor& children);

/// Mesh b in the frame of mesh a, and how far in that is a margin of the world and the rounding of
/// where b is.
struct PlacedMesh {
  PlacedMesh(const PlacedBody& a, const PlacedBody& b, double margin) noexcept;

  MeshPlacement b_in_a;
  double margin[3];
};

/// The box of a part, grown by `margin` in the world, in the frame of `other`.
[[nodiscard]] Box box_of(const PlacedPart& part, const PlacedBody& other, double margin) noexcept;

}  // namespace winnow::mid
