#pragma once

// Storage of meshes, height fields and compounds. The implementation is in composites/, with the
// functions that a Scene uses in composites/mid_phase.h; the trees of meshes are in mesh/.

#include <winnow/core/execution.h>
#include <winnow/core/export.h>
#include <winnow/core/memory.h>
#include <winnow/core/point_view.h>
#include <winnow/core/pose.h>
#include <winnow/core/status.h>
#include <winnow/core/vectors.h>
#include <winnow/core/volumes.h>
#include <winnow/pipeline/contact_types.h>
#include <winnow/pipeline/shape_pool.h>
#include <winnow/pipeline/surfaces.h>

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

class CompositePool;

/// Internal names.
namespace mid {
struct Composites;
struct MidPhase;
struct PoolAccess;
}  // namespace mid

/// A shape and its pose in a compound.
struct CompoundChild {
  ShapeId shape;  ///< convex, from the ShapePool; or a mesh or height field of the CompositePool
  Pose pose;      ///< in the frame of the compound
};

/// A part of a compound: a child, and a part of that child.
struct CompoundPart {
  std::uint32_t child = kWholeShape;  ///< index of the child; kWholeShape if there is no such part
  std::uint32_t part = kWholeShape;   ///< triangle of a surface; kWholeShape for a convex child
};

/// Shapes made of many primitives: triangle meshes, height fields, and compounds of convex shapes
/// and of these surfaces. Bodies refer to shapes by id and may share them; one mesh may be used at
/// many poses and scales. Queries are transformed into the frame of the shape, so moving a mesh
/// does not change its tree.
class WINNOW_API CompositePool {
 public:
  /// Creates an empty pool. `shapes` contains the convex children of compounds and must outlive the
  /// pool.
  explicit CompositePool(const ShapePool& shapes,
                         std::pmr::memory_resource* memory = default_memory()) noexcept;
  explicit CompositePool(ShapePool&& shapes, std::pmr::memory_resource* memory = nullptr) = delete;
  ~CompositePool();
  CompositePool& operator=(CompositePool&&) = delete;  // neither copied nor moved

  /// Adds a mesh; see TriangleMesh::build for parameters and errors.
  Answer<ShapeId> add_mesh(const PointView& vertices, const IndexView& triangles,
                           const MeshOptions& options = {},
                           const Execution& execution = Execution::parallel());
  /// Adds a scaled instance of a mesh: a new id that shares the triangles, multiplied by `scale`
  /// along the axes of the mesh. Factors are finite and not zero; negative ones mirror. Scaling a
  /// scaled instance multiplies the factors. The triangles live until the last id is removed.
  /// `invalid_argument` if a factor, or a product, is not between 1e-100 and 1e100.
  Answer<ShapeId> add_scaled(ShapeId mesh, const Vec3d& scale);
  /// Adds a mesh from a snapshot (TriangleMesh::save), with a scale. Errors as for `load` and
  /// `add_scaled`. O(bytes).
  Answer<ShapeId> add_saved_mesh(std::span<const std::byte> saved, const Vec3d& scale,
                                 const Execution& execution = Execution::parallel());
  /// Adds a height field from a snapshot (HeightField::save). O(bytes).
  Answer<ShapeId> add_saved_height_field(std::span<const std::byte> saved);
  /// Moves the vertices of a mesh, for all its scaled instances; see TriangleMesh::refit.
  Status refit_mesh(ShapeId mesh, const PointView& vertices,
                    const Execution& execution = Execution::parallel());
  /// Adds a height field; see HeightField::build for errors.
  Answer<ShapeId> add_height_field(const HeightSamples& samples);
  /// Replaces some heights of a height field; see HeightField::update. `invalid_key` if the id is
  /// not of a height field.
  Status update_height_field(ShapeId field, std::uint32_t column, std::uint32_t row,
                             const HeightSamples& samples);
  /// Adds a compound, a tree of children: convex shapes, meshes (of any scale, one-sided or not)
  /// and height fields. One shape may occur several times. Parts are numbered child by child: a
  /// convex child is one part, each triangle of a surface is one (for height fields, triangles of
  /// holes too). `part` in results is this number. `invalid_shape` if there are no children;
  /// `invalid_key` for a child that neither pool contains or that is a compound; `invalid_pose`;
  /// `too_many_objects` beyond 2^31 parts. While the compound exists, its convex children must stay
  /// in the ShapePool, and its surfaces cannot be removed. If a surface is changed in place, the
  /// compound changes too.
  Answer<ShapeId> add_compound(std::span<const CompoundChild> children);

  /// Makes the triangles of a mesh or height field one-sided, or two-sided again (the default). The
  /// front of a mesh triangle is the side from which its vertices run counter-clockwise in the
  /// unscaled mesh, even if the scale mirrors; the front of a height field is up.
  ///
  /// A one-sided triangle does not collide with an object whose centre is behind the plane of the
  /// triangle. The centre is the centre of the object's box in world axes. For a composite object,
  /// each convex part has its own box; for casts and rays, the box at the start is used. Pairs of a
  /// triangle and an object behind it have no contacts, overlaps, distances or hits. Objects in
  /// front collide as usual, however deep they are, and are pushed to the front: if the contact
  /// normal points to the back, an overlapping object gets the normal of the face, and an object
  /// that does not touch the triangle has no contact. A half-space has no centre and collides with
  /// both sides.
  ///
  /// The flag belongs to the id: scaled instances of the same mesh (also of scale 1) have their
  /// own. `invalid_key` if the id is not of a mesh or height field.
  Status set_one_sided(ShapeId surface, bool one_sided = true);
  /// True if the triangles of this surface are one-sided.
  [[nodiscard]] bool is_one_sided(ShapeId surface) const noexcept;

