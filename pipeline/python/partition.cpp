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

void reserve(SharedPartition& p, std::size_t objects, std::size_t pairs, bool touch) {
  const Pages pages = touch ? Pages::prefaulted : Pages::untouched;
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

void add_itself(PartitionClass& partition) {
  using py::arg;
  partition
      .def(py::init(&make_partition), arg("structure") = "LinearBvh", py::kw_only(),
           arg("volume") = "aabb", arg("fat_margin") = 0.0F, arg("fat_margin_share") = 0.0F,
           arg("parallel") = true, arg("build_budget") = 0, arg("loose") = py::none(),
           arg("recorder") = py::none(),
           "An empty partition. `structure`: the spatial structure (see `structures`). `volume`: "
           "the bounding volume of objects: 'aabb', 'sphere', 'kdop14', 'kdop18' or 'kdop26'. "
           "Volumes are stored larger by `fat_margin` (a length) + `fat_margin_share` * longest "
           "edge: "
           "moves within this margin are free. `loose`: parameter of LooseOctree and "
           "LooseQuadtree. `recorder`: records all calls.")
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
          "Frees memory that an empty partition, or scratch, holds.")
      .def("reserve", &reserve, arg("objects"), arg("pairs") = 0, arg("touch") = false,
           "Reserves the memory for a first frame with this many objects and pairs; `touch` writes "
           "to each page of it.")
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
          "Replaces the structure; objects, keys, filters and events stay.")
      .def_property_readonly(
          "structure",
          [](const SharedPartition& p) {
            return reading(p.mutex, [&] { return std::string(p.partition.name()); });
          },
          "Name of the current structure, as it was set.")
      .def_property_readonly(
          "volume",
          [](const SharedPartition& p) { return name_of(kVolumes, p.partition.volume()); },
          "The bounding volume of objects.")
      .def_property_readonly(
          "fat_margin",
          [](const SharedPartition& p) {
            const FatMargin m = p.partition.fat_margin();
            return py::make_tuple(m.distance, m.share);
          },
          "Fat margin: (length, share of the longest edge).")
      .def_property_readonly(
          "is_exact",
          [](const SharedPartition& p) {
            return reading(p.mutex, [&] { return p.partition.is_exact(); });
          },
          "True if `self_pairs` gives exactly the pairs whose given boxes "
          "overlap.")
      .def("choice", &choice_dict,
           "The structure that AutoPartition uses and the reason, with the properties of the "
           "scene; for any other structure that structure itself.")
      .def("statistics", &statistics_dict, "Counters of its state and work, no timings.")
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
  add_itself(partition);
  module.def(
      "structures",
      [] {
        std::vector<std::string> names;
        for (const StructureKind& kind : all_structures()) names.emplace_back(kind.name());
        return names;
      },
      "Names of all structures.");
}

}  // namespace winnow::python
