#include "pipeline/composites/composites.h"
#include "pipeline/shapes/extent.h"

#include <algorithm>
#include <new>

namespace winnow::mid {
namespace {

template <typename T>
[[nodiscard]] T* allocate(std::pmr::memory_resource* memory, std::size_t bytes) noexcept {
  try {
    return static_cast<T*>(memory->allocate(bytes, alignof(std::max_align_t)));
  } catch (...) {
    return nullptr;
  }
}

// A child's tree is made of degenerate triangles: two vertices each.
[[nodiscard]] Status plant(const Compound& compound, std::pmr::memory_resource* memory) noexcept {
  Column<float> vertices(memory);
  Column<std::uint32_t> corners(memory);
  const std::size_t count = compound.count;
  if (!vertices.resize(6 * count) || !corners.resize(3 * count)) return Status::out_of_memory;
  for (std::uint32_t i = 0; i < compound.count; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      vertices[6 * i + static_cast<std::size_t>(axis)] = compound.boxes[i].min[axis];
      vertices[6 * i + 3 + static_cast<std::size_t>(axis)] = compound.boxes[i].max[axis];
    }
    corners[3 * i] = 2 * i;
    corners[3 * i + 1] = corners[3 * i + 2] = 2 * i + 1;
  }
  const float* const x = vertices.data();
  return compound.tree->build(PointView({x, x + 1, x + 2}, 2 * count, 3 * sizeof(float)),
                              std::span<const std::uint32_t>(corners.data(), corners.size()));
}

[[nodiscard]] Aabb box_of(const ShapePool& shapes, const CompoundChild& child) noexcept {
  const Eigen::Vector4d turn = tame(child.pose.orientation);
  const Box box = box_under(shapes.tables(), child.shape, rotation_of(turn),
                            Eigen::Map<const Vec>(child.pose.position), 0.0);
  return Aabb::outward(box.min, box.max);
}

}  // namespace

bool SharedMesh::find_corners() noexcept {
  const MeshView& view = mesh.view();
  if (!active_corners.reserve((view.vertex_count + std::size_t{31}) / 32)) return false;
  active_corners.set_size((view.vertex_count + std::size_t{31}) / 32);
  std::fill(active_corners.begin(), active_corners.end(), 0U);
  for (std::uint32_t slot = 0; slot < view.triangle_count; ++slot) {
    const std::uint32_t active = view.triangle[slot] >> kActiveEdgeShift;
    for (std::uint32_t k = 0; k < 3; ++k) {
      // On edge k and on the one before.
      const std::uint32_t both = 1U << k | 1U << (k + 2) % 3;
      const std::uint32_t vertex = view.corner[k][slot];
      if ((active & both) != 0) active_corners[vertex / 32] |= 1U << vertex % 32;
    }
  }
  return true;
}

Composites::Composites(const ShapePool& pool, std::pmr::memory_resource* resource) noexcept
    : shapes(pool), memory(resource), meshes(resource), fields(resource), compounds(resource) {}

Composites::~Composites() {
  for (const MeshEntry& entry : meshes.entries) {
    if (entry.shared != nullptr) release(entry.shared);
  }
  for (HeightField* const field : fields.entries) {
    if (field == nullptr) continue;
    field->~HeightField();
    memory->deallocate(field, sizeof(HeightField), alignof(std::max_align_t));
  }
  for (Compound* const compound : compounds.entries) {
    if (compound != nullptr) release(compound);
  }
}

const MeshEntry* Composites::mesh(ShapeId id) const noexcept {
  if (id.kind_index() != static_cast<std::uint32_t>(CompositeKind::mesh)) return nullptr;
  if (id.index() >= meshes.entries.size()) return nullptr;
  const MeshEntry& entry = meshes.entries[id.index()];
  return entry.shared != nullptr ? &entry : nullptr;
}

HeightField* Composites::field(ShapeId id) const noexcept {
  if (id.kind_index() != static_cast<std::uint32_t>(CompositeKind::height_field)) return nullptr;
  return id.index() < fields.entries.size() ? fields.entries[id.index()] : nullptr;
}

