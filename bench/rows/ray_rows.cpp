#include "bench/rows/ray_rows.h"

namespace winnow::bench {
namespace {

const char* name_of(RayQueryType query_type) {
  constexpr const char* kNames[] = {"closest", "any", "all"};
  return kNames[static_cast<int>(query_type)];
}

}  // namespace

RayMeasurement add_mesh_rays(Results& results, const RayRaceOptions& options) {
  RayMeasurement measured = measure_rays(options);
  const Json mesh{{"mesh", options.mesh}, {"triangles", options.triangles}};
  Json memory = mesh;
  memory["bytes_per_triangle"] = measured.bytes_per_triangle;
  results.add("ray_meshes", std::move(memory));
  for (const RayTiming& timing : measured.timings) {
    Json row = mesh;
    row["want"] = name_of(timing.query_type);
    row["asking"] = timing.mode == QueryMode::single ? "single" : "batch";
    row["engine"] = timing.engine;
    row["ns"] = to_value(timing.ns);
    row["hits"] = timing.hits;
    row["differ"] = timing.differ;
    results.add("mesh_rays", std::move(row));
  }
  return measured;
}

}  // namespace winnow::bench
