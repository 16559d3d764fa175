// Objects of a partition, and the pairs of these.

#include "pipeline/python/partition.h"

#include "pipeline/python/drawing.h"
#include "pipeline/python/locks.h"

#include <winnow/core/kdop.h>
#include <winnow/core/rounding.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace winnow::python {

SharedPartition::SharedPartition(StructureKind structure, const PartitionOptions& options)
    : partition(structure, options), execution(options.execution) {
  accept(partition.status(), "Partition");
}

std::shared_ptr<PairBuffer> SharedPartition::take_pairs(bool incremental, bool with_events) {
  std::shared_ptr<PairBuffer> last;
  {
    const std::lock_guard lock(pairs_mutex_);
    last = std::exchange(last_pairs_, nullptr);
  }
  const std::size_t changes = changes_.exchange(0);
  if (last && last.use_count() == 1) {
    std::atomic_thread_fence(std::memory_order_acquire);
    return last;
  }
  std::shared_ptr<PairBuffer> out = pair_pool->take();
  // Where much has moved, all pairs are asked for anew, wherever they are written.
  const bool few = changes < partition.size() / 4;
  const bool carries = with_events || (incremental && few);
  if (last && carries && !out->assign(*last)) out->clear();
  return out;
}

void SharedPartition::keep_pairs(std::shared_ptr<PairBuffer> pairs) {
  const std::lock_guard lock(pairs_mutex_);
  last_pairs_ = std::move(pairs);
}

StructureKind structure_of(const std::string& name) {
  const StructureKind kind = structure_named(name);
  if (kind.info() != nullptr) return kind;
  std::string all;
  for (const StructureKind& known : all_structures()) {
    all += (all.empty() ? "" : ", ") + std::string(known.name());
  }
  throw Refusal(Status::invalid_argument, "structure: '" + name + "' is none of " + all);
}

py::array shown_pairs(const std::shared_ptr<PairBuffer>& pairs) {
  const auto* const ids = reinterpret_cast<const ObjectId*>(pairs->pairs().data());
  return shown_rows(pairs, ids, pairs->size(), 2, sizeof(Pair));
}

py::dict footprint_dict(const Footprint& footprint) {
  py::dict result;
  const auto add = [&](const char* name, const Bytes& bytes) {
    result[name] = py::make_tuple(bytes.used, bytes.reserved);
  };
  add("bounds", footprint.bounds);
  add("keys", footprint.keys);
  add("client_data", footprint.client_data);
  add("structure", footprint.structure);
  add("scratch", footprint.scratch);
  add("results", footprint.results);
  add("total", footprint.total());
  return result;
}

namespace {

/// The structure with a parameter of its own.
[[nodiscard]] StructureKind structure_with(const std::string& name, std::optional<float> loose) {
  const StructureKind kind = structure_of(name);
  if (!loose) return kind;
  if (name == loose_octree().name()) return loose_octree(*loose);
  if (name == loose_quadtree().name()) return loose_quadtree(*loose);
  throw Refusal(Status::invalid_argument, "loose: " + name + " has no such parameter");
}

[[nodiscard]] std::shared_ptr<SharedPartition> make_partition(
    const std::string& structure, const std::string& volume, float margin, float margin_share,
    bool parallel, std::size_t build_budget, std::optional<float> loose) {
  PartitionOptions options;
  options.volume = chosen(kVolumes, volume, "volume");
  options.margin = {margin, margin_share};
  options.execution = parallel ? Execution::parallel() : Execution::serial();
  options.build_budget = build_budget;
  return std::make_shared<SharedPartition>(structure_with(structure, loose), options);
}

// --- objects -----------------------------------------------------------------------------------

[[nodiscard]] py::array insert_boxes(SharedPartition& p, py::handle lower, py::handle upper,
                                     py::handle data) {
  const BoxInput boxes(lower, upper);
  const std::vector<ClientData> values = data_of(data, boxes.count());
  auto keys = fresh<std::uint64_t>(boxes.count());
  const std::span<Key> out(keys_in(keys), boxes.count());
  accept(changing(p.mutex, [&] { return p.partition.insert(boxes.view(p.room), values, out); }),
         "insert");
  p.count_changes(boxes.count());
  return keys;
}

/// Numbers of the entries that are meant: those that are listed, or where a mask of bool is set.
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
    accept(changing(p.mutex, [&] { return p.partition.update(keys.keys(), boxes.view(p.room)); }),
           "update");
    p.count_changes(keys.count());
    return;
  }
  const Integers<std::uint32_t> numbers(entry_numbers(entries), "entries");
  accept(changing(p.mutex,
                  [&] {
                    return p.partition.update(keys.keys(), boxes.view(p.room),
                                              Entries::listed(numbers.values()));
                  }),
         "update");
  p.count_changes(numbers.count());
}

