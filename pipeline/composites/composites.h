#pragma once

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

/// Triangles that one id or several scaled ones refer to, in a list of all.
struct SharedMesh {
  explicit SharedMesh(std::pmr::memory_resource* memory) noexcept
      : mesh(memory), active_corners(memory) {}

  /// Finds the active corners of a mesh that has been built or fitted anew. False if there is no
  /// room for them; there always is after the first time.
  [[nodiscard]] bool find_corners() noexcept;
  [[nodiscard]] bool is_active(std::uint32_t vertex) const noexcept {
    return (active_corners[vertex / 32] >> vertex % 32 & 1U) != 0;
  }

  TriangleMesh mesh;
  /// A bit for each vertex that is on an active edge of any triangle.
  Column<std::uint32_t> active_corners;
  std::uint32_t users = 0;
  SharedMesh* previous = nullptr;
  SharedMesh* next = nullptr;
};

struct MeshEntry {
  SharedMesh* shared = nullptr;
  double scale[3] = {1.0, 1.0, 1.0};
};

/// True for what a mesh may be scaled by: products of such factors, their inverses, and squares of
/// scaled lengths are finite.
[[nodiscard]] inline bool is_scale(double factor) noexcept {
  return std::abs(factor) >= 1e-100 && std::abs(factor) <= 1e100;
}

/// Of a compound: a bit more tells of which of two bodies a part is.
inline constexpr std::uint64_t kMaxParts = std::uint64_t{1} << 31U;

/// So many children are tested one by one; more get a tree.
inline constexpr std::uint32_t kFlatChildren = 16;

/// A compound and its children, in one block of memory.
///
/// The tree of many children is that of a triangle mesh: the box of a child is the box of the
/// degenerate triangle between its corners, so that every traversal of meshes is one of compounds.
/// A Partition would prune as well, but its keys, change lists and free places are for objects that
/// come, move and go; children never do, and scenes have many compounds of few children.
///
/// Parts are numbered child by child: a convex child is one, a surface has all its triangles.
struct Compound {
  std::uint32_t count = 0;
  double radius = 0.0;
  /// Of all children, in the compound's frame.
  Aabb bounds;
  const CompoundChild* children = nullptr;
  Aabb* boxes = nullptr;
  /// By child, and how many parts there are; null if no child is a surface: child i is part i then.
  const std::uint32_t* first_part = nullptr;
  /// Null for few children, or where one reaches to infinity.
  TriangleMesh* tree = nullptr;
  std::size_t bytes = 0;
  /// In a list of those with surfaces.
  Compound* previous = nullptr;
  Compound* next = nullptr;

  [[nodiscard]] bool has_surfaces() const noexcept { return first_part != nullptr; }
  [[nodiscard]] std::uint32_t parts() const noexcept {
    return has_surfaces() ? first_part[count] : count;
  }
  /// The child that a part belongs to.
  [[nodiscard]] std::uint32_t child_of(std::uint32_t part) const noexcept {
    if (first_part == nullptr) return part;
    const std::uint32_t* const after = std::upper_bound(first_part, first_part + count, part);
    return static_cast<std::uint32_t>(after - first_part) - 1;
  }
};

/// Entries of one kind of shape with their free places. Entry must be false where it is free.
template <typename Entry>
struct Places {
  explicit Places(std::pmr::memory_resource* memory) noexcept : entries(memory), free(memory) {}

  Column<Entry> entries;
  Column<std::uint32_t> free;

  /// Makes sure that `put` and a later `take` need no memory.
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

/// Ids of shapes that were told something of, sorted.
class IdSet {
 public:
  explicit IdSet(std::pmr::memory_resource* memory) noexcept : bits_(memory) {}

  [[nodiscard]] bool empty() const noexcept { return bits_.empty(); }
  [[nodiscard]] bool has(ShapeId id) const noexcept {
    return !bits_.empty() && std::binary_search(bits_.begin(), bits_.end(), id.bits);
  }
  /// Adds an id that is not there. False if memory is refused.
  [[nodiscard]] bool add(ShapeId id) noexcept {
    const std::ptrdiff_t place = place_of(id);
    if (!bits_.push_back(id.bits)) return false;
    std::rotate(bits_.begin() + place, bits_.end() - 1, bits_.end());
    return true;
  }
  /// Takes an id out that is there.
  void remove(ShapeId id) noexcept {
    std::uint32_t* const at = bits_.begin() + place_of(id);
    std::copy(at + 1, bits_.end(), at);
    bits_.set_size(bits_.size() - 1);
  }
  /// To be saved and read.
  [[nodiscard]] Column<std::uint32_t>& bits() noexcept { return bits_; }
  [[nodiscard]] const Column<std::uint32_t>& bits() const noexcept { return bits_; }

 private:
  [[nodiscard]] std::ptrdiff_t place_of(ShapeId id) const noexcept {
    return std::lower_bound(bits_.begin(), bits_.end(), id.bits) - bits_.begin();
  }

  Column<std::uint32_t> bits_;
};

/// What a CompositePool holds.
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

