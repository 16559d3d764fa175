#pragma once

#include <winnow/core/export.h>
#include <winnow/core/large_pages.h>
#include <winnow/core/point_view.h>
#include <winnow/pipeline/height_field.h>
#include <winnow/pipeline/mid_phase.h>
#include <winnow/pipeline/triangle_mesh.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow {

namespace mid {
class IdSet;
struct Composites;
}  // namespace mid

/// A shape and where it stands in its compound.
struct CompoundChild {
  ShapeId shape;  ///< convex, of the ShapePool; or a mesh or height field of the CompositePool
  Pose pose;      ///< in the frame of the compound
};

/// A part of a compound, as its child knows it.
struct CompoundPart {
  std::uint32_t child =
      kWholeShape;                   ///< in the order of the children; kWholeShape if there is none
  std::uint32_t part = kWholeShape;  ///< the triangle of a surface; kWholeShape of a convex child
};

/// Shapes made of many: triangle meshes, height fields, compounds of convex shapes and of these.
/// Bodies refer to them by id and may share them; one mesh may stand at many poses and in many
/// scales. Queries are taken into the shape's own frame: what moves a mesh costs nothing of its
/// tree.
class WINNOW_API CompositePool final : public MidPhase {
 public:
  /// `shapes` holds the convex children of compounds and must outlive this.
  explicit CompositePool(const ShapePool& shapes,
                         std::pmr::memory_resource* memory = default_memory()) noexcept;
  ~CompositePool() override;

  /// See TriangleMesh::build.
  Status add_mesh(const PointView& vertices, const IndexView& triangles, ShapeId& id,
                  const MeshOptions& options = {},
                  const Execution& execution = Execution::parallel());
  /// The same triangles, multiplied by `scale` along the axes of the mesh: an id of its own that
  /// shares them. Finite factors, none zero; negative ones mirror. Scales of scales multiply. The
  /// triangles live until the last id is removed. `invalid_argument` for factors that, multiplied,
  /// are not between 1e-100 and 1e100.
  Status add_scaled(ShapeId mesh, const std::array<double, 3>& scale, ShapeId& id);
  /// A mesh that was saved (TriangleMesh::save), with a scale: see `load` and `add_scaled` for the
  /// errors. O(bytes).
  Status add_saved_mesh(std::span<const std::byte> saved, const std::array<double, 3>& scale,
                        ShapeId& id, const Execution& execution = Execution::parallel());
  /// A height field that was saved (HeightField::save). O(bytes).
  Status add_saved_height_field(std::span<const std::byte> saved, ShapeId& id);
  /// New places for the vertices of a mesh, seen by all its scaled ids. See TriangleMesh::refit.
  Status refit_mesh(ShapeId mesh, const PointView& vertices,
                    const Execution& execution = Execution::parallel());
  /// See HeightField::build.
  Status add_height_field(const HeightSamples& samples, ShapeId& id);
  /// New heights for some samples of a field; see HeightField::update. `invalid_key` for an id that
  /// is none of a field.
  Status update_height_field(ShapeId field, std::uint32_t column, std::uint32_t row,
                             const HeightSamples& samples);
  /// A tree of children: convex shapes, meshes (of any scale, one-sided or not) and height fields;
  /// one shape may be several of them. Parts are numbered child by child, in their order: a convex
  /// child is one, of a surface each triangle is one (of a field those of holes too), so that
  /// `part` tells what is meant. `invalid_shape` if there are no children, `invalid_key` for one
  /// that neither pool has or that is a compound itself, `invalid_pose`, `too_many_objects` beyond
  /// 2^31 parts. Convex children must stay in the ShapePool while the compound lives; surfaces
  /// cannot be removed. Where one of these is changed in place, the compound follows.
  Status add_compound(std::span<const CompoundChild> children, ShapeId& id);

  /// Gives the triangles of a mesh or a height field a front, or two sides again. Of a mesh it is
  /// where corners run counter-clockwise in the mesh's own frame, whatever its scale mirrors; of a
  /// field it is up. A triangle does not meet what stands behind it, that is, of which the middle
  /// (of its box in the axes of the world, each convex part by itself, of casts and rays where they
  /// start) is behind the triangle's plane: neither contacts nor overlaps, distances, rays or
  /// casts. What stands in front is met as ever, however deep it is, and pushed out to the front:
  /// where the shortest way out leads to the back, normals are that of the face, and a shape that
  /// does not touch is no contact. A half-space has no middle and meets both sides. The id's own:
  /// that of the same mesh by another scale (which may be 1) has its own. Two-sided at first.
  /// `invalid_key` for an id that is none of a mesh or field.
  Status set_one_sided(ShapeId surface, bool one_sided = true);
  /// True for ids of surfaces that were told so.
  [[nodiscard]] bool is_one_sided(ShapeId surface) const noexcept;

  /// Gives a mesh an inside, or takes it away again. Questions that ask for distances and overlaps
  /// (SceneQueries::overlap, overlaps, distance, least_distance and nearest) then take what lies
  /// within for a part of the solid: of a point or a shape that is held without meeting the surface
  /// the distance is that from the surface, negative. Contacts, sensors, rays and casts are those
  /// of the surface, as of any mesh. The id's own, as what `set_one_sided` says; children of
  /// compounds have it, too. `invalid_key` for an id that is none of a mesh; `invalid_shape` unless
  /// every edge is that of two triangles, which run along it in opposite ways (vertices at the same
  /// place count as one), and corners run counter-clockwise seen from outside, whatever a scale
  /// mirrors. What is refitted stays a solid: it is to stay closed. O(n log n).
  Status set_solid(ShapeId mesh, bool solid = true);
  /// True for ids of meshes that were told so.
  [[nodiscard]] bool is_solid(ShapeId mesh) const noexcept;

