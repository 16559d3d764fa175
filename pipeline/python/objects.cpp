// Objects of a partition: insert, update, remove, and their properties.

#include "pipeline/python/locks.h"
#include "pipeline/python/partition.h"
#include "pipeline/python/volumes.h"

#include <winnow/core/volumes.h>

#include <limits>
#include <type_traits>

namespace winnow::python {
namespace {

// --- insert, update, remove ----------------------------------------------------------------------

/// Inserts `count` volumes by `insert(data, keys)` and returns their keys.
template <typename Insert>
[[nodiscard]] py::array inserted(SharedPartition& p, std::size_t count, py::handle data,
                                 const char* call, Insert&& insert) {
  const std::vector<ClientData> values = data_of(data, count);
  auto keys = fresh<std::uint64_t>(count);
  const std::span<Key> out(keys_in(keys), count);
  accept(changing(p.mutex, [&] { return insert(values, out); }), call);
  p.count_changes(count);
  return keys;
}

/// Changes `count` objects by `change()`.
template <typename Change>
void change_objects(SharedPartition& p, std::size_t count, const char* call, Change&& change) {
  accept(changing(p.mutex, change), call);
  p.count_changes(count);
}

[[nodiscard]] py::array insert_boxes(SharedPartition& p, py::handle lower, py::handle upper,
                                     py::handle data) {
  const BoxInput boxes(lower, upper);
  return inserted(p, boxes.count(), data, "insert", [&](const auto& values, std::span<Key> keys) {
    return p.partition.insert(boxes.view(p.room), values, keys);
  });
}

/// Returns the indices of the selected entries: `entries` itself, or the indices of true in a bool
/// mask.
[[nodiscard]] py::object entry_numbers(py::handle entries) {
  const py::array array = py::array::ensure(entries);
  if (array && array.dtype().kind() == 'b') return array.attr("nonzero")().attr("__getitem__")(0);
  return py::reinterpret_borrow<py::object>(entries);
}

void update_boxes(SharedPartition& p, py::handle key_array, py::handle lower, py::handle upper,
                  py::handle entries) {
  const KeyInput keys(key_array);
  const BoxInput boxes(lower, upper);
  if (entries.is_none()) {
    return change_objects(p, keys.count(), "update",
                          [&] { return p.partition.update(keys.keys(), boxes.view(p.room)); });
  }
  const Integers<std::uint32_t> numbers(entry_numbers(entries), "entries");
  change_objects(p, numbers.count(), "update", [&] {
    return p.partition.update(keys.keys(), boxes.view(p.room),
                              IndexSubset::listed(numbers.values()));
  });
}

/// Returns spheres in float that contain the given ones.
[[nodiscard]] std::vector<Sphere> spheres_of(py::handle centers, py::handle radii) {
  const Numbers center(centers, "centers", {3});
  Numbers radius(radii, "radii", {}, true);
  radius.expect(center.count());
  std::vector<Sphere> spheres(center.count());
  for (std::size_t i = 0; i < spheres.size(); ++i) spheres[i] = sphere_at(center, radius, i);
  return spheres;
}

[[nodiscard]] py::array insert_spheres(SharedPartition& p, py::handle centers, py::handle radii,
                                       py::handle data) {
  const std::vector<Sphere> spheres = spheres_of(centers, radii);
  return inserted(p, spheres.size(), data, "insert_spheres",
                  [&](const auto& values, std::span<Key> keys) {
                    return p.partition.insert(spheres, values, keys);
                  });
}

void update_spheres(SharedPartition& p, py::handle key_array, py::handle centers,
                    py::handle radii) {
  const KeyInput keys(key_array);
  const std::vector<Sphere> spheres = spheres_of(centers, radii);
  change_objects(p, keys.count(), "update_spheres",
                 [&] { return p.partition.update(keys.keys(), spheres); });
}

template <int K>
[[nodiscard]] std::vector<Kdop<K>> kdops_of(py::handle lower, py::handle upper) {
  constexpr std::size_t kSlabs = Kdop<K>::kSlabs;
  const Numbers low(lower, "lower", {kSlabs});
  Numbers high(upper, "upper", {kSlabs});
  high.expect(low.count());
  std::vector<Kdop<K>> kdops(low.count());
  for (std::size_t i = 0; i < kdops.size(); ++i) {
    for (std::size_t s = 0; s < kSlabs; ++s) {
      kdops[i].min[s] = round_down(low.at(i, s));
      kdops[i].max[s] = round_up(high.at(i, s));
    }
  }
  return kdops;
}

/// Calls `body` with k-DOPs of the partition's type.
template <typename Body>
auto with_kdops(const SharedPartition& p, py::handle lower, py::handle upper, Body&& body) {
  switch (p.partition.volume()) {
    case Volume::kdop14:
      return body(kdops_of<14>(lower, upper));
    case Volume::kdop18:
      return body(kdops_of<18>(lower, upper));
    case Volume::kdop26:
      return body(kdops_of<26>(lower, upper));
    default:
      throw Refusal(Status::unsupported_volume, "the partition is none of k-DOPs");
  }
}

[[nodiscard]] py::array insert_kdops(SharedPartition& p, py::handle lower, py::handle upper,
                                     py::handle data) {
  return with_kdops(p, lower, upper, [&](const auto& kdops) -> py::array {
    using Kind = typename std::decay_t<decltype(kdops)>::value_type;
    return inserted(p, kdops.size(), data, "insert_kdops",
                    [&](const auto& values, std::span<Key> keys) {
                      return p.partition.insert(std::span<const Kind>(kdops), values, keys);
                    });
  });
}

void update_kdops(SharedPartition& p, py::handle key_array, py::handle lower, py::handle upper) {
  const KeyInput keys(key_array);
  with_kdops(p, lower, upper, [&](const auto& kdops) {
    using Kind = typename std::decay_t<decltype(kdops)>::value_type;
    change_objects(p, keys.count(), "update_kdops",
                   [&] { return p.partition.update(keys.keys(), std::span<const Kind>(kdops)); });
  });
}

[[nodiscard]] py::array kdop_slabs(int faces) {
  const auto listed = [](const auto& directions) -> py::array {
    auto result = fresh<float>(directions.size(), 3);
    for (std::size_t s = 0; s < directions.size(); ++s) {
      for (std::size_t k = 0; k < 3; ++k) {
        result.mutable_at(s, k) = static_cast<float>(directions[s][k]);
      }
    }
    return result;
  };
  if (faces == 14) return listed(kdop_directions<14>());
  if (faces == 18) return listed(kdop_directions<18>());
  if (faces == 26) return listed(kdop_directions<26>());
  throw Refusal(Status::invalid_argument, "a k-DOP has 14, 18 or 26 faces");
}

void remove_objects(SharedPartition& p, py::handle key_array) {
  const KeyInput keys(key_array);
  change_objects(p, keys.count(), "remove", [&] { return p.partition.remove(keys.keys()); });
}

// --- properties of objects ---------------------------------------------------------------------

/// Calls `query(i)` for each of `count` objects until one call fails.
template <typename Query>
void query_each(const SharedPartition& p, std::size_t count, const char* call, Query&& query) {
  accept(reading(p.mutex,
                 [&] {
                   Status status = Status::ok;
                   for (std::size_t i = 0; i < count && status == Status::ok; ++i)
                     status = query(i);
                   return status;
                 }),
         call);
}

[[nodiscard]] py::array contains(const SharedPartition& p, py::handle key_array) {
  const KeyInput keys(key_array);
  auto result = fresh<bool>(keys.count());
  bool* const to = result.mutable_data();
  reading(p.mutex, [&] {
    for (std::size_t i = 0; i < keys.count(); ++i) to[i] = p.partition.contains(keys.keys()[i]);
  });
  return result;
}

[[nodiscard]] py::tuple bounds(const SharedPartition& p, py::handle key_array) {
  const KeyInput keys(key_array);
  auto lower = fresh<float>(keys.count(), 3);
  auto upper = fresh<float>(keys.count(), 3);
  float* const low = lower.mutable_data();
  float* const high = upper.mutable_data();
  std::vector<Aabb> boxes(keys.count());
  accept(reading(p.mutex, [&] { return p.partition.bounds(keys.keys(), boxes); }), "bounds");
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[3 * i + axis] = boxes[i].min[axis];
      high[3 * i + axis] = boxes[i].max[axis];
    }
  }
  return py::make_tuple(lower, upper);
}