/// Balls that contain those given.
[[nodiscard]] std::vector<Sphere> spheres_of(py::handle centers, py::handle radii) {
  const Numbers center(centers, "centers", {3});
  Numbers radius(radii, "radii", {}, true);
  radius.expect(center.count());
  std::vector<Sphere> spheres(center.count());
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    double square = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double given = center.at(i, axis);
      const auto rounded = static_cast<float>(given);
      spheres[i].center[static_cast<Eigen::Index>(axis)] = rounded;
      const double off = given - static_cast<double>(rounded);
      square += off * off;
    }
    const double r = radius.at(i);
    spheres[i].radius =
        square > 0.0 ? round_up(add_up(r, std::sqrt(square) * (1.0 + 1e-15))) : round_up(r);
  }
  return spheres;
}

[[nodiscard]] py::array insert_spheres(SharedPartition& p, py::handle centers, py::handle radii,
                                       py::handle data) {
  const std::vector<Sphere> spheres = spheres_of(centers, radii);
  const std::vector<ClientData> values = data_of(data, spheres.size());
  auto keys = fresh<std::uint64_t>(spheres.size());
  const std::span<Key> out(keys_in(keys), spheres.size());
  accept(changing(p.mutex, [&] { return p.partition.insert(spheres, values, out); }),
         "insert_spheres");
  p.count_changes(spheres.size());
  return keys;
}

void update_spheres(SharedPartition& p, py::handle key_array, py::handle centers,
                    py::handle radii) {
  const KeyInput keys(key_array);
  const std::vector<Sphere> spheres = spheres_of(centers, radii);
  accept(changing(p.mutex, [&] { return p.partition.update(keys.keys(), spheres); }),
         "update_spheres");
  p.count_changes(keys.count());
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

/// Calls `body` with the k-DOPs of the partition's volume.
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
    const std::vector<ClientData> values = data_of(data, kdops.size());
    auto keys = fresh<std::uint64_t>(kdops.size());
    const std::span<Key> out(keys_in(keys), kdops.size());
    accept(changing(p.mutex,
                    [&] { return p.partition.insert(std::span<const Kind>(kdops), values, out); }),
           "insert_kdops");
    p.count_changes(kdops.size());
    return keys;
  });
}

