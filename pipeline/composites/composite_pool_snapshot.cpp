// Saving and loading a CompositePool. A mesh shared by several ids is saved once. All other shapes
// are saved as the arguments that they were added with.

#include <winnow/pipeline/composite_pool.h>

#include "core/hooks/log.h"
#include "core/memory/free_list_io.h"
#include "core/memory/new_in.h"
#include "core/memory/snapshot_frame.h"
#include "core/threads/float_environment.h"
#include "pipeline/composites/composites.h"
#include "pipeline/composites/solid_hulls.h"

#include <utility>

namespace winnow {
namespace {

constexpr std::string_view kCompositesMagic = "WINNOWCP";
constexpr std::uint32_t kCompositesVersion = 1;

/// Writes each mesh entry: the index of its shared mesh, the mesh itself if the index is new, and
/// its scale.
void put_meshes(ByteWriter& out, const mid::SlotTable<mid::MeshEntry>& meshes,
                Column<const mid::SharedMesh*>& known) {
  for (const mid::MeshEntry& entry : meshes.entries) {
    if (entry.shared == nullptr) continue;
    const auto at = std::find(known.begin(), known.end(), entry.shared);
    out.put(static_cast<std::uint32_t>(at - known.begin()));
    if (at == known.end()) {
      known.set_size(known.size() + 1);
      known[known.size() - 1] = entry.shared;
      out.put_nested([&](Column<std::byte>& to) { return entry.shared->mesh.save(to); });
    }
    out.put_bytes(entry.scale, sizeof entry.scale);
  }
}

void put_children(ByteWriter& out, const mid::Compound& compound) {
  out.put(compound.count);
  for (const CompoundChild& child : std::span(compound.children, compound.count)) {
    out.put(child.shape.bits);
    out.put_bytes(&child.pose, sizeof child.pose);
  }
}

void put_ids(ByteWriter& out, const mid::IdSet& ids) {
  out.put_array(std::span<const std::uint32_t>(ids.bits().data(), ids.bits().size()));
}

void put_composites(ByteWriter& out, const mid::Composites& all,
                    Column<const mid::SharedMesh*>& known) {
  write_slots(out, all.meshes.entries.size(), all.meshes.free);
  put_meshes(out, all.meshes, known);
  write_slots(out, all.fields.entries.size(), all.fields.free);
  for (const HeightField* const field : all.fields.entries) {
    if (field == nullptr) continue;
    out.put_nested([&](Column<std::byte>& to) { return field->save(to); });
  }
  write_slots(out, all.compounds.entries.size(), all.compounds.free);
  for (const mid::Compound* const compound : all.compounds.entries) {
    if (compound != nullptr) put_children(out, *compound);
  }
  put_ids(out, all.one_sided);
  // Written only if there are solids: older snapshots end here.
  if (!all.solid.empty()) put_ids(out, all.solid);
}

/// Loads a mesh with one user, or a field. The caller adds it to the tables of `all`.
[[nodiscard]] Status read_shared(std::span<const std::byte> saved, const Execution& execution,
                                 mid::Composites& all, mid::SharedMesh*& shared) {
  shared = all.new_mesh();
  if (shared == nullptr) return Status::out_of_memory;
  Status status = shared->mesh.load(saved, execution);
  if (status == Status::ok && shared->mesh.triangles() == 0) status = Status::invalid_argument;
  if (status == Status::ok && !shared->find_corners()) status = Status::out_of_memory;
  if (status != Status::ok) all.release(shared);
  return status;
}
[[nodiscard]] Status read_field(std::span<const std::byte> saved, mid::Composites& all,
                                HeightField*& field) {
  field = new_in<HeightField>(all.memory, all.memory);
  if (field == nullptr) return Status::out_of_memory;
  Status status = field->load(saved);
  if (status == Status::ok && field->triangles() == 0) status = Status::invalid_argument;
  if (status != Status::ok) delete_in(all.memory, field);
  return status;
}

/// Reads a snapshot into an empty pool.
class CompositesReader {
 public:
  CompositesReader(ByteReader& in, CompositePool& pool, mid::Composites& all,
                   const Execution& execution) noexcept
      : in_(in), pool_(pool), all_(all), execution_(execution), known_(all.memory) {}

  [[nodiscard]] Status run() {
    Status status = read_all(all_.meshes, mid::MeshEntry{}, [&] { return read_mesh(); });
    if (status == Status::ok) {
      status = read_all(all_.fields, static_cast<HeightField*>(nullptr),
                        [&] { return read_next_field(); });
    }
    if (status == Status::ok) {
      status = read_all(all_.compounds, static_cast<mid::Compound*>(nullptr),
                        [&] { return read_compound(); });
    }
    if (status == Status::ok) {
      read_ids(all_.one_sided, [](CompositeKind kind) { return kind != CompositeKind::compound; });
    }
    if (status == Status::ok && !in_.rest().empty()) {
      read_ids(all_.solid, [](CompositeKind kind) { return kind == CompositeKind::mesh; });
    }
    if (status == Status::ok && !in_.rest().empty()) in_.fail();
    if (status == Status::ok && in_.ok()) status = mid::make_hulls(all_);
    return in_.ok() ? status : status_of(in_);
  }

