// The class Contacts: contacts of a scene as columns.

#include "pipeline/python/contact_choices.h"
#include "pipeline/python/entry_columns.h"
#include "pipeline/python/shared_scene.h"

#include <winnow/pipeline/narrow_result.h>

#include <algorithm>
#include <cstddef>

namespace winnow::python {
namespace {

/// Defines a property that makes arrays of contacts, locked against a concurrent fill.
template <typename Class, typename Make>
void define(Class& type, const char* name, Make make, const char* doc) {
  type.def_property_readonly(
      name,
      [make](const HeldContacts& held) -> py::object {
        const auto lock = held.hold();
        return make(*held.value(), std::shared_ptr<const void>(held.value()));
      },
      doc);
}

using Owner = const std::shared_ptr<const void>&;

template <typename T>
[[nodiscard]] py::array all(Owner owner, std::span<const T> values) {
  return shown(owner, values.data(), values.size());
}
[[nodiscard]] py::array key_column(Owner owner, std::span<const Key> keys) {
  return shown(owner, reinterpret_cast<const std::uint64_t*>(keys.data()), keys.size());
}
[[nodiscard]] py::array looked_up(const DataColumn& values) {
  py::array_t<ClientData> copy(static_cast<py::ssize_t>(values.size()));
  std::ranges::copy(values, copy.mutable_data());
  return copy;
}
/// If all shapes are convex, the column repeats one number with stride 0.
[[nodiscard]] py::array part_column(Owner owner, const PartColumn& values) {
  const std::uint32_t* const parts = values.lookup().parts;
  return parts != nullptr ? shown(owner, parts, values.size())
                          : shown(owner, &kWholeShape, values.size(), 0);
}
/// A tuple of three columns, one for each axis.
template <typename Column>
[[nodiscard]] py::tuple axes(Column&& column) {
  return py::make_tuple(column(0), column(1), column(2));
}

/// Two 64-bit numbers of each contact that ended.
[[nodiscard]] py::array ended_column(Owner owner, std::span<const EndedContact> ended,
                                     std::size_t offset) {
  return EntryColumns<EndedContact>(owner, ended).rows<std::uint64_t>(offset, 2);
}

[[nodiscard]] py::list runs_of(const Contacts& contacts) {
  py::list result;
  for (const ContactRun& run : contacts.runs()) {
    result.append(py::make_tuple(run.kind_a, run.kind_b, run.first, run.count));
  }
  return result;
}

template <typename Class>
void add_pairs(Class& type) {
  define(
      type, "a", [](const Contacts& c, Owner o) { return key_column(o, c.a()); },
      "Keys of the first bodies, (n,) uint64.");
  define(
      type, "b", [](const Contacts& c, Owner o) { return key_column(o, c.b()); },
      "Keys of the second bodies, (n,) uint64.");
  define(
      type, "data_a", [](const Contacts& c, Owner) { return looked_up(c.data_a()); },
      "Client data of the first bodies, (n,) uint64: a new array, made at each access.");
  define(
      type, "data_b", [](const Contacts& c, Owner) { return looked_up(c.data_b()); },
      "Client data of the second bodies, as data_a.");
  define(
      type, "event",
      [](const Contacts& c, Owner o) {
        const auto* const events = reinterpret_cast<const std::uint8_t*>(c.event().data());
        return shown(o, events, c.event().size());
      },
      "0 for pairs that began, 1 for pairs that persist: (n,) uint8.");
  define(
      type, "ended", [](const Contacts& c, Owner o) { return ended_column(o, c.ended(), 0); },
      "Pairs of keys that were in contact in the last frame and are not now, (k, 2) uint64.");
  define(
      type, "ended_data",
      [](const Contacts& c, Owner o) {
        return ended_column(o, c.ended(), offsetof(EndedContact, data_a));
      },
      "Client data of the pairs in `ended`, (k, 2) uint64.");
  define(
      type, "previous_pair", [](const Contacts& c, Owner o) { return all(o, c.previous_pair()); },
      "With the scene's `warm_start`, else empty: index of each pair in the last frame, or "
      "NO_CONTACT for new pairs: (n,) uint32.");
  define(
      type, "runs", [](const Contacts& c, Owner) { return runs_of(c); },
      "Ranges of pairs with the same two kinds of shapes: (kind a, kind b, first, count) each.");
}

template <typename Class>
void add_manifolds(Class& type) {
  define(
      type, "manifold_first", [](const Contacts& c, Owner o) { return all(o, c.manifold_first()); },
      "Manifolds of pair i are manifold_first[i] to manifold_first[i + 1]: (n + 1,) uint32.");
  define(
      type, "part_a", [](const Contacts& c, Owner o) { return part_column(o, c.part_a()); },
      "Triangle or child of a in each manifold, WHOLE_SHAPE for convex shapes: (m,) uint32.");
  define(
      type, "part_b", [](const Contacts& c, Owner o) { return part_column(o, c.part_b()); },
      "Triangle or child of b, as part_a.");
  define(
      type, "distance", [](const Contacts& c, Owner o) { return all(o, c.distance()); },
      "Distance, negative if they overlap: (m,) float64.");
  define(
      type, "error_bound", [](const Contacts& c, Owner o) { return all(o, c.error_bound()); },
      "The true distance is within distance +- this: (m,) float64.");
  define(
      type, "normal",
      [](const Contacts& c, Owner o) {
        return axes([&](int axis) { return all(o, c.normal(axis)); });
      },
      "Unit vector from a to b, in world axes: three (m,) float64.");
  define(
      type, "point",
      [](const Contacts& c, Owner o) {
        return axes([&](int axis) { return all(o, c.point(axis)); });
      },
      "Level distance: the closest or deepest point of a, relative to its position: three (m,) "
      "float64.");
}

template <typename Class>
void add_points(Class& type) {
  const auto span_of = [](const auto& c) { return std::span(c.data(), c.size()); };
  define(
      type, "point_first", [](const Contacts& c, Owner o) { return all(o, c.point_first()); },
      "Level manifold: the points of manifold m are point_first[m] to point_first[m + 1].");
  define(
      type, "contact_position",
      [span_of](const Contacts& c, Owner o) {
        return axes(
            [&](int axis) { return all<float>(o, span_of(c.contact_columns().position[axis])); });
      },
      "Position halfway between the surfaces, relative to the position of a: three (p,) float32.");
  define(
      type, "contact_depth",
      [span_of](const Contacts& c, Owner o) {
        return all<float>(o, span_of(c.contact_columns().depth));
      },
      "Positive where they overlap: (p,) float32.");
  define(
      type, "previous_point", [](const Contacts& c, Owner o) { return all(o, c.previous_point()); },
      "Index of each point in the last frame, as `previous_pair`: (p,) uint32.");
  define(
      type, "contact_feature",
      [span_of](const Contacts& c, Owner o) {
        return all<std::uint64_t>(o, span_of(c.contact_columns().feature));
      },
      "The features of a and b that made the point, the same from frame to frame: (p,) uint64.");
}

}  // namespace

void add_contacts(py::module_& module) {
  module.attr("NO_CONTACT") = kNoContact;
  py::class_<HeldContacts, std::shared_ptr<HeldContacts>> type(
      module, "Contacts",
      "The results of `Scene.collide`: pairs of bodies, the manifolds of each pair, and the points "
      "of each manifold. Reused from frame to frame, because it remembers the last results. Its "
      "arrays are read-only views; while one is alive, filling the contacts raises a BufferError. "
      "Vectors are tuples of one array for each axis.");
  type.def(py::init([] { return std::make_shared<HeldContacts>(); }),
           "Contacts without a last frame.")
      .def("__len__",
           [](const HeldContacts& held) {
             const auto lock = held.hold();
             return held.value()->size();
           })
      .def(
          "clear",
          [](const HeldContacts& held) {
            const auto lock = held.hold();
            held.to_fill("contacts").clear();
          },
          "Forgets everything.");
  define(
      type, "level",
      [](const Contacts& c, Owner) { return py::str(std::string(name_of(kLevels, c.level()))); },
      "The level of the last `collide`.");
  define(
      type, "cached_pairs", [](const Contacts& c, Owner) { return py::int_(c.cached_pairs()); },
      "Number of pairs that kept their manifolds.");
  add_pairs(type);
  add_manifolds(type);
  add_points(type);
}

}  // namespace winnow::python
