#include <winnow/pipeline/composite_pool.h>
#include "pipeline/composites/composites.h"
#include "pipeline/composites/expand.h"
#include "pipeline/composites/smooth.h"
#include "pipeline/composites/visits.h"

#include <algorithm>
#include <cmath>
#include <new>

namespace winnow {

struct CompositePool::State : mid::Composites {
  using Composites::Composites;
};

namespace {

// Products of scales stay where their inverses and squares of lengths are finite.
constexpr double kLeastScale = 1e-100;
constexpr double kMostScale = 1e100;

[[nodiscard]] bool is_scale(double factor) noexcept {
  return std::abs(factor) >= kLeastScale && std::abs(factor) <= kMostScale;
}

}  // namespace

CompositePool::CompositePool(const ShapePool& shapes, std::pmr::memory_resource* memory) noexcept
    : shapes_(shapes), memory_(memory) {}

CompositePool::~CompositePool() {
  if (state_ == nullptr) return;
  state_->~State();
  memory_->deallocate(state_, sizeof(State), alignof(State));
}

CompositePool::State* CompositePool::state() noexcept {
  if (state_ == nullptr) {
    try {
      state_ = new (memory_->allocate(sizeof(State), alignof(State))) State(shapes_, memory_);
    } catch (...) {
      return nullptr;
    }
  }
  return state_;
}

Status CompositePool::add_mesh(const PointView& vertices, const IndexView& triangles, ShapeId& id,
                               const MeshOptions& options, const Execution& execution) {
  State* const s = state();
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
  id = ShapeId::of(CompositeKind::mesh, s->meshes.put({shared}));
  return Status::ok;
}

Status CompositePool::add_scaled(ShapeId mesh, const std::array<double, 3>& scale, ShapeId& id) {
  if (!contains(mesh) || mesh.composite_kind() != CompositeKind::mesh) return Status::invalid_key;
  mid::MeshEntry entry = *state_->mesh(mesh);
  for (std::size_t i = 0; i < 3; ++i) {
    if (!is_scale(scale[i])) return Status::invalid_argument;
    entry.scale[i] *= scale[i];
    if (!is_scale(entry.scale[i])) return Status::invalid_argument;
  }
  const Status status = state_->meshes.prepare();
  if (status != Status::ok) return status;
  ++entry.shared->users;
  id = ShapeId::of(CompositeKind::mesh, state_->meshes.put(entry));
  return Status::ok;
}

Status CompositePool::refit_mesh(ShapeId mesh, const PointView& vertices,
                                 const Execution& execution) {
  if (!contains(mesh) || mesh.composite_kind() != CompositeKind::mesh) return Status::invalid_key;
  mid::SharedMesh& shared = *state_->mesh(mesh)->shared;
  const Status status = shared.mesh.refit(vertices, execution);
  if (status != Status::ok) return status;
  static_cast<void>(shared.find_corners());
  ++state_->revision;
  return Status::ok;
}

Status CompositePool::add_height_field(const HeightSamples& samples, ShapeId& id) {
  State* const s = state();
  if (s == nullptr) return Status::out_of_memory;
  HeightField built(memory_);
  Status status = built.build(samples);
  if (status == Status::ok) status = s->fields.prepare();
  if (status != Status::ok) return status;
  try {
    void* const room = memory_->allocate(sizeof(HeightField), alignof(std::max_align_t));
    id = ShapeId::of(CompositeKind::height_field,
                     s->fields.put(new (room) HeightField(std::move(built))));
  } catch (...) {
    return Status::out_of_memory;
  }
  return Status::ok;
}

Status CompositePool::update_height_field(ShapeId field, std::uint32_t column, std::uint32_t row,
                                          const HeightSamples& samples) {
  if (height_field(field) == nullptr) return Status::invalid_key;
  const Status status = state_->field(field)->update(column, row, samples);
  if (status == Status::ok) ++state_->revision;
  return status;
}

Status CompositePool::add_compound(std::span<const CompoundChild> children, ShapeId& id) {
  if (children.empty()) return Status::invalid_shape;
  if (children.size() >> ShapeId::kIndexBits != 0) return Status::too_many_objects;
  for (const CompoundChild& child : children) {
    if (!shapes_.contains(child.shape)) return Status::invalid_key;
    if (!child.pose.is_valid()) return Status::invalid_pose;
  }
  State* const s = state();
  if (s == nullptr) return Status::out_of_memory;
  Status status = s->compounds.prepare();
  if (status != Status::ok) return status;
  mid::Compound* compound = nullptr;
  status = s->new_compound(children, compound);
  if (status != Status::ok) return status;
  id = ShapeId::of(CompositeKind::compound, s->compounds.put(compound));
  return Status::ok;
}

Status CompositePool::remove(ShapeId id) {
  if (!contains(id)) return Status::invalid_key;
  switch (id.composite_kind()) {
    case CompositeKind::mesh:
      state_->release(state_->mesh(id)->shared);
      state_->meshes.take(id.index());
      break;
    case CompositeKind::compound:
      state_->release(state_->compounds.entries[id.index()]);
      state_->compounds.take(id.index());
      break;
    case CompositeKind::height_field: {
      HeightField* const field = state_->field(id);
      field->~HeightField();
      memory_->deallocate(field, sizeof(HeightField), alignof(std::max_align_t));
      state_->fields.take(id.index());
      break;
    }
  }
  ++state_->revision;
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
  if (!contains(id)) return {};
  const mid::Box box = bounds_of(*state_, id, pose);
  return Aabb::outward(box.min, box.max);
}

double CompositePool::radius(ShapeId id) const noexcept {
  if (!contains(id)) return 0.0;
  switch (id.composite_kind()) {
    case CompositeKind::mesh: {
      const mid::MeshEntry& entry = *state_->mesh(id);
      double most = 0.0;
      for (const double factor : entry.scale) most = std::max(most, std::abs(factor));
      return entry.shared->mesh.radius() * most * (1.0 + mid::kSlack);
    }
    case CompositeKind::compound:
      return state_->compound(id)->radius;
    case CompositeKind::height_field:
      break;
  }
  return state_->field(id)->radius();
}

std::uint64_t CompositePool::revision() const noexcept {
  return state_ != nullptr ? state_->revision : 0;
}

Status CompositePool::expand(const ShapePool& shapes, const Bodies& bodies,
                             std::span<const BodyPair> pairs, double margin,
                             const Execution& execution, PrimitivePairs& out) const {
  return mid::expand(state_, shapes.tables(), bodies, pairs, margin, execution, out);
}

void CompositePool::smooth(const ShapePool& shapes, const PrimitivePairs& pairs,
                           const Execution& execution, NarrowResult& result) const {
  mid::smooth(shapes, pairs, execution, result);
}

void CompositePool::visit(ShapeId id, const Pose& pose, const BoxSweep& sweep,
                          const PrimitiveVisitor& visitor) const {
  if (contains(id)) mid::visit(*state_, id, pose, sweep, visitor);
}

void CompositePool::visit_near(ShapeId id, const Pose& pose, const BoxSweep& from, double limit,
                               const PrimitiveVisitor& visitor) const {
  if (contains(id)) mid::visit_near(*state_, id, pose, from, limit, visitor);
}

Footprint CompositePool::footprint() const noexcept {
  Footprint footprint;
  if (state_ == nullptr) return footprint;
  const auto add = [&](std::size_t bytes) { footprint.structure += {bytes, bytes}; };
  const auto add_whole = [&](const Footprint& part) { footprint.structure += part.total(); };
  add(sizeof(State));
  footprint.keys += state_->meshes.entries.bytes();
  footprint.keys += state_->meshes.free.bytes();
  footprint.keys += state_->fields.entries.bytes();
  footprint.keys += state_->fields.free.bytes();
  footprint.keys += state_->compounds.entries.bytes();
  footprint.keys += state_->compounds.free.bytes();
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
