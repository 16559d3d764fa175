#pragma once

// Storage of a CompositePool.

#include <winnow/core/memory.h>
#include <winnow/pipeline/composite_pool.h>
#include "pipeline/composites/mid_phase.h"
#include "pipeline/shapes/frame.h"

#include <algorithm>
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
  static constexpr std::uint32_t kNoHull = ~0U;

  SharedMesh* shared = nullptr;
  double scale[3] = {1.0, 1.0, 1.0};
  /// Index in Composites::hulls of the scaled mesh as a hull, if it is a convex solid.
  std::uint32_t hull = kNoHull;
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
  /// Adds or removes an id, and increments `revision` if that changes the set. `out_of_memory`
  /// changes nothing.
  [[nodiscard]] Status set(ShapeId id, bool now, std::uint64_t& revision) noexcept {
    if (has(id) == now) return Status::ok;
    if (!now) remove(id);
    if (now && !add(id)) return Status::out_of_memory;
    ++revision;
    return Status::ok;
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
  /// Returns the tables of convex shapes in which `id` is looked up: `hull_tables` for a convex
  /// solid, else `convex`.
  [[nodiscard]] const ShapeTables& tables_of(ShapeId id, const ShapeTables& convex) const noexcept {
    const MeshEntry* const entry = mesh(id);
    return entry != nullptr && entry->hull != MeshEntry::kNoHull ? hull_tables : convex;
  }
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
  /// Frees the hull of a mesh, if it has one.
  void drop_hull(MeshEntry& entry) noexcept;

  const ShapePool& shapes;
  std::pmr::memory_resource* memory;
  SlotTable<MeshEntry> meshes;
  SlotTable<HeightField*> fields;
  SlotTable<Compound*> compounds;
  IdSet one_sided;  ///< surfaces with one-sided triangles
  IdSet solid;      ///< solid meshes
  /// Convex solids as hulls; see solid_hulls.h. Free slots have no vertices.
  SlotTable<HullShape> hulls;
  /// Tables that contain only `hulls`.
  ShapeTables hull_tables;
  /// Makes the hulls anew after a refit of a mesh; null if there was never a solid, because a
  /// program without solids then links no hulls.
  void (*refit_hulls)(Composites& all, const SharedMesh& mesh) noexcept = nullptr;
  SharedMesh* first_mesh = nullptr;
  Compound* first_compound_with_surfaces = nullptr;

 private:
  template <typename Is>
  [[nodiscard]] static bool has_child(const Compound& compound, Is&& is) noexcept {
    const std::span<const CompoundChild> children(compound.children, compound.count);
    return std::any_of(children.begin(), children.end(),
                       [&](const CompoundChild& child) { return is(child.shape); });
  }
};

/// Returns the shapes of a pool if they contain `id`, else null.
[[nodiscard]] inline const Composites* composites_with(const CompositePool& pool,
                                                       ShapeId id) noexcept {
  const Composites* const all = PoolAccess::composites(pool);
  return all != nullptr && all->contains(id) ? all : nullptr;
}

}  // namespace winnow::mid
