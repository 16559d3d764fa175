// Generated from pipeline/interface/*.toml; do not edit.
// clang-format off
#pragma once

// Conversions between structs of C and of C++, used by all functions.

#include "pipeline/c/binding/convert.h"

#include <winnow/c/contact_groups.h>
#include <winnow/c/continuous_collision.h>
#include <winnow/c/core.h>
#include <winnow/c/deformable_mesh.h>
#include <winnow/c/hooks.h>
#include <winnow/c/narrow_phase.h>
#include <winnow/c/partition.h>
#include <winnow/c/recording.h>
#include <winnow/c/scene.h>
#include <winnow/c/scene_queries.h>
#include <winnow/c/sensors.h>
#include <winnow/c/shapes.h>
#include <winnow/c/snapshots.h>
#include <winnow/c/time_of_impact.h>
#include <winnow/c/volumes.h>
#include <winnow/core/debug_draw.h>
#include <winnow/core/execution.h>
#include <winnow/core/filter.h>
#include <winnow/core/hooks.h>
#include <winnow/core/key.h>
#include <winnow/core/memory.h>
#include <winnow/core/point_view.h>
#include <winnow/core/pose.h>
#include <winnow/core/rays.h>
#include <winnow/core/regions.h>
#include <winnow/core/results.h>
#include <winnow/core/status.h>
#include <winnow/core/volumes.h>
#include <winnow/partitions/partition.h>
#include <winnow/partitions/structures.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/contact_groups.h>
#include <winnow/pipeline/contact_types.h>
#include <winnow/pipeline/contacts.h>
#include <winnow/pipeline/continuous_collision.h>
#include <winnow/pipeline/deformable_mesh.h>
#include <winnow/pipeline/impacts.h>
#include <winnow/pipeline/narrow_phase.h>
#include <winnow/pipeline/recording.h>
#include <winnow/pipeline/rigid_motion.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/scene_queries.h>
#include <winnow/pipeline/sensors.h>
#include <winnow/pipeline/shape_pool.h>
#include <winnow/pipeline/shape_rays.h>
#include <winnow/pipeline/shapes.h>
#include <winnow/pipeline/surfaces.h>

