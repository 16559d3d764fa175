// Snapshots of partitions, shapes, scenes and contacts as bytes.

#include "pipeline/python/snapshots.h"
#include <winnow/core/memory.h>

#include "pipeline/python/bytes.h"
#include "pipeline/python/locks.h"
#include "pipeline/python/refusal.h"

#include <cstring>

namespace winnow::python {
namespace {

/// Returns the bytes that save(column) appends, with shared access to the saved object.
template <typename Save>
[[nodiscard]] py::bytes saved_by(std::shared_mutex& mutex, const char* call, Save&& save) {
  Column<std::byte> out(default_memory());
  accept(reading(mutex, [&] { return save(out); }), call);
  return {reinterpret_cast<const char*>(out.data()), out.size()};
}

[[nodiscard]] py::bytes save_shapes(const SharedShapes& shapes) {
  return saved_by(shapes.mutex, "save", [&](Column<std::byte>& out) {
    const Status status = shapes.pool.save(out);
    return status == Status::ok ? shapes.composites.save(out) : status;
  });
}

/// Returns the end of the first of two concatenated snapshots, from the size in its header.
[[nodiscard]] std::size_t end_of_first(std::span<const std::byte> both) noexcept {
  constexpr std::size_t kHeader = 32;
  std::uint64_t size = 0;
  if (both.size() < kHeader) return both.size();
  std::memcpy(&size, both.data() + 16, sizeof size);
  return size > both.size() - kHeader ? both.size() : kHeader + static_cast<std::size_t>(size);
}

void load_shapes(SharedShapes& shapes, const py::buffer& data) {
  const BytesInput input(data);
  const std::span<const std::byte> all = input.bytes();
  const std::size_t middle = end_of_first(all);
  ++shapes.revision;
  SupportFunctions gone;
  change_or_throw(shapes.mutex, "load (of shapes that no scene uses)", [&] {
    const Status status = shapes.load(all.first(middle), all.subspan(middle));
    if (status == Status::ok) gone.swap(shapes.supports);
    return status;
  });
}

void load_scene(SharedScene& s, const py::buffer& data) {
  const BytesInput input(data);
  change_or_throw(s.mutex, "load", [&] {
    const std::shared_lock lock(s.shapes->mutex);
    s.is_stale = true;
    const Status status = s.scene.load(input.bytes());
    if (status != Status::ok) return status;
    s.held.clear();
    std::vector<ShapeId> used;
    BodyDefinition body;
    for (ObjectId id = 0; used.size() < s.scene.size(); ++id) {
      if (s.scene.body(s.scene.key_of(id)).get(body) == Status::ok) {
        used.push_back(body.shape);
      }
    }
    s.held.use(used, 1);
    return Status::ok;
  });
}

[[nodiscard]] py::bytes save_contacts(const SharedScene& s, const HeldContacts& contacts) {
  const std::unique_lock<std::mutex> held = contacts.hold();
  return saved_by(s.mutex, "save_contacts", [&](Column<std::byte>& out) {
    return s.scene.save_contacts(*contacts.value(), out);
  });
}

void load_contacts(SharedScene& s, const py::buffer& data, HeldContacts& contacts) {
  const BytesInput input(data);
  const std::unique_lock<std::mutex> filling = contacts.hold();
  Contacts& out = contacts.to_fill("contacts");
  change_or_throw(s.mutex, "load_contacts",
                  [&] { return s.scene.load_contacts(input.bytes(), out); });
}

}  // namespace

void add_partition_snapshots(PartitionClass& partition) {
  partition
      .def("save",
           [](const SharedPartition& p) {
             // Needs exclusive access: deferred updates may have to be written first.
             Column<std::byte> out(default_memory());
             change_or_throw(p.mutex, "save", [&] { return p.partition.save(out); });
             return py::bytes(reinterpret_cast<const char*>(out.data()), out.size());
           })
      .def("load", [](SharedPartition& p, const py::buffer& data) {
        const BytesInput input(data);
        change_or_throw(p.mutex, "load", [&] { return p.partition.load(input.bytes()); });
        p.count_changes(p.partition.size());
      });
}

void add_shape_snapshots(ShapesClass& shapes) {
  shapes.def("save", &save_shapes).def("load", &load_shapes);
}

void add_scene_snapshots(SceneClass& scene) {
  scene
      .def("save",
           [](const SharedScene& s) {
             return saved_by(s.mutex, "save",
                             [&](Column<std::byte>& out) { return s.scene.save(out); });
           })
      .def("load", &load_scene)
      .def("save_contacts", &save_contacts)
      .def("load_contacts", &load_contacts);
}

}  // namespace winnow::python
