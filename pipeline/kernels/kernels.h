#pragma once

#include "pipeline/kernels/narrow_job.h"
#include "simd/kernels/kernels.h"

namespace winnow {

// One table per kind of pair, defined in the file of its name.
WINNOW_KERNELS(NarrowKernels, sphere_sphere_kernels);
WINNOW_KERNELS(NarrowKernels, sphere_capsule_kernels);
WINNOW_KERNELS(NarrowKernels, sphere_box_kernels);
WINNOW_KERNELS(NarrowKernels, sphere_triangle_kernels);
WINNOW_KERNELS(NarrowKernels, sphere_half_space_kernels);
WINNOW_KERNELS(NarrowKernels, capsule_capsule_kernels);
WINNOW_KERNELS(NarrowKernels, capsule_box_kernels);
WINNOW_KERNELS(NarrowKernels, capsule_triangle_kernels);
WINNOW_KERNELS(NarrowKernels, capsule_half_space_kernels);
WINNOW_KERNELS(NarrowKernels, box_half_space_kernels);
WINNOW_KERNELS(NarrowKernels, triangle_half_space_kernels);
WINNOW_KERNELS(NarrowKernels, box_box_kernels);
WINNOW_KERNELS(NarrowKernels, box_triangle_kernels);
WINNOW_KERNELS(NarrowKernels, hull_hull_kernels);
WINNOW_KERNELS(NarrowKernels, triangle_triangle_kernels);
WINNOW_KERNELS(NarrowKernels, sphere_hull_kernels);
WINNOW_KERNELS(NarrowKernels, capsule_hull_kernels);
WINNOW_KERNELS(NarrowKernels, box_hull_kernels);
WINNOW_KERNELS(NarrowKernels, hull_triangle_kernels);

/// Where the kernel of a level stands in NarrowKernels. Level pairs has none.
[[nodiscard]] constexpr std::uint32_t kernel_index(ContactLevel level) noexcept {
  return static_cast<std::uint32_t>(level) - static_cast<std::uint32_t>(ContactLevel::boolean);
}

/// The active kernels of a pair kind, a <= b; null where the solver answers.
[[nodiscard]] const NarrowKernels* narrow_kernels(ShapeKind a, ShapeKind b) noexcept;

}  // namespace winnow
