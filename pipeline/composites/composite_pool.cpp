// CompositePool: adds, scales, refits and removes meshes, height fields and compounds; and the
// table of the mid phase (mid_phase.h), whose functions are in the other files of this folder.

#include <winnow/pipeline/composite_pool.h>

#include "core/memory/new_in.h"
#include "core/numbers/rotation.h"
#include "core/threads/float_environment.h"
#include "pipeline/composites/composites.h"
#include "pipeline/kernels/link.h"
#include "pipeline/mesh/mesh_view.h"
#include "pipeline/shapes/extent.h"
#include "pipeline/shapes/hull_builder.h"

#include <algorithm>
#include <cmath>
#include <new>

namespace winnow {
namespace mid {
namespace {

/// Insertion into and removal from a doubly linked list.
template <typename Entry>
void put_first(Entry*& first, Entry* entry) noexcept {
  entry->next = first;
  if (first != nullptr) first->previous = entry;
  first = entry;
}
template <typename Entry>
void take_out(Entry*& first, Entry* entry) noexcept {
  (entry->previous != nullptr ? entry->previous->next : first) = entry->next;
  if (entry->next != nullptr) entry->next->previous = entry->previous;
}

// Builds the tree of a compound: one degenerate triangle per child, with two opposite corners of
// the child's box as vertices.
[[nodiscard]] Status build_child_tree(const Compound& compound,
                                      std::pmr::memory_resource* memory) noexcept {
  Column<std::uint32_t> corners(memory);
  const std::size_t count = compound.count;
  if (!corners.resize(3 * count)) return Status::out_of_memory;
  for (std::uint32_t i = 0; i < compound.count; ++i) {
    corners[3 * i] = 2 * i;
    corners[3 * i + 1] = corners[3 * i + 2] = 2 * i + 1;
  }
  static_assert(sizeof(Aabb) == 6 * sizeof(float));
  const float* const x = &compound.boxes->min[0];
  return compound.tree->build(PointView({x, x + 1, x + 2}, 2 * count, 3 * sizeof(float)),
                              std::span<const std::uint32_t>(corners.data(), corners.size()));
}

/// The box of a shape at a pose.
[[nodiscard]] Box3 bounds_of(const Composites& all, ShapeId id, const Mat& rotation,
                             const Vec& position) noexcept {
  if (!id.is_composite()) {
    return box_under(all.shapes.tables(), id, rotation, position, 0.0);
  }
  if (const MeshEntry* const mesh = all.mesh(id)) {
    const Mat linear = rotation * Eigen::Map<const Vec>(mesh->scale).asDiagonal();
    return box_under(Box3::of(mesh->shared->mesh.bounds()), linear, position, 0.0);
  }
  if (const HeightField* const field = all.field(id)) {
    return box_under(Box3::of(field->bounds()), rotation, position, 0.0);
  }
  Box3 box;
  const Compound* const compound = all.compound(id);
  if (compound == nullptr) return box;
  for (std::uint32_t i = 0; i < compound->count; ++i) {
    const CompoundChild& child = compound->children[i];
    const auto at = as_eigen(child.pose.position);
    const Mat turned = rotation_of(scale_to_unit_max(child.pose.orientation));
    box.merge(bounds_of(all, child.shape, rotation * turned, position + rotation * at));
  }
  return box;
}
[[nodiscard]] Box3 bounds_of(const Composites& all, ShapeId id, const Pose& pose) noexcept {
  return bounds_of(all, id, rotation_of(scale_to_unit_max(pose.orientation)),
                   as_eigen(pose.position));
}

}  // namespace

bool SharedMesh::find_corners() noexcept {
  const MeshView& view = view_of(mesh);
  if (!active_corners.reserve((view.vertex_count + std::size_t{31}) / 32)) return false;
  active_corners.set_size((view.vertex_count + std::size_t{31}) / 32);
  std::fill(active_corners.begin(), active_corners.end(), 0U);
  for (std::uint32_t slot = 0; slot < view.triangle_count; ++slot) {
    const std::uint32_t active = view.triangle[slot] >> kActiveEdgeShift;
    for (std::uint32_t k = 0; k < 3; ++k) {
      // Edges that start or end at corner k.
      const std::uint32_t both = 1U << k | 1U << (k + 2) % 3;
      const std::uint32_t vertex = corner_of(view, k, slot);
      if ((active & both) != 0) active_corners[vertex / 32] |= 1U << vertex % 32;
    }
  }
  return true;
}

Composites::Composites(const ShapePool& pool, std::pmr::memory_resource* resource) noexcept
    : shapes(pool),
      memory(resource),
      meshes(resource),
      fields(resource),
      compounds(resource),
      one_sided(resource),
      solid(resource),
      hulls(resource) {}

Composites::~Composites() {
  for (MeshEntry& entry : meshes.entries) {
    drop_hull(entry);
    if (entry.shared != nullptr) release(entry.shared);
  }
  for (HeightField* const field : fields.entries) delete_in(memory, field);
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
  auto* const shared = new_in<SharedMesh>(memory, memory);
  if (shared == nullptr) return nullptr;
  shared->users = 1;
  put_first(first_mesh, shared);
  return shared;
}

void Composites::release(SharedMesh* shared) noexcept {
  if (--shared->users != 0) return;
  take_out(first_mesh, shared);
  delete_in(memory, shared);
}

std::uint32_t Composites::parts(ShapeId id) const noexcept {
  if (const MeshEntry* const entry = mesh(id)) {
    return static_cast<std::uint32_t>(entry->shared->mesh.triangles());
  }
  if (const HeightField* const heights = field(id)) return heights->triangles();
  const Compound* const children = compound(id);
  return children != nullptr ? children->parts() : 1;
}

double Composites::radius(ShapeId id) const noexcept {
  if (const MeshEntry* const entry = mesh(id)) {
    double most = 0.0;
    for (const double factor : entry->scale) most = std::max(most, std::abs(factor));
    return entry->shared->mesh.radius() * most * (1.0 + kSlack);
  }
  if (const HeightField* const heights = field(id)) return heights->radius();
  const Compound* const children = compound(id);
  return children != nullptr ? children->radius : radius_of(shapes.tables(), id) * (1.0 + kSlack);
}

Status Composites::new_compound(std::span<const CompoundChild> children, Compound*& made) noexcept {
  const std::size_t count = children.size();
  const bool many = count > kFlatChildren;
  const bool has_surfaces =
      std::any_of(children.begin(), children.end(),
                  [](const CompoundChild& child) { return child.shape.is_composite(); });
  const std::size_t tree_at = sizeof(Compound);
  const std::size_t children_at = tree_at + (many ? sizeof(TriangleMesh) : 0);
  const std::size_t boxes_at = children_at + count * sizeof(CompoundChild);
  const std::size_t parts_at = boxes_at + count * sizeof(Aabb);
  const std::size_t bytes = parts_at + (has_surfaces ? (count + 1) * sizeof(std::uint32_t) : 0);
  auto* const block =
      static_cast<std::byte*>(detail::try_allocate(*memory, bytes, alignof(std::max_align_t)));
  if (block == nullptr) return Status::out_of_memory;
  auto* const compound = new (block) Compound;
  compound->count = static_cast<std::uint32_t>(count);
  compound->bytes = bytes;
  auto* const to = reinterpret_cast<CompoundChild*>(block + children_at);
  auto* const boxes = reinterpret_cast<Aabb*>(block + boxes_at);
  compound->children = to;
  compound->boxes = boxes;
  auto* const parts_of = reinterpret_cast<std::uint32_t*>(block + parts_at);
  std::uint32_t part = 0;
  for (std::size_t i = 0; i < count; ++i) {
    new (to + i) CompoundChild(children[i]);
    new (boxes + i) Aabb;
    if (has_surfaces) new (parts_of + i) std::uint32_t(part);
    part += parts(children[i].shape);
  }
  if (has_surfaces) {
    new (parts_of + count) std::uint32_t(part);
    compound->first_part = parts_of;
    put_first(first_compound_with_surfaces, compound);
  }
  const Status status = fit(*compound);
  if (status != Status::ok) {
    release(compound);
    return status;
  }
  made = compound;
  return Status::ok;
}

Status Composites::fit(Compound& compound) noexcept {
  compound.bounds = Aabb{};
  compound.radius = 0.0;
  for (std::uint32_t i = 0; i < compound.count; ++i) {
    const CompoundChild& child = compound.children[i];
    const Box3 box = bounds_of(*this, child.shape, child.pose);
    compound.boxes[i] = Aabb::outward(box.min, box.max);
    compound.bounds.merge(compound.boxes[i]);
    const double farthest = radius(child.shape) + as_eigen(child.pose.position).stableNorm();
    compound.radius = std::max(compound.radius, farthest * (1.0 + kSlack));
  }
  if (compound.tree != nullptr) compound.tree->~TriangleMesh();
  compound.tree = nullptr;
  if (compound.count <= kFlatChildren || !Box3::of(compound.bounds).is_finite()) return Status::ok;
  // new_compound allocated room for the tree behind the compound.
  compound.tree = new (&compound + 1) TriangleMesh(memory);
  const Status status = build_child_tree(compound, memory);
  if (status == Status::ok) return status;
  compound.tree->~TriangleMesh();
  compound.tree = nullptr;
  return status;
}

void Composites::drop_hull(MeshEntry& entry) noexcept {
  if (entry.hull == MeshEntry::kNoHull) return;
  release_hull(hulls.entries[entry.hull], memory);
  hulls.take(entry.hull);
  entry.hull = MeshEntry::kNoHull;
}

void Composites::release(Compound* compound) noexcept {
  if (compound->has_surfaces()) take_out(first_compound_with_surfaces, compound);
  if (compound->tree != nullptr) compound->tree->~TriangleMesh();
  const std::size_t bytes = compound->bytes;
  memory->deallocate(compound, bytes, alignof(std::max_align_t));
}

namespace {

constexpr MidPhase kMidPhase = {
    .contains = [](const CompositePool& pool, ShapeId id) noexcept { return pool.contains(id); },
    .bounds = [](const CompositePool& pool, ShapeId id,
                 const Pose& pose) noexcept { return pool.bounds(id, pose); },
    .radius = [](const CompositePool& pool, ShapeId id) noexcept { return pool.radius(id); },
    .find_primitive_pairs = find_primitive_pairs,
    .correct_surface_contacts = correct_surface_contacts,
    .reduce_contacts = reduce_contacts,
    .visit = visit,
    .cast_rays = cast_rays,
    .visit_near = visit_near,
    .visit_pairs = visit_pairs,
    .visit_near_pairs = visit_near_pairs,
    .has_solids = has_solids,
    .solid_contains_point = solid_contains_point,
    .solid_contains_shape = solid_contains_shape,
};

}  // namespace
}  // namespace mid

CompositePool::CompositePool(const ShapePool& shapes, std::pmr::memory_resource* memory) noexcept
    : shapes_(shapes), memory_(memory), mid_phase_(&mid::kMidPhase) {
  link_triangle_kernels();
}

CompositePool::~CompositePool() {
  delete_in(memory_, state_);
}

mid::Composites* CompositePool::state() noexcept {
  if (state_ == nullptr) state_ = new_in<mid::Composites>(memory_, shapes_, memory_);
  return state_;
}

Answer<ShapeId> CompositePool::add_mesh(const PointView& vertices, const IndexView& triangles,
                                        const MeshOptions& options, const Execution& execution) {
  const DefaultFloatEnvironment environment;
  mid::Composites* const s = state();
  if (s == nullptr) return Status::out_of_memory;
  Status status = s->meshes.prepare();
  if (status != Status::ok) return status;
  mid::SharedMesh* const shared = s->new_mesh();
  if (shared == nullptr) return Status::out_of_memory;
  status = shared->mesh.build(vertices, triangles, options, execution);
  if (status == Status::ok && !shared->find_corners()) status = Status::out_of_memory;
  if (status != Status::ok) {
    s->release(shared);
    return status;
  }
  return ShapeId::of(CompositeKind::mesh, s->meshes.put({shared}));
}

Answer<ShapeId> CompositePool::add_scaled(ShapeId mesh, const Vec3d& scale) {
  const DefaultFloatEnvironment environment;
  if (!contains(mesh) || mesh.composite_kind() != CompositeKind::mesh) return Status::invalid_key;
  mid::MeshEntry entry = *state_->mesh(mesh);
  entry.hull = mid::MeshEntry::kNoHull;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!mid::is_scale(scale[i])) return Status::invalid_argument;
    entry.scale[i] *= scale[i];
    if (!mid::is_scale(entry.scale[i])) return Status::invalid_argument;
  }
  const Status status = state_->meshes.prepare();
  if (status != Status::ok) return status;
  ++entry.shared->users;
  return ShapeId::of(CompositeKind::mesh, state_->meshes.put(entry));
}

