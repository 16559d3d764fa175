#pragma once

// Conversion of C options to C++ options. Each function is passed options with the C++ defaults. It
// changes the options whose members in the C struct are not zero; none if the pointer is null. It
// returns false for a wrong `size` or an invalid choice.

#include <winnow/c/continuous_collision.h>
#include <winnow/c/narrow_phase.h>
#include <winnow/c/partition.h>
#include <winnow/c/scene.h>
#include <winnow/c/shapes.h>
#include <winnow/c/time_of_impact.h>
#include <winnow/c/volumes.h>
#include <winnow/core/debug_draw.h>
#include <winnow/partitions/partition.h>
#include <winnow/pipeline/continuous_collision.h>
#include <winnow/pipeline/narrow_phase.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/time_of_impact.h>
#include <winnow/pipeline/triangle_mesh.h>

#include <cstddef>

namespace winnow::c {

/// Sets `memory` to null for the default memory of C++.
[[nodiscard]] bool read_options(const winnow_scene_options* given, const winnow_memory*& memory,
                                SceneOptions& options) noexcept;
[[nodiscard]] bool read_options(const winnow_partition_options* given, const winnow_memory*& memory,
                                PartitionOptions& options) noexcept;
[[nodiscard]] bool read_options(const winnow_pair_options* given, PairOptions& options) noexcept;
[[nodiscard]] bool read_options(const winnow_narrow_options* given,
                                NarrowOptions& options) noexcept;
[[nodiscard]] bool read_options(const winnow_impact_options* given,
                                ImpactOptions& options) noexcept;
/// `count` is the number of moving bodies.
[[nodiscard]] bool read_options(const winnow_continuous_options* given, std::size_t count,
                                ContinuousOptions& options) noexcept;
[[nodiscard]] bool read_options(const winnow_mesh_options* given, MeshOptions& options) noexcept;
[[nodiscard]] bool read_options(const winnow_debug_draw_options* given,
                                DebugDrawOptions& options) noexcept;

/// Sets `number` unless `given` is 0, which means the default.
template <typename Number>
void take_given(Number given, Number& number) noexcept {
  if (given != Number{}) number = given;
}

}  // namespace winnow::c
