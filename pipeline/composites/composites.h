#pragma once

// Storage of a CompositePool, and the functions that its members forward to: `find_primitive_pairs`
// (find_primitive_pairs.cpp, primitive_pair_search.cpp), `correct_internal_edges`
// (internal_edges.cpp), `reduce_contacts` (manifold_reduction.cpp), and the traversals of queries
// (composite_traversal.cpp, rays.cpp).

#include <winnow/core/column.h>
#include <winnow/pipeline/composite_pool.h>
#include "pipeline/shapes/frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <span>

namespace winnow::mid {

/// A mesh that is used by one or more ids, which differ in scale. Element of a linked list of all
/// meshes.
struct SharedMesh {
  explicit SharedMesh(std::pmr::memory_resource* memory) noexcept
      : mesh(memory), active_corners(memory) {}

  /// Finds the active corners after a build or refit. Returns false if memory is refused, which is
  /// possible only the first time.
  [[nodiscard]] bool find_corners() noexcept;
  [[nodiscard]] bool is_active(std::uint32_t vertex) const noexcept {
    return (active_corners[vertex / 32] >> vertex % 32 & 1U) != 0;
  }

  TriangleMesh mesh;
  /// One bit per vertex: set if the vertex is on an active edge of any triangle.
  Column<std::uint32_t> active_corners;
  std::uint32_t users = 0;
  SharedMesh* previous = nullptr;
  SharedMesh* next = nullptr;
};

struct MeshEntry {
  SharedMesh* shared = nullptr;
  double scale[3] = {1.0, 1.0, 1.0};
};

/// True if a mesh may be scaled by this factor. The range keeps products of two factors, their
/// inverses and squares of scaled lengths finite.
[[nodiscard]] inline bool is_scale(double factor) noexcept {
  return std::abs(factor) >= 1e-100 && std::abs(factor) <= 1e100;
}

/// Maximal number of parts of a compound. One more bit of a part number selects body a or b.
inline constexpr std::uint64_t kMaxParts = std::uint64_t{1} << 31U;

/// Up to this many children are tested one by one; more get a tree.
inline constexpr std::uint32_t kFlatChildren = 16;

/// A compound and its children, in one block of memory.
///
/// The tree over many children is a TriangleMesh: each child is a degenerate triangle whose
/// vertices are two opposite corners of the child's box. So the traversals of meshes for boxes also
/// work for compounds. A Partition would need more memory: it has keys, change lists and free lists
/// for objects that move, and children of a compound never move.
///
/// Parts are numbered child by child: one part per convex child, one per triangle of a surface.
struct Compound {
  std::uint32_t count = 0;
  double radius = 0.0;
  /// Box of all children, in the frame of the compound.
  Aabb bounds;
  const CompoundChild* children = nullptr;
  Aabb* boxes = nullptr;
  /// First part of each child, then the number of parts. Null if no child is a surface: then child
  /// i is part i.
  const std::uint32_t* first_part = nullptr;
  /// Null if there are at most kFlatChildren children, if a child is unbounded, or if memory for
  /// the tree was refused.
  TriangleMesh* tree = nullptr;
  std::size_t bytes = 0;
  /// Links of the list of compounds that have surfaces as children.
  Compound* previous = nullptr;
  Compound* next = nullptr;

  [[nodiscard]] bool has_surfaces() const noexcept { return first_part != nullptr; }
  [[nodiscard]] std::uint32_t parts() const noexcept {
    return has_surfaces() ? first_part[count] : count;
  }
  /// Returns the child that a part belongs to.
  [[nodiscard]] std::uint32_t child_of(std::uint32_t part) const noexcept {
    if (first_part == nullptr) return part;
    const std::uint32_t* const after = std::upper_bound(first_part, first_part + count, part);
    return static_cast<std::uint32_t>(after - first_part) - 1;
  }
};

/// Entries of one kind of shape, and a free list. A free entry is default-constructed.
template <typename Entry>
struct SlotTable {
  explicit SlotTable(std::pmr::memory_resource* memory) noexcept : entries(memory), free(memory) {}

  Column<Entry> entries;
  Column<std::uint32_t> free;

