// Objects of a partition: insert, update, remove, and their properties.

#include "pipeline/python/batch.h"
#include "pipeline/python/locks.h"
#include "pipeline/python/partition.h"
#include "pipeline/python/volumes.h"

#include <winnow/core/volumes.h>

#include <optional>
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
  BoxInput boxes(lower, upper);
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
  const KeyInput keys(p, key_array);
  BoxInput boxes(lower, upper);
  boxes.expect(keys.count());
  if (entries.is_none()) {
    return change_objects(p, keys.count(), "update",
                          [&] { return p.partition.update(keys.keys(), boxes.view(p.room)); });
  }
  Integers<std::uint32_t> numbers(entry_numbers(entries), "entries");
  numbers.limit(keys.count());
  change_objects(p, numbers.count(), "update", [&] {
    return p.partition.update(keys.keys(), boxes.view(p.room),
                              IndexSubset::listed(numbers.values()));
  });
}

[[nodiscard]] py::array insert_spheres(SharedPartition& p, py::handle centers, py::handle radii,
                                       py::handle data) {
  const SphereInput spheres(centers, radii);
  return inserted(p, spheres.count(), data, "insert_spheres",
                  [&](const auto& values, std::span<Key> keys) {
                    return p.partition.insert(spheres.list(), values, keys);
                  });
}

void update_spheres(SharedPartition& p, py::handle key_array, py::handle centers,
                    py::handle radii) {
  const KeyInput keys(p, key_array);
  SphereInput spheres(centers, radii);
  spheres.expect(keys.count());
  change_objects(p, keys.count(), "update_spheres",
                 [&] { return p.partition.update(keys.keys(), spheres.list()); });
}

/// The ends of the slabs of k-DOPs as `lower` and `upper`.
template <int K>
class KdopInput {
 public:
  KdopInput(py::handle lower, py::handle upper)
      : lower_(lower, "lower", {Kdop<K>::kSlabs}), upper_(upper, "upper", {Kdop<K>::kSlabs}) {}
  /// Returns `count` k-DOPs; by default as many as there are.
  [[nodiscard]] std::vector<Kdop<K>> list(std::optional<std::size_t> count = {}) {
    std::vector<Kdop<K>> kdops(agree({&lower_, &upper_}));
    if (count) {
      expect_all(*count, {&lower_, &upper_});
      kdops.resize(*count);
    }
    for (std::size_t i = 0; i < kdops.size(); ++i) {
      for (std::size_t s = 0; s < Kdop<K>::kSlabs; ++s) {
        kdops[i].min[s] = round_down(lower_.at(i, s));
        kdops[i].max[s] = round_up(upper_.at(i, s));
      }
    }
    return kdops;
  }

 private:
  Numbers lower_;
  Numbers upper_;
};

/// Calls `body` with k-DOPs of the partition's type.
template <typename Body>
auto with_kdops(const SharedPartition& p, py::handle lower, py::handle upper, Body&& body) {
  switch (p.partition.volume()) {
    case Volume::kdop14:
      return body(KdopInput<14>(lower, upper));
    case Volume::kdop18:
      return body(KdopInput<18>(lower, upper));
    case Volume::kdop26:
      return body(KdopInput<26>(lower, upper));
    default:
      throw Refusal(Status::unsupported_volume, "the partition is none of k-DOPs");
  }
}

[[nodiscard]] py::array insert_kdops(SharedPartition& p, py::handle lower, py::handle upper,
                                     py::handle data) {
  return with_kdops(p, lower, upper, [&](auto&& input) -> py::array {
    const auto kdops = input.list();
    return inserted(p, kdops.size(), data, "insert_kdops",
                    [&](const auto& values, std::span<Key> keys) {
                      return p.partition.insert(std::span(kdops), values, keys);
                    });
  });
}

