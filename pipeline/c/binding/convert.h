#pragma once

// Conversion between values of C and of C++. structs.h, which is generated, states which structs
// have equal layouts and calls `take` and `put` for the members of all others.

#include "pipeline/c/binding/arguments.h"
#include "pipeline/c/binding/handles.h"

#include <winnow/core/debug_draw.h>
#include <winnow/core/execution.h>
#include <winnow/core/filter.h>
#include <winnow/core/key.h>
#include <winnow/core/point_view.h>
#include <winnow/core/pose.h>
#include <winnow/core/rays.h>
#include <winnow/core/regions.h>
#include <winnow/core/vectors.h>
#include <winnow/core/volumes.h>
#include <winnow/partitions/structures.h>
#include <winnow/pipeline/impacts.h>
#include <winnow/pipeline/scene_queries.h>
#include <winnow/pipeline/shapes.h>
#include <winnow/pipeline/surfaces.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>

namespace winnow::c {

// --- structs of equal layout -----------------------------------------------------------------

/// The C++ struct of the same layout as a C struct.
template <typename OfC>
struct CppOf;

/// True if two structs have the same layout.
template <typename OfC, typename OfCpp>
inline constexpr bool kIsSameLayout = std::is_same_v<OfC, OfCpp>;

#define WINNOW_ALSO_SAME_LAYOUT(OfC, OfCpp)                                      \
  static_assert(sizeof(OfC) == sizeof(OfCpp) && alignof(OfC) == alignof(OfCpp)); \
  template <>                                                                    \
  inline constexpr bool kIsSameLayout<OfC, OfCpp> = true;
#define WINNOW_SAME_LAYOUT(OfC, OfCpp) \
  WINNOW_ALSO_SAME_LAYOUT(OfC, OfCpp)  \
  template <>                          \
  struct CppOf<OfC> {                  \
    using Type = OfCpp;                \
  };

template <typename OfC>
[[nodiscard]] auto* as_cpp(OfC* p) noexcept {
  return reinterpret_cast<typename CppOf<OfC>::Type*>(p);
}
template <typename OfC>
[[nodiscard]] auto* as_cpp(const OfC* p) noexcept {
  return reinterpret_cast<const typename CppOf<OfC>::Type*>(p);
}
template <typename T>
[[nodiscard]] auto as_cpp_span(T* first, std::size_t count) noexcept {
  return std::span(as_cpp(first), count);
}

// --- values ----------------------------------------------------------------------------------

[[nodiscard]] inline Key to_cpp(winnow_key key) noexcept {
  return {key.id, key.stamp};
}
/// Returns a kind without a structure if `given` is invalid.
[[nodiscard]] StructureKind to_cpp(winnow_structure_kind given) noexcept;
/// Returns structure -1 for a kind without a structure.
[[nodiscard]] winnow_structure_kind structure_of(StructureKind kind) noexcept;

/// In C, an id is a plain number.
static_assert(sizeof(winnow_shape_id) == sizeof(ShapeId));
[[nodiscard]] inline std::span<const ShapeId> shape_ids(const winnow_shape_id* ids,
                                                        std::size_t count) noexcept {
  return {reinterpret_cast<const ShapeId*>(ids), count};
}

/// The last enumerator; structs.h specializes it.
template <typename Choice>
inline constexpr Choice kLast{};

/// Reads an enumerator. Returns false if it is out of range.
template <typename Choice>
requires std::is_enum_v<Choice>
[[nodiscard]] bool read(std::int64_t given, Choice& choice) noexcept {
  if (given < 0 || given > static_cast<std::int64_t>(kLast<Choice>)) return false;
  choice = static_cast<Choice>(given);
  return true;
}

// --- arguments that are read before a call -----------------------------------------------------
// They return false if the argument is invalid. Null pointers are allowed only for `optional` ones:
// they mean the defaults.

/// Draws with the callbacks of a winnow_debug_draw.
class CallbackDraw final : public DebugDraw {
 public:
  void box(const Aabb& box, Colour colour) override;
  void line(const Vec3f& from, const Vec3f& to, Colour colour) override;
  void sphere(const Sphere& sphere, Colour colour) override;
  void text(const Vec3f& at, std::string_view text, Colour colour) override;

