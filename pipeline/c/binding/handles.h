#pragma once

// Definitions of the handles of the C interface: each contains its memory, an object of C++ and,
// if it takes columns of numbers of several types, room for converted ones.

#include "pipeline/c/binding/callers_memory.h"

#include <winnow/c/contact_groups.h>
#include <winnow/c/continuous_collision.h>
#include <winnow/c/deformable_mesh.h>
#include <winnow/c/partition.h>
#include <winnow/c/recording.h>
#include <winnow/c/scene.h>
#include <winnow/c/scene_queries.h>
#include <winnow/c/sensors.h>
#include <winnow/c/shapes.h>
#include <winnow/c/snapshots.h>
#include <winnow/c/time_of_impact.h>
#include <winnow/core/memory.h>
#include <winnow/core/pose.h>
#include <winnow/core/results.h>
#include <winnow/partitions/partition.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/contact_groups.h>
#include <winnow/pipeline/contacts.h>
#include <winnow/pipeline/continuous_collision.h>
#include <winnow/pipeline/deformable_mesh.h>
#include <winnow/pipeline/impacts.h>
#include <winnow/pipeline/narrow_phase.h>
#include <winnow/pipeline/recording.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/scene_queries.h>
#include <winnow/pipeline/sensors.h>
#include <winnow/pipeline/shape_pool.h>
#include <winnow/pipeline/shape_rays.h>

#include <cstddef>
#include <cstdint>
#include <utility>

namespace winnow::c {

/// Room of a handle that converts no columns.
struct NoRoom {
  explicit NoRoom(std::pmr::memory_resource* /*memory*/) noexcept {}
  [[nodiscard]] static Bytes bytes() noexcept { return {}; }
};

/// A handle with an object of C++, which is constructed from `from` and the memory.
template <typename OfCpp, typename Room = NoRoom>
struct Holder : Handle {
  template <typename... From>
  explicit Holder(const CallersMemory& given, From&&... from) noexcept
      : Handle(given), value(std::forward<From>(from)..., &memory) {}

  /// Returns the bytes of `room`.
  [[nodiscard]] Bytes room_bytes() const noexcept { return room.bytes(); }

  OfCpp value;
  Room room{&memory};  ///< input columns, converted to the numbers of the engine
};

}  // namespace winnow::c

struct winnow_recorder : winnow::c::Holder<winnow::Recorder> {
  using Holder::Holder;
};

struct winnow_pair_buffer : winnow::c::Holder<winnow::PairBuffer, winnow::Column<float>> {
  using Holder::Holder;
};

struct winnow_hit_buffer : winnow::c::Holder<winnow::HitBuffer> {
  using Holder::Holder;
};

struct winnow_overlap_buffer : winnow::c::Holder<winnow::OverlapBuffer> {
  using Holder::Holder;
};

struct winnow_shape_pool : winnow::c::Holder<winnow::ShapePool> {
  using Holder::Holder;
};

struct winnow_composite_pool : winnow::c::Holder<winnow::CompositePool> {
  using Holder::Holder;
};

struct winnow_narrow_result : winnow::c::Holder<winnow::NarrowResult> {
  using Holder::Holder;
};

struct winnow_narrow_phase : winnow::c::Holder<winnow::NarrowPhase, winnow::Column<winnow::Pose>> {
  using Holder::Holder;
};

struct winnow_impact_result : winnow::c::Holder<winnow::ImpactResult> {
  using Holder::Holder;
};

struct winnow_contact_groups : winnow::c::Holder<winnow::ContactGroups> {
  using Holder::Holder;
};

struct winnow_scene_queries
    : winnow::c::Holder<winnow::SceneQueries, winnow::Column<winnow::ShapeRay>> {
  using Holder::Holder;
};

struct winnow_continuous_collision
    : winnow::c::Holder<winnow::ContinuousCollision, winnow::Column<winnow::Pose>> {
  using Holder::Holder;
};

struct winnow_sensors : winnow::c::Holder<winnow::Sensors> {
  using Holder::Holder;
};

struct winnow_snapshot : winnow::c::Holder<winnow::Column<std::byte>> {
  using Holder::Holder;
};

