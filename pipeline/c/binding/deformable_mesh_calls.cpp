// Generated from pipeline/interface/deformable_mesh.toml; do not edit.
// clang-format off

#include <winnow/c/deformable_mesh.h>

#include "pipeline/c/binding/results.h"

using namespace winnow;
using namespace winnow::c;

winnow_status winnow_deformable_mesh_create(
    const winnow_deformable_mesh_options* options, winnow_deformable_mesh** mesh) {
  DeformableMeshOptions own_options{};
  if (!(are_given(mesh) && read(options, own_options))) return WINNOW_INVALID_ARGUMENT;
  return create(memory_of(options), mesh, own_options);
}

void winnow_deformable_mesh_destroy(winnow_deformable_mesh* mesh) {
  destroy(mesh);
}

winnow_status winnow_deformable_mesh_build(
    winnow_deformable_mesh* mesh, const winnow_point_view* rest,
    const winnow_index_view* triangles) {
  if (!(are_given(mesh, rest, triangles))) return WINNOW_INVALID_ARGUMENT;
  PointView own_rest;
  if (const Status bad = read_view(*rest, own_rest); bad != Status::ok) {
    return answer(bad);
  }
  IndexView own_triangles;
  if (const Status bad = read_view(*triangles, own_triangles); bad != Status::ok) {
    return answer(bad);
  }
  return give([&]() -> decltype(auto) { return (of(mesh).build(own_rest, own_triangles)); });
}

winnow_status winnow_deformable_mesh_move(
    winnow_deformable_mesh* mesh, const winnow_point_view* start, const winnow_point_view* end,
    double distance) {
  if (!(are_given(mesh, start, end))) return WINNOW_INVALID_ARGUMENT;
  PointView own_start;
  if (const Status bad = read_view(*start, own_start); bad != Status::ok) {
    return answer(bad);
  }
  PointView own_end;
  if (const Status bad = read_view(*end, own_end); bad != Status::ok) {
    return answer(bad);
  }
  return give([&]() -> decltype(auto) { return (of(mesh).move(own_start, own_end, distance)); });
}

winnow_status winnow_deformable_mesh_triangles(const winnow_deformable_mesh* mesh, size_t* count) {
  if (!(are_given(mesh, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(mesh).triangles()); }, count);
}

winnow_status winnow_deformable_mesh_vertices(const winnow_deformable_mesh* mesh, size_t* count) {
  if (!(are_given(mesh, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(mesh).vertices()); }, count);
}

winnow_status winnow_deformable_mesh_edges(const winnow_deformable_mesh* mesh, size_t* count) {
  if (!(are_given(mesh, count))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(mesh).edges()); }, count);
}

winnow_status winnow_deformable_mesh_edge(
    const winnow_deformable_mesh* mesh, size_t i, uint32_t vertices[2]) {
  if (!(are_given(mesh, vertices))) return WINNOW_INVALID_ARGUMENT;
  if (!(i < of(mesh).edges())) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(mesh).edge(i)); }, vertices);
}

winnow_status winnow_deformable_mesh_self_candidates(
    const winnow_deformable_mesh* mesh, winnow_feature_pair kind,
    const winnow_pair_chunks* chunks) {
  FeaturePair own_kind{};
  Chunks<winnow_pair_chunks> own_chunks{};
  if (!(are_given(mesh, chunks) && read(kind, own_kind) && read(chunks, own_chunks))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(mesh).self_candidates(own_kind, own_chunks)); });
}

winnow_status winnow_deformable_mesh_candidates_with(
    const winnow_deformable_mesh* mesh, const winnow_deformable_mesh* other,
    winnow_feature_pair kind, const winnow_pair_chunks* chunks) {
  FeaturePair own_kind{};
  Chunks<winnow_pair_chunks> own_chunks{};
  if (!(are_given(mesh, other, chunks) && read(kind, own_kind) && read(chunks, own_chunks))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(mesh).candidates_with(of(other), own_kind, own_chunks)); });
}