  winnow_debug_draw draw{};
};

/// Passes chunks of results to the callback of a C struct, such as winnow_pair_chunks.
template <typename OfC>
struct Chunks {
  template <typename T>
  void operator()(std::span<const T> chunk) const noexcept {
    pass(given->take, chunk);
  }
  template <typename Result, typename T>
  void pass(void (*take)(void*, const Result*, std::size_t), std::span<const T> chunk) const {
    static_assert(kIsSameLayout<Result, T>);
    take(given->context, reinterpret_cast<const Result*>(chunk.data()), chunk.size());
  }

  const OfC* given = nullptr;
};
template <typename OfC>
[[nodiscard]] bool read(const OfC* given, Chunks<OfC>& chunks) noexcept {
  chunks.given = given;
  return given->take != nullptr;
}

/// WINNOW_EXECUTION_DEFAULT leaves `execution` unchanged.
[[nodiscard]] bool read(const winnow_execution* given, Execution& execution) noexcept;
/// The filter refers to `given` and is valid only during the call.
[[nodiscard]] bool read(const winnow_filter* given, Filter& filter) noexcept;
[[nodiscard]] bool read(const winnow_scene_filter* given, SceneFilter& filter) noexcept;
[[nodiscard]] bool read(const winnow_pair_predicate* given, PairPredicate& predicate) noexcept;
[[nodiscard]] bool read(const winnow_debug_draw* given, CallbackDraw& drawing) noexcept;
[[nodiscard]] bool read(const winnow_oriented_box* given, OrientedBox& box) noexcept;
[[nodiscard]] bool read(const winnow_cast* given, Cast& cast) noexcept;
[[nodiscard]] bool read(const winnow_region* given, Region& region) noexcept;
[[nodiscard]] bool read(const winnow_ray_batch* given, RayBatch& rays) noexcept;
[[nodiscard]] bool read(const winnow_hit_columns* given, HitColumns& hits) noexcept;
[[nodiscard]] bool read(const winnow_hull_faces* given, HullFaces& faces) noexcept;
[[nodiscard]] bool read(const winnow_height_samples* given, HeightSamples& samples) noexcept;
[[nodiscard]] bool read(const winnow_moving_bodies* given, MovingBodies& bodies) noexcept;
[[nodiscard]] bool read(const winnow_scene_hit_columns* given, SceneHitColumns& hits) noexcept;
[[nodiscard]] bool read(const winnow_shape_cast* given, ShapeCast& cast) noexcept;
[[nodiscard]] bool read(const winnow_motion_cast* given, MotionCast& cast) noexcept;
[[nodiscard]] bool read(const winnow_feature_columns* given, FeatureColumns& columns) noexcept;

// --- views of the caller's columns -------------------------------------------------------------
// Columns that have the number type of the engine are used without a copy; others are converted
// into `room`. The functions return `invalid_argument` if a column is missing, and `out_of_memory`.

/// Boxes in double are rounded outward. If `entries` is not null, only those entries are read.
[[nodiscard]] Status read_view(const winnow_box_view& given, Column<float>& room, BoxView& boxes,
                               const IndexSubset* entries = nullptr) noexcept;
[[nodiscard]] Status read_view(const winnow_pose_view& given, Column<Pose>& room,
                               PoseView& poses) noexcept;
[[nodiscard]] Status read_view(const winnow_bodies& given, Column<Pose>& room,
                               Bodies& bodies) noexcept;
[[nodiscard]] Status read_view(const winnow_shape_ray_batch& given, Column<ShapeRay>& room,
                               ShapeRayBatch& rays) noexcept;
/// Float and double are both used without a copy.
[[nodiscard]] Status read_view(const winnow_point_view& given, PointView& points) noexcept;
[[nodiscard]] Status read_view(const winnow_index_view& given, IndexView& triangles) noexcept;

// --- members of structs ------------------------------------------------------------------------

/// Replaces an option, unless the member of C is zero, which means the default. Returns false for
/// an invalid choice.
template <typename Given, typename Option>
[[nodiscard]] bool take(const Given& given, Option& option) noexcept {
  if constexpr (std::is_array_v<Given>) {
    for (std::size_t i = 0; i < std::extent_v<Given>; ++i) {
      if (!take(given[i], option[i])) return false;
    }
  } else if constexpr (std::is_same_v<Given, winnow_execution>) {
    return read(&given, option);
  } else if constexpr (std::is_same_v<Given, winnow_structure_kind>) {
    option = to_cpp(given);
  } else if constexpr (std::is_same_v<Given, const winnow_composite_pool*>) {
    if (given != nullptr) option = &of(given);
  } else if constexpr (std::is_same_v<Given, winnow_recorder*>) {
    if (given != nullptr) option = &of(given);
  } else if constexpr (std::is_enum_v<Option>) {
    return given == 0 || read(given, option);
  } else if constexpr (std::is_class_v<Given>) {
    option = *as_cpp(&given);
  } else {
    if (given != Given{}) option = static_cast<Option>(given);
  }
  return true;
}
/// Reads an array of `count` elements; null means none.
template <typename T>
[[nodiscard]] bool take(const T* given, std::size_t count, std::span<const T>& option) noexcept {
  option = span_of(given, count);
  return true;
}
/// Sets an option whose zero is not the default.
template <typename Choice>
[[nodiscard]] bool set(std::int32_t given, Choice& option) noexcept {
  return read(given, option);
}
/// Switches an option off that is on by default.
[[nodiscard]] inline bool take_off(std::uint8_t given, bool& option) noexcept {
  option = given == 0;
  return true;
}

/// Writes a value of C++ to a member of C. Empty columns are null.
template <typename Value, typename To>
void put(const Value& value, To& to) noexcept {
  if constexpr (std::is_array_v<To>) {
    for (std::size_t i = 0; i < std::extent_v<To>; ++i) put(value[i], to[i]);
  } else if constexpr (std::is_same_v<Value, std::string_view>) {
    to = value.empty() ? "" : value.data();
  } else if constexpr (std::is_pointer_v<Value>) {
    to = reinterpret_cast<To>(value);
  } else if constexpr (std::is_pointer_v<To>) {
    static_assert(sizeof(*to) == sizeof(*value.data()));
    to = value.empty() ? nullptr : reinterpret_cast<To>(value.data());
  } else if constexpr (std::is_same_v<To, winnow_structure_kind>) {
    to = structure_of(value);
  } else if constexpr (std::is_class_v<To> && !std::is_same_v<Value, To>) {
    *as_cpp(&to) = value;
  } else {
    to = static_cast<To>(value);
  }
}

// --- expressions of the description ------------------------------------------------------------

[[nodiscard]] Answer<ShapeId> add(ShapePool& pool, const winnow_shape& shape) noexcept;
/// The shape must exist and be no hull.
[[nodiscard]] winnow_shape shape_at(const ShapeTables& tables, ShapeId id) noexcept;
[[nodiscard]] bool is_hull(ShapeId id) noexcept;
[[nodiscard]] bool is_compound(ShapeId id) noexcept;
/// The matrix has 16 numbers, row by row.
[[nodiscard]] Mat4d matrix_by_rows(const double* numbers) noexcept;
[[nodiscard]] Answer<Frustum> valid_frustum(const Frustum& frustum) noexcept;
[[nodiscard]] Answer<RigidMotion> valid_motion(const RigidMotion& motion) noexcept;
[[nodiscard]] std::array<Vec3d, 4> four_points(const double* numbers) noexcept;
/// Returns the cast without hits of bodies that the shape touches at the start but leaves.
[[nodiscard]] ShapeCast from_touch(ShapeCast cast) noexcept;
[[nodiscard]] MeshObstacle obstacle_of(const winnow_mesh_obstacle& given) noexcept;

/// Calls `use` with the array as K-DOPs of compile-time K, if `k` is a valid one.
template <typename Use>
[[nodiscard]] Status with_kdops(std::uint32_t k, std::span<const float> kdops, Use&& use) noexcept {
  const auto as = [&]<int K>() {
    static_assert(sizeof(Kdop<K>) == K * sizeof(float));
    return use(std::span(reinterpret_cast<const Kdop<K>*>(kdops.data()), kdops.size()));
  };
  if (k == 14) return as.template operator()<14>();
  if (k == 18) return as.template operator()<18>();
  if (k == 26) return as.template operator()<26>();
  return Status::invalid_argument;
}

/// Replaces the snapshot by the bytes that `save(column)` appends, if it succeeds.
template <typename Save>
[[nodiscard]] Status save_into(Column<std::byte>& snapshot, Save&& save) noexcept {
  Column<std::byte> fresh(snapshot.memory());
  const Status status = save(fresh);
  if (status == Status::ok) snapshot.swap(fresh);
  return status;
}

}  // namespace winnow::c