[[nodiscard]] py::array client_data(const SharedPartition& p, py::handle key_array) {
  const KeyInput keys(key_array);
  auto result = fresh<std::uint64_t>(keys.count());
  std::uint64_t* const to = result.mutable_data();
  query_each(p, keys.count(), "client_data", [&](std::size_t i) {
    to[i] = p.partition.client_data(keys.keys()[i]);
    return p.partition.contains(keys.keys()[i]) ? Status::ok : Status::invalid_key;
  });
  return result;
}

[[nodiscard]] py::array keys_of(const SharedPartition& p, py::handle id_array) {
  const Integers<std::uint32_t> ids(id_array, "ids");
  auto result = fresh<std::uint64_t>(ids.count());
  Key* const to = keys_in(result);
  reading(p.mutex, [&] {
    for (std::size_t i = 0; i < ids.count(); ++i) to[i] = p.partition.key_of(ids[i]);
  });
  return result;
}

[[nodiscard]] py::array client_data_of(const SharedPartition& p, py::handle id_array) {
  const Integers<std::uint32_t> ids(id_array, "ids");
  auto result = fresh<std::uint64_t>(ids.count());
  std::uint64_t* const to = result.mutable_data();
  reading(p.mutex, [&] {
    for (std::size_t i = 0; i < ids.count(); ++i) to[i] = p.partition.client_data_of(ids[i]);
  });
  return result;
}