Status CompositePool::refit_mesh(ShapeId mesh, const PointView& vertices,
                                 const Execution& execution) {
  const DefaultFloatEnvironment environment;
  if (!contains(mesh) || mesh.composite_kind() != CompositeKind::mesh) return Status::invalid_key;
  mid::SharedMesh& shared = *state_->mesh(mesh)->shared;
  const Status status = shared.mesh.refit(vertices, execution);
  if (status != Status::ok) return status;
  static_cast<void>(shared.find_corners());
  if (state_->refit_hulls != nullptr) state_->refit_hulls(*state_, shared);
  state_->fit_users([&](ShapeId id) {
    const mid::MeshEntry* const entry = state_->mesh(id);
    return entry != nullptr && entry->shared == &shared;
  });
  ++revision_;
  return Status::ok;
}

Answer<ShapeId> CompositePool::add_height_field(const HeightSamples& samples) {
  const DefaultFloatEnvironment environment;
  mid::Composites* const s = state();
  if (s == nullptr) return Status::out_of_memory;
  Status status = s->fields.prepare();
  if (status != Status::ok) return status;
  auto* const field = new_in<HeightField>(memory_, memory_);
  if (field == nullptr) return Status::out_of_memory;
  status = field->build(samples);
  if (status != Status::ok) {
    delete_in(memory_, field);
    return status;
  }
  return ShapeId::of(CompositeKind::height_field, s->fields.put(field));
}

