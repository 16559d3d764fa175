// Pair filters of a scene (filters, layers, ignored pairs, predicate), offsets of bodies, and
// groups of contacts.

#include "pipeline/python/batch.h"
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
  const KeyInput keys(s, key_array);
  FilterInput filter(layers, mask, environment);
  filter.expect(keys.count());
  const std::span<const Key> list = keys.keys();
  set_of_each(
      s, list, "set_filter", [&](std::size_t i) { return s.scene.set_filter(list[i], filter[i]); },
      [&](std::size_t i, const BodyDefinition& was) {
        return s.scene.set_filter(list[i], was.filter);
      });
}

void set_offsets(SharedScene& s, py::handle key_array, py::handle contact, py::handle rest) {
  const KeyInput keys(s, key_array);
  Numbers gap(contact, "contact", {}, Valid::length);
  Numbers distance(rest, "rest", {}, Valid::finite);
  expect_all(keys.count(), {&gap, &distance});
  const std::span<const Key> list = keys.keys();
  set_of_each(
      s, list, "set_offsets",
      [&](std::size_t i) {
        return s.scene.set_offsets(list[i], {gap.at(i), distance.at(i)});
      },
      [&](std::size_t i, const BodyDefinition& was) {
        return s.scene.set_offsets(list[i], was.offsets);
      });
}

void set_layer(SharedScene& s, py::handle key_array, py::handle layer_array) {
  const KeyInput keys(s, key_array);
  EachInteger layer(layer_array, "layer", kSceneLayers - 1);
  layer.expect(keys.count());
  const std::span<const Key> list = keys.keys();
  set_of_each(
      s, list, "set_layer",
      [&](std::size_t i) {
        return s.scene.set_layer(list[i], static_cast<std::uint16_t>(layer[i]));
      },
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
  change_scene_or_throw(s, "set_layers_collide", [&] {
    return set_all(
        before.size(),
        [&](std::size_t i) {
          const std::uint16_t a = layers.layer(i, 0);
          const std::uint16_t b = layers.layer(i, 1);
          before[i] = s.scene.layers_collide(a, b) ? 1 : 0;
          return s.scene.set_layers_collide(a, b, collide);
        },
        [&](std::size_t i) {
          return s.scene.set_layers_collide(layers.layer(i, 0), layers.layer(i, 1), before[i] != 0);
        });
  });
}

[[nodiscard]] py::array layers_collide(const SharedScene& s, py::handle pairs) {
  const LayerPairs layers(pairs);
  return each_answer<bool>(s.mutex, layers.numbers.count(), [&](std::size_t i) {
    return s.scene.layers_collide(layers.layer(i, 0), layers.layer(i, 1));
  });
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
  change_scene_or_throw(s, "set_ignored",
                        [&] { return s.scene.set_ignored(pairs.pairs(), ignored); });
}

[[nodiscard]] py::array is_ignored(const SharedScene& s, py::handle pair_array) {
  const KeyPairInput input(pair_array);
  const std::span<const KeyPair> pairs = input.pairs();
  return each_answer<bool>(s.mutex, pairs.size(), [&](std::size_t i) {
    return s.scene.is_ignored(pairs[i].first, pairs[i].second);
  });
}

// --- groups of contacts ------------------------------------------------------------------------

template <typename Make>
[[nodiscard]] py::object groups_of(const SharedScene& s, const HeldContacts& contacts,
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
  return table("ContactGroups", given(std::vector(groups.group().begin(), groups.group().end())),
               given(std::move(first)), given(std::move(order)));
}

[[nodiscard]] py::object islands(const SharedScene& s, const HeldContacts& contacts) {
  return groups_of(s, contacts, "islands", [&](const Contacts& from, ContactGroups& out) {
    return s.scene.islands(from, out);
  });
}

[[nodiscard]] py::object colours(const SharedScene& s, const HeldContacts& contacts) {
  return groups_of(s, contacts, "colours", [&](const Contacts& from, ContactGroups& out) {
    return s.scene.colours(from, out);
  });
}

}  // namespace

void add_pair_filter(py::module_& module, SceneClass& scene) {
  module.attr("REST_COLOUR") = kRestColour;
  scene.def("set_filter", &set_filter)
      .def("set_offsets", &set_offsets)
      .def("set_layer", &set_layer)
      .def("set_layers_collide", &set_layers_collide)
      .def("layers_collide", &layers_collide)
      .def("set_ignored", &set_ignored)
      .def("is_ignored", &is_ignored)
      .def("islands", &islands)
      .def("colours", &colours);
}

}  // namespace winnow::python
