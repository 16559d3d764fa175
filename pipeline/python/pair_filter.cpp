// Pair filters of a scene (filters, layers, ignored pairs, predicate), offsets of bodies, and
// groups of contacts.

#include "pipeline/python/bodies.h"
#include "pipeline/python/contact_choices.h"

#include <winnow/pipeline/contact_groups.h>

namespace winnow::python {
namespace {

/// Calls set(i) for each body; if one call fails, calls undo(i, body) with the old definition of
/// each body before it.
template <typename Set, typename Undo>
void set_of_each(SharedScene& s, std::span<const Key> keys, const char* call, Set&& set,
                 Undo&& undo) {
  accept(changing_scene(s,
                        [&] {
                          std::vector<BodyDefinition> before;
                          const Status status = bodies_of(s.scene, keys, before);
                          if (status != Status::ok) return status;
                          return set_all(keys.size(), set,
                                         [&](std::size_t i) { return undo(i, before[i]); });
                        }),
         call);
}

void set_filter(SharedScene& s, py::handle key_array, py::handle layers, py::handle mask,
                py::handle environment) {
  const KeyInput keys(key_array);
  const FilterInput filter(layers, mask, environment);
  filter.expect(keys.count());
  const std::span<const Key> list = keys.keys();
  set_of_each(
      s, list, "set_filter", [&](std::size_t i) { return s.scene.set_filter(list[i], filter[i]); },
      [&](std::size_t i, const BodyDefinition& was) {
        return s.scene.set_filter(list[i], was.filter);
      });
}

void set_offsets(SharedScene& s, py::handle key_array, py::handle contact, py::handle rest) {
  const KeyInput keys(key_array);
  OffsetInput offsets(contact, rest);
  offsets.expect(keys.count());
  const std::span<const Key> list = keys.keys();
  set_of_each(
      s, list, "set_offsets",
      [&](std::size_t i) { return s.scene.set_offsets(list[i], offsets[i]); },
      [&](std::size_t i, const BodyDefinition& was) {
        return s.scene.set_offsets(list[i], was.offsets);
      });
}

void set_layer(SharedScene& s, py::handle key_array, py::handle layer_array) {
  const KeyInput keys(key_array);
  const LayerInput layer(layer_array, "layer");
  layer.expect(keys.count());
  const std::span<const Key> list = keys.keys();
  set_of_each(
      s, list, "set_layer", [&](std::size_t i) { return s.scene.set_layer(list[i], layer[i]); },
      [&](std::size_t i, const BodyDefinition& was) {
        return s.scene.set_layer(list[i], was.layer);
      });
}

/// Pairs of layers.
struct LayerPairs {
  explicit LayerPairs(py::handle pairs) : numbers(pairs, "layers", 2) {
    for (const std::uint32_t layer : numbers.values()) {
      if (layer >= kSceneLayers) {
        throw Refusal(Status::invalid_argument, "layers: a number is out of range");
      }
    }
  }
  [[nodiscard]] std::uint16_t layer(std::size_t i, std::size_t k) const noexcept {
    return static_cast<std::uint16_t>(numbers[2 * i + k]);
  }
  Integers<std::uint32_t> numbers;
};

void set_layers_collide(SharedScene& s, py::handle pairs, bool collide) {
  const LayerPairs layers(pairs);
  std::vector<std::uint8_t> before(layers.numbers.count());
  accept(changing_scene(s,
                        [&] {
                          return set_all(
                              before.size(),
                              [&](std::size_t i) {
                                const std::uint16_t a = layers.layer(i, 0);
                                const std::uint16_t b = layers.layer(i, 1);
                                before[i] = s.scene.layers_collide(a, b) ? 1 : 0;
                                return s.scene.set_layers_collide(a, b, collide);
                              },
                              [&](std::size_t i) {
                                return s.scene.set_layers_collide(
                                    layers.layer(i, 0), layers.layer(i, 1), before[i] != 0);
                              });
                        }),
         "set_layers_collide");
}

[[nodiscard]] py::array layers_collide(const SharedScene& s, py::handle pairs) {
  const LayerPairs layers(pairs);
  auto result = fresh<bool>(layers.numbers.count());
  bool* const to = result.mutable_data();
  reading(s.mutex, [&] {
    for (std::size_t i = 0; i < layers.numbers.count(); ++i) {
      to[i] = s.scene.layers_collide(layers.layer(i, 0), layers.layer(i, 1));
    }
  });
  return result;
}

/// Pairs of keys, read in place.
class KeyPairInput {
 public:
  explicit KeyPairInput(py::handle object) : words_(object, "pairs", 2) {}
  [[nodiscard]] std::span<const KeyPair> pairs() const noexcept {
    static_assert(sizeof(KeyPair) == 2 * sizeof(std::uint64_t));
    return {reinterpret_cast<const KeyPair*>(words_.values().data()), words_.count()};
  }

