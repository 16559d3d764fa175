#pragma once

// A body with its pose, prepared for the search of find_primitive_pairs.cpp and for the traversals
// in composite_traversal.cpp and rays.cpp: transforms, the mesh, field or compound, and access to
// its primitives.

#include "pipeline/composites/composites.h"
#include "pipeline/mesh/mesh_view.h"
#include "pipeline/shapes/frame.h"
#include "pipeline/shapes/one_sided.h"

#include <cstdint>
#include <optional>

namespace winnow::mid {

/// Corner 0 of a triangle and the edges from it to corners 1 and 2.
struct Corners {
  Vec first;
  Vec edge[2];

  /// The triangle with corner 0 at the origin.
  [[nodiscard]] TriangleShape triangle() const noexcept;
  /// Points to the side from which the corners are counter-clockwise; not normalised.
  [[nodiscard]] Vec normal() const noexcept { return edge[0].cross(edge[1]); }
  [[nodiscard]] Box3 box() const noexcept;
};

/// A convex shape at a pose.
struct PlacedPart {
  /// The tables that contain the shape.
  const ShapeTables* tables;
  ShapeId shape;
  /// 0, or the index of the child.
  std::uint32_t number;
  Mat rotation;
  Vec position;
  /// Upper bound on the distance of points of the shape from `position`.
  double radius = 0.0;
  /// A point relative to `position`, in world axes; inside the shape, except for triangles and
  /// half-spaces. All points of the shape are within `reach` of this point. The ball of radius
  /// `inner` about this point is inside the shape.
  Vec middle = Vec::Zero();
  double reach = 0.0;
  double inner = 0.0;

  PlacedPart(const ShapeTables& of, ShapeId id, std::uint32_t number, const Mat& turned,
             const Vec& at) noexcept;
};

/// A body of a pair, relative to the position of body a, in world axes. Its primitives have
/// numbers: 0 for a convex shape, the child of a compound, the slot of a mesh, the triangle of a
/// height field. A compound that has surfaces is handled child by child: each child is a
/// TransformedShape, whose numbers begin at `first_number` in the compound.
///
/// A convex solid is a convex shape, its hull, except for rays, which hit its triangles.
struct TransformedShape {
  enum class Kind : std::uint8_t { convex, compound, mesh, field };

  /// `at` is the position relative to body a.
  TransformedShape(const Composites& all, const ShapeTables& tables, ShapeId shape,
                   const Pose& pose, const Vec& at, Solids solids = Solids::hulls) noexcept;

  /// Returns a child of a compound that has surfaces.
  [[nodiscard]] TransformedShape child(std::uint32_t number) const noexcept;
  /// Returns the body at its world pose.
  [[nodiscard]] static TransformedShape at(const Composites& all, ShapeId shape, const Pose& pose,
                                           Solids solids = Solids::hulls) noexcept;

  [[nodiscard]] bool is_surface() const noexcept { return kind >= Kind::mesh; }
  /// Returns whether this is the hull of a convex solid.
  [[nodiscard]] bool is_solid_hull() const noexcept { return &tables == &all.hull_tables; }
  [[nodiscard]] bool has_surfaces() const noexcept {
    return kind == Kind::compound && compound->has_surfaces();
  }
  /// The box of the whole body, grown by `margin` in world units, in the frame of `other`.
  [[nodiscard]] Box3 box_in(const TransformedShape& other, double margin) const noexcept;
  [[nodiscard]] PlacedPart part(std::uint32_t number) const noexcept;
  [[nodiscard]] Quaternion part_turn(std::uint32_t number) const noexcept;
  /// Returns false for a triangle of a hole.
  [[nodiscard]] bool corners(std::uint32_t number, Corners& out) const noexcept;
  /// Returns the primitive with its own position; false for a triangle of a hole.
  [[nodiscard]] bool primitive(std::uint32_t number, Primitive& out) const noexcept;
  /// Returns the corners in the frame of the body; false for a triangle of a hole.
  [[nodiscard]] bool own_corners(std::uint32_t number, double (&corner)[3][3]) const noexcept;
  /// Number of a primitive in results; see Primitive::part.
  [[nodiscard]] std::uint32_t shown_number(std::uint32_t number) const noexcept;
  /// Active edges and corners of a triangle; see PrimitivePairs::active_edges.
  [[nodiscard]] std::uint8_t active(std::uint32_t number) const noexcept;
  /// True if the centre of the box is behind a one-sided triangle of this body.
  [[nodiscard]] bool is_behind(const Corners& triangle, const Box3& box) const noexcept {
    return front != 0 &&
           winnow::is_behind(triangle.normal() * front, triangle.first, box.min, box.max);
  }