void update_kdops(SharedPartition& p, py::handle key_array, py::handle lower, py::handle upper) {
  const KeyInput keys(key_array);
  with_kdops(p, lower, upper, [&](const auto& kdops) {
    using Kind = typename std::decay_t<decltype(kdops)>::value_type;
    accept(changing(p.mutex,
                    [&] { return p.partition.update(keys.keys(), std::span<const Kind>(kdops)); }),
           "update_kdops");
    p.count_changes(keys.count());
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
  accept(changing(p.mutex, [&] { return p.partition.remove(keys.keys()); }), "remove");
  p.count_changes(keys.count());
}

void reserve(SharedPartition& p, std::size_t objects, std::size_t pairs, bool touch) {
  const Pages pages = touch ? Pages::touched : Pages::untouched;
  accept(changing(p.mutex,
                  [&] {
                    const Status status = p.partition.reserve(objects, pages);
                    if (status != Status::ok || pairs == 0) return status;
                    const std::shared_ptr<PairBuffer> out = p.take_pairs(true);
                    const Status reserved = p.partition.reserve_pairs(*out, pairs, pages);
                    p.keep_pairs(out);
                    return reserved;
                  }),
         "reserve");
}

// --- what is known of objects ------------------------------------------------------------------

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
  accept(reading(p.mutex,
                 [&] {
                   for (std::size_t i = 0; i < keys.count(); ++i) {
                     Aabb box;
                     const Status status = p.partition.bounds(keys.keys()[i], box);
                     if (status != Status::ok) return status;
                     for (std::size_t axis = 0; axis < 3; ++axis) {
                       low[3 * i + axis] = box.min[static_cast<Eigen::Index>(axis)];
                       high[3 * i + axis] = box.max[static_cast<Eigen::Index>(axis)];
                     }
                   }
                   return Status::ok;
                 }),
         "bounds");
  return py::make_tuple(lower, upper);
}

[[nodiscard]] py::array client_data(const SharedPartition& p, py::handle key_array) {
  const KeyInput keys(key_array);
  auto result = fresh<std::uint64_t>(keys.count());
  std::uint64_t* const to = result.mutable_data();
  accept(reading(p.mutex,
                 [&] {
                   for (std::size_t i = 0; i < keys.count(); ++i) {
                     const Status status = p.partition.client_data(keys.keys()[i], to[i]);
                     if (status != Status::ok) return status;
                   }
                   return Status::ok;
                 }),
         "client_data");
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
  const EachInteger wanted(mask, "mask", most);
  const EachInteger world(environment, "environment", most);
  for (const EachInteger* each : {&layer, &wanted, &world}) each->expect(keys.count());
  std::vector<ObjectFilter> filters(keys.count());
  for (std::size_t i = 0; i < filters.size(); ++i) {
    filters[i] = {static_cast<std::uint32_t>(layer[i]), static_cast<std::uint32_t>(wanted[i]),
                  static_cast<std::uint32_t>(world[i])};
  }
  accept(changing(p.mutex, [&] { return p.partition.set_filter(keys.keys(), filters); }),
         "set_filter");
}

[[nodiscard]] py::tuple filters_of(const SharedPartition& p, py::handle key_array) {
  const KeyInput keys(key_array);
  std::vector<ObjectFilter> filters(keys.count());
  accept(reading(p.mutex,
                 [&] {
                   for (std::size_t i = 0; i < keys.count(); ++i) {
                     const Status status = p.partition.filter(keys.keys()[i], filters[i]);
                     if (status != Status::ok) return status;
                   }
                   return Status::ok;
                 }),
         "filters");
  std::vector<std::uint32_t> columns[3];
  for (const ObjectFilter& filter : filters) {
    columns[0].push_back(filter.layers);
    columns[1].push_back(filter.mask);
    columns[2].push_back(filter.environment);
  }
  return py::make_tuple(given(std::move(columns[0])), given(std::move(columns[1])),
                        given(std::move(columns[2])));
}

// --- pairs -------------------------------------------------------------------------------------

[[nodiscard]] py::array self_pairs(SharedPartition& p, Events* events, const std::string& order,
                                   bool incremental) {
  const PairOptions options{chosen(kOrders, order, "order"), incremental, {}};
  std::unique_lock<std::mutex> filling;
  PairEvents* changes = nullptr;
  if (events != nullptr) {
    filling = events->hold();
    changes = &events->to_fill("events");
  }
  std::shared_ptr<PairBuffer> out;
  accept(reading(p.mutex,
                 [&] {
                   out = p.take_pairs(incremental, changes != nullptr);
                   const Status status = changes == nullptr
                                             ? p.partition.self_pairs(*out, options)
                                             : p.partition.self_pairs(*out, *changes, options);
                   if (status == Status::ok) p.keep_pairs(out);
                   return status;
                 }),
         "self_pairs");
  return shown_pairs(out);
}

void pair_changes(SharedPartition& p, Events& events) {
  const std::unique_lock<std::mutex> filling = events.hold();
  PairEvents& changes = events.to_fill("events");
  accept(reading(p.mutex, [&] { return p.partition.self_pairs(changes); }), "pair_changes");
}

[[nodiscard]] py::array pairs_with(const SharedPartition& p, const SharedPartition& other,
                                   const std::string& order) {
  const PairOptions options{chosen(kOrders, order, "order"), true, {}};
  const std::shared_ptr<PairBuffer> out = p.pair_pool->take();
  const auto ask = [&] { return p.partition.pairs_with(other.partition, *out, options); };
  // One lock is not taken twice, and two always in the order of their addresses.
  const SharedPartition* const first = &p < &other ? &p : &other;
  const SharedPartition* const second = &p < &other ? &other : &p;
  accept(reading(first->mutex,
                 [&] {
                   if (first == second) return ask();
                   const std::shared_lock lock(second->mutex);
                   return ask();
                 }),
         "pairs_with");
  return shown_pairs(out);
}

[[nodiscard]] py::array shown_keys(const std::shared_ptr<PairEvents>& events,
                                   std::span<const KeyPair> pairs) {
  const auto* const keys = reinterpret_cast<const std::uint64_t*>(pairs.data());
  return shown_rows(std::shared_ptr<const void>(events), keys, pairs.size(), 2, sizeof(KeyPair));
}

// --- the partition itself ----------------------------------------------------------------------

[[nodiscard]] py::dict statistics_dict(const SharedPartition& p) {
  const Statistics s = reading(p.mutex, [&] { return p.partition.statistics(); });
  py::dict result;
  result["objects"] = s.objects;
  result["regular"] = s.regular;
  result["irregular"] = s.irregular;
  result["cells"] = s.cells;
  result["depth"] = s.depth;
  result["levels"] = s.levels;
  result["builds"] = s.builds;
  result["planned_builds"] = s.planned_builds;
  result["refits"] = s.refits;
  result["full_queries"] = s.full_queries;
  result["incremental_queries"] = s.incremental_queries;
  result["last_tests"] = s.last_tests;
  result["last_pairs"] = s.last_pairs;
  return result;
}

[[nodiscard]] py::dict choice_dict(const SharedPartition& p) {
  const StructureChoice c = reading(p.mutex, [&] { return p.partition.choice(); });
  py::dict result;
  result["structure"] = std::string(c.structure.name());
  result["reason"] = std::string(c.reason);
  result["changes"] = c.changes;
  result["objects"] = c.features.objects;
  result["room"] = py::make_tuple(c.features.room[0], c.features.room[1], c.features.room[2]);
  result["size_spread"] = c.features.size_spread;
  result["crowding"] = c.features.crowding;
  result["pairs"] = c.features.pairs;
  return result;
}

[[nodiscard]] Drawing draw(const SharedPartition& p, bool objects, bool structure, bool labels,
                           int max_depth) {
  Drawing drawing;
  accept(reading(p.mutex,
                 [&] {
                   return p.partition.debug_draw(drawing, {objects, structure, labels, max_depth});
                 }),
         "debug_draw");
  return drawing;
}

void add_objects(PartitionClass& partition) {
  using py::arg;
  partition
      .def(py::init(&make_partition), arg("structure") = "LinearBvh", py::kw_only(),
           arg("volume") = "aabb", arg("margin") = 0.0F, arg("margin_share") = 0.0F,
           arg("parallel") = true, arg("build_budget") = 0, arg("loose") = py::none(),
           "An empty partition. `structure` prunes (see `structures`), `volume` bounds an object: "
           "'aabb', 'sphere', 'kdop14', 'kdop18' or 'kdop26'. Volumes are stored larger by "
           "`margin` (a length) + `margin_share` * longest edge: moves within are free. `loose` is "
           "the parameter of LooseOctree and LooseQuadtree.")
      .def("insert", &insert_boxes, arg("lower"), arg("upper"), arg("data") = py::none(),
           "Adds n boxes and gives their keys, (n,) uint64. `lower`, `upper`: (n, 3), in units of "
           "the scene; lower <= upper, ends may be infinite. Floats of any strides are read where "
           "they lie, if both arrays have the same stride from box to box; all else is rounded "
           "outward to float. `data`: (n,) uint64, given back by queries.")
      .def("update", &update_boxes, arg("keys"), arg("lower"), arg("upper"),
           arg("entries") = py::none(),
           "Gives the n objects of `keys` (n,) new boxes, (n, 3) each. With `entries`, numbers "
           "(m,) or a mask (n,) of bool, only those entries of the arrays.")
      .def("insert_spheres", &insert_spheres, arg("centers"), arg("radii"),
           arg("data") = py::none(),
           "Adds n balls, where volume is 'sphere', and gives their keys, (n,) uint64. `centers`: "
           "(n, 3), `radii`: (n,) or one for all, finite and >= 0.")
      .def("update_spheres", &update_spheres, arg("keys"), arg("centers"), arg("radii"),
           "Gives the n objects of `keys` (n,) new balls: `centers` (n, 3), `radii` (n,) or one "
           "for all.")
      .def("insert_kdops", &insert_kdops, arg("lower"), arg("upper"), arg("data") = py::none(),
           "Adds n k-DOPs, where volume is one: lower and upper ends (n, k/2) of the slabs along "
           "`kdop_directions(k)`. Gives their keys, (n,) uint64.")
      .def("update_kdops", &update_kdops, arg("keys"), arg("lower"), arg("upper"),
           "Gives the n objects of `keys` (n,) new k-DOPs, lower and upper ends (n, k/2).")
      .def("remove", &remove_objects, arg("keys"),
           "Removes the objects of `keys` (n,). A key that is stale, of another partition or there "
           "twice refuses all.")
      .def(
          "clear",
          [](SharedPartition& p) {
            changing(p.mutex, [&] { p.partition.clear(); });
            p.count_changes(~std::size_t{0} / 8);
          },
          "Removes every object and keeps the memory.")
      .def(
          "release_memory",
          [](SharedPartition& p) {
            changing(p.mutex, [&] {
              p.partition.release_memory();
              p.room = {};
              p.keep_pairs(nullptr);
              p.pair_pool->release();
              p.hit_pool->release();
            });
          },
          "Gives back memory that an empty partition, or scratch, holds.")
      .def("reserve", &reserve, arg("objects"), arg("pairs") = 0, arg("touch") = false,
           "Makes ready the memory that a first frame of so many objects and pairs takes; `touch` "
           "writes to each page of it.");
}

void add_knowledge(PartitionClass& partition) {
  using py::arg;
  partition
      .def("__len__",
           [](const SharedPartition& p) {
             return reading(p.mutex, [&] { return p.partition.size(); });
           })
      .def("contains", &contains, arg("keys"), "Which of `keys` (n,) are alive: (n,) bool.")
      .def("bounds", &bounds, arg("keys"),
           "Boxes (lower, upper) of the objects of `keys` (n,), (n, 3) float32 each, as they are "
           "tested: larger than given by the margin, around other volumes.")
      .def("client_data", &client_data, arg("keys"),
           "What `insert` was given as data for the objects of `keys` (n,): (n,) uint64.")
      .def("keys_of", &keys_of, arg("ids"),
           "Keys (n,) uint64 of objects by id (n,); NULL_KEY for those that are not alive.")
      .def("client_data_of", &client_data_of, arg("ids"),
           "Client data (n,) uint64 of objects by id (n,); 0 for those that are not alive.")
      .def("set_filter", &set_filter, arg("keys"), arg("layers") = 1,
           arg("mask") = ~std::uint32_t{0}, arg("environment") = 0,
           "Sets what the objects of `keys` (n,) let themselves be paired with: `layers` they are "
           "in and `mask` of layers they meet, a bit each, and `environment`, which must be equal "
           "or EVERY_ENVIRONMENT. (n,) uint32 each, or one for all.")
      .def("filters", &filters_of, arg("keys"),
           "(layers, mask, environment) of the objects of `keys` (n,), (n,) uint32 each.");
}

void add_pairs(PartitionClass& partition) {
  using py::arg;
  partition
      .def("self_pairs", &self_pairs, arg("events") = py::none(), py::kw_only(),
           arg("order") = "fast", arg("incremental") = true,
           "All pairs of objects whose volumes overlap: (m, 2) uint32 of ids, first < second. An "
           "array that shows what winnow wrote, to be read; it never changes. Drop it before the "
           "next call, and that updates it in place where little moved; else pairs go to another "
           "buffer. `order`: 'fast' or 'canonical' (sorted). With `events`, what changed since the "
           "last call is written there.")
      .def("pair_changes", &pair_changes, arg("events"),
           "What changed of all pairs since the last call with these events, alone: costs what "
           "moved.")
      .def("pairs_with", &pairs_with, arg("other"), py::kw_only(), arg("order") = "fast",
           "All pairs (object of this, object of `other`) whose boxes overlap: (m, 2) uint32 of "
           "ids.");
}

void add_itself(PartitionClass& partition) {
  using py::arg;
  partition
      .def(
          "refresh",
          [](const SharedPartition& p) {
            accept(reading(p.mutex, [&] { return p.partition.refresh(); }), "refresh");
          },
          "Brings the structure up to date now rather than in the next query.")
      .def(
          "set_structure",
          [](SharedPartition& p, const std::string& name, std::optional<float> loose) {
            const StructureKind kind = structure_with(name, loose);
            accept(changing(p.mutex, [&] { return p.partition.set_structure(kind); }),
                   "set_structure");
          },
          arg("structure"), arg("loose") = py::none(),
          "Exchanges the structure; objects, keys, filters and events stay.")
      .def_property_readonly(
          "structure",
          [](const SharedPartition& p) {
            return reading(p.mutex, [&] { return std::string(p.partition.name()); });
          },
          "Name of the structure it was given last.")
      .def_property_readonly(
          "volume",
          [](const SharedPartition& p) { return name_of(kVolumes, p.partition.volume()); },
          "What bounds an object.")
      .def_property_readonly(
          "margin",
          [](const SharedPartition& p) {
            const Margin m = p.partition.margin();
            return py::make_tuple(m.distance, m.share);
          },
          "(distance, share of the longest edge).")
      .def_property_readonly(
          "is_exact",
          [](const SharedPartition& p) {
            return reading(p.mutex, [&] { return p.partition.is_exact(); });
          },
          "True if `self_pairs` gives exactly the pairs whose given boxes "
          "overlap.")
      .def("choice", &choice_dict,
           "What AutoPartition holds and why, and what is known of the scene; of any other "
           "structure that one itself.")
      .def("statistics", &statistics_dict, "How it stands and what it did: counters, no timings.")
      .def(
          "footprint",
          [](const SharedPartition& p) {
            return footprint_dict(reading(p.mutex, [&] { return p.partition.footprint(); }));
          },
          "Bytes (used, reserved) by purpose.")
      .def("debug_draw", &draw, py::kw_only(), arg("objects") = true, arg("structure") = true,
           arg("labels") = false, arg("max_depth") = 64,
           "The objects and the structure as boxes, lines, spheres and texts. O(n).");
}

}  // namespace

