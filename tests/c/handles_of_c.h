#pragma once

// For tests that call C and compare with the C++ object behind the handle, or with C++ calls on it.

#include "pipeline/c/binding/structs.h"

#include <winnow/c/winnow.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>
#include <utility>

namespace winnow::test {

/// A handle that is destroyed at the end.
template <typename OfC, void (*kDestroy)(OfC*)>
class Owned {
 public:
  /// Calls a create function with the given arguments, and with the place of the handle.
  template <typename Create, typename... Given>
  explicit Owned(Create create, const Given&... given) {
    OfC* made = nullptr;
    EXPECT_EQ(create(given..., &made), WINNOW_OK);
    handle_.reset(made);
  }
  operator OfC*() const noexcept { return handle_.get(); }  // NOLINT(google-explicit-constructor)
  /// Returns the C++ object.
  /// @{
  auto* operator->() const noexcept { return &handle_->value; }
  auto& operator*() const noexcept { return handle_->value; }
  /// @}

 private:
  struct Destroy {
    void operator()(OfC* handle) const noexcept { kDestroy(handle); }
  };
  std::unique_ptr<OfC, Destroy> handle_;
};

using OwnedRecorder = Owned<winnow_recorder, winnow_recorder_destroy>;
using OwnedThreads = Owned<winnow_threads, winnow_threads_destroy>;
using OwnedPartition = Owned<winnow_partition, winnow_partition_destroy>;
using OwnedPairs = Owned<winnow_pair_buffer, winnow_pair_buffer_destroy>;
using OwnedEvents = Owned<winnow_pair_events, winnow_pair_events_destroy>;
using OwnedHits = Owned<winnow_hit_buffer, winnow_hit_buffer_destroy>;
using OwnedOverlaps = Owned<winnow_overlap_buffer, winnow_overlap_buffer_destroy>;
using OwnedShapes = Owned<winnow_shape_pool, winnow_shape_pool_destroy>;
using OwnedComposites = Owned<winnow_composite_pool, winnow_composite_pool_destroy>;
using OwnedNarrowPhase = Owned<winnow_narrow_phase, winnow_narrow_phase_destroy>;
using OwnedNarrowResult = Owned<winnow_narrow_result, winnow_narrow_result_destroy>;
using OwnedImpactResult = Owned<winnow_impact_result, winnow_impact_result_destroy>;
using OwnedScene = Owned<winnow_scene, winnow_scene_destroy>;
using OwnedContacts = Owned<winnow_contacts, winnow_contacts_destroy>;
using OwnedGroups = Owned<winnow_contact_groups, winnow_contact_groups_destroy>;
using OwnedQueries = Owned<winnow_scene_queries, winnow_scene_queries_destroy>;
using OwnedImpacts = Owned<winnow_continuous_collision, winnow_continuous_collision_destroy>;
using OwnedSensors = Owned<winnow_sensors, winnow_sensors_destroy>;
using OwnedSnapshot = Owned<winnow_snapshot, winnow_snapshot_destroy>;
using OwnedMesh = Owned<winnow_deformable_mesh, winnow_deformable_mesh_destroy>;

/// Calls a function of C with the arguments and a place for its result, which it returns.
template <typename Result, typename Call, typename... Given>
[[nodiscard]] Result got(Call call, const Given&... given) {
  Result result{};
  if constexpr (requires { result.size; }) result.size = sizeof result;
  EXPECT_EQ(call(given..., &result), WINNOW_OK);
  return result;
}
/// As above, for functions that return an array.
template <typename Element, typename Call, typename... Given>
[[nodiscard]] std::span<const Element> got_all(Call call, const Given&... given) {
  const Element* first = nullptr;
  std::size_t count = 0;
  EXPECT_EQ(call(given..., &first, &count), WINNOW_OK);
  return {first, count};
}

/// True if an array of C is the array of C++.
template <typename OfC, typename OfCpp>
[[nodiscard]] bool is_array_of(std::span<const OfC> of_c, std::span<const OfCpp> of_cpp) {
  static_assert(c::kIsSameLayout<OfC, OfCpp>);
  return of_c.size() == of_cpp.size() && static_cast<const void*>(of_c.data()) == of_cpp.data();
}
/// True if a column of C is the column of C++; an empty one may be null.
template <typename OfC, typename OfCpp>
[[nodiscard]] bool is_column_of(const OfC* of_c, std::span<const OfCpp> of_cpp) {
  return of_cpp.empty() ? of_c == nullptr : static_cast<const void*>(of_c) == of_cpp.data();
}

[[nodiscard]] inline bool same(const SceneHit& a, const SceneHit& b) {
  return a.key == b.key && a.data == b.data && a.part == b.part && a.t == b.t &&
         a.normal == b.normal && a.point == b.point;
}
[[nodiscard]] inline bool same(const SceneCrossing& a, const SceneCrossing& b) {
  return a.key == b.key && a.data == b.data && a.part == b.part && a.t == b.t &&
         a.exits == b.exits && a.normal == b.normal && a.point == b.point &&
         a.barycentric == b.barycentric;
}
[[nodiscard]] inline bool same(const SceneOverlap& a, const SceneOverlap& b) {
  return a.key == b.key && a.data == b.data && a.part == b.part;
}
[[nodiscard]] inline bool same(const SceneDistance& a, const SceneDistance& b) {
  return a.key == b.key && a.data == b.data && a.part_a == b.part_a && a.part == b.part &&
         a.distance == b.distance && a.error_bound == b.error_bound && a.normal == b.normal &&
         a.point_a == b.point_a && a.point_b == b.point_b;
}
[[nodiscard]] inline bool same(const SetDistance& a, const SetDistance& b) {
  return a.a == b.a && a.data_a == b.data_a && same(a.to, b.to);
}
[[nodiscard]] inline bool same(const RigidMotion& a, const RigidMotion& b) {
  return a.start == b.start && a.travel == b.travel && a.turn == b.turn;
}
template <typename T>
requires std::equality_comparable<T>
[[nodiscard]] bool same(const T& a, const T& b) {
  return a == b;
}
/// True if a struct of C has the members of a struct of C++.
template <typename OfC>
requires requires {
  typename c::CppOf<OfC>::Type;
}
[[nodiscard]] bool same(const OfC& of_c, const typename c::CppOf<OfC>::Type& of_cpp) {
  return same(*c::as_cpp(&of_c), of_cpp);
}
/// True if the arrays are equal and not empty.
template <typename OfC, typename OfCpp>
[[nodiscard]] bool same_all(std::span<const OfC> of_c, std::span<const OfCpp> of_cpp) {
  return !of_c.empty() && std::equal(of_c.begin(), of_c.end(), of_cpp.begin(), of_cpp.end(),
                                     [](const OfC& a, const OfCpp& b) { return same(a, b); });
}
/// True if structs without padding have the same bits.
template <typename OfC, typename OfCpp>
[[nodiscard]] bool have_same_bits(const OfC& of_c, const OfCpp& of_cpp) {
  static_assert(c::kIsSameLayout<OfC, OfCpp>);
  return std::memcmp(&of_c, &of_cpp, sizeof of_c) == 0;
}

/// Memory for C that counts the bytes in use. It refuses all requests after the first `granted`.
struct CountedMemory {
  [[nodiscard]] winnow_memory functions() noexcept {
    return {[](void* context, std::size_t bytes, std::size_t alignment) -> void* {
              auto& own = *static_cast<CountedMemory*>(context);
              if (own.requests++ >= own.granted) return nullptr;
              own.outstanding += bytes;
              return std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
            },
            [](void* context, void* block, std::size_t bytes, std::size_t) {
              static_cast<CountedMemory*>(context)->outstanding -= bytes;
              std::free(block);
            },
            this};
  }
  std::size_t granted = SIZE_MAX;
  std::size_t requests = 0;
  std::size_t outstanding = 0;
};

/// Returns the bytes that a footprint has reserved.
[[nodiscard]] inline std::size_t reserved_of(const winnow_footprint& bytes) {
  return bytes.bounds.reserved + bytes.keys.reserved + bytes.client_data.reserved +
         bytes.structure.reserved + bytes.scratch.reserved + bytes.results.reserved;
}

}  // namespace winnow::test
