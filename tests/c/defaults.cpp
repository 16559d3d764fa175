// Prints the C++ defaults of all structs that callers pass, one line "Struct.member = value" for
// each member; test_defaults.py compares them with Python. Fails if C has other defaults, whether
// they come from a macro or, for options, from zeros or a null pointer. Does not compile if a C++
// struct gets a member that is not listed here.

#include <winnow/c/winnow.h>
#include <winnow/core/rays.h>
#include <winnow/pipeline/cluster.h>
#include <winnow/pipeline/cluster_scene.h>
#include <winnow/pipeline/deformable_mesh.h>
#include <winnow/pipeline/impacts.h>
#include <winnow/pipeline/scene_queries.h>
#include <winnow/pipeline/sensors.h>
#include "pipeline/c/binding/structs.h"

#include <cstdio>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace winnow {
namespace {

// Formats members as Python literals.

std::string text(bool value) {
  return value ? "True" : "False";
}
template <typename Number>
requires std::is_arithmetic_v<Number> std::string text(Number value) {
  char room[64];
  (void)std::snprintf(room, sizeof room, "%.17g", static_cast<double>(value));
  return room;
}
std::string quoted(std::string_view name) {
  std::string all(1, '\'');
  return all.append(name).append(1, '\'');
}
std::string named(std::size_t which, std::initializer_list<const char*> names) {
  return quoted(which < names.size() ? names.begin()[which] : "none of them");
}
std::string text(ContactLevel level) {
  return named(static_cast<std::size_t>(level), {"pairs", "boolean", "distance", "manifold"});
}
std::string text(NarrowTier tier) {
  return named(static_cast<std::size_t>(tier), {"robust", "reference"});
}
std::string text(BodyState state) {
  return named(static_cast<std::size_t>(state), {"fixed", "dynamic", "sleeping"});
}
std::string text(Order order) {
  return named(static_cast<std::size_t>(order), {"fast", "canonical"});
}
std::string text(Volume volume) {
  return named(static_cast<std::size_t>(volume), {"aabb", "sphere", "kdop14", "kdop18", "kdop26"});
}
std::string text(ContinuousPairs pairs) {
  return named(static_cast<std::size_t>(pairs), {"all", "fixed", "bullets", "bullets_and_fixed"});
}
std::string text(const Execution& execution) {
  if (execution == Execution::serial()) return "'serial'";
  return execution == Execution::parallel() ? "'parallel'" : "'jobs'";
}
std::string text(const StructureKind& kind) {
  return quoted(kind.name()) + " of " + text(kind.parameter());
}
std::string text(ShapeId id) {
  return text(id.bits);
}
std::string text(Key key) {
  return text(key.id) + " " + text(key.stamp);
}
std::string text(std::pmr::memory_resource* const& memory) {
  return memory == default_memory() ? "'default'" : "'another'";
}
/// Prints only whether the pointer is null.
template <typename Pointer>
requires std::is_pointer_v<Pointer> std::string text(const Pointer& pointer) {
  return pointer == nullptr ? "None" : "'something'";
}
template <typename T>
std::string text(std::span<const T> values) {
  return values.empty() ? "None" : "'something'";
}
std::string text(const PairPredicate& predicate) {
  return text(reinterpret_cast<const char*>(predicate.accept)) + text(predicate.context);
}
std::string text(const ObjectPredicate& predicate) {
  return text(reinterpret_cast<const char*>(predicate.accept)) + text(predicate.context);
}
template <typename T, std::size_t N>
std::string text(const T (&values)[N]) {
  std::string all;
  for (const T& value : values) all += (all.empty() ? "[" : ", ") + text(value);
  return all + "]";
}
std::string text(const Vec3d& v) {
  const double numbers[] = {v.x(), v.y(), v.z()};
  return text(numbers);
}
std::string text(const Pose& pose) {
  return text(pose.position) + text(pose.orientation);
}

/// Members by name, in order.
using Members = std::vector<std::pair<std::string, std::string>>;

/// Returns the members with their names from the list, in order.
template <typename... Given>
Members list(std::string_view names, const Given&... given) {
  Members members;
  const auto put = [&](const auto& value) {
    const std::size_t end = names.find(' ');
    members.emplace_back(names.substr(0, end), text(value));
    names = end == std::string_view::npos ? std::string_view() : names.substr(end + 1);
  };
  (put(given), ...);
  return members;
}

Members members(const ObjectFilter& o) {
  const auto& [layers, mask, environment] = o;
  return list("layers mask environment", layers, mask, environment);
}
Members members(const Filter& o) {
  const auto& [layers, mask, environment, predicate] = o;
  return list("layers mask environment predicate", layers, mask, environment, predicate);
}
Members members(const SceneFilter& o) {
  const auto& [layers, mask, environment, layer, ignored, predicate] = o;
  return list("layers mask environment layer ignored predicate", layers, mask, environment, layer,
              ignored, predicate);
}
Members members(const PartitionOptions& o) {
  const auto& [memory, execution, volume, fat_margin, build_budget, recorder] = o;
  return list("memory execution volume fat_margin fat_margin_share build_budget recorder", memory,
              execution, volume, fat_margin.distance, fat_margin.share, build_budget, recorder);
}
Members members(const PairOptions& o) {
  const auto& [order, incremental, predicate] = o;
  return list("order incremental predicate", order, incremental, predicate);
}
Members members(const DebugDrawOptions& o) {
  const auto& [objects, structure, labels, max_depth] = o;
  return list("objects structure labels max_depth", objects, structure, labels, max_depth);
}
Members members(const SceneOptions& o) {
  const auto& [memory, execution, structures, contact_margin, tier, cache_tolerance, part_manifolds,
               suppress_ghost_contacts, warm_start, build_budget, composites, recorder] = o;
  return list(
      "memory execution structures contact_margin tier cache_tolerance part_manifolds "
      "suppress_ghost_contacts "
      "warm_start build_budget composites recorder",
      memory, execution, structures, contact_margin, tier, cache_tolerance, part_manifolds,
      suppress_ghost_contacts, warm_start, build_budget, composites, recorder);
}
Members members(const NarrowOptions& o) {
  const auto& [level, tier, contact_margin, execution, contact_margins] = o;
  return list("level tier contact_margin execution contact_margins", level, tier, contact_margin,
              execution, contact_margins);
}
Members members(const ImpactOptions& o) {
  const auto& [tolerance, execution, composites] = o;
  return list("tolerance execution composites", tolerance, execution, composites);
}
Members members(const ContinuousOptions& o) {
  const auto& [pairs, bullets, tolerance, touching, first_only] = o;
  return list("pairs bullets tolerance touching first_only", pairs, bullets, tolerance, touching,
              first_only);
}
Members members(const MeshOptions& o) {
  const auto& [active_edge_angle] = o;
  return list("active_edge_angle", active_edge_angle);
}
Members members(const FeatureImpactOptions& o) {
  const auto& [min_separation, tolerance, max_intervals] = o;
  return list("min_separation tolerance max_intervals", min_separation, tolerance, max_intervals);
}
Members members(const DeformableMeshOptions& o) {
  const auto& [memory, execution, origin, chunk] = o;
  return list("memory execution origin chunk", memory, execution, origin, chunk);
}
Members members(const PairEventsOptions& o) {
  const auto& [memory, client_data] = o;
  return list("memory client_data", memory, client_data);
}
Members members(const ClusterOptions& o) {
  const auto& [memory, execution, structure, imbalance] = o;
  return list("memory execution structure imbalance", memory, execution, structure, imbalance);
}
Members members(const BodyDefinition& o) {
  const auto& [shape, pose, state, filter, data, offsets, layer] = o;
  return list("shape pose state layers mask environment data contact rest layer", shape, pose,
              state, filter.layers, filter.mask, filter.environment, data, offsets.contact,
              offsets.rest, layer);
}
Members members(const SensorDefinition& o) {
  const auto& [shape, pose, filter, carrier, layer, data] = o;
  return list("shape pose layers mask environment carrier layer data", shape, pose, filter.layers,
              filter.mask, filter.environment, carrier, layer, data);
}
Members members(const SceneCapacity& o) {
  const auto& [bodies, pairs, level, touching, manifolds, points] = o;
  return list("bodies pairs level touching manifolds points", bodies, pairs, level, touching,
              manifolds, points);
}
Members members(const ShapeRay& o) {
  const auto& [origin, direction, min_t, max_t] = o;
  return list("origin direction min_t max_t", origin, direction, min_t, max_t);
}
Members members(const ShapeCast& o) {
  const auto& [shape, pose, direction, max_t, touching] = o;
  return list("shape pose direction max_t touching", shape, pose, direction, max_t, touching);
}
Members members(const HeightSamples& o) {
  const auto& [heights, columns, rows, row_stride, spacing] = o;
  return list("heights columns rows row_stride spacing", heights, columns, rows, row_stride,
              spacing);
}

int differences = 0;

/// Prints a struct with its C++ values, and reports the members that differ in C.
template <typename OfCpp>
void show(const char* name, const OfCpp& of_cpp,
          std::initializer_list<std::pair<const char*, OfCpp>> of_c = {}) {
  const Members own = members(of_cpp);
  for (std::size_t i = 0; i < own.size(); ++i) {
    std::printf("%s.%s = %s\n", name, own[i].first.c_str(), own[i].second.c_str());
    for (const auto& [how, other] : of_c) {
      const std::string c_value = members(other)[i].second;
      if (c_value == own[i].second) continue;
      ++differences;
      (void)std::fprintf(stderr, "%s.%s is %s in C++, %s by %s of C\n", name, own[i].first.c_str(),
                         own[i].second.c_str(), c_value.c_str(), how);
    }
  }
}

/// Prints the default options of C++, and reports members that differ if the C calls read options
/// from zeros, null or the macro. read(given, options) returns true if `given` is valid.
template <typename Options, typename OfC, typename Read>
void show_options(const char* name, const OfC& macro, Read&& read) {
  OfC zeroed{};
  zeroed.size = sizeof zeroed;
  Options by_zeros;
  Options by_macro;
  Options by_null;
  if (!read(&zeroed, by_zeros) || !read(&macro, by_macro) || !read(nullptr, by_null)) {
    ++differences;
    (void)std::fprintf(stderr, "%s: what C has by default is refused\n", name);
  }
  show(name, Options{}, {{"zeros", by_zeros}, {"macro", by_macro}, {"null", by_null}});
}

/// Options that C reads without a number of elements.
template <typename Options, typename OfC>
void show_plain_options(const char* name, const OfC& macro) {
  show_options<Options>(name, macro,
                        [](const OfC* given, Options& options) { return c::read(given, options); });
}

/// Options with an array that has as many elements as an argument of the call.
template <typename Options, typename OfC>
void show_counted_options(const char* name, const OfC& macro) {
  show_options<Options>(
      name, macro, [](const OfC* given, Options& options) { return c::read(given, options, 0); });
}

void show_all_options() {
  const winnow_partition_options partition = WINNOW_PARTITION_OPTIONS;
  show_plain_options<PartitionOptions>("PartitionOptions", partition);
  const winnow_pair_options pair = WINNOW_PAIR_OPTIONS;
  show_plain_options<PairOptions>("PairOptions", pair);
  const winnow_debug_draw_options draw = WINNOW_DEBUG_DRAW_OPTIONS;
  show_plain_options<DebugDrawOptions>("DebugDrawOptions", draw);
  const winnow_scene_options scene = WINNOW_SCENE_OPTIONS;
  show_plain_options<SceneOptions>("SceneOptions", scene);
  const winnow_narrow_options narrow = WINNOW_NARROW_OPTIONS;
  show_counted_options<NarrowOptions>("NarrowOptions", narrow);
  const winnow_impact_options impact = WINNOW_IMPACT_OPTIONS;
  show_plain_options<ImpactOptions>("ImpactOptions", impact);
  const winnow_continuous_options continuous = WINNOW_CONTINUOUS_OPTIONS;
  show_counted_options<ContinuousOptions>("ContinuousOptions", continuous);
  const winnow_mesh_options mesh = WINNOW_MESH_OPTIONS;
  show_plain_options<MeshOptions>("MeshOptions", mesh);
  const winnow_feature_impact_options feature = WINNOW_FEATURE_IMPACT_OPTIONS;
  show_plain_options<FeatureImpactOptions>("FeatureImpactOptions", feature);
  const winnow_deformable_mesh_options deformable = WINNOW_DEFORMABLE_MESH_OPTIONS;
  show_plain_options<DeformableMeshOptions>("DeformableMeshOptions", deformable);
}

/// Returns the struct as C++ reads it.
template <typename OfCpp, typename OfC>
[[nodiscard]] OfCpp as_read(const OfC* given) {
  OfCpp own;
  if (!c::read(given, own)) ++differences;
  return own;
}

/// Structs whose default is not all zeros.
void show_definitions() {
  const winnow_object_filter object = WINNOW_OBJECT_FILTER;
  show("ObjectFilter", ObjectFilter{}, {{"macro", *c::as_cpp(&object)}});
  const winnow_filter filter = WINNOW_FILTER;
  const winnow_filter* const none = nullptr;
  show("Filter", Filter{}, {{"macro", as_read<Filter>(&filter)}, {"null", as_read<Filter>(none)}});
  const winnow_scene_filter bodies = WINNOW_SCENE_FILTER;
  const winnow_scene_filter* const any = nullptr;
  show("SceneFilter", SceneFilter{},
       {{"macro", as_read<SceneFilter>(&bodies)}, {"null", as_read<SceneFilter>(any)}});
  const winnow_body_definition body = WINNOW_BODY_DEFINITION;
  show("BodyDefinition", BodyDefinition{}, {{"macro", *c::as_cpp(&body)}});
  const winnow_sensor_definition sensor = WINNOW_SENSOR_DEFINITION;
  show("SensorDefinition", SensorDefinition{}, {{"macro", *c::as_cpp(&sensor)}});
  const winnow_shape_ray ray = WINNOW_SHAPE_RAY;
  show("ShapeRay", ShapeRay{}, {{"macro", *c::as_cpp(&ray)}});
  const winnow_scene_room room = WINNOW_SCENE_ROOM;
  show("SceneCapacity", SceneCapacity{}, {{"macro", as_read<SceneCapacity>(&room)}});
  const winnow_shape_cast cast = WINNOW_SHAPE_CAST;
  show("ShapeCast", ShapeCast{}, {{"macro", as_read<ShapeCast>(&cast)}});
  const winnow_height_samples heights = WINNOW_HEIGHT_SAMPLES;
  show("HeightSamples", HeightSamples{}, {{"macro", as_read<HeightSamples>(&heights)}});
}

template <typename Value>
void show_line(const char* name, Value of_cpp, Value of_c) {
  std::printf("%s = %s\n", name, text(of_cpp).c_str());
  if (of_cpp == of_c) return;
  ++differences;
  (void)std::fprintf(stderr, "%s is %s in C++, %s in C\n", name, text(of_cpp).c_str(),
                     text(of_c).c_str());
}

/// Structs that the C interface does not have, or of which it has only some members.
void show_others() {
  show("PairEventsOptions", PairEventsOptions{});
  show("ClusterOptions", ClusterOptions{});
  const ClusterSceneOptions cluster;
  show("ClusterSceneOptions.scene", cluster.scene);
  std::printf("ClusterSceneOptions.imbalance = %s\n", text(cluster.imbalance).c_str());
  const winnow_cast cast = WINNOW_CAST;
  show_line("Ray.min_t", Ray{}.min_t, cast.min_t);
  show_line("Ray.max_t", Ray{}.max_t, cast.max_t);
  const winnow_motion_cast motion = WINNOW_MOTION_CAST;
  show_line("MotionCast.touching", MotionCast{}.touching, as_read<MotionCast>(&motion).touching);
  std::printf("WINNOW_CAST_TOLERANCE = %s\n", text(WINNOW_CAST_TOLERANCE).c_str());
}

}  // namespace
}  // namespace winnow

int main() {
  winnow::show_all_options();
  winnow::show_definitions();
  winnow::show_others();
  return winnow::differences == 0 ? 0 : 1;
}
