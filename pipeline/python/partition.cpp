// The class Partition itself: construction, structure, statistics and drawing. Other members are in
// objects.cpp, pairs.cpp, queries.cpp and snapshots.cpp.

#include "pipeline/python/partition.h"

#include "pipeline/python/drawing.h"
#include "pipeline/python/locks.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace winnow::python {

SharedPartition::SharedPartition(StructureKind structure, const PartitionOptions& options,
                                 RecorderPointer recorder_in)
    : recorder(std::move(recorder_in)),
      partition(structure, recorded_by(recorder, options)),
      execution(options.execution) {
  accept(partition.status(), "Partition");
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

/// Returns the structure, with its own parameter if given.
[[nodiscard]] StructureKind structure_with(const std::string& name, std::optional<float> loose) {
  const StructureKind kind = structure_of(name);
  if (!loose) return kind;
  if (name == loose_octree().name()) return loose_octree(*loose);
  if (name == loose_quadtree().name()) return loose_quadtree(*loose);
  throw Refusal(Status::invalid_argument, "loose: " + name + " has no such parameter");
}

[[nodiscard]] std::shared_ptr<SharedPartition> make_partition(
    const std::string& structure, const std::string& volume, float fat_margin,
    float fat_margin_share, bool parallel, std::size_t build_budget, std::optional<float> loose,
    const RecorderPointer& recorder) {
  PartitionOptions options;
  options.volume = chosen(kVolumes, volume, "volume");
  options.fat_margin = {fat_margin, fat_margin_share};
  options.execution = parallel ? Execution::parallel() : Execution::serial();
  options.build_budget = build_budget;
  return std::make_shared<SharedPartition>(structure_with(structure, loose), options, recorder);
}

void reserve(SharedPartition& p, std::size_t objects, std::size_t pairs, bool touch,
             Events* events) {
  const Pages pages = touch ? Pages::prefaulted : Pages::untouched;
  std::unique_lock<std::mutex> filling;
  PairEvents* changes = nullptr;
  if (events != nullptr) {
    filling = events->hold();
    changes = &events->to_fill("events");
  }
  change_or_throw(p.mutex, "reserve", [&] {
    const Status status = p.partition.reserve(objects, pages);
    if (status != Status::ok || pairs == 0) return status;
    const std::shared_ptr<PairBuffer> out = p.take_pairs(true);
    const Status reserved = p.partition.reserve_pairs(*out, pairs, pages);
    p.keep_pairs(out);
    if (reserved != Status::ok || changes == nullptr) return reserved;
    return p.partition.reserve_events(*changes, pairs, false, pages);
  });
}

[[nodiscard]] py::dict statistics_dict(const SharedPartition& p) {
  const Statistics s = reading(p.mutex, [&] { return p.partition.statistics(); });
  return py::dict(py::arg("objects") = s.objects, py::arg("regular") = s.regular,
                  py::arg("irregular") = s.irregular, py::arg("cells") = s.cells,
                  py::arg("depth") = s.depth, py::arg("levels") = s.levels,
                  py::arg("builds") = s.builds, py::arg("planned_builds") = s.planned_builds,
                  py::arg("refits") = s.refits, py::arg("full_queries") = s.full_queries,
                  py::arg("incremental_queries") = s.incremental_queries,
                  py::arg("last_tests") = s.last_tests, py::arg("last_pairs") = s.last_pairs);
}

[[nodiscard]] py::dict choice_dict(const SharedPartition& p) {
  const StructureChoice c = reading(p.mutex, [&] { return p.partition.choice(); });
  return py::dict(
      py::arg("structure") = std::string(c.structure.name()),
      py::arg("reason") = std::string(c.reason), py::arg("changes") = c.changes,
      py::arg("objects") = c.features.objects,
      py::arg("room") = py::make_tuple(c.features.room[0], c.features.room[1], c.features.room[2]),
      py::arg("size_spread") = c.features.size_spread, py::arg("crowding") = c.features.crowding,
      py::arg("pairs") = c.features.pairs);
}

[[nodiscard]] py::object draw(const SharedPartition& p, bool objects, bool structure, bool labels,
                              int max_depth) {
  Drawing drawing;
  read_or_throw(p.mutex, "debug_draw", [&] {
    return p.partition.debug_draw(drawing, {objects, structure, labels, max_depth});
  });
  return drawing.shown();
}

}  // namespace

void add_partition(py::module_& module, PartitionClass& partition) {
  partition.def(py::init(&make_partition))
      .def("clear",
           [](SharedPartition& p) {
             changing(p.mutex, [&] { p.partition.clear(); });
             p.count_changes(~std::size_t{0} / 8);
           })
      .def("release_memory",
           [](SharedPartition& p) {
             changing(p.mutex, [&] {
               p.partition.release_memory();
               p.room = {};
               p.keep_pairs(nullptr);
               p.pair_pool->release();
               p.hit_pool->release();
             });
           })
      .def("reserve", &reserve)
      .def("refresh",
           [](const SharedPartition& p) {
             read_or_throw(p.mutex, "refresh", [&] { return p.partition.refresh(); });
           })
      .def("set_structure",
           [](SharedPartition& p, const std::string& name, std::optional<float> loose) {
             const StructureKind kind = structure_with(name, loose);
             change_or_throw(p.mutex, "set_structure",
                             [&] { return p.partition.set_structure(kind); });
           })
      .property("structure",
                [](const SharedPartition& p) {
                  return reading(p.mutex, [&] { return std::string(p.partition.name()); });
                })
      .property("volume",
                [](const SharedPartition& p) { return name_of(kVolumes, p.partition.volume()); })
      .property("fat_margin",
                [](const SharedPartition& p) {
                  const FatMargin m = p.partition.fat_margin();
                  return py::make_tuple(m.distance, m.share);
                })
      .property("is_exact",
                [](const SharedPartition& p) {
                  return reading(p.mutex, [&] { return p.partition.is_exact(); });
                })
      .def("choice", &choice_dict)
      .def("statistics", &statistics_dict)
      .def("footprint",
           [](const SharedPartition& p) {
             return footprint_dict(reading(p.mutex, [&] { return p.partition.footprint(); }));
           })
      .def("debug_draw", &draw);
  add_function(module, "structures", [] {
    std::vector<std::string> names;
    for (const StructureKind& kind : all_structures()) names.emplace_back(kind.name());
    return names;
  });
}

}  // namespace winnow::python