  /// Makes a closed mesh solid, or hollow again. The interior of a solid is part of the shape, for
  /// contacts, overlaps, distances and sensors. Rays hit the surface from both sides: a ray that
  /// starts inside hits where it leaves.
  ///
  /// A convex solid is a convex shape: it has the contacts, depths and casts of the hull of its
  /// vertices, and no parts. Faces that are coplanar to 2e-7 of its size, as float vertices allow,
  /// are one.
  ///
  /// The depth of other solids is the length of a translation after which the shapes are apart; the
  /// error bound is the difference to a length below which none parts them. It is found by a search
  /// (PolyDepth: Je, Tang, Lee, Lee, Kim 2012), so a shorter translation may exist within the
  /// bound. Contacts of `Scene::collide` are those of the surface, unless moving the bodies along
  /// them does not part the bodies: then one manifold has the depth of the solid. Casts of shapes
  /// are stopped only by the surface.
  ///
  /// The flag belongs to the id, as for `set_one_sided`; it also applies if the mesh is a child of
  /// a compound. `invalid_key` if the id is not of a mesh. `invalid_shape` unless as many triangles
  /// run along each edge in one direction as in the other (vertices at the same position count as
  /// one), and vertices run counter-clockwise as seen from outside, in the unscaled mesh, even if
  /// the scale mirrors. Parts of the mesh may touch, overlap or be given twice: the solid is their
  /// union. A refit keeps the flag; the caller keeps the mesh closed. O(n log n); a refit too.
  Status set_solid(ShapeId mesh, bool solid = true);
  /// True if this mesh is solid.
  [[nodiscard]] bool is_solid(ShapeId mesh) const noexcept;

  /// Appends a snapshot of all shapes and free indices. pipeline/FORMATS.md has the format.
  /// `out_of_memory` leaves `out` unchanged. O(bytes).
  Status save(Column<std::byte>& out) const;
  /// Replaces the shapes by a snapshot, with their ids, scales and part numbers; load the ShapePool
  /// first. Trees of meshes are read, not built: O(bytes). `invalid_argument` if the bytes are not
  /// a valid snapshot (untrusted bytes are safe) or have children that the ShapePool does not
  /// contain; it and `out_of_memory` change nothing.
  Status load(std::span<const std::byte> saved, const Execution& execution = Execution::parallel());

  /// Removes a shape. Bodies must not use its id any more. `invalid_argument` for a surface that is
  /// a child of a compound.
  Status remove(ShapeId id);
  /// Returns the number of shapes of a kind; scaled instances of meshes count too.
  [[nodiscard]] std::size_t size(CompositeKind kind) const noexcept;
  /// Returns the mesh of an id; null if the id is not of a mesh in the pool.
  [[nodiscard]] const TriangleMesh* mesh(ShapeId id) const noexcept;
  /// Returns the scale of a mesh along its axes; ones if the id is not of a mesh.
  [[nodiscard]] Vec3d scale(ShapeId mesh) const noexcept;
  /// Returns the height field of an id; null if the id is not of a height field in the pool. Valid
  /// until the field is removed.
  [[nodiscard]] const HeightField* height_field(ShapeId id) const noexcept;
  /// Returns the children of a compound in the order in which they were given; empty for other ids.
  [[nodiscard]] std::span<const CompoundChild> children(ShapeId compound) const noexcept;
  /// Returns the number of parts, which are numbered from 0: triangles of a mesh or height field
  /// (for height fields, including triangles of holes), or parts of a compound as in
  /// `add_compound`. 0 for ids that are not in the pool.
  [[nodiscard]] std::uint32_t parts(ShapeId id) const noexcept;
  /// Returns which child, and which part of it, the part number of a contact, hit or overlap refers
  /// to. O(log n).
  [[nodiscard]] CompoundPart part(ShapeId compound, std::uint32_t part) const noexcept;

  /// True if the shape exists.
  [[nodiscard]] bool contains(ShapeId id) const noexcept;
  /// Returns a float box that contains the shape at a valid pose, rounded outward.
  [[nodiscard]] Aabb bounds(ShapeId id, const Pose& pose) const noexcept;
  /// Returns an upper bound on the distance of the shape's points from the origin of its frame.
  [[nodiscard]] double radius(ShapeId id) const noexcept;
  /// Returns a counter that grows when a shape is changed in place (refit) or removed. Cached data
  /// about pairs of composite shapes are then invalid.
  [[nodiscard]] std::uint64_t revision() const noexcept { return revision_; }
  /// Returns the bytes of meshes, height fields, compounds and the pool itself.
  [[nodiscard]] Footprint footprint() const noexcept;

 private:
  friend struct mid::PoolAccess;

  /// Returns the state, which is created for the first shape: a pool without shapes takes no
  /// memory. Null if memory is refused.
  [[nodiscard]] mid::Composites* state() noexcept;

  const ShapePool& shapes_;
  std::pmr::memory_resource* memory_;
  /// The functions that scenes use, by a pointer, so that a program without a pool links none.
  const mid::MidPhase* mid_phase_;
  mid::Composites* state_ = nullptr;
  std::uint64_t revision_ = 0;
};

}  // namespace winnow
