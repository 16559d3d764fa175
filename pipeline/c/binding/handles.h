#pragma once

// Definitions of the handles of the C interface.

#include "pipeline/c/binding/callers_memory.h"

#include <winnow/c/contact_groups.h>
#include <winnow/c/continuous_collision.h>
#include <winnow/c/partition.h>
#include <winnow/c/scene.h>
#include <winnow/c/scene_queries.h>
#include <winnow/c/sensors.h>
#include <winnow/c/shapes.h>
#include <winnow/c/time_of_impact.h>
#include <winnow/core/column.h>
#include <winnow/core/hits.h>
#include <winnow/core/pair_buffer.h>
#include <winnow/core/pair_events.h>
#include <winnow/core/pose.h>
#include <winnow/partitions/partition.h>
#include <winnow/pipeline/composite_pool.h>
#include <winnow/pipeline/contact_groups.h>
#include <winnow/pipeline/contacts.h>
#include <winnow/pipeline/continuous_collision.h>
#include <winnow/pipeline/narrow_phase.h>
#include <winnow/pipeline/narrow_result.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/scene_queries.h>
#include <winnow/pipeline/sensors.h>
#include <winnow/pipeline/shape_pool.h>
#include <winnow/pipeline/time_of_impact.h>

struct winnow_pair_buffer : winnow::c::Handle {
  using Handle::Handle;
  winnow::PairBuffer value{&memory};
  winnow::Column<float> room{&memory};  ///< input boxes, converted from double
};

struct winnow_pair_events : winnow::c::Handle {
  explicit winnow_pair_events(const winnow::c::CallersMemory& given,
                              bool client_data = false) noexcept
      : Handle(given), value({&memory, client_data}) {}

  winnow::PairEvents value;
};

struct winnow_hit_buffer : winnow::c::Handle {
  using Handle::Handle;
  winnow::HitBuffer value{&memory};
};

struct winnow_overlap_buffer : winnow::c::Handle {
  using Handle::Handle;
  winnow::OverlapBuffer value{&memory};
};

/// Owns a partition, or is a view of a partition of a scene. In a view, `value` has no structure
/// and therefore refuses every change; `target` points to the scene's partition.
struct winnow_partition : winnow::c::Handle {
  explicit winnow_partition(const winnow::c::CallersMemory& given) noexcept : Handle(given) {}
  winnow_partition(const winnow::c::CallersMemory& given, winnow::StructureKind structure,
                   winnow::PartitionOptions options) noexcept
      : Handle(given), value(structure, winnow::c::in(options, &memory)) {}

  winnow::Partition value{winnow::StructureKind{}};
  const winnow::Partition* target = &value;
  winnow::Column<float> room{&memory};  ///< input boxes, converted from double
};

struct winnow_shape_pool : winnow::c::Handle {
  using Handle::Handle;
  winnow::ShapePool value{&memory};
  winnow::Column<double> room{&memory};  ///< input points of hulls
};

struct winnow_composite_pool : winnow::c::Handle {
  winnow_composite_pool(const winnow::c::CallersMemory& given,
                        const winnow::ShapePool& shapes) noexcept
      : Handle(given), value(shapes, &memory) {}

  winnow::CompositePool value;
};

struct winnow_narrow_result : winnow::c::Handle {
  using Handle::Handle;
  winnow::NarrowResult value{&memory};
};

struct winnow_narrow_phase : winnow::c::Handle {
  using Handle::Handle;
  winnow::NarrowPhase value{&memory};
  winnow::Column<winnow::Pose> room{&memory};
};

struct winnow_impact_result : winnow::c::Handle {
  using Handle::Handle;
  winnow::ImpactResult value{&memory};
};

struct winnow_contacts : winnow::c::Handle {
  using Handle::Handle;
  winnow::Contacts value{&memory};
  /// Columns that Contacts computes on access, as arrays: client data of a and of b, and
  /// kWholeShape for each manifold, used if the contacts have no column of parts.
  winnow::Column<winnow::ClientData> data[2]{winnow::Column<winnow::ClientData>(&memory),
                                             winnow::Column<winnow::ClientData>(&memory)};
  winnow::Column<std::uint32_t> whole{&memory};

  /// Fills these columns; call it whenever `value` was filled. If memory is refused, clears `value`
  /// and returns out_of_memory.
  [[nodiscard]] winnow::Status look_up() noexcept;
};

struct winnow_contact_groups : winnow::c::Handle {
  using Handle::Handle;
  winnow::ContactGroups value{&memory};
};

struct winnow_scene : winnow::c::Handle {
  winnow_scene(const winnow::c::CallersMemory& given, const winnow::ShapePool& shapes,
               winnow::SceneOptions options) noexcept
      : Handle(given),
        value(shapes, winnow::c::in(options, &memory)),
        sets{winnow_partition(given), winnow_partition(given), winnow_partition(given)} {}

  winnow::Scene value;
  winnow::Column<winnow::Pose> room{&memory};
  winnow_partition sets[winnow::kBodyStates];  ///< views of the partitions
};

struct winnow_scene_queries : winnow::c::Handle {
  winnow_scene_queries(const winnow::c::CallersMemory& given, const winnow::Scene& scene) noexcept
      : Handle(given), value(scene, &memory) {}

  winnow::SceneQueries value;
  winnow::Column<winnow::ShapeRay> room{&memory};  ///< input rays, converted from float
};

struct winnow_continuous_collision : winnow::c::Handle {
  winnow_continuous_collision(const winnow::c::CallersMemory& given, winnow::Scene& scene) noexcept
      : Handle(given), value(scene, &memory) {}

  winnow::ContinuousCollision value;
  winnow::Column<winnow::Pose> room{&memory};
};

struct winnow_sensors : winnow::c::Handle {
  winnow_sensors(const winnow::c::CallersMemory& given, winnow::Scene& scene) noexcept
      : Handle(given), value(scene, &memory) {}

  winnow::Sensors value;
};