struct winnow_deformable_mesh : winnow::c::Handle {
  winnow_deformable_mesh(const winnow::c::CallersMemory& given,
                         winnow::DeformableMeshOptions options) noexcept
      : Handle(given), value(winnow::c::in(options, &memory)) {}
  [[nodiscard]] static winnow::Bytes room_bytes() noexcept { return {}; }

  winnow::DeformableMesh value;
};

struct winnow_pair_events : winnow::c::Handle {
  explicit winnow_pair_events(const winnow::c::CallersMemory& given,
                              bool client_data = false) noexcept
      : Handle(given), value({&memory, client_data}) {}
  [[nodiscard]] static winnow::Bytes room_bytes() noexcept { return {}; }

  winnow::PairEvents value;
};

/// Owns a partition, or is a view of a partition of a scene. In a view, `value` has no structure
/// and therefore refuses every change; `target` points to the scene's partition.
struct winnow_partition : winnow::c::Handle {
  explicit winnow_partition(const winnow::c::CallersMemory& given) noexcept : Handle(given) {}
  winnow_partition(const winnow::c::CallersMemory& given, winnow::StructureKind structure,
                   winnow::PartitionOptions options) noexcept
      : Handle(given), value(structure, winnow::c::in(options, &memory)) {}
  [[nodiscard]] winnow::Bytes room_bytes() const noexcept { return room.bytes(); }

  winnow::Partition value{winnow::StructureKind{}};
  const winnow::Partition* target = &value;
  winnow::Column<float> room{&memory};
};

struct winnow_contacts : winnow::c::Handle {
  using Handle::Handle;
  [[nodiscard]] winnow::Bytes room_bytes() const noexcept;
  /// Fills the columns below; call it whenever `value` was filled. If memory is refused, clears
  /// `value` and returns out_of_memory.
  [[nodiscard]] winnow::Status look_up() noexcept;
  /// Returns a column of parts as an array.
  [[nodiscard]] const std::uint32_t* parts(const winnow::PartColumn& column) const noexcept;

  winnow::Contacts value{&memory};
  /// Columns that Contacts computes on access, as arrays: client data of a and of b, and
  /// kWholeShape for each manifold, used if the contacts have no column of parts.
  winnow::Column<winnow::ClientData> data[2]{winnow::Column<winnow::ClientData>(&memory),
                                             winnow::Column<winnow::ClientData>(&memory)};
  winnow::Column<std::uint32_t> whole{&memory};
};

struct winnow_scene : winnow::c::Handle {
  winnow_scene(const winnow::c::CallersMemory& given, const winnow::ShapePool& shapes,
               winnow::SceneOptions options) noexcept
      : Handle(given),
        value(shapes, winnow::c::in(options, &memory)),
        sets{winnow_partition(given), winnow_partition(given), winnow_partition(given)} {}
  /// Returns the bytes of bodies, of the handle and of its room.
  [[nodiscard]] winnow::Bytes body_bytes() const noexcept;

  winnow::Scene value;
  winnow::Column<winnow::Pose> room{&memory};
  winnow_partition sets[winnow::kBodyStates];  ///< views of the partitions
};

namespace winnow::c {

/// Returns the object of a handle.
template <typename Of>
[[nodiscard]] auto& of(Of* handle) noexcept {
  return handle->value;
}
[[nodiscard]] inline const Partition& of(const winnow_partition* handle) noexcept {
  return *handle->target;
}

/// Returns the status of a new object; a Scene reports invalid options or refused memory only in
/// its calls.
template <typename Made>
[[nodiscard]] Status standing(Made& /*made*/) noexcept {
  return Status::ok;
}
[[nodiscard]] inline Status standing(winnow_recorder& made) noexcept {
  return made.value.status();
}
[[nodiscard]] inline Status standing(winnow_partition& made) noexcept {
  return made.value.status();
}
[[nodiscard]] inline Status standing(winnow_scene& made) noexcept {
  return made.value.add({}, std::span<Key>());
}
[[nodiscard]] inline Status standing(winnow_scene_queries& made) noexcept {
  return made.value.footprint().structure.used == 0 ? Status::out_of_memory : Status::ok;
}

}  // namespace winnow::c
