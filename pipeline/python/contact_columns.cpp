// The class Contacts: contacts of a scene as columns.

#include "pipeline/python/arrays.h"
#include "pipeline/python/contact_choices.h"
#include "pipeline/python/shared_scene.h"

#include <winnow/pipeline/narrow_phase.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <functional>
#include <span>
#include <type_traits>

namespace winnow::python {
namespace {

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

/// A property that makes arrays of contacts, locked against a concurrent fill.
template <typename Make>
[[nodiscard]] auto locked(Make make) {
  return [make](const HeldContacts& held) {
    const auto lock = held.hold();
    return make(*held.value());
  };
}
/// A property that copies the column which a function of contacts returns.
template <typename Column>
[[nodiscard]] auto copied(Column column) {
  return locked([column](const Contacts& c) { return all(std::invoke(column, c)); });
}

[[nodiscard]] py::list runs_of(const Contacts& contacts) {
  py::list result;
  for (const ContactRun& run : contacts.runs()) {
    result.append(py::make_tuple(run.kind_a, run.kind_b, run.first, run.count));
  }
  return result;
}

template <typename Columns>
[[nodiscard]] auto span_of(const Columns& columns) {
  return std::span(columns.data(), columns.size());
}

}  // namespace

void add_contacts(py::module_& module) {
  module.attr("NO_CONTACT") = kNoContact;
  Class<HeldContacts>(module, "Contacts")
      .def(py::init([] { return std::make_shared<HeldContacts>(); }))
      .def("__len__", locked([](const Contacts& c) { return c.size(); }))
      .def("clear",
           [](const HeldContacts& held) {
             const auto lock = held.hold();
             held.to_fill("contacts").clear();
           })
      .property("level", locked([](const Contacts& c) { return name_of(kLevels, c.level()); }))
      .property("cached_pairs", locked([](const Contacts& c) { return c.cached_pairs(); }))
      .property("a", locked([](const Contacts& c) { return key_column(c.a()); }))
      .property("b", locked([](const Contacts& c) { return key_column(c.b()); }))
      .property("data_a", copied([](const Contacts& c) { return c.data_a(); }))
      .property("data_b", copied([](const Contacts& c) { return c.data_b(); }))
      .property("event", copied([](const Contacts& c) {
                  const auto* const events =
                      reinterpret_cast<const std::uint8_t*>(c.event().data());
                  return std::span(events, c.event().size());
                }))
      .property("ended", locked([](const Contacts& c) {
                  return ended_column(c.ended(), [](const EndedContact& contact, int side) {
                    return std::bit_cast<std::uint64_t>(side == 0 ? contact.a : contact.b);
                  });
                }))
      .property("ended_data", locked([](const Contacts& c) {
                  return ended_column(c.ended(), [](const EndedContact& contact, int side) {
                    return side == 0 ? contact.data_a : contact.data_b;
                  });
                }))
      .property("previous_pair", copied([](const Contacts& c) { return c.previous_pair(); }))
      .property("runs", locked([](const Contacts& c) { return runs_of(c); }))
      .property("manifold_first", copied([](const Contacts& c) { return c.manifold_first(); }))
      .property("part_a", copied([](const Contacts& c) { return c.part_a(); }))
      .property("part_b", copied([](const Contacts& c) { return c.part_b(); }))
      .property("distance", copied([](const Contacts& c) { return c.distance(); }))
      .property("error_bound", copied([](const Contacts& c) { return c.error_bound(); }))
      .property("normal", locked([](const Contacts& c) {
                  return vectors([&](int axis) { return c.normal(axis); });
                }))
      .property("point", locked([](const Contacts& c) {
                  return vectors([&](int axis) { return c.point(axis); });
                }))
      .property("point_first", copied([](const Contacts& c) { return c.point_first(); }))
      .property(
          "contact_position", locked([](const Contacts& c) {
            return vectors([&](int axis) { return span_of(c.contact_columns().position[axis]); });
          }))
      .property("contact_depth",
                copied([](const Contacts& c) { return span_of(c.contact_columns().depth); }))
      .property("previous_point", copied([](const Contacts& c) { return c.previous_point(); }))
      .property("contact_feature",
                copied([](const Contacts& c) { return span_of(c.contact_columns().feature); }));
}

}  // namespace winnow::python