  /// Null if memory is refused.
  [[nodiscard]] SharedMesh* new_mesh() noexcept;
  /// One user less; with the last one it is given back.
  void release(SharedMesh* shared) noexcept;
  /// How many a shape has: triangles of a surface, holes of a field included; 1 of convex shapes.
  [[nodiscard]] std::uint32_t parts(ShapeId id) const noexcept;
  [[nodiscard]] double radius(ShapeId id) const noexcept;
  Status new_compound(std::span<const CompoundChild> children, Compound*& made) noexcept;
  /// Finds the boxes of its children, and what follows from them. Without memory for a tree it has
  /// none.
  Status fit(Compound& compound) noexcept;
  /// The same of all compounds with a child that `is_changed(id)` is true of.
  template <typename IsChanged>
  void fit_users(IsChanged&& is_changed) noexcept {
    for (Compound* compound = first_of_surfaces; compound != nullptr; compound = compound->next) {
      if (has_child(*compound, is_changed)) (void)fit(*compound);
    }
  }
  /// True if a surface is a child of a compound.
  [[nodiscard]] bool is_child(ShapeId surface) const noexcept {
    const auto is_this = [&](ShapeId id) { return id == surface; };
    const Compound* compound = first_of_surfaces;
    while (compound != nullptr && !has_child(*compound, is_this)) compound = compound->next;
    return compound != nullptr;
  }
  void release(Compound* compound) noexcept;

  const ShapePool& shapes;
  std::pmr::memory_resource* memory;
  Places<MeshEntry> meshes;
  Places<HeightField*> fields;
  Places<Compound*> compounds;
  IdSet one_sided;  ///< surfaces whose triangles have a front
  IdSet solid;      ///< meshes that have an inside
  SharedMesh* first_mesh = nullptr;
  Compound* first_of_surfaces = nullptr;
  std::uint64_t revision = 0;

 private:
  template <typename Is>
  [[nodiscard]] static bool has_child(const Compound& compound, Is&& is) noexcept {
    const std::span<const CompoundChild> children(compound.children, compound.count);
    return std::any_of(children.begin(), children.end(),
                       [&](const CompoundChild& child) { return is(child.shape); });
  }
};

/// See MidPhase::expand. `all` may be null: there are no composite shapes then. O(pairs of bodies +
/// pairs of primitives, each found in a traversal of O(log n + found)).
///
/// Fixed chunks of pairs of bodies are searched as tasks, which write numbers to shared room; then
/// what they found is counted, and the same chunks write it out where it belongs. Neither depends
/// on how many threads there are.
Status expand(const Composites* all, const ShapeTables& tables, const Bodies& bodies,
              std::span<const BodyPair> pairs, const PairMargins& margins,
              const Execution& execution, PrimitivePairs& out);

/// See MidPhase::smooth.
///
/// A contact of a triangle is one with an edge or a corner if that is what lies farthest along the
/// contact's normal. Where a neighbour continues the surface beyond, the surface as a whole has no
/// edge there, and only the face's normal makes sense. Then:
/// - shapes that are apart keep their distance, its bound and their points, and get the normal;
/// - so do shapes that only their rounding lets touch, with the point of a sphere moved below its
///   centre, so that it does not turn;
/// - others are clipped against the triangle along the normal, and the depth is that of the
///   clipped points, at least what it was. It is as it was where nothing is left of them, and where
///   it would be several times what it is for any contact of the same bodies: they are beside the
///   surface then, not above it.
/// No contact is lost: the distance to a face's plane is never more than that to the face. Contacts
/// of triangles of two meshes stay as they are: which face's normal is meant is not known. Which
/// edges are active is known for the front of a surface only; on its back concave edges, which look
/// convex from there, are taken for internal ones too, so that a floor is flat whichever way its
/// triangles are wound.
void smooth(const ShapePool& shapes, const PrimitivePairs& pairs, const PairMargins& margins,
            const Execution& execution, NarrowResult& result) noexcept;

/// See MidPhase::reduce.
Status reduce(const ShapePool& shapes, const PrimitivePairs& pairs, const NarrowResult& answers,
              const PairMargins& margins, const Execution& execution, ContactRegions& out);

/// See MidPhase::visit, visit_rays, place, visit_ray, visit_pairs, visit_near_pairs and visit_near.
/// `id` is there, `pose` is valid.
void visit(const Composites& all, ShapeId id, const Pose& pose, const BoxSweep& sweep,
           const PrimitiveVisitor& visitor);
void visit_rays(const Composites& all, ShapeId id, const Pose& pose, std::span<const ShapeRay> rays,
                const double* limits, const RayVisitor& visitor);
[[nodiscard]] bool place(const Composites& all, ShapeId id, const Pose& pose,
                         RaySurface& surface) noexcept;
void visit_ray(const Composites& all, const RaySurface& surface, const ShapeRay& ray, double limit,
               const RayVisitor& visitor);
bool visit_pairs(const Composites& all, ShapeId a, const Pose& pose_a, ShapeId b,
                 const Pose& pose_b, const PrimitivePairVisitor& visitor);
bool visit_near_pairs(const Composites& all, ShapeId a, const Pose& pose_a, ShapeId b,
                      const Pose& pose_b, double limit, const NearPairVisitor& visitor);
void visit_near(const Composites& all, ShapeId id, const Pose& pose, const BoxSweep& from,
                double limit, const PrimitiveVisitor& visitor);

}  // namespace winnow::mid
