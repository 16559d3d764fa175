#pragma once

// Arguments for hostile_test.cpp: an object of every kind of the C interface, and a value of every
// argument type.

#include "tests/c/handles_of_c.h"

#include <winnow/c/winnow.h>

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace winnow::test {

/// An object of every kind and arguments of any type: pointers to these kinds point to the objects
/// here, other pointers point to zeros with room for an array of one, numbers are 1.
class HostileWorld {
 public:
  HostileWorld() {
    const winnow_shape ball = {WINNOW_SHAPE_SPHERE, {.sphere = {0.5}}};
    winnow_body_definition body = WINNOW_BODY_DEFINITION;
    winnow_key key = WINNOW_NULL_KEY;
    EXPECT_EQ(winnow_shape_pool_add(shapes, &ball, &body.shape), WINNOW_OK);
    EXPECT_EQ(winnow_scene_add(scene, &body, 1, &key), WINNOW_OK);
    EXPECT_EQ(winnow_scene_refresh(scene), WINNOW_OK);
  }

  /// Returns the argument of a call at `index`.
  template <typename T>
  [[nodiscard]] T get(std::size_t index) {
    if constexpr (std::is_pointer_v<T>) {
      using To = std::remove_const_t<std::remove_pointer_t<T>>;
      if constexpr (requires { of(static_cast<To*>(nullptr)); }) {
        return of(static_cast<To*>(nullptr));
      } else {
        return zeros<To>(index);
      }
    } else if constexpr (std::is_arithmetic_v<T>) {
      return T{1};
    } else {
      return T{};
    }
  }

  /// Destroys the object that a call has created.
  void end_made() {
    if (end_ != nullptr) end_(made_);
    end_ = nullptr;
  }

  /// The value of the size members of structs; 1 means the size of this version.
  std::size_t size_of_structs = 1;

  OwnedThreads threads{winnow_threads_create, 1U};
  OwnedSnapshot snapshot{winnow_snapshot_create, nullptr};
  OwnedPartition partition{winnow_partition_create, winnow_structure_kind{}, nullptr};
  OwnedPairs pairs{winnow_pair_buffer_create, nullptr};
  OwnedEvents events{winnow_pair_events_create, nullptr};
  OwnedHits hits{winnow_hit_buffer_create, nullptr};
  OwnedOverlaps overlaps{winnow_overlap_buffer_create, nullptr};
  OwnedShapes shapes{winnow_shape_pool_create, nullptr};
  OwnedComposites composites{winnow_composite_pool_create, shapes, nullptr};
  OwnedNarrowPhase narrow{winnow_narrow_phase_create, nullptr};
  OwnedNarrowResult result{winnow_narrow_result_create, nullptr};
  OwnedImpactResult impacts{winnow_impact_result_create, nullptr};
  OwnedContacts contacts{winnow_contacts_create, nullptr};
  OwnedScene scene{winnow_scene_create, shapes, nullptr};
  OwnedQueries queries{winnow_scene_queries_create, scene, nullptr};
  OwnedGroups groups{winnow_contact_groups_create, nullptr};
  OwnedImpacts ccd{winnow_continuous_collision_create, scene, nullptr};
  OwnedSensors sensors{winnow_sensors_create, scene, nullptr};
  OwnedMesh mesh{winnow_deformable_mesh_create, nullptr};

 private:
#define WINNOW_THING(type, member)         \
  [[nodiscard]] type* of(type*) noexcept { \
    return member;                         \
  }                                        \
  static void destroy(type* thing) {       \
    type##_destroy(thing);                 \
  }
  WINNOW_THING(winnow_threads, threads)
  WINNOW_THING(winnow_snapshot, snapshot)
  WINNOW_THING(winnow_partition, partition)
  WINNOW_THING(winnow_pair_buffer, pairs)
  WINNOW_THING(winnow_pair_events, events)
  WINNOW_THING(winnow_hit_buffer, hits)
  WINNOW_THING(winnow_overlap_buffer, overlaps)
  WINNOW_THING(winnow_shape_pool, shapes)
  WINNOW_THING(winnow_composite_pool, composites)
  WINNOW_THING(winnow_narrow_phase, narrow)
  WINNOW_THING(winnow_narrow_result, result)
  WINNOW_THING(winnow_impact_result, impacts)
  WINNOW_THING(winnow_contacts, contacts)
  WINNOW_THING(winnow_scene, scene)
  WINNOW_THING(winnow_scene_queries, queries)
  WINNOW_THING(winnow_contact_groups, groups)
  WINNOW_THING(winnow_continuous_collision, ccd)
  WINNOW_THING(winnow_sensors, sensors)
  WINNOW_THING(winnow_deformable_mesh, mesh)
#undef WINNOW_THING

  template <typename To>
  [[nodiscard]] To* zeros(std::size_t index) {
    std::memset(storage_[index], 0, kRoom);
    To* const first = reinterpret_cast<To*>(storage_[index]);
    if constexpr (requires { first->size; }) {
      first->size = size_of_structs == 1 ? sizeof(To) : size_of_structs;
    }
    if constexpr (std::is_pointer_v<To>) {
      if constexpr (requires { destroy(*first); }) {
        made_ = first;
        end_ = [](void* made) { destroy(*static_cast<To*>(made)); };
      }
    }
    return first;
  }

  static constexpr std::size_t kRoom = 8192;
  alignas(64) std::byte storage_[16][kRoom];
  void* made_ = nullptr;
  void (*end_)(void*) = nullptr;
};

/// Returns whether one of the arguments is a struct with a size member.
template <typename... Arguments>
[[nodiscard]] constexpr bool takes_sized(winnow_status (*)(Arguments...)) noexcept {
  return ([] {
    using To = std::remove_pointer_t<Arguments>;
    if constexpr (std::is_pointer_v<Arguments> && std::is_class_v<To>) {
      if constexpr (requires(To to) { to.size; }) return true;
    }
    return false;
  }() || ...);
}

}  // namespace winnow::test