Status CompositePool::update_height_field(ShapeId field, std::uint32_t column, std::uint32_t row,
                                          const HeightSamples& samples) {
  const DefaultFloatEnvironment environment;
  if (height_field(field) == nullptr) return Status::invalid_key;
  const Status status = state_->field(field)->update(column, row, samples);
  if (status != Status::ok) return status;
  state_->fit_users([&](ShapeId id) { return id == field; });
  ++revision_;
  return Status::ok;
}

Answer<ShapeId> CompositePool::add_compound(std::span<const CompoundChild> children) {
  const DefaultFloatEnvironment environment;
  if (children.empty()) return Status::invalid_shape;
  if (children.size() >> ShapeId::kIndexBits != 0) return Status::too_many_objects;
  const auto can_be_child = [&](ShapeId id) {
    return id.is_composite() ? contains(id) && id.composite_kind() != CompositeKind::compound
                             : shapes_.contains(id);
  };
  std::uint64_t parts = 0;
  for (const CompoundChild& child : children) {
    if (!can_be_child(child.shape)) return Status::invalid_key;
    if (!child.pose.is_valid()) return Status::invalid_pose;
    parts += state_ != nullptr ? state_->parts(child.shape) : 1;
  }
  if (parts > mid::kMaxParts) return Status::too_many_objects;
  mid::Composites* const s = state();
  if (s == nullptr) return Status::out_of_memory;
  Status status = s->compounds.prepare();
  if (status != Status::ok) return status;
  mid::Compound* compound = nullptr;
  status = s->new_compound(children, compound);
  if (status != Status::ok) return status;
  return ShapeId::of(CompositeKind::compound, s->compounds.put(compound));
}