void update_kdops(SharedPartition& p, py::handle key_array, py::handle lower, py::handle upper) {
  const KeyInput keys(p, key_array);
  with_kdops(p, lower, upper, [&](auto&& input) {
    const auto kdops = input.list(keys.count());
    change_objects(p, keys.count(), "update_kdops",
                   [&] { return p.partition.update(keys.keys(), std::span(kdops)); });
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
  const KeyInput keys(p, key_array);
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

[[nodiscard]] py::tuple bounds(const SharedPartition& p, py::handle key_array) {
  const KeyInput keys(p, key_array);
  auto lower = fresh<float>(keys.count(), 3);
  auto upper = fresh<float>(keys.count(), 3);
  float* const low = lower.mutable_data();
  float* const high = upper.mutable_data();
  std::vector<Aabb> boxes(keys.count());
  read_or_throw(p.mutex, "bounds", [&] { return p.partition.bounds(keys.keys(), boxes); });
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[3 * i + axis] = boxes[i].min[axis];
      high[3 * i + axis] = boxes[i].max[axis];
    }
  }
  return py::make_tuple(lower, upper);
}

[[nodiscard]] py::array client_data(const SharedPartition& p, py::handle key_array) {
  const KeyInput keys(p, key_array);
  auto result = fresh<std::uint64_t>(keys.count());
  std::uint64_t* const to = result.mutable_data();
  query_each(p, keys.count(), "client_data", [&](std::size_t i) {
    to[i] = p.partition.client_data(keys.keys()[i]);
    return p.partition.contains(keys.keys()[i]) ? Status::ok : Status::invalid_key;
  });
  return result;
}

void set_filter(SharedPartition& p, py::handle key_array, py::handle layers, py::handle mask,
                py::handle environment) {
  const KeyInput keys(p, key_array);
  FilterInput filter(layers, mask, environment);
  filter.expect(keys.count());
  std::vector<ObjectFilter> filters(keys.count());
  for (std::size_t i = 0; i < filters.size(); ++i) filters[i] = filter[i];
  change_or_throw(p.mutex, "set_filter",
                  [&] { return p.partition.set_filter(keys.keys(), filters); });
}

[[nodiscard]] py::tuple filters_of(const SharedPartition& p, py::handle key_array) {
  const KeyInput keys(p, key_array);
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

}  // namespace

void add_objects(py::module_& module, PartitionClass& partition) {
  partition.def("insert", &insert_boxes)
      .def("update", &update_boxes)
      .def("insert_spheres", &insert_spheres)
      .def("update_spheres", &update_spheres)
      .def("insert_kdops", &insert_kdops)
      .def("update_kdops", &update_kdops)
      .def("remove", &remove_objects)
      .def("__len__",
           [](const SharedPartition& p) {
             return reading(p.mutex, [&] { return p.partition.size(); });
           })
      .def("contains",
           [](const SharedPartition& p, py::handle key_array) {
             const KeyInput keys(p, key_array);
             return each_answer<bool>(p.mutex, keys.count(), [&](std::size_t i) {
               return p.partition.contains(keys.keys()[i]);
             });
           })
      .def("bounds", &bounds)
      .def("client_data", &client_data)
      .def("keys_of",
           [](const SharedPartition& p, py::handle id_array) {
             const Integers<std::uint32_t> ids(id_array, "ids");
             return each_key(p.mutex, ids.count(),
                             [&](std::size_t i) { return p.partition.key_of(ids[i]); });
           })
      .def("client_data_of",
           [](const SharedPartition& p, py::handle id_array) {
             const Integers<std::uint32_t> ids(id_array, "ids");
             return each_answer<std::uint64_t>(p.mutex, ids.count(), [&](std::size_t i) {
               return p.partition.client_data_of(ids[i]);
             });
           })
      .def("set_filter", &set_filter)
      .def("filters", &filters_of);
  add_function(module, "kdop_directions", &kdop_slabs);
  add_function(module, "boxes_address", [](py::handle lower, py::handle upper) {
    const BoxInput boxes(lower, upper);
    std::vector<Aabb> room;
    const BoxView view = boxes.view(room);
    return reinterpret_cast<std::uintptr_t>(view.min[0]);
  });
}

}  // namespace winnow::python