namespace winnow::c {

static_assert(static_cast<int>(Status::ok) == WINNOW_OK);
static_assert(static_cast<int>(Status::invalid_bounds) == WINNOW_INVALID_BOUNDS);
static_assert(static_cast<int>(Status::invalid_key) == WINNOW_INVALID_KEY);
static_assert(static_cast<int>(Status::invalid_argument) == WINNOW_INVALID_ARGUMENT);
static_assert(static_cast<int>(Status::size_mismatch) == WINNOW_SIZE_MISMATCH);
static_assert(static_cast<int>(Status::out_of_memory) == WINNOW_OUT_OF_MEMORY);
static_assert(static_cast<int>(Status::too_many_objects) == WINNOW_TOO_MANY_OBJECTS);
static_assert(static_cast<int>(Status::unsupported_volume) == WINNOW_UNSUPPORTED_VOLUME);
static_assert(static_cast<int>(Status::invalid_shape) == WINNOW_INVALID_SHAPE);
static_assert(static_cast<int>(Status::invalid_pose) == WINNOW_INVALID_POSE);
static_assert(static_cast<int>(Status::unsupported) == WINNOW_UNSUPPORTED);
static_assert(static_cast<int>(Status::communication_failed) == WINNOW_COMMUNICATION_FAILED);
template <>
inline constexpr Status kLast<Status> = Status::communication_failed;

static_assert(static_cast<int>(Pages::untouched) == WINNOW_PAGES_UNTOUCHED);
static_assert(static_cast<int>(Pages::prefaulted) == WINNOW_PAGES_TOUCHED);
template <>
inline constexpr Pages kLast<Pages> = Pages::prefaulted;

static_assert(static_cast<int>(Order::fast) == WINNOW_ORDER_FAST);
static_assert(static_cast<int>(Order::canonical) == WINNOW_ORDER_CANONICAL);
template <>
inline constexpr Order kLast<Order> = Order::canonical;

static_assert(static_cast<int>(Frustum::NearDepth::zero) == WINNOW_NEAR_DEPTH_ZERO);
static_assert(static_cast<int>(Frustum::NearDepth::minus_one) == WINNOW_NEAR_DEPTH_MINUS_ONE);
template <>
inline constexpr Frustum::NearDepth kLast<Frustum::NearDepth> = Frustum::NearDepth::minus_one;

static_assert(static_cast<int>(WorkStage::refresh) == WINNOW_STAGE_REFRESH);
static_assert(static_cast<int>(WorkStage::build) == WINNOW_STAGE_BUILD);
static_assert(static_cast<int>(WorkStage::pairs) == WINNOW_STAGE_PAIRS);
static_assert(static_cast<int>(WorkStage::mid_phase) == WINNOW_STAGE_MID_PHASE);
static_assert(static_cast<int>(WorkStage::narrow_phase) == WINNOW_STAGE_NARROW_PHASE);
static_assert(static_cast<int>(WorkStage::contacts) == WINNOW_STAGE_CONTACTS);
template <>
inline constexpr WorkStage kLast<WorkStage> = WorkStage::contacts;

static_assert(static_cast<int>(LogEntry::Kind::choice) == WINNOW_LOG_CHOICE);
static_assert(static_cast<int>(LogEntry::Kind::refusal) == WINNOW_LOG_REFUSAL);
template <>
inline constexpr LogEntry::Kind kLast<LogEntry::Kind> = LogEntry::Kind::refusal;

static_assert(static_cast<int>(Volume::aabb) == WINNOW_VOLUME_AABB);
static_assert(static_cast<int>(Volume::sphere) == WINNOW_VOLUME_SPHERE);
static_assert(static_cast<int>(Volume::kdop14) == WINNOW_VOLUME_KDOP14);
static_assert(static_cast<int>(Volume::kdop18) == WINNOW_VOLUME_KDOP18);
static_assert(static_cast<int>(Volume::kdop26) == WINNOW_VOLUME_KDOP26);
template <>
inline constexpr Volume kLast<Volume> = Volume::kdop26;

static_assert(static_cast<int>(ContactLevel::pairs) == WINNOW_LEVEL_PAIRS);
static_assert(static_cast<int>(ContactLevel::boolean) == WINNOW_LEVEL_BOOLEAN);
static_assert(static_cast<int>(ContactLevel::distance) == WINNOW_LEVEL_DISTANCE);
static_assert(static_cast<int>(ContactLevel::manifold) == WINNOW_LEVEL_MANIFOLD);
template <>
inline constexpr ContactLevel kLast<ContactLevel> = ContactLevel::manifold;

static_assert(static_cast<int>(NarrowTier::robust) == WINNOW_TIER_ROBUST);
static_assert(static_cast<int>(NarrowTier::reference) == WINNOW_TIER_REFERENCE);
template <>
inline constexpr NarrowTier kLast<NarrowTier> = NarrowTier::reference;

static_assert(static_cast<int>(BodyState::fixed) == WINNOW_BODY_STATE_FIXED);
static_assert(static_cast<int>(BodyState::dynamic) == WINNOW_BODY_STATE_DYNAMIC);
static_assert(static_cast<int>(BodyState::sleeping) == WINNOW_BODY_STATE_SLEEPING);
template <>
inline constexpr BodyState kLast<BodyState> = BodyState::sleeping;

static_assert(static_cast<int>(ContactEvent::begun) == WINNOW_EVENT_BEGUN);
static_assert(static_cast<int>(ContactEvent::persisted) == WINNOW_EVENT_PERSISTED);
template <>
inline constexpr ContactEvent kLast<ContactEvent> = ContactEvent::persisted;

static_assert(static_cast<int>(PairRules::scene) == WINNOW_PAIR_RULES_SCENE);
static_assert(static_cast<int>(PairRules::none) == WINNOW_PAIR_RULES_NONE);
template <>
inline constexpr PairRules kLast<PairRules> = PairRules::none;

static_assert(static_cast<int>(ContinuousPairs::all) == WINNOW_CONTINUOUS_ALL);
static_assert(static_cast<int>(ContinuousPairs::fixed) == WINNOW_CONTINUOUS_FIXED);
static_assert(static_cast<int>(ContinuousPairs::bullets) == WINNOW_CONTINUOUS_BULLETS);
static_assert(static_cast<int>(ContinuousPairs::bullets_and_fixed) == WINNOW_CONTINUOUS_BULLETS_AND_FIXED);
template <>
inline constexpr ContinuousPairs kLast<ContinuousPairs> = ContinuousPairs::bullets_and_fixed;

static_assert(static_cast<int>(FeaturePair::vertex_face) == WINNOW_FEATURES_VERTEX_FACE);
static_assert(static_cast<int>(FeaturePair::edge_edge) == WINNOW_FEATURES_EDGE_EDGE);
template <>
inline constexpr FeaturePair kLast<FeaturePair> = FeaturePair::edge_edge;

static_assert(kNoObject == WINNOW_NO_OBJECT);

static_assert(kAllEnvironments == WINNOW_EVERY_ENVIRONMENT);

static_assert(kWholeShape == WINNOW_WHOLE_SHAPE);

static_assert(kBodyStates == WINNOW_BODY_STATES);

static_assert(kSceneLayers == WINNOW_SCENE_LAYERS);

static_assert(kEveryLayer == WINNOW_EVERY_LAYER);

static_assert(kNoContact == WINNOW_NO_CONTACT);

static_assert(kRestColour == WINNOW_REST_COLOUR);

static_assert(kNoImpact == WINNOW_NO_IMPACT);

WINNOW_SAME_LAYOUT(winnow_bytes, Bytes)
static_assert(offsetof(winnow_bytes, used) == offsetof(Bytes, used));
static_assert(offsetof(winnow_bytes, reserved) == offsetof(Bytes, reserved));

inline void show(const Footprint& own, winnow_footprint& to) noexcept {
  put(own.bounds, to.bounds);
  put(own.keys, to.keys);
  put(own.client_data, to.client_data);
  put(own.structure, to.structure);
  put(own.scratch, to.scratch);
  put(own.results, to.results);
}

WINNOW_SAME_LAYOUT(winnow_key, Key)
static_assert(offsetof(winnow_key, id) == offsetof(Key, id));
static_assert(offsetof(winnow_key, stamp) == offsetof(Key, stamp));

WINNOW_SAME_LAYOUT(winnow_object_filter, ObjectFilter)
static_assert(offsetof(winnow_object_filter, layers) == offsetof(ObjectFilter, layers));
static_assert(offsetof(winnow_object_filter, mask) == offsetof(ObjectFilter, mask));
static_assert(offsetof(winnow_object_filter, environment) == offsetof(ObjectFilter, environment));

WINNOW_SAME_LAYOUT(winnow_aabb, Aabb)
static_assert(offsetof(winnow_aabb, min) == offsetof(Aabb, min));
static_assert(offsetof(winnow_aabb, max) == offsetof(Aabb, max));

WINNOW_SAME_LAYOUT(winnow_sphere, Sphere)
static_assert(offsetof(winnow_sphere, center) == offsetof(Sphere, center));
static_assert(offsetof(winnow_sphere, radius) == offsetof(Sphere, radius));

WINNOW_SAME_LAYOUT(winnow_capsule, Capsule)
static_assert(offsetof(winnow_capsule, a) == offsetof(Capsule, a));
static_assert(offsetof(winnow_capsule, b) == offsetof(Capsule, b));
static_assert(offsetof(winnow_capsule, radius) == offsetof(Capsule, radius));

WINNOW_SAME_LAYOUT(winnow_plane, Plane)
static_assert(offsetof(winnow_plane, normal) == offsetof(Plane, normal));
static_assert(offsetof(winnow_plane, offset) == offsetof(Plane, offset));

WINNOW_SAME_LAYOUT(winnow_frustum, Frustum)
static_assert(offsetof(winnow_frustum, planes) == offsetof(Frustum, planes));
static_assert(offsetof(winnow_frustum, bounds) == offsetof(Frustum, bounds));

WINNOW_SAME_LAYOUT(winnow_pose, Pose)
static_assert(offsetof(winnow_pose, position) == offsetof(Pose, position));
static_assert(offsetof(winnow_pose, orientation) == offsetof(Pose, orientation));

[[nodiscard]] inline bool read(const winnow_debug_draw_options* given, DebugDrawOptions& options) noexcept {
  winnow_debug_draw_options own{};
  return read_sized(given, own) &&
         take_off(own.leave_out_objects, options.objects) &&
         take_off(own.leave_out_structure, options.structure) &&
         take(own.labels, options.labels) &&
         take(own.max_depth, options.max_depth);
}

WINNOW_SAME_LAYOUT(winnow_pair, Pair)
static_assert(offsetof(winnow_pair, first) == offsetof(Pair, first));
static_assert(offsetof(winnow_pair, second) == offsetof(Pair, second));

WINNOW_SAME_LAYOUT(winnow_key_pair, KeyPair)
static_assert(offsetof(winnow_key_pair, first) == offsetof(KeyPair, first));
static_assert(offsetof(winnow_key_pair, second) == offsetof(KeyPair, second));

WINNOW_SAME_LAYOUT(winnow_client_data_pair, ClientDataPair)
static_assert(offsetof(winnow_client_data_pair, first) == offsetof(ClientDataPair, first));
static_assert(offsetof(winnow_client_data_pair, second) == offsetof(ClientDataPair, second));

WINNOW_SAME_LAYOUT(winnow_hit, Hit)
static_assert(offsetof(winnow_hit, key) == offsetof(Hit, key));
static_assert(offsetof(winnow_hit, data) == offsetof(Hit, data));
static_assert(offsetof(winnow_hit, t) == offsetof(Hit, t));

WINNOW_SAME_LAYOUT(winnow_fat_margin, FatMargin)
static_assert(offsetof(winnow_fat_margin, distance) == offsetof(FatMargin, distance));
static_assert(offsetof(winnow_fat_margin, share) == offsetof(FatMargin, share));

template <>
inline constexpr std::size_t kFirstSize<winnow_partition_options> =
    offsetof(winnow_partition_options, build_budget) + sizeof(winnow_partition_options::build_budget);
[[nodiscard]] inline bool read(const winnow_partition_options* given, PartitionOptions& options) noexcept {
  winnow_partition_options own{};
  return read_sized(given, own) &&
         take(own.execution, options.execution) &&
         take(own.volume, options.volume) &&
         take(own.fat_margin, options.fat_margin) &&
         take(own.build_budget, options.build_budget) &&
         take(own.recorder, options.recorder);
}

inline void show(const StructureChoice& own, winnow_structure_choice& to) noexcept {
  put(own.structure, to.structure);
  put(own.reason, to.reason);
  put(own.changes, to.changes);
  put(own.features.objects, to.objects);
  put(own.features.room, to.room);
  put(own.features.size_spread, to.size_spread);
  put(own.features.crowding, to.crowding);
  put(own.features.pairs, to.pairs);
}

[[nodiscard]] inline bool read(const winnow_pair_options* given, PairOptions& options) noexcept {
  winnow_pair_options own{};
  return read_sized(given, own) &&
         take(own.order, options.order) &&
         take_off(own.anew, options.incremental) &&
         take(own.accept, options.predicate.accept) &&
         take(own.context, options.predicate.context);
}

inline void show(const Statistics& own, winnow_statistics& to) noexcept {
  put(own.objects, to.objects);
  put(own.regular, to.regular);
  put(own.irregular, to.irregular);
  put(own.cells, to.cells);
  put(own.depth, to.depth);
  put(own.levels, to.levels);
  put(own.builds, to.builds);
  put(own.planned_builds, to.planned_builds);
  put(own.refits, to.refits);
  put(own.full_queries, to.full_queries);
  put(own.incremental_queries, to.incremental_queries);
  put(own.last_tests, to.last_tests);
  put(own.last_pairs, to.last_pairs);
}

WINNOW_SAME_LAYOUT(winnow_hull_face, HullFace)
static_assert(offsetof(winnow_hull_face, normal) == offsetof(HullFace, normal));
static_assert(offsetof(winnow_hull_face, offset) == offsetof(HullFace, offset));
static_assert(offsetof(winnow_hull_face, first) == offsetof(HullFace, first));
static_assert(offsetof(winnow_hull_face, count) == offsetof(HullFace, count));

inline void show(const HullShape& own, winnow_hull& to) noexcept {
  put(own.vertex_count, to.vertices);
  put(own.face_count, to.faces);
  put(own.dimension, to.dimension);
  put(own.rounding, to.rounding);
  put(own.center, to.center);
  put(own.radius, to.radius);
  for (int axis = 0; axis < 3; ++axis) put(own.vertex[axis], to.vertex[axis]);
  put(own.faces, to.face);
  put(own.loop, to.loop);
}

WINNOW_SAME_LAYOUT(winnow_shape_ray, ShapeRay)
static_assert(offsetof(winnow_shape_ray, origin) == offsetof(ShapeRay, origin));
static_assert(offsetof(winnow_shape_ray, direction) == offsetof(ShapeRay, direction));
static_assert(offsetof(winnow_shape_ray, min_t) == offsetof(ShapeRay, min_t));
static_assert(offsetof(winnow_shape_ray, max_t) == offsetof(ShapeRay, max_t));

inline void show(const ShapeHit& own, winnow_shape_hit& to) noexcept {
  put(own.hit, to.hit);
  put(own.t, to.t);
  put(own.normal, to.normal);
}

[[nodiscard]] inline bool read(const winnow_mesh_options* given, MeshOptions& options) noexcept {
  winnow_mesh_options own{};
  return read_sized(given, own) &&
         take(own.active_edge_angle, options.active_edge_angle);
}

WINNOW_SAME_LAYOUT(winnow_compound_child, CompoundChild)
static_assert(offsetof(winnow_compound_child, shape) == offsetof(CompoundChild, shape));
static_assert(offsetof(winnow_compound_child, pose) == offsetof(CompoundChild, pose));

WINNOW_SAME_LAYOUT(winnow_body_pair, BodyPair)
static_assert(offsetof(winnow_body_pair, a) == offsetof(BodyPair, a));
static_assert(offsetof(winnow_body_pair, b) == offsetof(BodyPair, b));

WINNOW_SAME_LAYOUT(winnow_run, ContactRun)
static_assert(offsetof(winnow_run, kind_a) == offsetof(ContactRun, kind_a));
static_assert(offsetof(winnow_run, kind_b) == offsetof(ContactRun, kind_b));
static_assert(offsetof(winnow_run, first) == offsetof(ContactRun, first));
static_assert(offsetof(winnow_run, count) == offsetof(ContactRun, count));
WINNOW_ALSO_SAME_LAYOUT(winnow_run, NarrowRun)

inline void show(const NarrowResult& own, winnow_narrow_columns& to) noexcept {
  put(own.level(), to.level);
  put(own.size(), to.answers);
  put(own.order(), to.pair_of);
  put(own.runs(), to.runs);
  put(own.runs().size(), to.run_count);
  put(own.overlap(), to.overlap);
  put(own.distance(), to.distance);
  put(own.error_bound(), to.error_bound);
  for (int axis = 0; axis < 3; ++axis) put(own.normal(axis), to.normal[axis]);
  for (int axis = 0; axis < 3; ++axis) put(own.point(axis), to.point[axis]);
  put(own.contact_first(), to.contact_first);
  put(own.contact_count(), to.contact_count);
  put(own.contacts(), to.contacts);
  for (int axis = 0; axis < 3; ++axis) put(own.contact_columns().position[axis], to.position[axis]);
  put(own.contact_columns().depth, to.depth);
  put(own.contact_columns().feature, to.feature);
}

template <>
inline constexpr std::size_t kFirstSize<winnow_narrow_options> =
    offsetof(winnow_narrow_options, execution) + sizeof(winnow_narrow_options::execution);
[[nodiscard]] inline bool read(const winnow_narrow_options* given, NarrowOptions& options, std::size_t count) noexcept {
  winnow_narrow_options own{};
  return read_sized(given, own) &&
         take(own.level, options.level) &&
         take(own.tier, options.tier) &&
         take(own.contact_margin, options.contact_margin) &&
         take(own.execution, options.execution) &&
         take(own.contact_margins, count, options.contact_margins);
}

inline void show(const NarrowStatistics& own, winnow_narrow_statistics& to) noexcept {
  put(own.pairs, to.pairs);
  put(own.recomputed, to.recomputed);
  put(own.without_lanes, to.without_lanes);
  put(own.exact, to.exact);
  put(own.bounded, to.bounded);
}

WINNOW_SAME_LAYOUT(winnow_contact_point, ContactPoint)
static_assert(offsetof(winnow_contact_point, position) == offsetof(ContactPoint, position));
static_assert(offsetof(winnow_contact_point, depth) == offsetof(ContactPoint, depth));
static_assert(offsetof(winnow_contact_point, feature) == offsetof(ContactPoint, feature));

WINNOW_SAME_LAYOUT(winnow_pair_answer, PairAnswer)
static_assert(offsetof(winnow_pair_answer, distance) == offsetof(PairAnswer, distance));
static_assert(offsetof(winnow_pair_answer, error_bound) == offsetof(PairAnswer, error_bound));
static_assert(offsetof(winnow_pair_answer, normal) == offsetof(PairAnswer, normal));
static_assert(offsetof(winnow_pair_answer, point) == offsetof(PairAnswer, point));
static_assert(offsetof(winnow_pair_answer, overlap) == offsetof(PairAnswer, overlap));
static_assert(offsetof(winnow_pair_answer, contact_count) == offsetof(PairAnswer, contact_count));
static_assert(offsetof(winnow_pair_answer, contacts) == offsetof(PairAnswer, contacts));

WINNOW_SAME_LAYOUT(winnow_rigid_motion, RigidMotion)
static_assert(offsetof(winnow_rigid_motion, start) == offsetof(RigidMotion, start));
static_assert(offsetof(winnow_rigid_motion, travel) == offsetof(RigidMotion, travel));
static_assert(offsetof(winnow_rigid_motion, turn) == offsetof(RigidMotion, turn));

[[nodiscard]] inline bool read(const winnow_impact_options* given, ImpactOptions& options) noexcept {
  winnow_impact_options own{};
  return read_sized(given, own) &&
         take(own.tolerance, options.tolerance) &&
         take(own.composites, options.composites) &&
         take(own.execution, options.execution);
}

inline void show(const ImpactResult& own, winnow_impact_columns& to) noexcept {
  put(own.size(), to.answers);
  put(own.status(), to.status);
  put(own.hit(), to.hit);
  put(own.time(), to.time);
  put(own.gap(), to.gap);
  put(own.error_bound(), to.error_bound);
  for (int axis = 0; axis < 3; ++axis) put(own.normal(axis), to.normal[axis]);
  for (int axis = 0; axis < 3; ++axis) put(own.point(axis), to.point[axis]);
  put(own.part_a(), to.part_a);
  put(own.part_b(), to.part_b);
}

template <>
inline constexpr std::size_t kFirstSize<winnow_scene_options> =
    offsetof(winnow_scene_options, composites) + sizeof(winnow_scene_options::composites);
[[nodiscard]] inline bool read(const winnow_scene_options* given, SceneOptions& options) noexcept {
  winnow_scene_options own{};
  return read_sized(given, own) &&
         take(own.execution, options.execution) &&
         take(own.structures, options.structures) &&
         take(own.contact_margin, options.contact_margin) &&
         take(own.tier, options.tier) &&
         take(own.part_manifolds, options.part_manifolds) &&
         take(own.cache_tolerance, options.cache_tolerance) &&
         take(own.build_budget, options.build_budget) &&
         take(own.composites, options.composites) &&
         take(own.suppress_ghost_contacts, options.suppress_ghost_contacts) &&
         take(own.warm_start, options.warm_start) &&
         take(own.recorder, options.recorder);
}

WINNOW_SAME_LAYOUT(winnow_contact_offsets, ContactOffsets)
static_assert(offsetof(winnow_contact_offsets, contact) == offsetof(ContactOffsets, contact));
static_assert(offsetof(winnow_contact_offsets, rest) == offsetof(ContactOffsets, rest));

WINNOW_SAME_LAYOUT(winnow_body_definition, BodyDefinition)
static_assert(offsetof(winnow_body_definition, shape) == offsetof(BodyDefinition, shape));
static_assert(offsetof(winnow_body_definition, pose) == offsetof(BodyDefinition, pose));
static_assert(offsetof(winnow_body_definition, state) == offsetof(BodyDefinition, state));
static_assert(offsetof(winnow_body_definition, filter) == offsetof(BodyDefinition, filter));
static_assert(offsetof(winnow_body_definition, data) == offsetof(BodyDefinition, data));
static_assert(offsetof(winnow_body_definition, offsets) == offsetof(BodyDefinition, offsets));
static_assert(offsetof(winnow_body_definition, layer) == offsetof(BodyDefinition, layer));

WINNOW_SAME_LAYOUT(winnow_ended_contact, EndedContact)
static_assert(offsetof(winnow_ended_contact, a) == offsetof(EndedContact, a));
static_assert(offsetof(winnow_ended_contact, b) == offsetof(EndedContact, b));
static_assert(offsetof(winnow_ended_contact, data_a) == offsetof(EndedContact, data_a));
static_assert(offsetof(winnow_ended_contact, data_b) == offsetof(EndedContact, data_b));

template <>
inline constexpr std::size_t kFirstSize<winnow_contact_columns> =
    offsetof(winnow_contact_columns, feature) + sizeof(winnow_contact_columns::feature);
inline void show(const winnow_contacts& own, winnow_contact_columns& to) noexcept {
  put(own.value.level(), to.level);
  put(own.value.size(), to.pairs);
  put(own.value.a(), to.a);
  put(own.value.b(), to.b);
  put(own.data[0], to.data_a);
  put(own.data[1], to.data_b);
  put(own.value.event(), to.event);
  put(own.value.runs(), to.runs);
  put(own.value.runs().size(), to.run_count);
  put(own.value.ended(), to.ended);
  put(own.value.ended().size(), to.ended_count);
  put(own.value.cached_pairs(), to.cached_pairs);
  put(own.value.manifold_first(), to.manifold_first);
  put(own.value.manifolds(), to.manifolds);
  put(own.parts(own.value.part_a()), to.part_a);
  put(own.parts(own.value.part_b()), to.part_b);
  put(own.value.distance(), to.distance);
  put(own.value.error_bound(), to.error_bound);
  for (int axis = 0; axis < 3; ++axis) put(own.value.normal(axis), to.normal[axis]);
  for (int axis = 0; axis < 3; ++axis) put(own.value.point(axis), to.point[axis]);
  put(own.value.point_first(), to.point_first);
  put(own.value.points(), to.points);
  for (int axis = 0; axis < 3; ++axis) put(own.value.contact_columns().position[axis], to.position[axis]);
  put(own.value.contact_columns().depth, to.depth);
  put(own.value.contact_columns().feature, to.feature);
  put(own.value.previous_pair(), to.previous_pair);
  put(own.value.previous_point(), to.previous_point);
}

[[nodiscard]] inline bool read(const winnow_scene_room* given, SceneCapacity& options) noexcept {
  winnow_scene_room own{};
  return given != nullptr && read_sized(given, own) &&
         take(own.bodies, options.bodies) &&
         take(own.pairs, options.pairs) &&
         set(own.level, options.level) &&
         take(own.touching, options.touching) &&
         take(own.manifolds, options.manifolds) &&
         take(own.points, options.points);
}

inline void show(const winnow_scene& own, winnow_scene_bytes& to) noexcept {
  put(own.body_bytes(), to.bodies);
  put(own.value.footprint().partitions, to.partitions);
  put(own.value.footprint().pairs, to.pairs);
  put(own.value.footprint().mid_phase, to.mid_phase);
  put(own.value.footprint().narrow_phase, to.narrow_phase);
}

template <>
inline constexpr std::size_t kFirstSize<winnow_scene_counts> =
    offsetof(winnow_scene_counts, rejected_by_spheres) + sizeof(winnow_scene_counts::rejected_by_spheres);
inline void show(const SceneStatistics& own, winnow_scene_counts& to) noexcept {
  put(own.boxes_updated, to.boxes_updated);
  put(own.body_pairs, to.body_pairs);
  put(own.cached_pairs, to.cached_pairs);
  put(own.primitive_pairs, to.primitive_pairs);
  put(own.convex.pairs, to.convex_pairs);
  put(own.convex.recomputed, to.convex_recomputed);
  put(own.convex.exact, to.convex_exact);
  put(own.parts.pairs, to.part_pairs);
  put(own.parts.recomputed, to.part_recomputed);
  put(own.parts.exact, to.part_exact);
  put(own.rejected_by_spheres, to.rejected_by_spheres);
  put(own.convex.without_lanes, to.convex_without_lanes);
  put(own.convex.bounded, to.convex_bounded);
  put(own.parts.without_lanes, to.part_without_lanes);
  put(own.parts.bounded, to.part_bounded);
}

WINNOW_SAME_LAYOUT(winnow_scene_hit, SceneHit)
static_assert(offsetof(winnow_scene_hit, key) == offsetof(SceneHit, key));
static_assert(offsetof(winnow_scene_hit, data) == offsetof(SceneHit, data));
static_assert(offsetof(winnow_scene_hit, part) == offsetof(SceneHit, part));
static_assert(offsetof(winnow_scene_hit, t) == offsetof(SceneHit, t));
static_assert(offsetof(winnow_scene_hit, normal) == offsetof(SceneHit, normal));
static_assert(offsetof(winnow_scene_hit, point) == offsetof(SceneHit, point));

WINNOW_SAME_LAYOUT(winnow_scene_crossing, SceneCrossing)
static_assert(offsetof(winnow_scene_crossing, key) == offsetof(SceneCrossing, key));
static_assert(offsetof(winnow_scene_crossing, data) == offsetof(SceneCrossing, data));
static_assert(offsetof(winnow_scene_crossing, part) == offsetof(SceneCrossing, part));
static_assert(offsetof(winnow_scene_crossing, t) == offsetof(SceneCrossing, t));
static_assert(offsetof(winnow_scene_crossing, exits) == offsetof(SceneCrossing, exits));
static_assert(offsetof(winnow_scene_crossing, normal) == offsetof(SceneCrossing, normal));
static_assert(offsetof(winnow_scene_crossing, point) == offsetof(SceneCrossing, point));
static_assert(offsetof(winnow_scene_crossing, barycentric) == offsetof(SceneCrossing, barycentric));

WINNOW_SAME_LAYOUT(winnow_scene_overlap, SceneOverlap)
static_assert(offsetof(winnow_scene_overlap, key) == offsetof(SceneOverlap, key));
static_assert(offsetof(winnow_scene_overlap, data) == offsetof(SceneOverlap, data));
static_assert(offsetof(winnow_scene_overlap, part) == offsetof(SceneOverlap, part));

WINNOW_SAME_LAYOUT(winnow_scene_distance, SceneDistance)
static_assert(offsetof(winnow_scene_distance, key) == offsetof(SceneDistance, key));
static_assert(offsetof(winnow_scene_distance, data) == offsetof(SceneDistance, data));
static_assert(offsetof(winnow_scene_distance, part_a) == offsetof(SceneDistance, part_a));
static_assert(offsetof(winnow_scene_distance, part) == offsetof(SceneDistance, part));
static_assert(offsetof(winnow_scene_distance, distance) == offsetof(SceneDistance, distance));
static_assert(offsetof(winnow_scene_distance, error_bound) == offsetof(SceneDistance, error_bound));
static_assert(offsetof(winnow_scene_distance, normal) == offsetof(SceneDistance, normal));
static_assert(offsetof(winnow_scene_distance, point_a) == offsetof(SceneDistance, point_a));
static_assert(offsetof(winnow_scene_distance, point_b) == offsetof(SceneDistance, point_b));

WINNOW_SAME_LAYOUT(winnow_set_distance, SetDistance)
static_assert(offsetof(winnow_set_distance, a) == offsetof(SetDistance, a));
static_assert(offsetof(winnow_set_distance, data_a) == offsetof(SetDistance, data_a));
static_assert(offsetof(winnow_set_distance, to) == offsetof(SetDistance, to));

[[nodiscard]] inline bool read(const winnow_continuous_options* given, ContinuousOptions& options, std::size_t count) noexcept {
  winnow_continuous_options own{};
  return read_sized(given, own) &&
         take(own.pairs, options.pairs) &&
         take_off(own.leave_out_touching, options.touching) &&
         take(own.first_only, options.first_only) &&
         take(own.tolerance, options.tolerance) &&
         take(own.bullets, count, options.bullets);
}

WINNOW_SAME_LAYOUT(winnow_scene_impact, SceneImpact)
static_assert(offsetof(winnow_scene_impact, a) == offsetof(SceneImpact, a));
static_assert(offsetof(winnow_scene_impact, b) == offsetof(SceneImpact, b));
static_assert(offsetof(winnow_scene_impact, data_a) == offsetof(SceneImpact, data_a));
static_assert(offsetof(winnow_scene_impact, data_b) == offsetof(SceneImpact, data_b));
static_assert(offsetof(winnow_scene_impact, part_a) == offsetof(SceneImpact, part_a));
static_assert(offsetof(winnow_scene_impact, part_b) == offsetof(SceneImpact, part_b));
static_assert(offsetof(winnow_scene_impact, time) == offsetof(SceneImpact, time));
static_assert(offsetof(winnow_scene_impact, gap) == offsetof(SceneImpact, gap));
static_assert(offsetof(winnow_scene_impact, error_bound) == offsetof(SceneImpact, error_bound));
static_assert(offsetof(winnow_scene_impact, normal) == offsetof(SceneImpact, normal));
static_assert(offsetof(winnow_scene_impact, point) == offsetof(SceneImpact, point));

inline void show(const ContinuousStatistics& own, winnow_continuous_statistics& to) noexcept {
  put(own.boxes, to.boxes);
  put(own.body_pairs, to.body_pairs);
}

WINNOW_SAME_LAYOUT(winnow_sensor_definition, SensorDefinition)
static_assert(offsetof(winnow_sensor_definition, shape) == offsetof(SensorDefinition, shape));
static_assert(offsetof(winnow_sensor_definition, pose) == offsetof(SensorDefinition, pose));
static_assert(offsetof(winnow_sensor_definition, filter) == offsetof(SensorDefinition, filter));
static_assert(offsetof(winnow_sensor_definition, carrier) == offsetof(SensorDefinition, carrier));
static_assert(offsetof(winnow_sensor_definition, layer) == offsetof(SensorDefinition, layer));
static_assert(offsetof(winnow_sensor_definition, data) == offsetof(SensorDefinition, data));

WINNOW_SAME_LAYOUT(winnow_sensed_body, SensedBody)
static_assert(offsetof(winnow_sensed_body, sensor) == offsetof(SensedBody, sensor));
static_assert(offsetof(winnow_sensed_body, body) == offsetof(SensedBody, body));
static_assert(offsetof(winnow_sensed_body, sensor_data) == offsetof(SensedBody, sensor_data));
static_assert(offsetof(winnow_sensed_body, body_data) == offsetof(SensedBody, body_data));
static_assert(offsetof(winnow_sensed_body, event) == offsetof(SensedBody, event));

WINNOW_SAME_LAYOUT(winnow_left_sensor, ExitedBody)
static_assert(offsetof(winnow_left_sensor, sensor) == offsetof(ExitedBody, sensor));
static_assert(offsetof(winnow_left_sensor, body) == offsetof(ExitedBody, body));
static_assert(offsetof(winnow_left_sensor, sensor_data) == offsetof(ExitedBody, sensor_data));
static_assert(offsetof(winnow_left_sensor, body_data) == offsetof(ExitedBody, body_data));

[[nodiscard]] inline bool read(const winnow_deformable_mesh_options* given, DeformableMeshOptions& options) noexcept {
  winnow_deformable_mesh_options own{};
  return read_sized(given, own) &&
         take(own.execution, options.execution) &&
         take(own.origin, options.origin) &&
         take(own.chunk, options.chunk);
}

[[nodiscard]] inline bool read(const winnow_feature_impact_options* given, FeatureImpactOptions& options) noexcept {
  winnow_feature_impact_options own{};
  return read_sized(given, own) &&
         take(own.min_separation, options.min_separation) &&
         take(own.tolerance, options.tolerance) &&
         take(own.max_intervals, options.max_intervals);
}

WINNOW_SAME_LAYOUT(winnow_mesh_impact, MeshImpact)
static_assert(offsetof(winnow_mesh_impact, features) == offsetof(MeshImpact, features));
static_assert(offsetof(winnow_mesh_impact, time) == offsetof(MeshImpact, time));

WINNOW_SAME_LAYOUT(winnow_mesh_proximity, MeshProximity)
static_assert(offsetof(winnow_mesh_proximity, features) == offsetof(MeshProximity, features));
static_assert(offsetof(winnow_mesh_proximity, distance) == offsetof(MeshProximity, distance));
static_assert(offsetof(winnow_mesh_proximity, point) == offsetof(MeshProximity, point));
static_assert(offsetof(winnow_mesh_proximity, weight) == offsetof(MeshProximity, weight));

WINNOW_SAME_LAYOUT(winnow_mesh_shape_impact, MeshShapeImpact)
static_assert(offsetof(winnow_mesh_shape_impact, face) == offsetof(MeshShapeImpact, face));
static_assert(offsetof(winnow_mesh_shape_impact, part) == offsetof(MeshShapeImpact, part));
static_assert(offsetof(winnow_mesh_shape_impact, time) == offsetof(MeshShapeImpact, time));
static_assert(offsetof(winnow_mesh_shape_impact, gap) == offsetof(MeshShapeImpact, gap));
static_assert(offsetof(winnow_mesh_shape_impact, error_bound) == offsetof(MeshShapeImpact, error_bound));
static_assert(offsetof(winnow_mesh_shape_impact, normal) == offsetof(MeshShapeImpact, normal));
static_assert(offsetof(winnow_mesh_shape_impact, point) == offsetof(MeshShapeImpact, point));

WINNOW_SAME_LAYOUT(winnow_feature_hit, FeatureImpact)
static_assert(offsetof(winnow_feature_hit, hit) == offsetof(FeatureImpact, hit));
static_assert(offsetof(winnow_feature_hit, time) == offsetof(FeatureImpact, time));

}  // namespace winnow::c