void add_partition(py::module_& module, PartitionClass& partition) {
  using py::arg;
  py::class_<Events, std::shared_ptr<Events>>(
      module, "PairEvents",
      "What changed between two frames. Its arrays show what winnow wrote; while "
      "one of them is alive, filling the events again is a BufferError.")
      .def(py::init([] { return std::make_shared<Events>(); }), "Events that remember nothing.")
      .def_property_readonly(
          "begun",
          [](const Events& e) {
            const auto held = e.hold();
            return shown_keys(e.value(), e.value()->begun());
          },
          "Pairs of this frame that the last one had not: (m, 2) uint64 of "
          "keys, sorted by id.")
      .def_property_readonly(
          "ended",
          [](const Events& e) {
            const auto held = e.hold();
            return shown_keys(e.value(), e.value()->ended());
          },
          "Pairs of the last frame that this one has not: (m, 2) uint64 of "
          "keys, sorted by id; those of removed objects are stale.")
      .def_property_readonly(
          "persisting",
          [](const Events& e) {
            const auto held = e.hold();
            return e.value()->persisting();
          },
          "How many pairs are in both frames.")
      .def(
          "clear",
          [](const Events& e) {
            const auto held = e.hold();
            e.to_fill("events").clear();
          },
          "Forgets everything.");
  add_objects(partition);
  add_knowledge(partition);
  add_pairs(partition);
  add_itself(partition);
  module.def("kdop_directions", &kdop_slabs, arg("faces"),
             "Directions of the slabs of a k-DOP of 14, 18 or 26 faces, not normalised: (k/2, 3) "
             "float32.");
  module.def(
      "structures",
      [] {
        std::vector<std::string> names;
        for (const StructureKind& kind : all_structures()) names.emplace_back(kind.name());
        return names;
      },
      "Names of all structures.");
  module.def(
      "boxes_address",
      [](py::handle lower, py::handle upper) {
        const BoxInput boxes(lower, upper);
        std::vector<Aabb> room;
        const BoxView view = boxes.view(room);
        return reinterpret_cast<std::uintptr_t>(view.min[0]);
      },
      arg("lower"), arg("upper"),
      "Where a call reads the lower corner of the first of these boxes: in `lower` itself, "
      "unless they have to be copied.");
}

}  // namespace winnow::python