void set_filter(SharedPartition& p, py::handle key_array, py::handle layers, py::handle mask,
                py::handle environment) {
  constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
  const KeyInput keys(key_array);
  const EachInteger layer(layers, "layers", most);
  const EachInteger mask_bits(mask, "mask", most);
  const EachInteger world(environment, "environment", most);
  for (const EachInteger* each : {&layer, &mask_bits, &world}) each->expect(keys.count());
  std::vector<ObjectFilter> filters(keys.count());
  for (std::size_t i = 0; i < filters.size(); ++i) {
    filters[i] = {static_cast<std::uint32_t>(layer[i]), static_cast<std::uint32_t>(mask_bits[i]),
                  static_cast<std::uint32_t>(world[i])};
  }
  accept(changing(p.mutex, [&] { return p.partition.set_filter(keys.keys(), filters); }),
         "set_filter");
}

[[nodiscard]] py::tuple filters_of(const SharedPartition& p, py::handle key_array) {
  const KeyInput keys(key_array);
  std::vector<ObjectFilter> filters(keys.count());
  query_each(p, keys.count(), "filters",
             [&](std::size_t i) { return p.partition.filter(keys.keys()[i]).get(filters[i]); });
  std::vector<std::uint32_t> columns[3];
  for (const ObjectFilter& filter : filters) {
    columns[0].push_back(filter.layers);
    columns[1].push_back(filter.mask);
    columns[2].push_back(filter.environment);
  }
  return py::make_tuple(given(std::move(columns[0])), given(std::move(columns[1])),
                        given(std::move(columns[2])));
}