  /// Appends all shapes, and which places are free, to bytes; pipeline/CONTRACT.md has the format.
  /// `out_of_memory` leaves `out` as it was. O(bytes).
  Status save(Column<std::byte>& out) const;
  /// Becomes the pool that was saved, ids, scales and numbers of parts as they were; the ShapePool
  /// has to be loaded before. Trees of meshes are read, not built: O(bytes). `invalid_argument` for
  /// anything that was not saved so, whoever made it, children that the ShapePool does not have
  /// among it, and `out_of_memory`, leave the pool as it was.
  Status load(std::span<const std::byte> saved, const Execution& execution = Execution::parallel());

  /// Bodies must not use the id any more. `invalid_argument` for a surface that is the child of a
  /// compound.
  Status remove(ShapeId id);
  /// Shapes of a kind; of meshes the scaled ids count as well.
  [[nodiscard]] std::size_t size(CompositeKind kind) const noexcept;
  /// Null for ids of other kinds, or that are not there.
  [[nodiscard]] const TriangleMesh* mesh(ShapeId id) const noexcept;
  /// By what a mesh is multiplied along its axes; ones for ids of other kinds.
  [[nodiscard]] std::array<double, 3> scale(ShapeId mesh) const noexcept;
  /// Null for ids of other kinds, or that are not there. Valid until the field is removed.
  [[nodiscard]] const HeightField* height_field(ShapeId id) const noexcept;
  /// In the order in which they were given; empty for ids of other kinds.
  [[nodiscard]] std::span<const CompoundChild> children(ShapeId compound) const noexcept;
  /// How many parts a shape has, which are numbered from 0 on: triangles of a mesh or height field
  /// (of the latter also those of holes), parts of a compound as `add_compound` says. 0 for ids
  /// that are not there.
  [[nodiscard]] std::uint32_t parts(ShapeId id) const noexcept;
  /// What part number `part` of a compound is (that of contacts, hits and overlaps). O(log n).
  [[nodiscard]] CompoundPart part(ShapeId compound, std::uint32_t part) const noexcept;

  [[nodiscard]] bool contains(ShapeId id) const noexcept override;
  [[nodiscard]] Aabb bounds(ShapeId id, const Pose& pose) const noexcept override;
  [[nodiscard]] double radius(ShapeId id) const noexcept override;
  [[nodiscard]] std::uint64_t revision() const noexcept override;
  Status expand(const ShapePool& shapes, const Bodies& bodies, std::span<const BodyPair> pairs,
                const PairMargins& margins, const Execution& execution,
                PrimitivePairs& out) const override;
  void smooth(const ShapePool& shapes, const PrimitivePairs& pairs, const PairMargins& margins,
              const Execution& execution, NarrowResult& result) const override;
  Status reduce(const ShapePool& shapes, const PrimitivePairs& pairs, const NarrowResult& answers,
                const PairMargins& margins, const Execution& execution,
                ContactRegions& out) const override;
  void visit(ShapeId id, const Pose& pose, const BoxSweep& sweep,
             const PrimitiveVisitor& visitor) const override;
  void visit_rays(ShapeId id, const Pose& pose, std::span<const ShapeRay> rays,
                  const double* limits, const RayVisitor& visitor) const override;
  [[nodiscard]] bool place(ShapeId id, const Pose& pose, RaySurface& surface) const override;
  void visit_ray(const RaySurface& surface, const ShapeRay& ray, double limit,
                 const RayVisitor& visitor) const override;
  void visit_near(ShapeId id, const Pose& pose, const BoxSweep& from, double limit,
                  const PrimitiveVisitor& visitor) const override;
  bool visit_pairs(ShapeId a, const Pose& pose_a, ShapeId b, const Pose& pose_b,
                   const PrimitivePairVisitor& visitor) const override;
  bool visit_near_pairs(ShapeId a, const Pose& pose_a, ShapeId b, const Pose& pose_b, double limit,
                        const NearPairVisitor& visitor) const override;
  [[nodiscard]] bool holds(ShapeId id, const Pose& pose, const double point[3]) const override;
  [[nodiscard]] bool holds(ShapeId id, const Pose& pose, ShapeId other,
                           const Pose& other_pose) const override;
  /// Meshes, fields, compounds and what the pool itself holds, all under the resource it was given.
  [[nodiscard]] Footprint footprint() const noexcept override;

 private:
  [[nodiscard]] bool can_be_child(ShapeId id) const noexcept;
  [[nodiscard]] bool has_solids() const noexcept;
  [[nodiscard]] Status tell(mid::IdSet& set, ShapeId surface, bool now) noexcept;
  /// Null if memory is refused. Made by the first shape, so that a pool without any takes no
  /// memory.
  [[nodiscard]] mid::Composites* state() noexcept;

  const ShapePool& shapes_;
  std::pmr::memory_resource* memory_;
  mid::Composites* state_ = nullptr;
};

}  // namespace winnow