  /// Reserves memory so that the next `put` and its later `take` cannot fail.
  [[nodiscard]] Status prepare() noexcept {
    if (!free.empty()) return Status::ok;
    const std::size_t count = entries.size() + 1;
    if (entries.size() >> ShapeId::kIndexBits != 0) return Status::too_many_objects;
    return entries.grow(count) && free.grow(count) ? Status::ok : Status::out_of_memory;
  }
  [[nodiscard]] std::uint32_t put(const Entry& entry) noexcept {
    if (free.empty()) {
      entries.set_size(entries.size() + 1);
      entries[entries.size() - 1] = entry;
      return static_cast<std::uint32_t>(entries.size() - 1);
    }
    const std::uint32_t index = free[free.size() - 1];
    free.set_size(free.size() - 1);
    entries[index] = entry;
    return index;
  }
  void take(std::uint32_t index) noexcept {
    entries[index] = Entry{};
    free.set_size(free.size() + 1);
    free[free.size() - 1] = index;
  }
  [[nodiscard]] std::size_t size() const noexcept { return entries.size() - free.size(); }
};

/// A sorted set of shape ids.
class IdSet {
 public:
  explicit IdSet(std::pmr::memory_resource* memory) noexcept : bits_(memory) {}

  [[nodiscard]] bool empty() const noexcept { return bits_.empty(); }
  [[nodiscard]] bool has(ShapeId id) const noexcept {
    return !bits_.empty() && std::binary_search(bits_.begin(), bits_.end(), id.bits);
  }
  /// Adds an id that is not in the set. Returns false if memory is refused.
  [[nodiscard]] bool add(ShapeId id) noexcept {
    const std::ptrdiff_t place = place_of(id);
    if (!bits_.push_back(id.bits)) return false;
    std::rotate(bits_.begin() + place, bits_.end() - 1, bits_.end());
    return true;
  }
  /// Removes an id that is in the set.
  void remove(ShapeId id) noexcept {
    std::uint32_t* const at = bits_.begin() + place_of(id);
    std::copy(at + 1, bits_.end(), at);
    bits_.set_size(bits_.size() - 1);
  }
  /// The ids as a column, for snapshots.
  [[nodiscard]] Column<std::uint32_t>& bits() noexcept { return bits_; }
  [[nodiscard]] const Column<std::uint32_t>& bits() const noexcept { return bits_; }

 private:
  [[nodiscard]] std::ptrdiff_t place_of(ShapeId id) const noexcept {
    return std::lower_bound(bits_.begin(), bits_.end(), id.bits) - bits_.begin();
  }

  Column<std::uint32_t> bits_;
};

/// State of a CompositePool.
struct Composites {
  Composites(const ShapePool& pool, std::pmr::memory_resource* memory) noexcept;
  ~Composites();
  Composites(const Composites&) = delete;
  Composites& operator=(const Composites&) = delete;

  [[nodiscard]] const MeshEntry* mesh(ShapeId id) const noexcept;
  [[nodiscard]] HeightField* field(ShapeId id) const noexcept;
  [[nodiscard]] const Compound* compound(ShapeId id) const noexcept;
  [[nodiscard]] bool is_one_sided(ShapeId id) const noexcept { return one_sided.has(id); }
  [[nodiscard]] bool is_solid(ShapeId id) const noexcept { return solid.has(id); }
  [[nodiscard]] bool contains(ShapeId id) const noexcept {
    return mesh(id) != nullptr || field(id) != nullptr || compound(id) != nullptr;
  }

  /// Returns null if memory is refused.
  [[nodiscard]] SharedMesh* new_mesh() noexcept;
  /// Removes one user; deletes the mesh if it was the last one.
  void release(SharedMesh* shared) noexcept;
  /// Returns the number of parts: triangles of a surface, including holes of a field; 1 for a
  /// convex shape.
  [[nodiscard]] std::uint32_t parts(ShapeId id) const noexcept;
  [[nodiscard]] double radius(ShapeId id) const noexcept;
  Status new_compound(std::span<const CompoundChild> children, Compound*& made) noexcept;
  /// Updates the boxes of the children and everything that depends on them. If memory for a tree is
  /// refused, the compound has none.
  Status fit(Compound& compound) noexcept;
  /// As above, for all compounds with a child for which `is_changed(id)` is true.
  template <typename IsChanged>
  void fit_users(IsChanged&& is_changed) noexcept {
    for (Compound* compound = first_compound_with_surfaces; compound != nullptr;
         compound = compound->next) {
      if (has_child(*compound, is_changed)) (void)fit(*compound);
    }
  }
  /// True if the surface is a child of a compound.
  [[nodiscard]] bool is_child(ShapeId surface) const noexcept {
    const auto is_this = [&](ShapeId id) { return id == surface; };
    const Compound* compound = first_compound_with_surfaces;
    while (compound != nullptr && !has_child(*compound, is_this)) compound = compound->next;
    return compound != nullptr;
  }
  void release(Compound* compound) noexcept;