void add_changes(PartitionClass& partition) {
  using py::arg;
  partition
      .def("insert", &insert_boxes, arg("lower"), arg("upper"), arg("data") = py::none(),
           "Adds n boxes and returns their keys, (n,) uint64. `lower`, `upper`: (n, 3), in units "
           "of the scene; lower <= upper, may be infinite. Floats of any strides are read in place "
           "if both arrays have the same stride from box to box; all others are rounded outward to "
           "float. `data`: (n,) uint64, returned by queries.")
      .def("update", &update_boxes, arg("keys"), arg("lower"), arg("upper"),
           arg("entries") = py::none(),
           "Sets new boxes, (n, 3) each, of the n objects of `keys` (n,). With `entries`, indices "
           "(m,) or a mask (n,) of bool, only of these entries.")
      .def("insert_spheres", &insert_spheres, arg("centers"), arg("radii"),
           arg("data") = py::none(),
           "Adds n spheres, if the volume is 'sphere', and returns their keys, (n,) uint64. "
           "`centers`: (n, 3), `radii`: (n,) or one for all, finite and >= 0.")
      .def("update_spheres", &update_spheres, arg("keys"), arg("centers"), arg("radii"),
           "Sets new spheres of the n objects of `keys` (n,): `centers` (n, 3), `radii` (n,) or "
           "one for all.")
      .def("insert_kdops", &insert_kdops, arg("lower"), arg("upper"), arg("data") = py::none(),
           "Adds n k-DOPs, if the volume is one: lower and upper ends (n, k/2) of the slabs along "
           "`kdop_directions(k)`. Returns their keys, (n,) uint64.")
      .def("update_kdops", &update_kdops, arg("keys"), arg("lower"), arg("upper"),
           "Sets new k-DOPs of the n objects of `keys` (n,), lower and upper ends (n, k/2).")
      .def("remove", &remove_objects, arg("keys"),
           "Removes the objects of `keys` (n,), all or none. Fails for a key that is stale, of "
           "another partition or given twice.");
}

void add_knowledge(PartitionClass& partition) {
  using py::arg;
  partition
      .def("__len__",
           [](const SharedPartition& p) {
             return reading(p.mutex, [&] { return p.partition.size(); });
           })
      .def("contains", &contains, arg("keys"), "True for `keys` (n,) of live objects: (n,) bool.")
      .def("bounds", &bounds, arg("keys"),
           "Boxes (lower, upper) of the objects of `keys` (n,), (n, 3) float32 each, as they are "
           "tested: grown by the fat margin, and around other volumes.")
      .def("client_data", &client_data, arg("keys"),
           "Client data of the objects of `keys` (n,): (n,) uint64.")
      .def("keys_of", &keys_of, arg("ids"),
           "Keys (n,) uint64 of objects by id (n,); NULL_KEY for objects that do not exist.")
      .def("client_data_of", &client_data_of, arg("ids"),
           "Client data (n,) uint64 of objects by id (n,); 0 for objects that do not exist.")
      .def("set_filter", &set_filter, arg("keys"), arg("layers") = 1,
           arg("mask") = ~std::uint32_t{0}, arg("environment") = 0,
           "Sets filters of the objects of `keys` (n,): `layers` that they are in and `mask` of "
           "layers that they may be paired with, a bit each, and `environment`, which must be "
           "equal or EVERY_ENVIRONMENT. (n,) uint32 each, or one for all.")
      .def("filters", &filters_of, arg("keys"),
           "(layers, mask, environment) of the objects of `keys` (n,), (n,) uint32 each.");
}

}  // namespace

void add_objects(py::module_& module, PartitionClass& partition) {
  using py::arg;
  add_changes(partition);
  add_knowledge(partition);
  module.def("kdop_directions", &kdop_slabs, arg("faces"),
             "Directions of the slabs of a k-DOP of 14, 18 or 26 faces, not normalised: (k/2, 3) "
             "float32.");
  module.def(
      "boxes_address",
      [](py::handle lower, py::handle upper) {
        const BoxInput boxes(lower, upper);
        std::vector<Aabb> room;
        const BoxView view = boxes.view(room);
        return reinterpret_cast<std::uintptr_t>(view.min[0]);
      },
      arg("lower"), arg("upper"),
      "Address from which a call reads the lower corner of the first box: in `lower` itself, "
      "unless the boxes must be copied.");
}

}  // namespace winnow::python