std::uint32_t CompositePool::parts(ShapeId id) const noexcept {
  return contains(id) ? state_->parts(id) : 0;
}

CompoundPart CompositePool::part(ShapeId compound, std::uint32_t part) const noexcept {
  const DefaultFloatEnvironment environment;
  const mid::Compound* const found = state_ != nullptr ? state_->compound(compound) : nullptr;
  if (found == nullptr || part >= found->parts()) return {};
  const std::uint32_t child = found->child_of(part);
  if (!found->children[child].shape.is_composite()) return {child, kWholeShape};
  return {child, part - found->first_part[child]};
}

Status CompositePool::set_one_sided(ShapeId surface, bool one_sided) {
  if (!contains(surface) || surface.composite_kind() == CompositeKind::compound) {
    return Status::invalid_key;
  }
  return state_->one_sided.set(surface, one_sided, revision_);
}

bool CompositePool::is_solid(ShapeId id) const noexcept {
  return contains(id) && state_->is_solid(id);
}

bool CompositePool::is_one_sided(ShapeId surface) const noexcept {
  return contains(surface) && state_->is_one_sided(surface);
}

Status CompositePool::remove(ShapeId id) {
  if (!contains(id)) return Status::invalid_key;
  if (state_->is_child(id)) return Status::invalid_argument;
  if (is_one_sided(id)) state_->one_sided.remove(id);
  if (is_solid(id)) state_->solid.remove(id);
  switch (id.composite_kind()) {
    case CompositeKind::mesh:
      state_->drop_hull(state_->meshes.entries[id.index()]);
      state_->release(state_->mesh(id)->shared);
      state_->meshes.take(id.index());
      break;
    case CompositeKind::compound:
      state_->release(state_->compounds.entries[id.index()]);
      state_->compounds.take(id.index());
      break;
    case CompositeKind::height_field:
      delete_in(memory_, state_->field(id));
      state_->fields.take(id.index());
      break;
  }
  ++revision_;
  return Status::ok;
}