  const ShapePool& shapes;
  std::pmr::memory_resource* memory;
  SlotTable<MeshEntry> meshes;
  SlotTable<HeightField*> fields;
  SlotTable<Compound*> compounds;
  IdSet one_sided;  ///< surfaces with one-sided triangles
  IdSet solid;      ///< solid meshes
  SharedMesh* first_mesh = nullptr;
  Compound* first_compound_with_surfaces = nullptr;
  std::uint64_t revision = 0;

 private:
  template <typename Is>
  [[nodiscard]] static bool has_child(const Compound& compound, Is&& is) noexcept {
    const std::span<const CompoundChild> children(compound.children, compound.count);
    return std::any_of(children.begin(), children.end(),
                       [&](const CompoundChild& child) { return is(child.shape); });
  }
};

/// See MidPhase::find_primitive_pairs. If `all` is null, there are no composite shapes. O(pairs of
/// bodies + pairs of primitives); each traversal is O(log n + found).
///
/// Tasks search fixed chunks of body pairs and write numbers to a shared arena. Then the results
/// are counted, and tasks for the same chunks write them to their final positions. Neither step
/// depends on the number of threads.
Status find_primitive_pairs(const Composites* all, const ShapeTables& tables, const Bodies& bodies,
                            std::span<const BodyPair> pairs, const PairMargins& margins,
                            const Execution& execution, PrimitivePairs& out);

/// See MidPhase::correct_internal_edges.
///
/// A triangle touches with an edge or a corner if this feature is its farthest point along the
/// contact normal. If a neighbouring triangle continues the surface at the feature, the feature is
/// no edge of the surface as a whole (an internal edge). Then the contact gets the normal of the
/// face:
/// - Spheres, shapes that are apart, and shapes that overlap only by their rounding keep their
///   distance and its error bound. The point of a sphere is moved to its deepest point along the
///   new normal, so that the contact exerts no torque; other shapes keep their points.
/// - Other shapes are clipped against the triangle along the new normal. The depth becomes the
///   depth of the clipped points, but at least the previous depth. If the deepest point is not over
///   the triangle, or if its depth would exceed kMaxDeeper times the largest depth of the contacts
///   of the two bodies with the same kinds, the distance and the points are kept: the body is then
///   beside the surface, not above it.
///
/// No contact is lost, because the distance to the plane of a face is at most the distance to the
/// face. Contacts of two mesh triangles are changed only if their normal points to the back of a
/// one-sided triangle; otherwise it is ambiguous which normal to use. Active edges are computed
/// only for the front of a surface. On its back, where concave edges look convex, concave edges
/// also count as internal, so that a floor is flat for either winding.
void correct_internal_edges(const ShapePool& shapes, const PrimitivePairs& pairs,
                            const PairMargins& margins, const Execution& execution,
                            NarrowResult& result) noexcept;

/// See MidPhase::reduce_contacts.
Status reduce_contacts(const ShapePool& shapes, const PrimitivePairs& pairs,
                       const NarrowResult& answers, const PairMargins& margins,
                       const Execution& execution, ContactRegions& out);

/// See the members of MidPhase with the same names. `id` must exist and `pose` must be valid.
void visit(const Composites& all, ShapeId id, const Pose& pose, const MovingBox& moving_box,
           const PrimitiveVisitor& visitor);
void visit_rays(const Composites& all, ShapeId id, const Pose& pose, std::span<const ShapeRay> rays,
                const double* limits, const RayVisitor& visitor);
[[nodiscard]] bool prepare_ray_surface(const Composites& all, ShapeId id, const Pose& pose,
                                       RaySurface& surface) noexcept;
void visit_ray(const Composites& all, const RaySurface& surface, const ShapeRay& ray, double limit,
               const RayVisitor& visitor);
bool visit_pairs(const Composites& all, ShapeId a, const Pose& pose_a, ShapeId b,
                 const Pose& pose_b, const PrimitivePairVisitor& visitor);
bool visit_near_pairs(const Composites& all, ShapeId a, const Pose& pose_a, ShapeId b,
                      const Pose& pose_b, double limit, const NearPairVisitor& visitor);
void visit_near(const Composites& all, ShapeId id, const Pose& pose, const MovingBox& from,
                double limit, const PrimitiveVisitor& visitor);

}  // namespace winnow::mid