 private:
  Integers<std::uint64_t> words_;
};

void set_ignored(SharedScene& s, py::handle pair_array, bool ignored) {
  const KeyPairInput pairs(pair_array);
  accept(changing_scene(s, [&] { return s.scene.set_ignored(pairs.pairs(), ignored); }),
         "set_ignored");
}

[[nodiscard]] py::array is_ignored(const SharedScene& s, py::handle pair_array) {
  const KeyPairInput input(pair_array);
  const std::span<const KeyPair> pairs = input.pairs();
  auto result = fresh<bool>(pairs.size());
  bool* const to = result.mutable_data();
  reading(s.mutex, [&] {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      to[i] = s.scene.is_ignored(pairs[i].first, pairs[i].second);
    }
  });
  return result;
}

// --- groups of contacts ------------------------------------------------------------------------

struct GroupTable : EmptyIfZero {
  py::array group;
  py::array first;
  py::array order;
};

template <typename Make>
[[nodiscard]] GroupTable groups_of(const SharedScene& s, const HeldContacts& contacts,
                                   const char* call, Make&& make) {
  const std::unique_lock<std::mutex> held = contacts.hold();
  ContactGroups groups;
  accept(reading(s.mutex, [&] { return make(*contacts.value(), groups); }), call);
  std::vector<std::uint32_t> first{0};
  std::vector<std::uint32_t> order;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const std::span<const std::uint32_t> pairs = groups.pairs(i);
    order.insert(order.end(), pairs.begin(), pairs.end());
    first.push_back(static_cast<std::uint32_t>(order.size()));
  }
  return {{},
          given(std::vector(groups.group().begin(), groups.group().end())),
          given(std::move(first)),
          given(std::move(order))};
}

[[nodiscard]] GroupTable islands(const SharedScene& s, const HeldContacts& contacts) {
  return groups_of(s, contacts, "islands", [&](const Contacts& from, ContactGroups& out) {
    return s.scene.islands(from, out);
  });
}

[[nodiscard]] GroupTable colours(const SharedScene& s, const HeldContacts& contacts) {
  return groups_of(s, contacts, "colours", [&](const Contacts& from, ContactGroups& out) {
    return s.scene.colours(from, out);
  });
}

void add_groups(py::module_& module, SceneClass& scene) {
  using py::arg;
  module.attr("REST_COLOUR") = kRestColour;
  py::class_<GroupTable>(module, "ContactGroups", "Groups of contact pairs, none of them empty.")
      .def_readonly("group", &GroupTable::group, "Group of each pair of the contacts: (n,) uint32.")
      .def_readonly(
          "first", &GroupTable::first,
          "The pairs of group g are order[first[g]] to order[first[g + 1]]: (g + 1,) uint32.")
      .def_readonly("order", &GroupTable::order,
                    "Pairs sorted by group, ascending in each: (n,) uint32.");
  scene
      .def("islands", &islands, arg("contacts"),
           "Islands of the pairs in contacts that this scene filled last: pairs connected by "
           "bodies that are not fixed. invalid_key for other contacts.")
      .def("colours", &colours, arg("contacts"),
           "Groups in which no two pairs share a body that is not fixed, so that they can be "
           "solved in parallel; except group REST_COLOUR, the pairs that got no colour.");
}

}  // namespace

void add_pair_filter(py::module_& module, SceneClass& scene) {
  using py::arg;
  constexpr std::uint32_t every = ~0U;
  scene
      .def("set_filter", &set_filter, arg("keys"), arg("layers") = 1, arg("mask") = every,
           arg("environment") = 0, "As Partition.set_filter.")
      .def("set_offsets", &set_offsets, arg("keys"), arg("contact"), arg("rest") = 0.0,
           "Sets contact and rest offsets. Two bodies are in contact from a gap of the sum of "
           "their `contact` on, in addition to the scene's contact margin, and rest at a distance "
           "of the "
           "sum of their `rest`: (n,) lengths, or one for all, contact >= 0 and >= rest.")
      .def("set_layer", &set_layer, arg("keys"), arg("layer"),
           "Puts bodies into layers, (n,) below 4096 or one for all: see `set_layers_collide`. "
           "These "
           "are independent of the 32 layers of a filter.")
      .def("set_layers_collide", &set_layers_collide, arg("layers"), arg("collide") = true,
           "Sets whether bodies of two layers, pairs (n, 2), collide. By default all do.")
      .def("layers_collide", &layers_collide, arg("layers"),
           "True for pairs of layers (n, 2) that collide.")
      .def("set_ignored", &set_ignored, arg("pairs"), arg("ignored") = true,
           "Makes pairs of bodies, keys (n, 2), never collide, whatever their filters are; or "
           "collide again. All or none.")
      .def("is_ignored", &is_ignored, arg("pairs"),
           "True for pairs of keys (n, 2) that are ignored: (n,) bool.");
  add_groups(module, scene);
}

}  // namespace winnow::python