std::size_t CompositePool::size(CompositeKind kind) const noexcept {
  if (state_ == nullptr) return 0;
  switch (kind) {
    case CompositeKind::mesh:
      return state_->meshes.size();
    case CompositeKind::compound:
      return state_->compounds.size();
    case CompositeKind::height_field:
      break;
  }
  return state_->fields.size();
}

const TriangleMesh* CompositePool::mesh(ShapeId id) const noexcept {
  const mid::MeshEntry* const entry = state_ != nullptr ? state_->mesh(id) : nullptr;
  return entry != nullptr ? &entry->shared->mesh : nullptr;
}

Vec3d CompositePool::scale(ShapeId mesh) const noexcept {
  const mid::MeshEntry* const entry = state_ != nullptr ? state_->mesh(mesh) : nullptr;
  if (entry == nullptr) return {1.0, 1.0, 1.0};
  return {entry->scale[0], entry->scale[1], entry->scale[2]};
}

const HeightField* CompositePool::height_field(ShapeId id) const noexcept {
  return state_ != nullptr ? state_->field(id) : nullptr;
}

std::span<const CompoundChild> CompositePool::children(ShapeId compound) const noexcept {
  const mid::Compound* const found = state_ != nullptr ? state_->compound(compound) : nullptr;
  if (found == nullptr) return {};
  return {found->children, found->count};
}

bool CompositePool::contains(ShapeId id) const noexcept {
  return state_ != nullptr && state_->contains(id);
}

Aabb CompositePool::bounds(ShapeId id, const Pose& pose) const noexcept {
  const DefaultFloatEnvironment environment;
  if (!contains(id)) return {};
  const mid::Box3 box = mid::bounds_of(*state_, id, pose);
  return Aabb::outward(box.min, box.max);
}

double CompositePool::radius(ShapeId id) const noexcept {
  const DefaultFloatEnvironment environment;
  return contains(id) ? state_->radius(id) : 0.0;
}

Footprint CompositePool::footprint() const noexcept {
  Footprint footprint;
  if (state_ == nullptr) return footprint;
  const auto add = [&](std::size_t bytes) { footprint.structure += {bytes, bytes}; };
  const auto add_whole = [&](const Footprint& part) { footprint.structure += part.total(); };
  add(sizeof(mid::Composites));
  footprint.keys += state_->meshes.entries.bytes();
  footprint.keys += state_->meshes.free.bytes();
  footprint.keys += state_->fields.entries.bytes();
  footprint.keys += state_->fields.free.bytes();
  footprint.keys += state_->compounds.entries.bytes();
  footprint.keys += state_->compounds.free.bytes();
  footprint.keys += state_->one_sided.bits().bytes();
  footprint.keys += state_->solid.bits().bytes();
  footprint.structure += state_->hulls.entries.bytes();
  footprint.structure += state_->hulls.free.bytes();
  for (const HullShape& hull : state_->hulls.entries) add(hull_bytes(hull));
  for (const mid::SharedMesh* m = state_->first_mesh; m != nullptr; m = m->next) {
    add(sizeof(mid::SharedMesh));
    add_whole(m->mesh.footprint());
    footprint.structure += m->active_corners.bytes();
  }
  for (const HeightField* const field : state_->fields.entries) {
    if (field == nullptr) continue;
    add(sizeof(HeightField));
    add_whole(field->footprint());
  }
  for (const mid::Compound* const compound : state_->compounds.entries) {
    if (compound == nullptr) continue;
    add(compound->bytes);
    if (compound->tree != nullptr) add_whole(compound->tree->footprint());
  }
  return footprint;
}

}  // namespace winnow