const Compound* Composites::compound(ShapeId id) const noexcept {
  if (id.kind_index() != static_cast<std::uint32_t>(CompositeKind::compound)) return nullptr;
  return id.index() < compounds.entries.size() ? compounds.entries[id.index()] : nullptr;
}

SharedMesh* Composites::new_mesh() noexcept {
  auto* const room = allocate<SharedMesh>(memory, sizeof(SharedMesh));
  if (room == nullptr) return nullptr;
  auto* const shared = new (room) SharedMesh(memory);
  shared->users = 1;
  shared->next = first_mesh;
  if (first_mesh != nullptr) first_mesh->previous = shared;
  first_mesh = shared;
  return shared;
}

void Composites::release(SharedMesh* shared) noexcept {
  if (--shared->users != 0) return;
  (shared->previous != nullptr ? shared->previous->next : first_mesh) = shared->next;
  if (shared->next != nullptr) shared->next->previous = shared->previous;
  shared->~SharedMesh();
  memory->deallocate(shared, sizeof(SharedMesh), alignof(std::max_align_t));
}

Status Composites::new_compound(std::span<const CompoundChild> children, Compound*& made) noexcept {
  const std::size_t count = children.size();
  const bool many = count > kFlatChildren;
  const std::size_t tree_at = sizeof(Compound);
  const std::size_t children_at = tree_at + (many ? sizeof(TriangleMesh) : 0);
  const std::size_t boxes_at = children_at + count * sizeof(CompoundChild);
  const std::size_t bytes = boxes_at + count * sizeof(Aabb);
  auto* const block = allocate<std::byte>(memory, bytes);
  if (block == nullptr) return Status::out_of_memory;
  auto* const compound = new (block) Compound;
  compound->count = static_cast<std::uint32_t>(count);
  compound->bytes = bytes;
  auto* const to = reinterpret_cast<CompoundChild*>(block + children_at);
  auto* const boxes = reinterpret_cast<Aabb*>(block + boxes_at);
  compound->children = to;
  compound->boxes = boxes;
  for (std::size_t i = 0; i < count; ++i) {
    new (to + i) CompoundChild(children[i]);
    new (boxes + i) Aabb(box_of(shapes, children[i]));
    compound->bounds.merge(boxes[i]);
    const Eigen::Map<const Vec> at(children[i].pose.position);
    const double radius = radius_of(shapes.tables(), children[i].shape) + at.stableNorm();
    compound->radius = std::max(compound->radius, radius * (1.0 + kSlack));
  }
  if (many && Box::of(compound->bounds).is_finite()) {
    compound->tree = new (block + tree_at) TriangleMesh(memory);
    const Status status = plant(*compound, memory);
    if (status != Status::ok) {
      release(compound);
      return status;
    }
  }
  made = compound;
  return Status::ok;
}

void Composites::release(Compound* compound) noexcept {
  if (compound->tree != nullptr) compound->tree->~TriangleMesh();
  const std::size_t bytes = compound->bytes;
  memory->deallocate(compound, bytes, alignof(std::max_align_t));
}

Box bounds_of(const Composites& all, ShapeId id, const Pose& pose) noexcept {
  const Eigen::Vector4d turn = tame(pose.orientation);
  const Mat rotation = rotation_of(turn);
  const Eigen::Map<const Vec> position(pose.position);
  if (const MeshEntry* const mesh = all.mesh(id)) {
    const Mat linear = rotation * Eigen::Map<const Vec>(mesh->scale).asDiagonal();
    return box_under(Box::of(mesh->shared->mesh.bounds()), linear, position, 0.0);
  }
  if (const HeightField* const field = all.field(id)) {
    return box_under(Box::of(field->bounds()), rotation, position, 0.0);
  }
  Box box;
  const Compound* const compound = all.compound(id);
  if (compound == nullptr) return box;
  for (std::uint32_t i = 0; i < compound->count; ++i) {
    const CompoundChild& child = compound->children[i];
    const Eigen::Map<const Vec> at(child.pose.position);
    const Mat linear = rotation * rotation_of(tame(child.pose.orientation));
    box.merge(box_under(all.shapes.tables(), child.shape, linear, position + rotation * at, 0.0));
  }
  return box;
}

}  // namespace winnow::mid