winnow_status winnow_deformable_mesh_self_impacts(
    const winnow_deformable_mesh* mesh, winnow_feature_pair kind,
    const winnow_feature_impact_options* options, const winnow_mesh_impact_chunks* chunks) {
  FeaturePair own_kind{};
  FeatureImpactOptions own_options{};
  Chunks<winnow_mesh_impact_chunks> own_chunks{};
  if (!(are_given(mesh, chunks) && read(kind, own_kind) && read(options, own_options) && read(chunks, own_chunks))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(mesh).self_impacts(own_kind, own_options, own_chunks)); });
}

winnow_status winnow_deformable_mesh_impacts_with(
    const winnow_deformable_mesh* mesh, const winnow_deformable_mesh* other,
    winnow_feature_pair kind, const winnow_feature_impact_options* options,
    const winnow_mesh_impact_chunks* chunks) {
  FeaturePair own_kind{};
  FeatureImpactOptions own_options{};
  Chunks<winnow_mesh_impact_chunks> own_chunks{};
  if (!(are_given(mesh, other, chunks) && read(kind, own_kind) && read(options, own_options) && read(chunks, own_chunks))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(mesh).impacts_with(of(other), own_kind, own_options, own_chunks)); });
}

winnow_status winnow_deformable_mesh_impacts_with_shape(
    const winnow_deformable_mesh* mesh, const winnow_mesh_obstacle* obstacle,
    const winnow_impact_options* options, const winnow_mesh_shape_impact_chunks* chunks) {
  ImpactOptions own_options{};
  Chunks<winnow_mesh_shape_impact_chunks> own_chunks{};
  if (!(are_given(mesh, obstacle, chunks) && read(options, own_options) && read(chunks, own_chunks))) return WINNOW_INVALID_ARGUMENT;
  if (!(obstacle->shapes != nullptr)) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(mesh).impacts_with(obstacle_of(*obstacle), own_options, own_chunks)); });
}

winnow_status winnow_deformable_mesh_self_proximity(
    const winnow_deformable_mesh* mesh, winnow_feature_pair kind, double thickness,
    const winnow_mesh_proximity_chunks* chunks) {
  FeaturePair own_kind{};
  Chunks<winnow_mesh_proximity_chunks> own_chunks{};
  if (!(are_given(mesh, chunks) && read(kind, own_kind) && read(chunks, own_chunks))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(mesh).self_proximity(own_kind, thickness, own_chunks)); });
}

winnow_status winnow_deformable_mesh_proximity_with(
    const winnow_deformable_mesh* mesh, const winnow_deformable_mesh* other,
    winnow_feature_pair kind, double thickness, const winnow_mesh_proximity_chunks* chunks) {
  FeaturePair own_kind{};
  Chunks<winnow_mesh_proximity_chunks> own_chunks{};
  if (!(are_given(mesh, other, chunks) && read(kind, own_kind) && read(chunks, own_chunks))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (of(mesh).proximity_with(of(other), own_kind, thickness, own_chunks)); });
}

winnow_status winnow_deformable_mesh_footprint(
    const winnow_deformable_mesh* mesh, winnow_footprint* footprint) {
  if (!(are_given(mesh) && is_sized(footprint))) return WINNOW_INVALID_ARGUMENT;
  return write_footprint(mesh, footprint);
}

winnow_status winnow_feature_impact(
    winnow_feature_pair kind, const double start[12], const double end[12],
    const winnow_feature_impact_options* options, winnow_feature_hit* hit) {
  FeaturePair own_kind{};
  FeatureImpactOptions own_options{};
  if (!(are_given(start, end, hit) && read(kind, own_kind) && read(options, own_options))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (feature_impact(own_kind, four_points(start), four_points(end), own_options)); }, hit);
}

winnow_status winnow_feature_impacts(
    winnow_feature_pair kind, const winnow_feature_columns* pairs, double* times,
    const winnow_feature_impact_options* options) {
  FeaturePair own_kind{};
  FeatureColumns own_pairs{};
  FeatureImpactOptions own_options{};
  if (!(are_given(pairs) && read(kind, own_kind) && read(pairs, own_pairs) && is_array(times, pairs->count) && read(options, own_options))) return WINNOW_INVALID_ARGUMENT;
  return give([&]() -> decltype(auto) { return (feature_impacts(own_kind, own_pairs, span_of(times, pairs->count), own_options)); });
}
