#pragma once

// Options of C as C++ has them. Each of these is given the defaults of C++, which stay if C gives
// zeros or null. False for a struct of a wrong size and for choices that are none.

#include <winnow/c/narrow_phase.h>
#include <winnow/c/partition.h>
#include <winnow/c/scene.h>
#include <winnow/c/scene_sweep.h>
#include <winnow/c/shapes.h>
#include <winnow/c/time_of_impact.h>
#include <winnow/c/volumes.h>
#include <winnow/core/debug_draw.h>
#include <winnow/partitions/partition.h>
#include <winnow/pipeline/narrow_phase.h>
#include <winnow/pipeline/scene.h>
#include <winnow/pipeline/scene_sweep.h>
#include <winnow/pipeline/time_of_impact.h>
#include <winnow/pipeline/triangle_mesh.h>

#include <cstddef>

namespace winnow::c {

/// The memory is null for that of C++.
[[nodiscard]] bool read_options(const winnow_scene_options* given, const winnow_memory*& memory,
                                SceneOptions& options) noexcept;
[[nodiscard]] bool read_options(const winnow_partition_options* given, const winnow_memory*& memory,
                                PartitionOptions& options) noexcept;
[[nodiscard]] bool read_options(const winnow_pair_options* given, PairOptions& options) noexcept;
[[nodiscard]] bool read_options(const winnow_narrow_options* given,
                                NarrowOptions& options) noexcept;
[[nodiscard]] bool read_options(const winnow_impact_options* given,
                                ImpactOptions& options) noexcept;
/// `count` bodies move.
[[nodiscard]] bool read_options(const winnow_sweep_options* given, std::size_t count,
                                SweepOptions& options) noexcept;
[[nodiscard]] bool read_options(const winnow_mesh_options* given, MeshOptions& options) noexcept;
[[nodiscard]] bool read_options(const winnow_debug_draw_options* given,
                                DebugDrawOptions& options) noexcept;

/// Takes a number that is given; 0 leaves the default.
template <typename Number>
void take_given(Number given, Number& number) noexcept {
  if (given != Number{}) number = given;
}

}  // namespace winnow::c