  const Composites& all;
  /// The tables of `id` or of the parts.
  const ShapeTables& tables;
  Solids solids = Solids::hulls;
  Kind kind = Kind::convex;
  /// The shape of the body; for a convex solid, its hull.
  ShapeId id;
  /// True for a child of a compound that has surfaces.
  bool is_child = false;
  std::uint32_t first_number = 0;
  Quaternion turn;
  Mat rotation;
  Vec position;
  /// Linear maps from the frame of the body, including its scale, to the world, and back.
  Mat to_world;
  Mat to_local;
  /// A vector of world length l is at most l * max_inverse_scale long in the frame of the body.
  double max_inverse_scale = 1.0;
  /// Facing of one-sided triangles in the world; see Primitive::front.
  int front = 0;
  /// True for a mesh that its scale mirrors.
  bool is_mirrored = false;
  const MeshView* mesh = nullptr;
  const SharedMesh* shared = nullptr;
  const HeightField* field = nullptr;
  const Compound* compound = nullptr;
  /// The box of a composite shape in its own frame.
  Box3 bounds;

 private:
  /// A rotation as quaternion and as matrix.
  struct Turned {
    explicit Turned(const Quaternion& orientation) noexcept;
    Turned(const Quaternion& by, const Mat& matrix) noexcept : turn(by), rotation(matrix) {}

    Quaternion turn;
    Mat rotation;
  };
  TransformedShape(const Composites& all, const ShapeTables& tables, ShapeId shape,
                   const Turned& turned, const Vec& at, Solids solids) noexcept;
};

/// Finds the children of a compound that has surfaces by part number. Caches the last child,
/// because consecutive numbers mostly belong to the same child.
class ChildOfPart {
 public:
  explicit ChildOfPart(const TransformedShape& body) noexcept : body_(body) {}

  /// Returns the child that a number belongs to, and makes the number relative to it. Returns the
  /// body itself if it has no surfaces as children.
  [[nodiscard]] const TransformedShape& find(std::uint32_t& number) noexcept {
    if (!body_.has_surfaces()) return body_;
    const std::uint32_t child = body_.compound->child_of(number);
    if (!last_ || child != last_child_) last_.emplace(body_.child(child));
    last_child_ = child;
    number -= last_->first_number;
    return *last_;
  }

 private:
  const TransformedShape& body_;
  std::optional<TransformedShape> last_;
  std::uint32_t last_child_ = 0;
};

/// Callback for the children of a compound that has surfaces; like PrimitiveVisitor for primitives.
struct ChildVisitor {
  double (*visit)(void* context, std::uint32_t child, double limit) = nullptr;
  void* context = nullptr;

  /// Makes a visitor that calls visit(child, limit).
  template <typename Visit>
  [[nodiscard]] static ChildVisitor of(Visit& visit) noexcept {
    return {[](void* called, std::uint32_t child, double limit) {
              return (*static_cast<Visit*>(called))(child, limit);
            },
            &visit};
  }
};

/// Calls `visitor` for the primitives that the moving box may hit (see mid::visit). For a
/// compound that has surfaces, calls `children` instead.
void visit(const TransformedShape& body, const MovingBox& moving_box,
           const PrimitiveVisitor& visitor, const ChildVisitor& children);

/// Transform of mesh b to the frame of mesh a, and the margin in that frame per axis: the world
/// margin and the rounding error of the transform.
struct PlacedMesh {
  PlacedMesh(const TransformedShape& a, const TransformedShape& b, double margin) noexcept;

  MeshPlacement b_in_a;
  double margin[3];
};

/// The box of a part, grown by `margin` in world units, in the frame of `other`.
[[nodiscard]] Box3 box_of(const PlacedPart& part, const TransformedShape& other,
                          double margin) noexcept;

}  // namespace winnow::mid