 private:
  template <typename IsOf>
  void read_ids(mid::IdSet& ids, IsOf&& is_of) {
    if (!in_.get_array(ids.bits())) return;
    std::uint32_t before = 0;
    for (const std::uint32_t bits : ids.bits()) {
      const ShapeId id{bits};
      if (!pool_.contains(id) || !is_of(id.composite_kind()) || bits <= before) in_.fail();
      before = bits;
    }
  }
  template <typename Entry, typename Read>
  [[nodiscard]] Status read_all(mid::SlotTable<Entry>& places, const Entry& nothing, Read&& read) {
    SlotReader saved(all_.memory);
    if (!saved.read(in_) || !saved.open(in_, places.entries, places.free, nothing)) {
      return status_of(in_);
    }
    Status status = Status::ok;
    for (std::size_t i = 0; i < saved.taken() && status == Status::ok; ++i) status = read();
    return status;
  }

  [[nodiscard]] Status read_mesh() {
    const auto number = in_.get<std::uint32_t>();
    if (number > known_.size()) in_.fail();
    if (!in_.ok()) return status_of(in_);
    mid::MeshEntry entry;
    if (number < known_.size()) {
      entry.shared = known_[number];
      ++entry.shared->users;
    } else if (const Status status = read_next(entry.shared); status != Status::ok) {
      return status;
    }
    (void)in_.get_bytes(entry.scale, sizeof entry.scale);
    for (const double factor : entry.scale) {
      if (!mid::is_scale(factor)) in_.fail();
    }
    (void)all_.meshes.put(entry);
    return status_of(in_);
  }

  [[nodiscard]] Status read_next(mid::SharedMesh*& shared) {
    if (!known_.grow(known_.size() + 1)) return Status::out_of_memory;
    const Status status = read_shared(in_.get_nested(), execution_, all_, shared);
    if (status == Status::ok) (void)known_.push_back(shared);
    return status;
  }

  [[nodiscard]] Status read_next_field() {
    HeightField* field = nullptr;
    const Status status = read_field(in_.get_nested(), all_, field);
    if (status == Status::ok) (void)all_.fields.put(field);
    return status;
  }

  [[nodiscard]] Status read_compound() {
    const auto count = in_.get<std::uint32_t>();
    if (!in_.ok() || count > in_.rest().size() / sizeof(Pose)) return Status::invalid_argument;
    Column<CompoundChild> children(all_.memory);
    if (!children.resize(count)) return Status::out_of_memory;
    for (CompoundChild& child : children) {
      child = {};
      child.shape.bits = in_.get<std::uint32_t>();
      (void)in_.get_bytes(&child.pose, sizeof child.pose);
    }
    return in_.ok() ? pool_.add_compound({children.data(), children.size()}).status
                    : status_of(in_);
  }

  ByteReader& in_;
  CompositePool& pool_;
  mid::Composites& all_;
  const Execution& execution_;
  Column<mid::SharedMesh*> known_;
};

}  // namespace

Status CompositePool::save(Column<std::byte>& out) const {
  Column<const mid::SharedMesh*> known(memory_);
  if (state_ != nullptr && !known.reserve(state_->meshes.entries.size())) {
    return logged(Status::out_of_memory, "CompositePool::save");
  }
  const Status status =
      write_snapshot(out, kCompositesMagic, kCompositesVersion, [&](ByteWriter& writer) {
        writer.put(kShapeKinds);
        if (state_ != nullptr) put_composites(writer, *state_, known);
      });
  return logged(status, "CompositePool::save");
}

Status CompositePool::load(std::span<const std::byte> saved, const Execution& execution) {
  const DefaultFloatEnvironment environment;
  ByteReader in = open_snapshot(saved, kCompositesMagic, kCompositesVersion);
  if (in.get<std::uint32_t>() != kShapeKinds) in.fail();
  if (!in.ok()) return logged(status_of(in), "CompositePool::load");
  CompositePool fresh(shapes_, memory_);
  Status status = Status::ok;
  // A pool that has a state gets a new one even if the snapshot is empty, because `revision` must
  // increase.
  if (!in.rest().empty() || state_ != nullptr) {
    mid::Composites* const all = fresh.state();
    status = all == nullptr ? Status::out_of_memory : Status::ok;
    if (status == Status::ok && !in.rest().empty()) {
      status = CompositesReader(in, fresh, *all, execution).run();
    }
  }
  if (status != Status::ok) return logged(snapshot_status(status), "CompositePool::load");
  if (fresh.state_ != nullptr) ++revision_;
  std::swap(state_, fresh.state_);
  return Status::ok;
}

Answer<ShapeId> CompositePool::add_saved_mesh(std::span<const std::byte> saved, const Vec3d& scale,
                                              const Execution& execution) {
  const DefaultFloatEnvironment environment;
  if (!std::all_of(scale.begin(), scale.end(), mid::is_scale)) return Status::invalid_argument;
  mid::Composites* const s = state();
  if (s == nullptr) return Status::out_of_memory;
  Status status = s->meshes.prepare();
  if (status != Status::ok) return status;
  mid::MeshEntry entry;
  std::copy(scale.begin(), scale.end(), entry.scale);
  status = read_shared(saved, execution, *s, entry.shared);
  if (status != Status::ok) return status;
  return ShapeId::of(CompositeKind::mesh, s->meshes.put(entry));
}

Answer<ShapeId> CompositePool::add_saved_height_field(std::span<const std::byte> saved) {
  const DefaultFloatEnvironment environment;
  mid::Composites* const s = state();
  if (s == nullptr) return Status::out_of_memory;
  Status status = s->fields.prepare();
  if (status != Status::ok) return status;
  HeightField* field = nullptr;
  status = read_field(saved, *s, field);
  if (status != Status::ok) return status;
  return ShapeId::of(CompositeKind::height_field, s->fields.put(field));
}

}  // namespace winnow
