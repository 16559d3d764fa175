// The class Contacts: contacts of a scene as columns.

#include "pipeline/python/arrays.h"
#include "pipeline/python/contact_choices.h"
#include "pipeline/python/shared_scene.h"

#include <winnow/pipeline/narrow_phase.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <type_traits>

namespace winnow::python {
namespace {

/// Defines a property that makes arrays of contacts, locked against a concurrent fill.
template <typename Class, typename Make>
void define(Class& type, const char* name, Make make, const char* doc) {
  type.def_property_readonly(
      name,
      [make](const HeldContacts& held) -> py::object {
        const auto lock = held.hold();
        return make(*held.value());
      },
      doc);
}

/// A new array of a column.
template <typename Column>
[[nodiscard]] py::array all(const Column& values) {
  using T = std::remove_cvref_t<decltype(*values.begin())>;
  py::array_t<T> copy = fresh<T>(values.size());
  std::ranges::copy(values, copy.mutable_data());
  return copy;
}
[[nodiscard]] py::array key_column(std::span<const Key> keys) {
  py::array_t<std::uint64_t> copy = fresh<std::uint64_t>(keys.size());
  std::ranges::copy(keys, keys_in(copy));
  return copy;
}
/// Two 64-bit numbers of each contact that ended: member(contact, side).
template <typename Member>
[[nodiscard]] py::array ended_column(std::span<const EndedContact> ended, Member&& member) {
  py::array_t<std::uint64_t> rows = fresh<std::uint64_t>(ended.size(), 2);
  std::uint64_t* to = rows.mutable_data();
  for (const EndedContact& contact : ended) {
    for (int side = 0; side < 2; ++side) *to++ = member(contact, side);
  }
  return rows;
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
      type, "a", [](const Contacts& c) { return key_column(c.a()); },
      "Keys of the first bodies, (n,) uint64.");
  define(
      type, "b", [](const Contacts& c) { return key_column(c.b()); },
      "Keys of the second bodies, (n,) uint64.");
  define(
      type, "data_a", [](const Contacts& c) { return all(c.data_a()); },
      "Client data of the first bodies, (n,) uint64.");
  define(
      type, "data_b", [](const Contacts& c) { return all(c.data_b()); },
      "Client data of the second bodies, as data_a.");
  define(
      type, "event",
      [](const Contacts& c) {
        const auto* const events = reinterpret_cast<const std::uint8_t*>(c.event().data());
        return all(std::span(events, c.event().size()));
      },
      "0 for pairs that began, 1 for pairs that persist: (n,) uint8.");
  define(
      type, "ended",
      [](const Contacts& c) {
        return ended_column(c.ended(), [](const EndedContact& contact, int side) {
          return std::bit_cast<std::uint64_t>(side == 0 ? contact.a : contact.b);
        });
      },
      "Pairs of keys that were in contact in the last frame and are not now, (k, 2) uint64.");
  define(
      type, "ended_data",
      [](const Contacts& c) {
        return ended_column(c.ended(), [](const EndedContact& contact, int side) {
          return side == 0 ? contact.data_a : contact.data_b;
        });
      },
      "Client data of the pairs in `ended`, (k, 2) uint64.");
  define(
      type, "previous_pair", [](const Contacts& c) { return all(c.previous_pair()); },
      "With the scene's `warm_start`, else empty: index of each pair in the last frame, or "
      "NO_CONTACT for new pairs: (n,) uint32.");
  define(
      type, "runs", [](const Contacts& c) { return runs_of(c); },
      "Ranges of pairs with the same two kinds of shapes: (kind a, kind b, first, count) each.");
}

template <typename Class>
void add_manifolds(Class& type) {
  define(
      type, "manifold_first", [](const Contacts& c) { return all(c.manifold_first()); },
      "Manifolds of pair i are manifold_first[i] to manifold_first[i + 1]: (n + 1,) uint32.");
  define(
      type, "part_a", [](const Contacts& c) { return all(c.part_a()); },
      "Triangle or child of a in each manifold, WHOLE_SHAPE for convex shapes: (m,) uint32.");
  define(
      type, "part_b", [](const Contacts& c) { return all(c.part_b()); },
      "Triangle or child of b, as part_a.");
  define(
      type, "distance", [](const Contacts& c) { return all(c.distance()); },
      "Distance, negative if they overlap: (m,) float64.");
  define(
      type, "error_bound", [](const Contacts& c) { return all(c.error_bound()); },
      "The true distance is within distance +- this: (m,) float64.");
  define(
      type, "normal",
      [](const Contacts& c) { return vectors([&](int axis) { return c.normal(axis); }); },
      "Unit vector from a to b, in world axes: (m, 3) float64.");
  define(
      type, "point",
      [](const Contacts& c) { return vectors([&](int axis) { return c.point(axis); }); },
      "Level distance: the closest or deepest point of a, relative to its position: (m, 3) "
      "float64.");
}

template <typename Class>
void add_points(Class& type) {
  const auto span_of = [](const auto& c) { return std::span(c.data(), c.size()); };
  define(
      type, "point_first", [](const Contacts& c) { return all(c.point_first()); },
      "Level manifold: the points of manifold m are point_first[m] to point_first[m + 1].");
  define(
      type, "contact_position",
      [span_of](const Contacts& c) {
        return vectors([&](int axis) { return span_of(c.contact_columns().position[axis]); });
      },
      "Position halfway between the surfaces, relative to the position of a: (p, 3) float32.");
  define(
      type, "contact_depth",
      [span_of](const Contacts& c) { return all(span_of(c.contact_columns().depth)); },
      "Positive where they overlap: (p,) float32.");
  define(
      type, "previous_point", [](const Contacts& c) { return all(c.previous_point()); },
      "Index of each point in the last frame, as `previous_pair`: (p,) uint32.");
  define(
      type, "contact_feature",
      [span_of](const Contacts& c) { return all(span_of(c.contact_columns().feature)); },
      "The features of a and b that made the point, the same from frame to frame: (p,) uint64.");
}

}  // namespace

void add_contacts(py::module_& module) {
  module.attr("NO_CONTACT") = kNoContact;
  py::class_<HeldContacts, std::shared_ptr<HeldContacts>> type(
      module, "Contacts",
      "The results of `Scene.collide`: pairs of bodies, the manifolds of each pair, and the points "
      "of each manifold. Reused from frame to frame, because it remembers the last results. Each "
      "access returns a new array, which later calls do not change.");
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
      [](const Contacts& c) { return py::str(std::string(name_of(kLevels, c.level()))); },
      "The level of the last `collide`.");
  define(
      type, "cached_pairs", [](const Contacts& c) { return py::int_(c.cached_pairs()); },
      "Number of pairs that kept their manifolds.");
  add_pairs(type);
  add_manifolds(type);
  add_points(type);
}

}  // namespace winnow::python
